// How a trace element parts between metal and silicate, docs/theory/partition.md. Exchange coefficient of
//   M + (n/2) FeO = MO_(n/2) + (n/2) Fe,   log10 K_D = a + b/T + c p/T,   metal over silicate
#pragma once

#include <fmt/format.h>
#include <cmath>
#include <foundation/error.hpp>

namespace tetsuame::theory {

struct exchange_law {
  double a, b, c;  // -, K, K/GPa
  int valence;     // n
};

// [D. C. Rubie et al., Icarus 248, 89 (2015), table S1]
inline constexpr exchange_law nickel{1.06, 1553.0, -98.0, 2};
inline constexpr exchange_law cobalt{0.13, 2057.0, -57.0, 2};

// Mole fraction in the metal over that in the silicate, K_D (X_Fe/X_FeO)^(n/2), at p (Pa), T (K) for that ratio of
// iron.
inline double partition_coefficient(const exchange_law& law, double p, double T, double iron_ratio) {
  const auto require = [](bool good, const char* what, double value) {
    if (!good) foundation::fail_input(fmt::format("uptake of a sphere: {}, not {}", what, value));
  };
  require(iron_ratio > 0.0, "the ratio of iron must be > 0", iron_ratio);
  require(T > 0.0, "the temperature must be > 0 K", T);
  return std::pow(10.0, law.a + (law.b + law.c * p * 1e-9) / T) * std::pow(iron_ratio, 0.5 * law.valence);
}

}  // namespace tetsuame::theory
