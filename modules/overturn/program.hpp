// What the programs rti and drop share: input, `--theory`, and the march in two or three dimensions.
#pragma once

#include <cstdio>
#include <overturn/two_fluids.hpp>
#include <run/time_loop.hpp>
#include <string>

namespace tetsuame::overturn {

// `theory_is`: what --theory prints, for the help.
inline int program(int argc, char** argv, const char* name, problem_kind kind, const std::string& theory_is) {
  options o;
  parameters p;
  bool theory = false;
  const run::program_input own{
      .program = name,
      .shorthands = {},
      .restarts = true,
      .declare = [&](namelist::schema& schema) { declare(schema, kind, o); },
      .complete = [&](const namelist::schema& schema) { p = resolve(schema, kind, o); },
      .flags = {{"--theory", &theory, "print " + theory_is + ", and stop"}},
      .need = [&] { return run::need_of(expected_particles(o), 800.0, o.common.kernel, o.domain.dimension); }};
  return run::start(argc, argv, own, [&](const run::command_line& line, const std::string& resolved) {
    if (theory) {
      if (domain::communicator::world().rank == 0) std::fputs(theory_text(kind, o, p).c_str(), stdout);
    } else if (o.domain.dimension == 3) {
      two_fluids<3> problem(kind, o, p);
      run::carry_out(problem, o.common, line, resolved);
    } else {
      two_fluids<2> problem(kind, o, p);
      run::carry_out(problem, o.common, line, resolved);
    }
  });
}

}  // namespace tetsuame::overturn
