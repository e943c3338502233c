// The start at rest: a column of two materials in hydrostatic balance, dp/dy = -ρ g from the lid down.
#pragma once

#include <eos/eos.hpp>
#include <optional>
#include <theory/rayleigh_taylor.hpp>
#include <vector>

namespace tetsuame::two_fluids {

// A material on its isotherm, or on the adiabat through (pressure, temperature).
struct barotropic {
  const eos::any* material;
  double pressure, temperature;  // Pa, K: a point of the curve
  bool adiabatic;
};

struct place {
  double pressure, density, temperature;  // Pa, kg/m3, K
};

// ρ and T at a pressure (Pa): dT/dp = γ_th T/K_S by fourth-order Runge-Kutta steps of at most a hundredth of K_S.
place at_pressure(const barotropic& b, double pressure);

// For theory::layer. The materials must outlive it.
theory::barotrope curve(const barotropic& b);

// Pressure and density by height.
class column {
 public:
  // Heights in m: floor at 0, interface, top; g in m/s2; upper.pressure is that of the top. With an adiabat the lower
  // layer starts at the temperature that the upper one has at the interface. From `cover_from` to the top the lower
  // material lies once more: then all are on isotherms, and lower.pressure is that of the top.
  column(const barotropic& lower, const barotropic& upper, double interface, double top, double g,
         std::optional<double> cover_from = {});

  place at(double y) const;  // y == interface: of the layer above
  struct pressure_at_rest {
    double value, slope;  // Pa, Pa/m: one the exact derivative of the other
  };
  // The same pressure without the material's density there; beyond floor and top that of floor and top, with no slope.
  pressure_at_rest pressure(double y) const;
  const barotropic& lower() const { return lower_; }
  const barotropic& upper() const { return upper_; }

 private:
  struct node {
    double y;
    place state;
  };
  void descend(const barotropic& b, double from, double to, double p, std::vector<node>& nodes) const;
  // Cubic between two nodes, with the slopes -ρ g at both.
  struct cubic {
    const node &high, &low;
    double t, dy, g_dy;  // of the way from high to low; m, between the nodes; m²/s²
    cubic(const std::vector<node>& nodes, double y);
    double pressure() const;  // Pa
    double slope() const;     // Pa/m
  };
  static place between(const barotropic& b, const std::vector<node>& nodes, double y);

  barotropic lower_, upper_, cover_;
  double interface_, cover_from_, g_;
  std::vector<node> below_, above_, covering_;  // descending
};

}  // namespace tetsuame::two_fluids
