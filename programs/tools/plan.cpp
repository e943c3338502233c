// Plans a run before it is started: `plan relaxation`, `plan timestep`. Formulas: modules/relaxation.
#include <command.hpp>
#include <plan/shared.hpp>

int main(int argc, char** argv) {
  using namespace tetsuame;
  CLI::App app{"Time steps, their number and the time they take, before a run is started.", "plan"};
  app.require_subcommand(1);
  auto* first = app.add_subcommand("relaxation", "convection with slowed sound and inertia: zeta, xi, steps");
  auto* second = app.add_subcommand("timestep", "metal sinking through silicate with damped sound: eta, steps");
  const auto relaxation = plan::relaxation_question(*first), timestep = plan::timestep_question(*second);
  if (const int status = tools::parse(app, argc, argv); status >= 0) return status;
  return tools::carry_out("plan", foundation::exit_status::calculation_failed, [&] {
    first->parsed() ? relaxation() : timestep();
    return 0;
  });
}
