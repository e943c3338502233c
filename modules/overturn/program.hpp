// What the programs rti and drop share: input, `--theory`, and the march in two or three dimensions.
#pragma once

#include <cstdio>
#include <march/march.hpp>
#include <overturn/two_fluids.hpp>
#include <string>

namespace tetsuame::overturn {

// `theory_is`: what --theory prints, for the help.
inline int program(int argc, char** argv, const char* name, problem_kind kind, const std::string& theory_is) {
  options o;
  parameters p;
  bool theory = false;
  const simulation::program_input own{
      .program = name,
      .shorthands = {},
      .restarts = true,
      .declare = [&](namelist::schema& schema) { declare(schema, kind, o); },
      .complete = [&](const namelist::schema& schema) { p = resolve(schema, kind, o); },
      .flags = {{"--theory", &theory, "print " + theory_is + ", and stop"}},
      .need = [&] { return simulation::need_of(expected_particles(o), 800.0, o.march.kernel, o.domain.dimension); }};
  return simulation::start(argc, argv, own, [&](const simulation::command_line& line, const std::string& resolved) {
    if (theory) {
      if (domain::communicator::world().rank == 0) std::fputs(theory_text(kind, o, p).c_str(), stdout);
    } else if (o.domain.dimension == 3) {
      two_fluids<3> problem(kind, o, p);
      march::run(problem, o.march, line, resolved);
    } else {
      two_fluids<2> problem(kind, o, p);
      march::run(problem, o.march, line, resolved);
    }
  });
}

}  // namespace tetsuame::overturn
