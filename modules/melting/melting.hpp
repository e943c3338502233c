// Solidus and liquidus of the mantle, melt fraction between them, viscosity by melt fraction.
// Pressure in Pa, temperature in K. Sources and ranges: docs/theory/melting.md.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <foundation/error.hpp>

namespace tetsuame::melting {

// Liquidus above 20 GPa, fitted to G. Fiquet et al., Science 329, 1516 (2010), or D. Andrault et al., Earth Planet.
// Sci. Lett. 304, 251 (2011); below, and for the solidus, one curve serves both.
enum class composition { peridotitic, chondritic };

// T = T0 (p/a + 1)^(1/c) [F. Simon and G. Glatzel, Z. Anorg. Allg. Chem. 178, 309 (1929)].
struct simon_glatzel {
  double T0, a, c;  // K, Pa, -
  double at(double p) const {
    if (!(p > -a)) foundation::fail_calculation(fmt::format("no melting temperature at p = {} Pa", p));
    return T0 * std::pow(p / a + 1.0, 1.0 / c);
  }
};

// Fits of J. Monteux, D. Andrault and H. Samuel, Earth Planet. Sci. Lett. 448, 140 (2016), eqs. 10-13, which use C.
// Herzberg and J. Zhang, J. Geophys. Res. 101, 8271 (1996), up to 20 GPa. The pieces meet there within 2 K.
inline constexpr double transition = 20e9;  // Pa
inline constexpr simon_glatzel low_solidus{1661.2, 1.336e9, 7.437};
inline constexpr simon_glatzel low_liquidus{1982.1, 6.594e9, 5.374};
inline constexpr simon_glatzel high_solidus{2081.8, 101.69e9, 1.226};
inline constexpr simon_glatzel peridotitic_liquidus{78.74, 4.054e6, 2.44};
inline constexpr simon_glatzel chondritic_liquidus{2006.8, 34.65e9, 1.844};

inline double solidus(double p) { return (p <= transition ? low_solidus : high_solidus).at(p); }

inline double liquidus(composition c, double p) {
  if (p <= transition) return low_liquidus.at(p);
  return (c == composition::peridotitic ? peridotitic_liquidus : chondritic_liquidus).at(p);
}

// (T - solidus)/(liquidus - solidus), held in [0, 1].
inline double melt_fraction(double T, double T_solidus, double T_liquidus) {
  if (!(T_liquidus > T_solidus)) {
    foundation::fail_input(fmt::format("the liquidus, {} K, must lie above the solidus, {} K", T_liquidus, T_solidus));
  }
  return std::clamp((T - T_solidus) / (T_liquidus - T_solidus), 0.0, 1.0);
}

// Heat content of what melts between solidus and liquidus, and the temperature that belongs to it:
//   h(T) = c T + L f(T),  f = (T - T_s)/(T_l - T_s) held in [0, 1]
// with one c of solid and liquid. Energy that is exchanged as h is conserved, latent heat included (the enthalpy
// method: V. R. Voller and M. Cross, Int. J. Heat Mass Transfer 24, 545 (1981)).
struct heat_content {
  double c, L;                  // J/(kg K), J/kg; L = 0: nothing melts
  double T_s = 0.0, T_l = 1.0;  // K, T_l > T_s

  double enthalpy(double T) const { return c * T + L * std::clamp((T - T_s) / (T_l - T_s), 0.0, 1.0); }

  struct state {
    double temperature, melt_fraction;  // K, 1
  };
  state at(double h) const {
    const double low = c * T_s, high = c * T_l + L;
    if (h <= low) return {h / c, 0.0};
    if (h >= high) return {(h - L) / c, 1.0};
    const double f = (h - low) / (high - low);
    return {T_s + f * (T_l - T_s), f};
  }
};

// Viscosity, Pa s, by temperature and melt fraction.
//
// The laws of T. Lebrun et al., J. Geophys. Res. Planets 118, 1155 (2013): liquid 2.4e-4 exp[4600/(T - 1000)], which
// needs T > 1000 K (fail_input), solid 3.8e9 exp[3.5e5/(R T)].
inline double liquid_viscosity(double T) {
  if (!(T > 1000.0)) foundation::fail_input(fmt::format("the viscosity of the liquid needs T > 1000 K, not {} K", T));
  return 2.4e-4 * std::exp(4600.0 / (T - 1000.0));
}
inline double solid_viscosity(double T) {
  constexpr double R = 8.31446261815324;  // J/(mol K)
  return 3.8e9 * std::exp(3.5e5 / (R * T));
}

inline constexpr double rheological_transition = 0.4;  // melt fraction at which crystals lock

// A suspension above the transition, liquid/[1 - (1 - f)/0.6]^2.5 and never more than the solid; the solid below.
inline double suspension_viscosity(double T, double f) {
  if (f <= rheological_transition) return solid_viscosity(T);
  const double dilution = 1.0 - (1.0 - f) / (1.0 - rheological_transition);
  return std::min(liquid_viscosity(T) / std::pow(dilution, 2.5), solid_viscosity(T));
}

// Smooth: log eta goes from solid to liquid as 1/2 {1 + tanh[(f - 0.4)/width]}.
inline double blended_viscosity(double T, double f, double width = 0.15) {
  const double s = 0.5 * (1.0 + std::tanh((f - rheological_transition) / width));
  return std::exp((1.0 - s) * std::log(solid_viscosity(T)) + s * std::log(liquid_viscosity(T)));
}

}  // namespace tetsuame::melting
