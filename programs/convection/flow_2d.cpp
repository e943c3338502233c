#include <boussinesq/convection.hpp>
#include <boussinesq/make.hpp>
#include <run/passes.hpp>

std::unique_ptr<tetsuame::run::problem> tetsuame::boussinesq::make_2d(const options& o, const parameters& p) {
  return std::make_unique<convection<2>>(o, p);
}
