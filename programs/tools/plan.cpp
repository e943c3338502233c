// Plans a run before it is started: `plan relaxation`, `plan timestep`. Formulas: modules/relaxation.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <foundation/error.hpp>
#include <plan/shared.hpp>
#include <run/command_line.hpp>

int main(int argc, char** argv) {
  using namespace tetsuame;
  CLI::App app{"Time steps, their number and the time they take, before a run is started.", "plan"};
  app.set_version_flag("--version", run::version());
  app.require_subcommand(1);
  auto* first = app.add_subcommand("relaxation", "convection with slowed sound and inertia: zeta, xi, steps");
  auto* second = app.add_subcommand("timestep", "metal sinking through silicate with damped sound: eta, steps");
  const auto relaxation = plan::relaxation_question(*first), timestep = plan::timestep_question(*second);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    app.exit(e);
    return 0;
  } catch (const CLI::ParseError& e) {
    fmt::print(stderr, "plan: {}\nTry --help.\n", e.what());
    return static_cast<int>(foundation::exit_status::bad_input);
  }
  try {
    first->parsed() ? relaxation() : timestep();
    return 0;
  } catch (const foundation::error& e) {
    fmt::print(stderr, "plan: {}\n", e.what());
    return static_cast<int>(e.status());
  }
}
