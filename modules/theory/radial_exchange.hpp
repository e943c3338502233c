// An element that diffuses into a round body out of a shell of other material, at rest, in one dimension (radius):
//   ∂c/∂t = 1/r^(d-1) ∂/∂r (r^(d-1) D_in or D_out ∂c/∂r),   c(a-) = P c(a+),   ρ D ∂c/∂r continuous at r = a,
// no flux at r = 0 and r = R. Finite volumes of the potential c/P (inside) and c (outside), which has no jump; steps of
// TR-BDF2 [R. E. Bank et al., IEEE Trans. Electron Devices 32, 1992 (1985)]. P may change with time: at each step the
// concentrations stay and the potential inside changes.
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace tetsuame::theory {

struct radial_exchange {
  int dimension;                                   // 2: cylinder, 3: sphere
  double radius, shell;                            // m: a, R > a
  double density_inside, density_outside;          // kg/m3
  double diffusivity_inside, diffusivity_outside;  // m2/s, > 0
  double start_inside, start_outside;              // c, amount per mass
  std::function<double(double)> partition;         // P at time t (s)
};

// Mean concentration inside (by mass) at ascending times (s) >= 0; `cells` a radius, steps of at most the time between
// two times and a thousandth of the last. Errors fall as 1/cells².
std::vector<double> mean_inside(const radial_exchange& problem, std::span<const double> times, int cells = 100);

}  // namespace tetsuame::theory
