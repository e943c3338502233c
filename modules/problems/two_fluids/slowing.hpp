// Slowed sound and heavier inertia (docs/theory/slowed_layers.md):
//
//   p = p_h + (p̂ - p_h)/ζ²,   p_h(y): the column at rest (column.hpp)
//   ξ² m dv/dt = -∇ terms + viscosity + m g + (1 - 1/ζ²) ∇p_h (V - V_h),   V_h = m/ρ_h: the volume at p_h
//
// The last term comes from the energy of a particle, m u(ρ)/ζ² + (1 - 1/ζ²) m [h(p_h) - p_h/ρ], h = u + p/ρ: the
// physical one and its tangent at p_h. It takes back the weight of the compression that there is too much of: gravity
// then acts on the density of the physical equation of state, as in [S1].
#pragma once

#include <two_fluids/fluids.hpp>

namespace tetsuame::two_fluids {

// kg/m3, at pressure p_h, of what has density rho and temperature T: with T as it is, or on the adiabat. Two of
// Newton's steps in ln ρ, the error some fourth power of the relative change.
inline double density_at(const eos::any& material, double rho, double T, double p_h, bool adiabatic) {
  for (int step = 0; step < 2; ++step) {
    const auto e = eos::evaluate(material, rho, T);
    const double modulus = adiabatic ? rho * e.sound_speed * e.sound_speed : e.K_T;
    const double change = (p_h - e.p) / modulus;
    if (adiabatic) T *= std::exp(e.alpha * e.K_T / (rho * e.c_V) * change);
    rho *= std::exp(change);
  }
  return rho;
}

template <int D>
double density_at_rest(const fluids<D>& f, std::size_t i, double p_h) {
  const auto& s = f.world.w.s;
  return density_at(f.world.w.materials[f.material_of(i)], s.rho[i], s.T[i], p_h, f.warms);
}

// N, what lifts particle i, of volume V.
template <int D>
double find_lift(const fluids<D>& f, std::size_t i, double V) {
  const auto& s = f.world.w.s;
  const auto rest = f.p.base->pressure(s.x[1][i]);
  const double V_h = s.m[i] / density_at_rest(f, i, rest.value);
  return (1.0 - f.stiffness) * rest.slope * (V - V_h);
}

// The pressure of particle i from that of the equation of state.
template <int D>
void slow_pressure(fluids<D>& f, std::size_t i) {
  auto& s = f.world.w.s;
  const double rest = f.p.base->pressure(s.x[1][i]).value;
  s.p_eos[i] = rest + f.stiffness * (s.p_eos[i] - rest);
}

// What a program's scheme has of it: pressure and its stiffness, ∂p/∂ln ρ = K_T/ζ²; α K_T, which heats what is
// compressed, stays.
template <int D>
void slow_equation_of_state(fluids<D>& f, std::size_t first, std::size_t last) {
  auto& s = f.world.w.s;
  foundation::for_all(last - first, [&](std::size_t k) {
    const std::size_t i = first + k;
    slow_pressure(f, i);
    s.K_T[i] *= f.stiffness;
    s.alpha[i] /= f.stiffness;
  });
}

}  // namespace tetsuame::two_fluids
