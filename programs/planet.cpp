// A planet of layers under its own gravity: its structure, and its particles, settled and free.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <domain/communicator.hpp>
#include <foundation/error.hpp>
#include <gas/convergence.hpp>
#include <output/file.hpp>
#include <planet/options.hpp>
#include <run/command_line.hpp>
#include <run/simulation.hpp>

using namespace tetsuame;

int main(int argc, char** argv) {
  planet::options o;
  std::string profile;
  const run::program_input own{.program = "planet",
                               .restarts = true,
                               .declare = [&](namelist::schema& schema) { planet::declare(schema, o); },
                               .complete = [&](const namelist::schema& schema) { planet::resolve(schema, o); },
                               .need =
                                   [&] {
                                     return run::need_of(static_cast<double>(o.number_of_particles()), 1330.0,
                                                         o.gas.common.kernel, static_cast<int>(o.dimension));
                                   },
                               .particles_key = {"planet", "particles"},
                               .add_options =
                                   [&](CLI::App& app, run::command_line&) {
                                     app.add_option("--profile", profile,
                                                    "write the planet's structure to this file, as JSON, and stop")
                                         ->type_name("FILE.json");
                                   }};
  return run::start(argc, argv, own, [&](const run::command_line& line, const std::string& resolved) {
    if (!profile.empty() && o.impact_of)
      foundation::fail_input("--profile is of one planet, and the input has &impact");
    if (!profile.empty()) return output::write_text(MPI_COMM_WORLD, profile, planet::describe(o));
    if (domain::communicator::world().rank == 0) std::fputs(planet::summary(o).c_str(), stderr);
    auto start = o.impact_of ? planet::impact_start(o) : planet::start_of(o);
    const auto simulation =
        o.dimension == 2 ? gas::make_2d(o.gas, std::move(start)) : gas::make_3d(o.gas, std::move(start));
    run::carry_out(*simulation, o.gas.common, line, resolved);
  });
}
