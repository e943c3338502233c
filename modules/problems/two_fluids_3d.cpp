#include <liquid/passes.hpp>
#include <overturn/two_fluids.hpp>
#include <problems/make.hpp>

namespace tetsuame::problems {

std::unique_ptr<run::problem> two_fluids_3d(overturn::problem_kind kind, const overturn::options& o,
                                            const overturn::parameters& p, const liquid::program* scheme) {
  return std::make_unique<overturn::two_fluids<3>>(kind, o, p, scheme ? scheme->in_3d(o.liquid) : nullptr);
}

}  // namespace tetsuame::problems
