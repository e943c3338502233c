// The structure of a planet of layers in hydrostatic equilibrium. With the mass m inside of radius r, in a sphere
//   dr/dm = 1/(4 π r² ρ),  dp/dm = -G m/(4 π r⁴),
// in a cylinder, with m the mass a metre of its length,
//   dr/dm = 1/(2 π r ρ),  dp/dm = -G m/(π r²),  ρ by the layer's equation of state from p and T,
// from the surface, where p and T are given, to the centre. T along the way: the same throughout; proportional to ρ^a
// in each layer; or on the layer's adiabat, du = p/ρ² dρ. T and p are continuous where layers meet.
#pragma once

#include <cmath>
#include <eos/eos.hpp>
#include <gravity/cloud.hpp>
#include <numbers>
#include <string>
#include <vector>

namespace tetsuame::planet {

inline constexpr double pi = std::numbers::pi;
inline constexpr double G = 6.67408e-11;  // m³/(kg s²), gravitational constant [CODATA 2014]

enum class temperature_law { isothermal, power, adiabatic };

// A sphere, or a cylinder without ends, whose masses are per metre.
struct shape {
  int dimension = 3;

  bool is_sphere() const { return dimension == 3; }
  double area() const { return is_sphere() ? 4.0 * pi : 2.0 * pi; }  // of r = 1
  double volume() const { return area() / dimension; }
  double strength() const {
    return is_sphere() ? gravity::strength<3>(G) : gravity::strength<2>(G);
  }  // the field is this times m/r^(D - 1)
  double power(double r) const { return is_sphere() ? r * r * r : r * r; }
  double root(double volume) const { return is_sphere() ? std::cbrt(volume) : std::sqrt(volume); }
  // m/s: (2 g R)^½, which is a sphere's escape velocity.
  double fall(double M, double R) const { return is_sphere() ? std::sqrt(2.0 * G * M / R) : 2.0 * std::sqrt(G * M); }
};

// From the centre outwards.
struct layer {
  std::string name;
  eos::any material;
  double fraction;  // of the planet's mass
};

struct structure_input {
  std::vector<layer> layers;                     // fractions add up to 1
  double mass;                                   // kg, of a cylinder kg/m
  double surface_pressure, surface_temperature;  // Pa, K
  temperature_law law = temperature_law::isothermal;
  double exponent = 0.0;  // a of 'power'
  shape form = {};
};

// A place of the planet.
struct level {
  double m, r, rho, p, T;  // kg (kg/m) inside, m, kg/m³, Pa, K
};

// Levels from the surface to the centre, both among them; where layers meet there are two, one on either side.
class profile {
 public:
  struct layer_levels {
    std::vector<level> levels;  // from the outside to the inside
    const level& outer() const { return levels.front(); }
    const level& inner() const { return levels.back(); }
  };

  profile(std::vector<layer_levels> layers, const shape& form) : layers_(std::move(layers)), form_(form) {}

  const shape& form() const { return form_; }

  // From the centre outwards, as in the input.
  const std::vector<layer_levels>& layers() const { return layers_; }
  double radius() const { return layers_.back().outer().r; }
  double mass() const { return layers_.back().outer().m; }
  const level& centre() const { return layers_.front().inner(); }
  // The layer that holds this radius; the outermost beyond the surface.
  std::size_t layer_at(double r) const;
  // Linear between levels in r^D, with a relative error of about 1e-5; beyond the layer the nearest level's values.
  level at(double r, std::size_t layer) const;
  // The radius that encloses m.
  level at_mass(double m, std::size_t layer) const;

 private:
  std::vector<layer_levels> layers_;
  shape form_;
};

// The planet of this mass with these fractions; its radius follows, to 1e-10, the larger one where two carry the mass.
// fail_input: no radius between those of a density of 1 and 1e6 kg/m³ carries it, or a layer's equation of state has no
// such state, with the layer and the place.
profile structure_of_mass(const structure_input& input);

// The planet of this mass and radius; the fraction of the innermost of two layers follows, to 1e-10. fail_input: even
// the one material alone, or the other, makes it larger or smaller.
profile structure_of_radius(structure_input input, double radius);

}  // namespace tetsuame::planet
