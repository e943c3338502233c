// A plate or half space cooling from its top, on fixed particles [S2].
#include <cooling/cooling.hpp>
#include <run/time_loop.hpp>

using namespace tetsuame;

int main(int argc, char** argv) {
  cooling::options o;
  const run::program_input own{
      .program = "conduction",
      .shorthands = {},
      .restarts = true,
      .declare = [&](namelist::schema& schema) { cooling::declare(schema, o); },
      .complete = [&](const namelist::schema& schema) { cooling::resolve(schema, o); },
      .need = [&] { return run::need_of(cooling::expected_particles(o), 300.0, o.common.kernel, o.dimension); }};
  return run::start(argc, argv, own, [&](const run::command_line& line, const std::string& resolved) {
    if (o.dimension == 3) {
      cooling::body<3> problem(o);
      run::carry_out(problem, o.common, line, resolved);
    } else {
      cooling::body<2> problem(o);
      run::carry_out(problem, o.common, line, resolved);
    }
  });
}
