// Hot and cold half space in contact, the cold one melting: conduction alone, with latent heat (Stefan's problem).
//
// x < 0: at T_hot at first, does not change phase. x > 0: at T_cold, melts between solidus and liquidus with the melt
// fraction linear in between, so that there its heat capacity is c + L/(T_l - T_s). All depends on x/(2 sqrt t) alone;
// liquid, mush and solid each have T = A + C erf(x/(2 sqrt(kappa t))) with a kappa of its own, and k dT/dx is
// continuous [H. S. Carslaw and J. C. Jaeger, Conduction of Heat in Solids, 2nd ed., sect. 11.2; the pieces joined:
// here].
#pragma once

#include <vector>

namespace tetsuame::theory {

struct half_space {
  double density, heat_capacity, conductivity, temperature;  // kg/m3, J/(kg K), W/(m K), K
};

struct melting_contact {
  half_space hot, cold;
  double solidus, liquidus, latent_heat;  // K, K, J/kg
};

struct stefan_solution {
  struct piece {
    double from, kappa, T, B;  // x/(2 sqrt t), m/sqrt s; m2/s; K: T there, and in T + B exp(a²) [erf(..) - erf(a)]
  };
  melting_contact problem;
  double contact;             // K
  std::vector<piece> pieces;  // of x > 0, outwards

  double temperature(double x, double t) const;  // K; x in m, either side; t > 0 s
  // m, the integral of the melt fraction over x > 0 at time t > 0 s; it grows as sqrt t.
  double melt_thickness(double t) const;
};

// T_hot > T_cold, T_cold <= solidus < liquidus.
stefan_solution solve(const melting_contact& problem);

}  // namespace tetsuame::theory
