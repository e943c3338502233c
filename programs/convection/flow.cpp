#include <convection/convection.hpp>
#include <run/passes.hpp>

namespace tetsuame::convection {

std::unique_ptr<run::simulation> make(const options& o, const parameters& p) {
  if (o.domain.dimension == 3) return std::make_unique<problem<3>>(o, p);
  return std::make_unique<problem<2>>(o, p);
}

}  // namespace tetsuame::convection
