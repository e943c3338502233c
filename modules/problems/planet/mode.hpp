// The growing mode of a cylinder in which a denser layer lies over a lighter one, by linear theory, and its amplitude
// among particles.
#pragma once

#include <gas/setups.hpp>
#include <planet/profile.hpp>
#include <theory/growth_fit.hpp>
#include <theory/layered_cylinder.hpp>

namespace tetsuame::planet {

// The layers with their mean densities.
theory::layered_cylinder layers_of(const profile& planet, const std::vector<double>& viscosities);

class growing_mode {
 public:
  // Of a planet whose growth rate of this degree is above 0. amplitude: m, of the interface `fastest`.
  growing_mode(const theory::layered_cylinder& planet, theory::cylinder_mode mode, double amplitude);

  double growth_rate() const { return mode_.growth_rate; }  // 1/s
  double amplitude() const { return amplitude_; }           // m, at the start
  double radius() const { return radius_; }                 // m, of that interface
  std::size_t inside() const { return mode_.fastest; }      // the layer within it
  // The growth rate of amplitudes (m) over time: of those from 1.2 times the first one to 0.05 R/m.
  std::optional<theory::growth_fit> fit(const std::vector<double>& time, const std::vector<double>& amplitude) const;

  // At the start: how far a particle is moved from x, m, x from the axis; times growth_rate() its velocity.
  std::array<double, 2> displacement(double x, double y) const;
  // m: ∫ r^m cos mθ over what is within the interface, over π R^(m + 1), about the planet's centre of mass; particles
  // have the volume that they have at the mean density of their layer. layer_of: by material. Collective.
  double measure(const gas::view& w, const gas::point& centre, const std::vector<std::size_t>& layer_of) const;

 private:
  theory::cylinder_mode mode_;
  double amplitude_, radius_;
  std::vector<double> density_;  // kg/m³, of the layers
};

}  // namespace tetsuame::planet
