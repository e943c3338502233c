// Explicit steps: those of the start lattice (lattice.hpp), for sound at the pressures of top and floor, for viscosity,
// conduction, diffusion and capillary waves.
#pragma once

#include <two_fluids/fluids.hpp>

namespace tetsuame::two_fluids {

struct step_bounds {
  integrators::step_limit step;  // s, of all together
  double sound, viscous;         // s, of sound alone, of viscosity and the other diffusions
  double radius;                 // 1/s, of diffusion
  double fastest_sound;          // m/s, of pressure over mass: not slowed by inertia
};

struct largest_coefficients {
  double sound = 0.0, pressure_sound = 0.0, nu = 0.0, kappa = 0.0;  // m/s, m/s, m2/s, m2/s
};

// A material by itself: isotherm or adiabat through the lid's pressure and temperature.
inline place at_pressure(const options& o, const parameters& p, std::size_t n, double pressure) {
  return at_pressure({&(*p.material)[n], o.p_top, o.temperature, o.temperature_law == "adiabatic"}, pressure);
}

inline largest_coefficients largest_of_materials(const options& o, const parameters& p) {
  largest_coefficients most;
  const double p_floor = p.base->at(0.0).pressure;
  const bool contrast = o.slowing.any() && !o.equally_viscous();
  bool unequal = false;  // conductivities
  for (std::size_t n = 1; n < o.material.size(); ++n) unequal |= o.conductivity_of(n) != o.conductivity_of(0);
  for (std::size_t n = 0; n < o.material.size(); ++n)
    for (const double pressure : {o.p_top, p_floor}) {
      const auto& material = (*p.material)[n];
      const auto state = at_pressure(o, p, n, pressure);
      const auto e = eos::evaluate(material, state.density, state.temperature);
      const double c = e.sound_speed / o.slowing.zeta, xi = o.slowing.xi_n(n);
      most.sound = std::max(most.sound, c / xi);
      most.pressure_sound = std::max(most.pressure_sound, c);
      const auto& melting = p.melting[n];
      const bool law = melting.viscosity_law != "constant";
      const double stiffest = law ? melting.viscosity_max : o.material[n].viscosity;
      const double eta = melting.inertia_viscosity > 0.0 ? std::min(stiffest, melting.inertia_viscosity) : stiffest;
      // Beside something far stiffer a pair's mean, 4 η η'/(η + η'), is twice that of equals.
      most.nu = std::max(most.nu, (law || contrast ? 2.0 : 1.0) * eta / (state.density * xi * xi));
      most.kappa = std::max(most.kappa, (unequal ? 2.0 : 1.0) * o.conductivity_of(n) / (state.density * e.c_V));
    }
  // Twice, as for viscosities: a partition coefficient makes a contrast.
  if (o.element.name != "none")
    most.kappa = std::max(most.kappa, 2.0 * std::max(o.element.diffusivity_silicate, o.element.diffusivity_metal));
  return most;
}

// 1/s, the stiffest capillary wave: of two spacings, ω² = σk³/(ρ + ρ').
inline double capillary_frequency(const options& o, const parameters& p, double dx) {
  if (!(o.surface_tension > 0.0)) return 0.0;
  std::array<double, 2> lightest{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  double xi = lightest[0];
  for (std::size_t n = 0; n < o.material.size(); ++n) {  // of silicate, of metal
    auto& of = lightest[o.material[n].metal ? 1 : 0];
    of = std::min(of, at_pressure(o, p, n, o.p_top).density);
    xi = std::min(xi, o.slowing.xi_n(n));
  }
  return std::sqrt(o.surface_tension * std::pow(std::numbers::pi / dx, 3) / (lightest[0] + lightest[1])) / xi;
}

// dx: m, of the lattice
template <int D>
step_bounds bounds_of(const options& o, const parameters& p, const kernels::any<D>& kernel, double dx,
                      const viscous_weights& weights) {
  const auto stiff = rates_of_lattice<D>(kernel, dx, weights, p.symmetric_stress);
  const auto most = largest_of_materials(o, p);
  const double conduction = rates_of_lattice<D>(kernel, dx, {}).viscous * most.kappa;
  const double diffusive = std::max(stiff.viscous * most.nu, conduction);
  // The fractions (run/options.hpp) are those of |eigenvalue| <= 2.2 c/dx and 4 d nu/dx^2.
  const double sound = *o.common.time.cfl * 2.2 / stiff.sound * dx / most.sound;
  const double viscous = *o.common.time.diffusive * 4.0 * D * dx * dx / diffusive;
  const double wave = capillary_frequency(o, p, dx) / (*o.common.time.cfl * 2.2);
  const double both = 1.0 / std::hypot(1.0 / sound, 1.0 / viscous, wave);
  const char* by = wave * std::min(sound, viscous) > 1.0 ? "surface tension"
                   : sound < viscous                     ? "sound"
                   : conduction < diffusive              ? "viscosity"
                                                         : "conduction";
  return {{both, by}, sound, viscous, 1.2 * diffusive / (dx * dx), most.pressure_sound};
}

// With the viscous sum's weights, which it depends on.
template <int D>
step_bounds find_limit(fluids<D>& f) {
  const auto& w = f.world.w;
  f.viscous = f.fourth_order() ? fourth_order_weights<D>(w.kernel, w.dx) : viscous_weights{};
  return bounds_of<D>(f.o, f.p, w.kernel, w.dx, f.viscous);
}

}  // namespace tetsuame::two_fluids
