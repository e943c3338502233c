// What every equation of state gives, and how its parts follow from three derivatives.
//
// All state is (rho, T). With K_T = rho (dp/drho)_T and alpha K_T = (dp/dT)_rho,
//   gamma_th = alpha K_T/(rho c_V),   c^2 = (dp/drho)_T + gamma_th^2 c_V T:
// the speed of sound of a material whose temperature follows d ln T/d ln rho = gamma_th,
// which is what the temperature equation of the scheme integrates.
#pragma once

#include <cmath>
#include <limits>
#include <string>

namespace tetsuame::eos {

inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Of one state, or R holds several, one a lane.
template <class R>
struct properties_of {
  R p;            // Pa
  R K_T;          // Pa, isothermal bulk modulus rho (dp/drho)_T at this very state
  R alpha;        // 1/K, thermal expansivity
  R c_V;          // J/(kg K)
  R sound_speed;  // m/s; not a number where c^2 < 0 (beyond the spinodal)
};
using properties = properties_of<double>;

struct description {
  std::string name;    // as in the input
  std::string source;  // citation
  bool illustrative;   // parameters of unverified origin: not for quantitative results
};

// rho kg/m^3, T K, p and K_T Pa, alpha_K = (dp/dT)_rho Pa/K, c_V J/(kg K).
template <class R>
properties_of<R> from_derivatives(const R& rho, const R& T, const R& p, const R& K_T, const R& alpha_K, const R& c_V) {
  using std::sqrt;  // of lanes: found through their own namespace
  const R c2 = (K_T + T * alpha_K * alpha_K / (rho * c_V)) / rho;
  return {p, K_T, alpha_K / K_T, c_V, sqrt(c2)};
}

}  // namespace tetsuame::eos
