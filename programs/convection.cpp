// Thermal convection of air and mantle, with slowed sound and inertia [S1].
#include <boussinesq/convection.hpp>
#include <march/march.hpp>

using namespace tetsuame;

int main(int argc, char** argv) {
  boussinesq::options o;
  boussinesq::parameters p;
  const simulation::program_input own{
      .program = "convection",
      .shorthands = {},
      .restarts = true,
      .declare = [&](namelist::schema& schema) { boussinesq::declare(schema, o); },
      .complete = [&](const namelist::schema& schema) { p = boussinesq::resolve(schema, o); },
      .need =
          [&] {
            return simulation::need_of(boussinesq::expected_particles(o), 1440.0, o.march.kernel,
                                       o.physics.domain.dimension);
          }};
  return simulation::start(argc, argv, own, [&](const simulation::command_line& line, const std::string& resolved) {
    if (o.physics.domain.dimension == 3) {
      boussinesq::convection<3> problem(o, p);
      march::run(problem, o.march, line, resolved);
    } else {
      boussinesq::convection<2> problem(o, p);
      march::run(problem, o.march, line, resolved);
    }
  });
}
