// Uptake of a trace element by a sphere in which it diffuses, with a partition coefficient at its surface. Times are
// given as the Fourier number D t/a^2 (D diffusivity inside, a radius). Equations: docs/theory/partition.md;
// numbers such as (6.20) are those of J. Crank, The Mathematics of Diffusion, 2nd ed., Oxford (1975).
#pragma once

#include <span>
#include <vector>

namespace tetsuame::theory {

// Surface held at one concentration from time 0, none inside before.
//
// Mean concentration over that of the surface, (6.20), (6.22).
double uptake(double fourier);
// Concentration at r/a in [0, 1] over that of the surface, (6.18), (6.19).
double concentration(double r_over_a, double fourier);

// Well-stirred surroundings of limited volume that lose what the sphere gains. alpha = (volume outside)/(volume of the
// sphere)/ (concentration inside over outside at equilibrium). Uptake over that at infinite time, (6.30); the latter is
// alpha/(1 + alpha) of the uptake from surroundings without limit.
double limited_uptake(double fourier, double alpha);

// Surface concentration that changes: values at ascending times (Fourier numbers), straight lines between. Mean
// concentration at those times, from `initial` everywhere inside at the first. Exact up to rounding: 400 eigenfunctions
// are integrated in closed form and faster ones follow the surface, which asks for steps above 2e-5 where the surface
// jumps.
std::vector<double> uptake_history(std::span<const double> fourier, std::span<const double> surface, double initial);

// Exchange coefficient of M + (n/2) FeO = MO_(n/2) + (n/2) Fe, metal over silicate: log10 K_D = a + b/T + c p/T.
struct exchange_law {
  double a, b, c;  // -, K, K/GPa
  int valence;     // n
  const char* source;
};
// [D. C. Rubie et al., Icarus 248, 89 (2015), table S1]
inline constexpr exchange_law nickel{1.06, 1553.0, -98.0, 2, "Rubie et al. (2015)"};
inline constexpr exchange_law cobalt{0.13, 2057.0, -57.0, 2, "Rubie et al. (2015)"};

double exchange_coefficient(const exchange_law& law, double pressure /* Pa */, double T /* K */);
// Mole fraction in the metal over that in the silicate, D = K_D (X_Fe/X_FeO)^(n/2), for that ratio of iron.
double partition_coefficient(const exchange_law& law, double pressure, double T, double iron_ratio);

}  // namespace tetsuame::theory
