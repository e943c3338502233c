// Thermal convection of air and mantle, with slowed sound and inertia [S1].
#include <convection/options.hpp>
#include <run/simulation.hpp>

using namespace tetsuame;

int main(int argc, char** argv) {
  convection::options o;
  convection::parameters p;
  const run::program_input own{
      .program = "convection",
      .restarts = true,
      .declare = [&](namelist::schema& schema) { convection::declare(schema, o); },
      .complete = [&](const namelist::schema& schema) { p = convection::resolve(schema, o); },
      .need = [&] { return run::need_of(o.domain.lattice_particles(), 1440.0, o.common.kernel, o.domain.dimension); },
      .rehearsed_with = {"convection.levels=0"}};
  return run::start(argc, argv, own, [&](const run::command_line& line, const std::string& resolved) {
    if (line.plan) o.convection.levels = 0;  // of the lattice that is asked for, without the coarser ones before it
    run::carry_out(*convection::make(o, p), o.common, line, resolved);
  });
}
