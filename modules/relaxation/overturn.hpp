// How many steps a metal layer takes to sink through silicate, if sound is not slowed but damped by an artificial
// viscosity; numbers are those of [S0], docs/theory/relaxation.md.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <relaxation/steps.hpp>
#include <string>

namespace tetsuame::relaxation {

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

double damping_viscosity(const two_layers& s, std::int64_t n);  // Pa s, (18)
double steps_of_20(const two_layers& s, std::int64_t n);        // (20)

overturn_plan plan_overturn(const two_layers& s, std::int64_t n, int dimension, const cost& c);

// What at most `steps` steps or `seconds` of computing allow (infinite: no such wish).
struct budget {
  double steps = std::numeric_limits<double>::infinity();
  double seconds = std::numeric_limits<double>::infinity();
};

struct affordable {
  std::int64_t n;           // the largest at the given L, 0 if none
  double L;                 // m, the smallest at the given n (the box is cheaper the larger it is); with eta by (18)
  double eta;               // Pa s, at the given n and L: the largest
  double eta_over_damping;  // eta / (18): below 1 sound outlives a step
};

// fail_input if seconds are asked for without a rate.
affordable afford(const two_layers& s, std::int64_t n, int dimension, const cost& c, const budget& b);

}  // namespace tetsuame::relaxation
