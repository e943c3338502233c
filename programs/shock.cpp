// Gas with contacts and shocks: SSPH, DISPH, GSPH, Godunov DISPH [S4] and REMIX.
#include <march/march.hpp>
#include <shocks/make.hpp>

using namespace tetsuame;

int main(int argc, char** argv) {
  shocks::options o;
  const simulation::program_input own{.program = "shock",
                                      .shorthands = {},
                                      .restarts = true,
                                      .declare = [&](namelist::schema& schema) { shocks::declare(schema, o); },
                                      .complete = [&](const namelist::schema& schema) { shocks::resolve(schema, o); }};
  return simulation::start(argc, argv, own, [&](const simulation::command_line& line, const std::string& resolved) {
    const auto problem = o.dimension == 1   ? shocks::make_1d(o)
                         : o.dimension == 2 ? shocks::make_2d(o)
                                            : shocks::make_3d(o);
    march::run(*problem, o.march, line, resolved);
  });
}
