#include <conduction/conduction.hpp>
#include <liquid/passes.hpp>
#include <problems/make.hpp>

namespace tetsuame::problems {

std::unique_ptr<run::problem> conduction(const conduction::options& o) {
  if (o.domain.dimension == 3) return std::make_unique<conduction::problem<3>>(o);
  return std::make_unique<conduction::problem<2>>(o);
}

}  // namespace tetsuame::problems
