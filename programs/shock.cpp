// Gas with contacts and shocks: SSPH, geometric densities, DISPH, GSPH, Godunov DISPH [S4] and REMIX.
#include <gas/convergence.hpp>
#include <run/simulation.hpp>

using namespace tetsuame;

namespace {

std::unique_ptr<run::simulation> make(const gas::options& o, const std::vector<gas::level>& coarser) {
  return o.domain.dimension == 1   ? gas::make_1d(o, coarser)
         : o.domain.dimension == 2 ? gas::make_2d(o, coarser)
                                   : gas::make_3d(o, coarser);
}

}  // namespace

int main(int argc, char** argv) {
  gas::options o;
  std::vector<gas::coarser_input> coarser;
  const run::program_input own{
      .program = "shock",
      .restarts = true,
      .declare = [&](namelist::schema& schema) { gas::declare(schema, o); },
      .complete =
          [&](const namelist::schema& schema) {
            gas::resolve(schema, o);
            coarser = gas::coarser_inputs(schema, o);
          },
      .need = [&] { return run::need_of(gas::expected_particles(o), 1080.0, o.common.kernel, o.domain.dimension); },
      .rehearsed_with = {"shock.coarser=0"}};
  return run::start(argc, argv, own, [&](const run::command_line& line, const std::string& resolved) {
    gas::run_all(o, resolved, coarser, line, make);
  });
}
