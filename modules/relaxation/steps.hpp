// Time steps of slowed convection and how many of them show it (docs/theory/relaxation.md):
//   dt <= C min( zeta xi dx/c_0, xi^2 dx^2/(2 nu), dx^2/(2 kappa) ),  tau = L/V,  N = tau/dt
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
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

// At most so many steps, or seconds of computing, which need a rate (infinite: no such wish).
struct budget {
  double steps = std::numeric_limits<double>::infinity();
  double seconds = std::numeric_limits<double>::infinity();
};

// The largest n >= 1 for which a turnover takes no more; 0 if even n = 1 does.
std::int64_t largest_n(const fluid_layer& f, const recommendation& r, int dimension, double volume_ratio,
                       double fraction, const cost& c, const budget& b);

// How many steps a metal layer takes to sink through silicate, if sound is not slowed but damped by an artificial
// viscosity; numbers are those of [S0].
struct two_layers {
  double L = 1.5e6;                          // m, edge of the box; defaults: the note's example
  double c = 1e4;                            // m/s
  double rho_min = 3e3;                      // kg/m3
  double delta_rho = 7e3;                    // kg/m3
  double g = 10.0;                           // m/s2
  double heat_capacity = 1e3;                // J/(kg K)
  double conductivity = 0.0;                 // W/(m K); 0: no limit
  std::optional<double> eta = std::nullopt;  // Pa s; not given: (18)
};

struct overturn_plan {
  std::int64_t n;
  double dx;                              // m
  double eta;                             // Pa s
  double dt_sound, dt_momentum, dt_heat;  // s; infinite where there is no such limit
  double dt;                              // s, the least
  std::string binding;                    // "sound", "momentum" or "heat"
  double V;                               // m/s, (16)
  double tau;                             // s, (17)
  double steps;                           // tau/dt, (13)
  double particles;
  double seconds;  // of computing; 0: the rate is not known
};

double steps_of_20(const two_layers& s, std::int64_t n);  // (20)

overturn_plan plan_overturn(const two_layers& s, std::int64_t n, int dimension, const cost& c);

// What a budget allows.
struct affordable {
  std::int64_t n;           // the largest at the given L, 0 if none
  double L;                 // m, the smallest at the given n (the box is cheaper the larger it is); with eta by (18)
  double eta;               // Pa s, at the given n and L: the largest
  double eta_over_damping;  // eta / (18): below 1 sound outlives a step
};

affordable afford(const two_layers& s, std::int64_t n, int dimension, const cost& c, const budget& b);

}  // namespace tetsuame::relaxation
