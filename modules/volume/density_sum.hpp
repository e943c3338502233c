// Standard SPH: the density is the kernel's own sum [Gingold & Monaghan, Mon. Not. R. Astron. Soc. 181, 375 (1977)].
//   ρ_i = (1/s) Σ_j m_j W_ij, j = i included, with m_i for what stands behind walls;  s = Σ W Δx^D of the start lattice
//   ΔV_i = m_i/ρ_i,  Y_i = p^_i ΔV_i
// With gradient pattern 1 and p = p^ the force is -m_i Σ_j m_j (p_i/ρ_i² + p_j/ρ_j²) ∇_i W_ij. Where two liquids meet,
// ρ is smeared over a kernel, and with it p^(ρ): the surface tension that DISPH is without.
#pragma once

#include <volume/smoothed.hpp>

namespace tetsuame::volume {

// ρ_i as above; `mass` is zero behind walls.
template <int D>
struct mass_sum {
  const double* mass;  // kg
  double self, scale;  // 1/m^D, 1
  double* rho;         // kg/m3

  template <class R>
  struct me {
    R fluid, behind_walls;
  };
  auto reads() const { return std::tuple{pairs::read(pairs::of_weight, mass)}; }
  template <class R>
  me<R> begin(const pairs::cluster<R>&) const {
    return {R(0.0), R(0.0)};
  }
  void add(auto& a, const auto& ij) const {
    const auto m = ij(pairs::of_weight);
    a.fluid += m * ij.W;
    a.behind_walls += foundation::select(m != 0.0, 0.0, ij.W);
  }
  void end(const auto& i, const auto& a) const {
    i.set(rho, scale * (a.fluid + i(mass) * (self * i.lengths.to(D) + a.behind_walls)), -D);
  }
};

struct density_sum {
  static constexpr const char* name = "density_sum";
  static constexpr carries carried = carries::nothing;
};

}  // namespace tetsuame::volume
