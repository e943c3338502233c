#include <granular/granular.hpp>
#include <granular/make.hpp>
#include <run/passes.hpp>

std::unique_ptr<tetsuame::run::simulation> tetsuame::granular::make_2d(const options& o) {
  return std::make_unique<problem<2>>(o);
}
