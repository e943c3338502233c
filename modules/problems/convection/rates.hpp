// Rates of change of a weakly compressible Boussinesq fluid, sound slowed by ζ and inertia raised by ξ [S1]:
//
//   dx/dt = v + w
//   dv/dt = F/ξ² + (w + a v)·G(v) + ε h |w| Q(v),  F = -G(p)/ρ₀ + ν L(v) [or the divergence of ν (∇v + ∇vᵀ + ∇·v)] + b
//   ŷ dp/dt = -ρ₀ (c₀/ζ)² D(v) + (w + v)·G(p) + δ h c_eff Q(p) dT/dt = κ L(T) + w·G(T) + ε h |w| Q(T) + H/c_p [+ 2 ν
//   e:e/c_p, e the rate of strain] [- T ∂b/∂T v_y/c_p]
//
// G, D = tr G, L: operators/consistent.hpp; volumes are Δx^d throughout; b: state.hpp. p is the part of the pressure
// beyond that which carries T_ref; its rate is that at a place: the steady state then does not know the speed of sound.
// a = 1 (target steady): so is that of v, and ξ follows the viscosity, ξ² = ν/ν_eff. Where one viscosity is everywhere
// its force is then ν L(z), of a velocity that relaxes to v (docs/theory/convection.md, "Relaxed viscous response"),
//   ∂z/∂t = θ ∂v/∂t + (v - z)/λ      dz/dt = ∂z/∂t + (w + v)·G(z) + ε h |w| Q(z)
// w spreads the particles evenly, w = -C h v_max Σ V F r [1 + 0.2 (W/W(Δx))⁴], |w| <= v_max/2 [after Lind et al., J.
// Comput. Phys. 231, 1499 (2012)]; fields are moved back along their gradients. Q: pass.hpp.
#pragma once

#include <convection/state.hpp>

