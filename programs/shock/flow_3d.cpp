#include <run/passes.hpp>
#include <shocks/flow.hpp>
#include <shocks/make.hpp>

std::unique_ptr<tetsuame::run::problem> tetsuame::shocks::make_3d(const options& o, const std::vector<level>& coarser) {
  return std::make_unique<flow<3>>(o, coarser);
}
