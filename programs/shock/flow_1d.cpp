#include <gas/flow.hpp>

std::unique_ptr<tetsuame::run::simulation> tetsuame::gas::make_1d(const options& o, const std::vector<level>& coarser) {
  return std::make_unique<flow<1>>(o, make_setup(o), coarser);
}
