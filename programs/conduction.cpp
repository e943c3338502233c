// A plate or half space cooling from its top, on fixed particles [S2].
#include <cooling/cooling.hpp>
#include <march/march.hpp>

using namespace tetsuame;

int main(int argc, char** argv) {
  cooling::options o;
  const simulation::program_input own{
      .program = "conduction",
      .shorthands = {},
      .restarts = true,
      .declare = [&](namelist::schema& schema) { cooling::declare(schema, o); },
      .complete = [&](const namelist::schema& schema) { cooling::resolve(schema, o); },
      .need = [&] { return simulation::need_of(cooling::expected_particles(o), 300.0, o.march.kernel, o.dimension); }};
  return simulation::start(argc, argv, own, [&](const simulation::command_line& line, const std::string& resolved) {
    if (o.dimension == 3) {
      cooling::body<3> problem(o);
      march::run(problem, o.march, line, resolved);
    } else {
      cooling::body<2> problem(o);
      march::run(problem, o.march, line, resolved);
    }
  });
}
