#include <conduction/conduction.hpp>
#include <hydrostatic/hydrostatic.hpp>
#include <liquid/passes.hpp>
#include <problems/make.hpp>

namespace tetsuame::problems {

std::unique_ptr<run::simulation> at_rest(const hydrostatic::options& o, const liquid::program& scheme) {
  if (o.domain.dimension == 3) return std::make_unique<hydrostatic::problem<3>>(o, scheme.in_3d(o.scheme));
  return std::make_unique<hydrostatic::problem<2>>(o, scheme.in_2d(o.scheme));
}

std::unique_ptr<run::simulation> conduction(const conduction::options& o) {
  if (o.domain.dimension == 3) return std::make_unique<conduction::problem<3>>(o);
  return std::make_unique<conduction::problem<2>>(o);
}

}  // namespace tetsuame::problems
