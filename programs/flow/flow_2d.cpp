#include <free_surface/flow.hpp>
#include <free_surface/make.hpp>
#include <run/passes.hpp>

namespace tetsuame::free_surface {

// In sums_2d.cpp.
extern template void sum_over_neighbours(water<2>&, const pairs::row_range&);
extern template void sum_over_neighbours(water<2>&, const pairs::row_subset&);

}  // namespace tetsuame::free_surface

std::unique_ptr<tetsuame::run::problem> tetsuame::free_surface::make_2d(const options& o, const parameters& p) {
  return std::make_unique<flow<2>>(o, p);
}
