// Sums over the fluid of all ranks, exact: they do not depend on how it is split.
#pragma once

#include <foundation/exact_sum.hpp>
#include <run/lists.hpp>

namespace tetsuame::liquid {

// each(i, add) gives add what particle i adds to the first sums, one number for each; as often as it likes.
template <std::size_t N, int D, class Each>
std::array<double, N> exact_sums(const run::state<D>& box, const Each& each) {
  std::array<foundation::exact_sum, N> sums;
  const auto add = [&](auto... values) {
    static_assert(sizeof...(values) <= N);
    std::size_t k = 0;
    (sums[k++].add(values), ...);
  };
  for (std::size_t i = 0; i < box.w.s.fluid; ++i) each(i, add);
  std::array<double, N> rounded;
  for (std::size_t k = 0; k < N; ++k) rounded[k] = box.w.d.ranks.exact(sums[k]);
  return rounded;
}

}  // namespace tetsuame::liquid
