#include <free_surface/flow.hpp>
#include <free_surface/make.hpp>
#include <run/passes.hpp>

namespace tetsuame::free_surface {

// In sums_3d.cpp.
extern template void sum_over_neighbours(water<3>&, const pairs::row_range&);
extern template void sum_over_neighbours(water<3>&, const pairs::row_subset&);

}  // namespace tetsuame::free_surface

std::unique_ptr<tetsuame::run::problem> tetsuame::free_surface::make_3d(const options& o, const parameters& p) {
  return std::make_unique<flow<3>>(o, p);
}
