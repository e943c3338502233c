#include <gas/flow.hpp>
#include <run/passes.hpp>

std::unique_ptr<tetsuame::run::simulation> tetsuame::gas::make_2d(const options& o, const std::vector<level>& coarser) {
  return std::make_unique<flow<2>>(o, make_setup(o), coarser);
}

std::unique_ptr<tetsuame::run::simulation> tetsuame::gas::make_2d(const options& o, setup start) {
  return std::make_unique<flow<2>>(o, std::move(start), std::vector<level>{});
}
