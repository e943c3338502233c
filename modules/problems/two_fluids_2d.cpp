#include <liquid/passes.hpp>
#include <problems/make.hpp>
#include <two_fluids/passes.hpp>
#include <two_fluids/two_fluids.hpp>

namespace tetsuame::problems {

std::unique_ptr<run::simulation> two_fluids_2d(two_fluids::problem_kind kind, const two_fluids::options& o,
                                               const two_fluids::parameters& p, const liquid::program* scheme) {
  return std::make_unique<two_fluids::problem<2>>(kind, o, p,
                                                  scheme ? scheme->in_2d(two_fluids::liquid_options(o)) : nullptr);
}

}  // namespace tetsuame::problems
