// Explicit steps: those of the start lattice (lattice.hpp), for sound at the pressures of top and floor, for viscosity,
// conduction, diffusion and capillary waves.
#pragma once

#include <two_fluids/fluids.hpp>

namespace tetsuame::two_fluids {

struct step_bounds {
  integrators::step_limit step;  // s
  double radius;                 // 1/s, of diffusion
  double fastest_sound;          // m/s
};

struct largest_coefficients {
  double sound = 0.0, nu = 0.0, kappa = 0.0;  // m/s, m2/s, m2/s
};

template <int D>
largest_coefficients largest_of_materials(const fluids<D>& f) {
  const auto& o = f.o;
  largest_coefficients most;
  const double p_floor = f.p.base->at(0.0).pressure;
  for (const std::size_t n : {0, 1})
    for (const double p : {o.p_top, p_floor}) {
      const auto& material = (*f.p.material)[n];
      const auto state = on_curve(f, n, p);
      const auto e = eos::evaluate(material, state.density, state.temperature);
      most.sound = std::max(most.sound, e.sound_speed);
      const bool law = n == 0 && o.melting.viscosity_law != "constant";
      const double stiffest = law ? o.melting.viscosity_max : o.material[n].viscosity;
      const double eta =
          n == 0 && o.melting.inertia_viscosity > 0.0 ? std::min(stiffest, o.melting.inertia_viscosity) : stiffest;
      // Beside something far stiffer a pair's mean, 4 η η'/(η + η'), is twice that of equals.
      most.nu = std::max(most.nu, (law ? 2.0 : 1.0) * eta / state.density);
      most.kappa = std::max(most.kappa, o.conductivity / (state.density * e.c_V));
    }
  // Twice, as for viscosities: a partition coefficient makes a contrast.
  if (f.dissolved)
    most.kappa = std::max(most.kappa, 2.0 * std::max(o.element.diffusivity_silicate, o.element.diffusivity_metal));
  return most;
}

// 1/s, the stiffest capillary wave: of two spacings, ω² = σk³/(ρ + ρ').
template <int D>
double capillary_frequency(const fluids<D>& f) {
  if (!f.tense) return 0.0;
  const double both = on_curve(f, 0, f.o.p_top).density + on_curve(f, 1, f.o.p_top).density;
  return std::sqrt(f.o.surface_tension * std::pow(std::numbers::pi / f.world.w.dx, 3) / both);
}

// With the viscous sum's weights, which it depends on.
template <int D>
step_bounds find_limit(fluids<D>& f) {
  const auto& o = f.o;
  const double dx = f.world.w.dx;
  const auto& kernel = f.world.w.kernel;
  f.viscous = f.fourth_order() ? fourth_order_weights<D>(kernel, dx) : viscous_weights{};
  const auto stiff = rates_of_lattice<D>(kernel, dx, f.viscous, f.p.symmetric_stress);
  const auto most = largest_of_materials(f);
  const double conduction = rates_of_lattice<D>(kernel, dx, {}).viscous * most.kappa;
  const double diffusive = std::max(stiff.viscous * most.nu, conduction);
  // The fractions (run/options.hpp) are those of |eigenvalue| <= 2.2 c/dx and 4 d nu/dx^2.
  const double sound = *o.common.time.cfl * 2.2 / stiff.sound * dx / most.sound;
  const double viscous = *o.common.time.diffusive * 4.0 * D * dx * dx / diffusive;
  const double wave = capillary_frequency(f) / (*o.common.time.cfl * 2.2);
  const double both = 1.0 / std::hypot(1.0 / sound, 1.0 / viscous, wave);
  const char* by = wave * std::min(sound, viscous) > 1.0 ? "surface tension"
                   : sound < viscous                     ? "sound"
                   : conduction < diffusive              ? "viscosity"
                                                         : "conduction";
  return {{both, by}, 1.2 * diffusive / (dx * dx), most.sound};
}

}  // namespace tetsuame::two_fluids
