// Time steps of slowed convection and how many of them show it (docs/theory/relaxation.md):
//   dt <= C min( zeta xi dx/c_0, xi^2 dx^2/(2 nu), dx^2/(2 kappa) ),  tau = L/V,  N = tau/dt
#pragma once

#include <cstdint>
#include <relaxation/rules.hpp>
#include <string>

namespace tetsuame::relaxation {

struct step_bounds {
  double sound, momentum, heat;  // s, the fraction C included
  double least() const;
  std::string binding() const;  // "sound", "momentum" or "heat"
};

// dx: m, the particle spacing; fraction: C, below 1.
step_bounds bounds(const fluid_layer& f, double zeta, double xi, double dx, double fraction);

struct cost {
  double evaluations_per_step = 1.0;  // of the right-hand side
  double updates_per_second = 0.0;    // particles x evaluations; 0: not known
};

struct convection_plan {
  std::int64_t n;    // particles along the height L
  double particles;  // n^d times the box's other edges over L
  double dx;         // m
  step_bounds dt;    // s
  double tau;        // s, L/V
  double steps;      // tau/dt
  double seconds;    // of computing; 0: the rate is not known
};

// volume_ratio: the box's volume over L^d.
convection_plan plan_convection(const fluid_layer& f, const recommendation& r, std::int64_t n, int dimension,
                                double volume_ratio, double fraction, const cost& c);

// The largest n >= 1 for which a turnover takes at most so many steps, or so many seconds (which needs the
// rate); 0 if even n = 1 takes more.
std::int64_t largest_n_in_steps(const fluid_layer& f, const recommendation& r, double steps, double fraction);
std::int64_t largest_n_in_seconds(const fluid_layer& f, const recommendation& r, int dimension, double volume_ratio,
                                  double fraction, const cost& c, double seconds);

// The largest n in 1 … 10^9 that is affordable, where affordable(n) is true up to some n and false
// beyond it; 0 if none is.
template <class Test>
std::int64_t largest_that(Test affordable) {
  std::int64_t below = 0, above = 1'000'000'001;
  while (above - below > 1) {
    const std::int64_t middle = below + (above - below) / 2;
    (affordable(middle) ? below : above) = middle;
  }
  return below;
}

}  // namespace tetsuame::relaxation
