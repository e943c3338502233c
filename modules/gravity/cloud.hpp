// Particles that attract each other, and where their field is written: what direct summation and the tree share.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <foundation/error.hpp>
#include <string>

namespace tetsuame::gravity {

// n particles, each array of n values, not owned. In 2-D a particle is an infinitely long straight line.
template <int D>
struct cloud {
  std::array<const double*, D> x;     // m
  const double* mass;                 // kg, in 2-D kg/m; at least 0
  const double* support;              // m, the distance from which the field of a particle is Newton's; at least 0
  const std::uint64_t* id = nullptr;  // each value once
  std::size_t n = 0;
};

// Arrays as long as there are targets, not owned.
template <int D>
struct field {
  std::array<double*, D> acceleration;  // m/s²
  double* potential;                    // J/kg, without a particle's own share; in 2-D 0 at a distance of 1 m
};

// G in 3-D, 2 G in 2-D (m³/(kg s²)): the acceleration is this times m/r^(D-1).
template <int D>
constexpr double strength(double gravitational_constant) {
  return (D - 1 == 1 ? 2.0 : 1.0) * gravitational_constant;
}

// Throws foundation::error, which names the particle, unless positions are finite, masses and supports finite and at
// least 0.
template <int D>
void check(const cloud<D>& particles) {
  const auto fail = [&](std::size_t i, const std::string& fault) {
    foundation::fail_calculation("gravity: particle " + std::to_string(particles.id ? particles.id[i] : i) +
                                 " (index " + std::to_string(i) + ") " + fault);
  };
  for (std::size_t i = 0; i < particles.n; ++i) {
    for (std::size_t a = 0; a < D; ++a)
      if (!std::isfinite(particles.x[a][i])) fail(i, "has a position that is not finite");
    if (!(particles.mass[i] >= 0.0) || !std::isfinite(particles.mass[i]))
      fail(i, "has a mass that is negative or not finite");
    if (!(particles.support[i] >= 0.0) || !std::isfinite(particles.support[i]))
      fail(i, "has a support that is negative or not finite");
  }
}

}  // namespace tetsuame::gravity
