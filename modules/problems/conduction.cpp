#include <cooling/cooling.hpp>
#include <liquid/passes.hpp>
#include <problems/make.hpp>

namespace tetsuame::problems {

std::unique_ptr<run::problem> conduction(const cooling::options& o) {
  if (o.domain.dimension == 3) return std::make_unique<cooling::body<3>>(o);
  return std::make_unique<cooling::body<2>>(o);
}

}  // namespace tetsuame::problems
