#include <free_surface/make.hpp>
#include <free_surface/passes.hpp>

std::unique_ptr<tetsuame::run::simulation> tetsuame::free_surface::make_3d(const options& o, const parameters& p) {
  return std::make_unique<flow<3>>(o, p);
}
