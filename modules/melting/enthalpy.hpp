// Heat content of what melts between solidus and liquidus, and the temperature that belongs to it.
//
//   h(T) = c T + L f(T),  f = (T - T_s)/(T_l - T_s) held in [0, 1]
// J/kg; c J/(kg K) of solid and liquid alike, L J/kg. h rises with T, so T and f follow from h: energy that is
// exchanged as h is conserved, latent heat included, whatever melts on the way (the enthalpy method: V. R. Voller and
// M. Cross, Int. J. Heat Mass Transfer 24, 545 (1981)).
#pragma once

#include <algorithm>

namespace tetsuame::melting {

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

}  // namespace tetsuame::melting
