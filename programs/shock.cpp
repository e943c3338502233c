// Gas with contacts and shocks: SSPH, DISPH, GSPH, Godunov DISPH [S4] and REMIX.
#include <run/time_loop.hpp>
#include <shocks/make.hpp>

using namespace tetsuame;

namespace {

std::unique_ptr<run::problem> make(const shocks::options& o, const std::vector<shocks::level>& coarser) {
  return o.domain.dimension == 1   ? shocks::make_1d(o, coarser)
         : o.domain.dimension == 2 ? shocks::make_2d(o, coarser)
                                   : shocks::make_3d(o, coarser);
}

}  // namespace

int main(int argc, char** argv) {
  shocks::options o;
  std::vector<shocks::coarser_input> coarser;
  const run::program_input own{
      .program = "shock",
      .shorthands = {},
      .restarts = true,
      .declare = [&](namelist::schema& schema) { shocks::declare(schema, o); },
      .complete =
          [&](const namelist::schema& schema) {
            shocks::resolve(schema, o);
            coarser = shocks::coarser_inputs(schema, o);
          },
      .need = [&] { return run::need_of(shocks::expected_particles(o), 1080.0, o.common.kernel, o.domain.dimension); }};
  return run::start(argc, argv, own, [&](const run::command_line& line, const std::string& resolved) {
    shocks::run_all(o, resolved, coarser, line, make);
  });
}
