// Sums over the start lattice: how fast its stiffest waves are, which bounds an explicit step, and the viscous sum's
// weights.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <kernels/kernel.hpp>
#include <numbers>

namespace tetsuame::two_fluids {

struct lattice_rates {
  double sound;  // largest |Σ Δx^D F x_j sin(k·x_j)| Δx: a wave of sound has the frequency c/Δx times it
  // Bound of Σ 2 Δx^D |F'| (1 - cos k·x_j) (a + b n n) Δx², a and b of terms.hpp: waves die at the rate ν/Δx² times it.
  double viscous;
};

// Numbers along each axis, the third 0 in two dimensions.
template <int D, class F>
void for_each_place(int low, int high, const F& visit) {
  for (int x = low; x <= high; ++x)
    for (int y = low; y <= high; ++y)
      for (int z = D == 3 ? low : 0; z <= (D == 3 ? high : 0); ++z) visit(std::array<int, 3>{x, y, z});
}

// Weights F (a0 - a1 r²) of the viscous sum.
struct viscous_weights {
  double a0 = 1.0, a1 = 0.0;  // 1, 1/m2
};

// Those with Σ Δx^D F' r² = -d and Σ Δx^D F' r⁴ = 0 over the lattice: the sum is ∇² up to sixth derivatives, but for
// what the lattice has of fourth ones in its own directions. Far neighbours then have the other sign.
template <int D>
viscous_weights fourth_order_weights(const kernels::any<D>& kernel, double dx) {
  return std::visit(
      [&](const auto& k) {
        const int n = static_cast<int>(std::ceil(k.support() / dx));
        std::array<double, 3> M{};  // Σ F r², r⁴, r⁶
        for_each_place<D>(-n, n, [&](const std::array<int, 3>& at) {
          const double r2 = dx * dx * (at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
          if (r2 == 0.0) return;
          const double F = std::pow(dx, D) * k.gradient_over_r(std::sqrt(r2));
          for (std::size_t m = 0; m < 3; ++m) M[m] += F * std::pow(r2, static_cast<double>(m + 1));
        });
        // a0 M2 - a1 M4 = -d, a0 M4 - a1 M6 = 0
        const double a1 = -D * M[1] / (M[0] * M[2] - M[1] * M[1]);
        return viscous_weights{a1 * M[2] / M[1], a1};
      },
      kernel);
}

template <int D>
lattice_rates rates_of_lattice(const kernels::any<D>& kernel, double dx, const viscous_weights& weights,
                               bool symmetric_stress = false) {
  const double a = symmetric_stress ? 0.0 : 1.0, b = symmetric_stress ? D + 2.0 : 0.0;
  return std::visit(
      [&](const auto& k) {
        const int n = static_cast<int>(std::ceil(k.support() / dx)), waves = D == 3 ? 12 : 32;
        const double V = std::pow(dx, D), unit = std::numbers::pi / waves;
        lattice_rates most{0.0, 0.0};
        for_each_place<D>(0, waves, [&](const std::array<int, 3>& m) {
          if (m[0] < m[1] || m[1] < m[2]) return;  // the lattice's symmetry
          std::array<double, 3> slope{};
          std::array<std::array<double, 3>, 3> decay{};
          for_each_place<D>(-n, n, [&](const std::array<int, 3>& at) {
            const double r2 = static_cast<double>(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
            if (r2 == 0.0) return;
            const double F = V * k.gradient_over_r(dx * std::sqrt(r2)) * dx * dx;
            const double phase = unit * static_cast<double>(m[0] * at[0] + m[1] * at[1] + m[2] * at[2]);
            for (std::size_t axis = 0; axis < 3; ++axis) slope[axis] += F * at[axis] * std::sin(phase);
            const double rate = -2.0 * F * (weights.a0 - weights.a1 * dx * dx * r2) * (1.0 - std::cos(phase));
            for (std::size_t row = 0; row < D; ++row) {
              decay[row][row] += a * rate;
              for (std::size_t column = 0; column < D; ++column)
                decay[row][column] += b * rate * at[row] * at[column] / r2;
            }
          });
          most.sound = std::max(most.sound, std::hypot(slope[0], slope[1], slope[2]));
          // The largest row sum bounds the eigenvalues.
          for (const auto& row : decay)
            most.viscous = std::max(most.viscous, std::abs(row[0]) + std::abs(row[1]) + std::abs(row[2]));
        });
        return most;
      },
      kernel);
}

}  // namespace tetsuame::two_fluids
