#include "direct.hpp"

#include <algorithm>
#include <foundation/threads.hpp>
#include <gravity/near_field.hpp>
#include <vector>

namespace tetsuame::gravity {

template <int D>
void direct(const cloud<D>& particles, double gravitational_constant, std::size_t first, std::size_t last,
            const field<D>& to) {
  constexpr std::size_t lanes = foundation::lanes;
  check(particles);
  const std::size_t n = particles.n;
  const auto padded = [n](const double* from) {
    std::vector<double> all(from, from + n);
    all.resize(n + lanes, 0.0);
    return all;
  };
  std::array<std::vector<double>, D> x;
  for (std::size_t a = 0; a < D; ++a) x[a] = padded(particles.x[a]);
  const auto mass = padded(particles.mass);
  auto inverse = padded(particles.support);
  for (auto& h : inverse) h = inverse_support(h);
  source_arrays<D> all{{}, mass.data(), inverse.data()};
  for (std::size_t a = 0; a < D; ++a) all.x[a] = x[a].data();
  const double factor = strength<D>(gravitational_constant);
  foundation::for_chunks(last - first, 64, n > 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; k += lanes) {
      std::array<target_register<D>, 1> targets;
      targets[0].start(all, first + k);
      add_sources<true, true>(targets, all, 0, n);
      for (std::size_t lane = 0; lane < std::min(lanes, end - k); ++lane) {
        for (std::size_t a = 0; a < D; ++a) to.acceleration[a][k + lane] = factor * targets[0].pull[a][lane];
        to.potential[k + lane] = factor * targets[0].potential[lane];
      }
    }
  });
}

template void direct<2>(const cloud<2>&, double, std::size_t, std::size_t, const field<2>&);
template void direct<3>(const cloud<3>&, double, std::size_t, std::size_t, const field<3>&);

}  // namespace tetsuame::gravity
