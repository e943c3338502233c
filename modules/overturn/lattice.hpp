// How fast the stiffest waves of the start lattice are: what bounds an explicit step.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <kernels/kernel.hpp>
#include <numbers>

namespace tetsuame::overturn {

struct lattice_rates {
  double sound;    // largest |Σ Δx^D F x_j sin(k·x_j)| Δx: a wave of sound has the frequency c/Δx times it
  double viscous;  // largest Σ 2 Δx^D |F| (1 - cos k·x_j) Δx²: shear dies at the rate ν/Δx² times it
};

template <int D>
lattice_rates rates_of_lattice(const kernels::any<D>& kernel, double dx) {
  return std::visit(
      [&](const auto& k) {
        const int n = static_cast<int>(std::ceil(k.support() / dx)), waves = D == 3 ? 12 : 32;
        const double V = std::pow(dx, D), unit = std::numbers::pi / waves;
        lattice_rates most{0.0, 0.0};
        const auto each = [](int low, int high, const auto& f) {
          for (int a = low; a <= high; ++a)
            for (int b = low; b <= high; ++b)
              for (int c = D == 3 ? low : 0; c <= (D == 3 ? high : 0); ++c) f(std::array<int, 3>{a, b, c});
        };
        each(0, waves, [&](const std::array<int, 3>& m) {
          if (m[0] < m[1] || m[1] < m[2]) return;  // the lattice's symmetry
          std::array<double, 3> slope{};
          double decay = 0.0;
          each(-n, n, [&](const std::array<int, 3>& at) {
            const double r2 = static_cast<double>(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
            if (r2 == 0.0) return;
            const double F = V * k.gradient_over_r(dx * std::sqrt(r2)) * dx * dx;
            const double phase = unit * static_cast<double>(m[0] * at[0] + m[1] * at[1] + m[2] * at[2]);
            for (std::size_t a = 0; a < 3; ++a) slope[a] += F * at[a] * std::sin(phase);
            decay -= 2.0 * F * (1.0 - std::cos(phase));
          });
          most.sound = std::max(most.sound, std::hypot(slope[0], slope[1], slope[2]));
          most.viscous = std::max(most.viscous, decay);
        });
        return most;
      },
      kernel);
}

}  // namespace tetsuame::overturn
