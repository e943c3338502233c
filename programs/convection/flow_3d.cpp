#include <boussinesq/convection.hpp>
#include <boussinesq/make.hpp>
#include <run/passes.hpp>

std::unique_ptr<tetsuame::run::problem> tetsuame::boussinesq::make_3d(const options& o, const parameters& p) {
  return std::make_unique<convection<3>>(o, p);
}
