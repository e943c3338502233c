// Growth of small waves on a layered flow, U(y) along x, gravity towards -y.
#pragma once

#include <complex>
#include <functional>
#include <limits>
#include <vector>

namespace tetsuame::exact {

// Rayleigh-Taylor growth of sharp incompressible layers of thickness h between walls, k > 0 in 1/m, 1/s
// [S. Chandrasekhar, Hydrodynamic and Hydromagnetic Stability (1961), section 92]:
//   sqrt[g k (rho_u - rho_l)/(rho_u coth(k h_u) + rho_l coth(k h_l))]; 0 where the lower one is the heavier.
double rayleigh_taylor_growth(double k, double g, double rho_upper, double rho_lower,
                              double h_upper = std::numeric_limits<double>::infinity(),
                              double h_lower = std::numeric_limits<double>::infinity());

struct layer_state {
  double rho, U, p;  // kg/m^3, m/s, Pa
};

enum class edge {
  wall,      // displacement 0; also the plane of symmetry where pressure is even
  free,      // pressure of the moving fluid 0: a surface, or where pressure is odd
  decaying,  // uniform beyond, the wave dies away; g = 0 only
};

// For ideal gas or, with gamma infinite, an incompressible fluid. p(y) has to be hydrostatic,
// dp/dy = -rho g, and U and rho may jump at `jumps` (inside, rising), where at() is never asked.
struct layered_flow {
  std::function<layer_state(double y)> at;
  double gamma;
  double g;          // m/s^2 towards -y
  double low, high;  // m, the edges
  edge at_low, at_high;
  std::vector<double> jumps;
};

// Displacement and pressure of the moving fluid of a wave exp[ik(x - ct)] obey the two equations of
// docs/theory/riemann.md, "Waves on layers".
// The fastest growing mode, c with the largest Im c that searches from a net of guesses find
// (Howard's semicircle, widened by sqrt(g/k)); 0 if none grows faster than 1e-6 of the net's
// width. Growth rate: k Im c.
std::complex<double> fastest_mode(const layered_flow& flow, double k);

}  // namespace tetsuame::exact
