#include "direct.hpp"

#include <algorithm>
#include <foundation/threads.hpp>
#include <gravity/near_field.hpp>

namespace tetsuame::gravity {

template <int D>
void direct(const cloud<D>& particles, double gravitational_constant, std::size_t first, std::size_t last,
            const field<D>& to) {
  using foundation::real;
  constexpr std::size_t lanes = foundation::lanes;
  check(particles);
  const std::size_t n = particles.n;
  const double factor = strength<D>(gravitational_constant);
  foundation::for_chunks(last - first, 64, n > 256, [&](std::size_t begin, std::size_t end) {
    // Targets stand before all others in the list.
    source_list<D, real> all;
    all.reserve(n + lanes);
    const auto put = [&](std::size_t at, std::size_t i) {
      for (std::size_t a = 0; a < D; ++a) all.x[a][at] = particles.x[a][i];
      all.mass[at] = particles.mass[i];
      all.inverse_support[at] = inverse_support<real>(particles.support[i]);
    };
    for (std::size_t k = first + begin; k < first + end; k += lanes) {
      const std::size_t targets = std::min(lanes, first + end - k);
      all.size = 0;
      for (std::size_t i = k; i < k + targets; ++i) put(all.size++, i);
      for (std::size_t i = 0; i < n; ++i)
        if (i < k || i >= k + targets) put(all.size++, i);
      const auto sums = sum_pairs<D, real, lanes>(all, targets, n);
      for (std::size_t lane = 0; lane < targets; ++lane) {
        for (std::size_t a = 0; a < D; ++a) to.acceleration[a][k - first + lane] = factor * sums.pull[a][lane];
        to.potential[k - first + lane] = factor * sums.potential[lane];
      }
    }
  });
}

template void direct<2>(const cloud<2>&, double, std::size_t, std::size_t, const field<2>&);
template void direct<3>(const cloud<3>&, double, std::size_t, std::size_t, const field<3>&);

}  // namespace tetsuame::gravity
