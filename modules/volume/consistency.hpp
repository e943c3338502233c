// An integrated density, or Y, that is tied to the particles' places: &volume consistency = 'tied'.
//   D ln ρ_i/Dt = (continuity) + (ρ_N,i/ρ_i - 1)/τ_i,   ρ_N,i = m_i Σ_j W_ij/s,   1/τ = rate · c/Δx
// with j = i and what stands behind walls in the sum and s = Σ W Δx^D of the start lattice. The continuity equation
// alone lets ρ drift from where the particles are, first beside walls (docs/theory/consistency.md).
#pragma once

#include <volume/smoothed.hpp>

namespace tetsuame::volume {

// 1/s, what the tie adds to D ln ρ/Dt of particle i. counted: kg/m3, ρ_N.
template <int D>
double tie(const pairs::workspace<D>& w, double rate, double counted, std::size_t i) {
  return rate * w.s.c[i] / w.dx * (counted / w.s.rho[i] - 1.0);
}

// ρ of the particles [first, last) as the root of Y = m p^(ρ, T)/ρ, by Newton's method in ln ρ from ρ_N: there is one
// where K_T > p^. Not a number where it is not found. The equation of state's values are those at the root.
template <int D>
void density_by_weight(pairs::workspace<D>& w, const particles::array& counted, std::size_t first, std::size_t last) {
  constexpr int most = 60;
  auto& s = w.s;
  foundation::for_all(last - first, [&](std::size_t k) {
    const std::size_t i = first + k;
    std::visit(
        [&](const auto& material) {
          double rho = counted[i], change = 1.0;
          for (int n = 0; n < most && std::abs(change) > 1e-14; ++n) {
            const eos::properties e = material.evaluate(rho, s.T[i]);
            change = (s.Y[i] / s.m[i] * rho - e.p) / (e.K_T - e.p);
            rho *= std::exp(std::clamp(change, -0.5, 0.5));
          }
          s.rho[i] = std::abs(change) <= 1e-12 ? rho : std::numeric_limits<double>::quiet_NaN();
        },
        w.materials[static_cast<std::size_t>(s.material[i])]);
  });
}

// Values of wall particles where the field is even about the wall: those at the markers; 0 where there are none.
template <int D>
void even_behind_walls(pairs::workspace<D>& w, walls::wall_set<D>& set, const walls::any& treatment,
                       particles::array& values) {
  std::visit(
      [&]<class Treatment>(Treatment) {
        if constexpr (Treatment::has_markers)
          walls::detail::at_markers(w, set, std::array<const double*, 1>{values.data()},
                                    [&](std::size_t i, const auto& of) { values[i] = of[0]; });
        else
          std::fill(values.begin() + static_cast<std::ptrdiff_t>(w.s.first_wall()), values.end(), 0.0);
      },
      treatment);
  w.exchange_walls({values.data()});
}

}  // namespace tetsuame::volume
