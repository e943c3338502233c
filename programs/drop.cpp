// A drop of one fluid that sinks in another: terminal velocity in a box.
#include <march/march.hpp>
#include <overturn/two_fluids.hpp>

using namespace tetsuame;

int main(int argc, char** argv) {
  constexpr auto kind = overturn::problem_kind::drop;
  overturn::options o;
  overturn::parameters p;
  bool theory = false;
  const simulation::program_input own{
      .program = "drop",
      .shorthands = {},
      .restarts = true,
      .declare = [&](namelist::schema& schema) { overturn::declare(schema, kind, o); },
      .complete = [&](const namelist::schema& schema) { p = overturn::resolve(schema, kind, o); },
      .flags = {{"--theory", &theory, "print the terminal velocity of creeping flow, and stop"}}};
  return simulation::start(argc, argv, own, [&](const simulation::command_line& line, const std::string& resolved) {
    if (theory) {
      if (domain::communicator::world().rank == 0) std::fputs(overturn::theory_text(kind, o, p).c_str(), stdout);
    } else if (o.domain.dimension == 3) {
      overturn::two_fluids<3> problem(kind, o, p);
      march::run(problem, o.march, line, resolved);
    } else {
      overturn::two_fluids<2> problem(kind, o, p);
      march::run(problem, o.march, line, resolved);
    }
  });
}
