// An element dissolved in metal and silicate, c the amount per mass (docs/theory/partition.md#in-a-run):
//   m_i dc_i/dt = Σ_j K_ij ΔV_i ΔV_j F_ij (u_i - u_j),  K_ij = 4 k_i k_j/(k_i + k_j)
//   within a material u = c and k = ρ D; across the contact u = c/P in the metal, and k = ρ D P
#pragma once

#include <diffusion/viscosity.hpp>
#include <pairs/pairs.hpp>

namespace tetsuame::elements {

inline constexpr struct concentration_tag {
} of_concentration;
inline constexpr struct partition_tag {
} of_partition;
inline constexpr struct mobility_tag {
} of_mobility;
inline constexpr struct metal_tag {
} of_metal;

template <int D>
struct exchange {
  const double *c, *P;          // 1: amount per mass; 1 in silicate
  const double *k, *metal, *V;  // kg/(m s): ρ D; 1 or 0; m^D
  double* gain;                 // kg/s

  template <class R>
  struct me {
    R sum;
  };
  auto reads() const {
    using namespace pairs;
    return std::tuple{read(of_concentration, c), read(of_partition, P), read(of_mobility, k), read(of_metal, metal),
                      read(of_volume, V, D)};
  }
  template <class R>
  me<R> begin(const pairs::cluster<R>&) const {
    return {R(0.0)};
  }
  void add(auto& a, const auto& ij) const {
    using namespace pairs;
    const auto same = ij.own(of_metal) == ij(of_metal);
    const auto P_i = foundation::select(same, 1.0, ij.own(of_partition));
    const auto P_j = foundation::select(same, 1.0, ij(of_partition));
    const auto K =
        diffusion::harmonic(foundation::rounded(ij.own(of_mobility) * P_i), foundation::rounded(ij(of_mobility) * P_j));
    a.sum += diffusion::of_both_ends(K, ij.own(of_volume), ij(of_volume), ij.F) *
             (ij.own(of_concentration) / P_i - ij(of_concentration) / P_j);
  }
  void end(const auto& i, const auto& a) const { i.set(gain, a.sum, D - 2); }
};

}  // namespace tetsuame::elements
