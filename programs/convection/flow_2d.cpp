#include <convection/convection.hpp>
#include <run/passes.hpp>

std::unique_ptr<tetsuame::run::problem> tetsuame::convection::make_2d(const options& o, const parameters& p) {
  return std::make_unique<problem<2>>(o, p);
}
