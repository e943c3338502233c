// Spheres in contact: impacts, heaps, silos.
#include <granular/make.hpp>
#include <run/command_line.hpp>

using namespace tetsuame;

int main(int argc, char** argv) {
  granular::options o;
  const run::program_input own{.program = "granular",
                               .restarts = true,
                               .declare = [&](namelist::schema& schema) { granular::declare(schema, o); },
                               .complete = [&](const namelist::schema& schema) { granular::resolve(schema, o); },
                               .need =
                                   [&] {
                                     return run::need_of(static_cast<double>(granular::number_of_grains(o)), 900.0,
                                                         o.common.kernel, static_cast<int>(o.domain.dimension));
                                   },
                               .particles_key = {"packing", "radius"}};
  return run::start(argc, argv, own, [&](const run::command_line& line, const std::string& resolved) {
    const auto simulation = o.domain.dimension == 2 ? granular::make_2d(o) : granular::make_3d(o);
    run::carry_out(*simulation, o.common, line, resolved);
  });
}