namespace tetsuame::convection {

template <int D>
double dissipation(const convection_state<D>& state, std::size_t i, double nu) {  // 2 ν e:e, W/kg
  const auto& G = state.last.latest.gradient;
  double sum = 0.0;
  for (std::size_t a = 0; a < D; ++a)
    for (std::size_t b = 0; b < D; ++b) {
      const double shear = G[a][b][i] + G[b][a][i];
      sum += 0.5 * nu * shear * shear;
    }
  return sum;
}

// Of a particle against the fluid: w, m/s, and ε h |w|, m2/s.
template <int D>
struct particle_shift {
  std::array<double, D> w;
  double remap;
};

template <int D>
particle_shift<D> shift_of(const convection_state<D>& state, std::size_t i) {
  const auto& c = state.input.convection;
  const double h = state.at_start.h, strength = c.shifting * h * state.start.v_max, most = 0.5 * state.start.v_max;
  particle_shift<D> of;
  double w2 = 0.0;
  for (std::size_t a = 0; a < D; ++a) {
    of.w[a] = -strength * state.last.uneven[a][i];
    w2 += of.w[a] * of.w[a];
  }
  const double cut = w2 > most * most ? most / std::sqrt(w2) : 1.0;
  of.remap = c.remap_diffusion * h * cut * std::sqrt(w2);
  for (double& w : of.w) w *= cut;
  return of;
}

// Heat of friction and of compression, to dT/dt. With an equation of state c_p follows the pressure
// (gravity_density.hpp), for conduction and heat from inside as well.
template <int D>
void release_heat(const convection_state<D>& state, std::size_t i, double nu, double& dT) {
  const auto& s = state.fluid();
  const auto& c = state.input.convection;
  const auto& layer = state.layer;
  const auto& laplacian_T = state.last.laplacian[unknown<D>::T];
  const double kappa = layer.fluid.kappa, c_p = layer.heat_capacity, per_c_p = 1.0 / c_p;
  const bool follows_pressure = layer.weighed && c.adiabatic_heating;
  double released = 0.0;  // W/kg
  if (c.viscous_heating) released += dissipation(state, i, nu);
  if (c.adiabatic_heating) released -= buoyancy_slope(layer, s.x[1][i], s.T[i]) * s.v[1][i] * s.T[i];
  if (follows_pressure)
    dT += (kappa * laplacian_T[i] + layer.heating + released * per_c_p) *
              (c_p / (c_p + layer.weighed->heat_capacity_change(s.x[1][i], s.T[i]))) -
          kappa * laplacian_T[i] - layer.heating;
  else
    dT += released * per_c_p;
}

// The rates of a particle, in the order of convection::fields(). Returns its speed squared, with its shift.
template <int D>
double rates_of(const convection_state<D>& state, std::size_t i, std::span<double* const> rate) {
  const auto& s = state.fluid();
  const auto& layer = state.layer;
  const auto& c = state.input.convection;
  const auto& f = layer.fluid;
  const auto& last = state.last;
  const auto& G = last.latest.gradient;
  constexpr std::size_t T = unknown<D>::T, p = unknown<D>::p, z = unknown<D>::z;
  const auto [w, remap] = shift_of(state, i);
  const double nu = state.viscosity(i), xi2 = inertia(layer, nu), per_xi2 = 1.0 / xi2;
  const double a_inertia = layer.steady ? 1.0 : 0.0;
  std::array<double, D> moving;  // w + a v
  for (std::size_t a = 0; a < D; ++a) moving[a] = w[a] + a_inertia * s.v[a][i];
  double speed2 = 0.0, divergence = 0.0, dT = f.kappa * last.laplacian[T][i] + layer.heating + remap * last.noise[T][i];
  double dp = *c.pressure_diffusion * state.at_start.h * layer.c_eff * last.noise[p][i];
  for (std::size_t a = 0; a < D; ++a) {
    const double viscous = layer.law.varies ? last.viscous[a][i] : last.laplacian[layer.relaxed ? z + a : a][i];
    double force = nu * viscous - G[p][a][i] / f.rho, advected = 0.0;
    if (a == 1) force += buoyancy(layer, s.x[1][i], s.T[i], state.p[i]);
    for (std::size_t b = 0; b < D; ++b) advected += moving[b] * G[a][b][i];
    rate[a][i] = s.v[a][i] + w[a];
    rate[D + a][i] = per_xi2 * force + advected + remap * last.noise[a][i];
    if (layer.relaxed) {
      double carried = 0.0;
      for (std::size_t b = 0; b < D; ++b) carried += moving[b] * G[z + a][b][i];
      rate[D + z + a][i] = layer.instant_share * per_xi2 * force +
                           (s.v[a][i] - state.z[a][i]) * (1.0 / layer.relaxation_time) + carried +
                           remap * last.noise[z + a][i];
    }
    speed2 += rate[a][i] * rate[a][i];
    divergence += G[a][a][i];
    dT += w[a] * G[T][a][i];
    dp += (w[a] + s.v[a][i]) * G[p][a][i];
  }
  release_heat(state, i, nu, dT);
  rate[D + T][i] = dT;
  rate[D + p][i] = dp - f.rho * layer.c_eff * layer.c_eff * xi2 * divergence;
  return speed2;
}

template <int D>
void rates_of_change(convection_state<D>& state, std::span<double* const> rate) {
  auto& w = state.world.w;
  const auto& s = w.s;
  const foundation::stage timed(w.times, "rates");
  const auto finite = [&](std::size_t i) {
    return std::ranges::all_of(rate.subspan(D), [&](const double* r) { return std::isfinite(r[i]); });
  };
  bool all_finite = true;
  double speed2 = 0.0;  // m2/s2
#pragma omp parallel for schedule(static) reduction(&& : all_finite) reduction(max : speed2) if (s.fluid > foundation::rows_worth_threads)
  for (std::size_t i = 0; i < s.fluid; ++i) {
    speed2 = std::max(speed2, rates_of(state, i, rate));
    all_finite = all_finite && finite(i);
  }
  state.displacing = std::sqrt(speed2);
  for (std::size_t i = 0; i < s.fluid && !all_finite; ++i)
    if (!finite(i))
      w.first_fault.report(s.id[i], "a rate is not finite at particle " + std::to_string(s.id[i]) +
                                        ", T = " + std::to_string(s.T[i]) + " K; the time step may be too large");
  w.agree();
  // In a closed box the mean divergence is zero: what the operators leave of it would let the mean pressure, which
  // nothing feels, grow without bound.
  remove_mean(state, rate[D + unknown<D>::p]);
}

}  // namespace tetsuame::convection
