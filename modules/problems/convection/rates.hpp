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
// Beside b stands K, beside H J of the input's sources (sources/fields.hpp).
#pragma once

#include <convection/state.hpp>
#include <limits>

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

// Rates are computed of several particles at once, in lanes.
using pairs::real;
using several = pairs::cluster<real>;

// f(particle) of each of them, of what is only known one by one.
template <class F>
real one_by_one(const several& i, F&& f) {
  real all = 0.0;
  i.each([&](std::size_t particle, const auto&) { all[particle - i.first] = f(particle); });
  return all;
}

// Of particles against the fluid: w, m/s, and ε h |w|, m2/s.
template <int D>
struct particle_shift {
  std::array<real, D> w;
  real remap;
};

template <int D>
particle_shift<D> shift_of(const convection_state<D>& state, const several& i) {
  const auto& c = state.input.convection;
  const double h = state.at_start.h, strength = c.shifting * h * state.start.v_max, most = 0.5 * state.start.v_max;
  particle_shift<D> of;
  real w2 = 0.0;
  for (std::size_t a = 0; a < D; ++a) {
    of.w[a] = -strength * i(state.last.uneven[a].data());
    w2 += of.w[a] * of.w[a];
  }
  const real speed = sqrt(w2), cut = foundation::select(w2 > most * most, most / speed, real(1.0));
  of.remap = c.remap_diffusion * h * cut * speed;
  for (real& w : of.w) w *= cut;
  return of;
}

// b, m/s2.
template <int D>
real buoyancy_of(const convection_state<D>& state, const several& i) {
  const auto& s = state.fluid();
  const auto& layer = state.layer;
  if (layer.weighed)
    return one_by_one(i, [&](std::size_t k) { return buoyancy(layer, s.x[1][k], s.T[k], state.p[k]); });
  return linear_buoyancy(layer, i(s.x[1].data()), i(s.T.data()), i(state.p.data()));
}

// dT/dt with heat of friction and of compression. With an equation of state c_p follows the pressure
// (gravity_density.hpp), for conduction and heat from inside as well.
template <int D>
double with_heat(const convection_state<D>& state, std::size_t i, double nu, double dT) {
  const auto& s = state.fluid();
  const auto& c = state.input.convection;
  const auto& layer = state.layer;
  const auto& laplacian_T = state.last.laplacian[unknown<D>::T];
  const double kappa = layer.fluid.kappa, c_p = layer.heat_capacity, per_c_p = 1.0 / c_p;
  const bool follows_pressure = layer.weighed && c.adiabatic_heating;
  double released = state.sources.heat() ? (*state.world.w.heating)[i] : 0.0;  // W/kg
  if (c.viscous_heating) released += dissipation(state, i, nu);
  if (c.adiabatic_heating) released -= buoyancy_slope(layer, s.x[1][i], s.T[i]) * s.v[1][i] * s.T[i];
  if (follows_pressure)
    return dT +
           (kappa * laplacian_T[i] + layer.heating + released * per_c_p) *
               (c_p / (c_p + layer.weighed->heat_capacity_change(s.x[1][i], s.T[i]))) -
           kappa * laplacian_T[i] - layer.heating;
  return dT + released * per_c_p;
}

// The rates of some particles, in the order of the problem's fields. Returns their largest speed squared, with the
// shift, m2/s2.
template <int D>
double rates_of(const convection_state<D>& state, const several& i, std::span<double* const> rate) {
  const auto& s = state.fluid();
  const auto& layer = state.layer;
  const auto& c = state.input.convection;
  const auto& f = layer.fluid;
  const auto& last = state.last;
  constexpr std::size_t T = unknown<D>::T, p = unknown<D>::p, z = unknown<D>::z;
  const auto G = [&](std::size_t k, std::size_t a) { return i(last.latest.gradient[k][a].data()); };
  const auto hyperdiffusion = [&](std::size_t k) { return i(last.hyperdiffusion[k].data()); };
  const auto [w, remap] = shift_of(state, i);
  const real nu = layer.law.varies ? one_by_one(i, [&](std::size_t k) { return state.viscosity(k); }) : real(layer.nu);
  const real xi2 = inertia(layer, nu), per_xi2 = 1.0 / xi2;
  const double a_inertia = layer.steady ? 1.0 : 0.0;
  const auto set = [&](std::size_t k, const real& value) { i.set(rate[k], value); };
  std::array<real, D> v, moving;  // w + a v
  for (std::size_t a = 0; a < D; ++a) {
    v[a] = i(s.v[a].data());
    moving[a] = w[a] + a_inertia * v[a];
  }
  real speed2 = 0.0, divergence = 0.0;
  real dT = f.kappa * i(last.laplacian[T].data()) + layer.heating + remap * hyperdiffusion(T);
  real dp = *c.pressure_diffusion * state.at_start.h * layer.c_eff * hyperdiffusion(p);
  for (std::size_t a = 0; a < D; ++a) {
    const auto& viscous = layer.law.varies ? last.viscous[a] : last.laplacian[layer.relaxed ? z + a : a];
    real force = nu * i(viscous.data()) - G(p, a) / f.rho, advected = 0.0;
    if (a == 1) force += buoyancy_of(state, i);
    if (state.sources.force()) force += i(state.world.w.accelerations[a].data());
    for (std::size_t b = 0; b < D; ++b) advected += moving[b] * G(a, b);
    const real dx = v[a] + w[a];
    i.set(rate[a], dx);
    set(D + a, per_xi2 * force + advected + remap * hyperdiffusion(a));
    if (layer.relaxed) {
      real carried = 0.0;
      for (std::size_t b = 0; b < D; ++b) carried += moving[b] * G(z + a, b);
      set(D + z + a, layer.instant_share * per_xi2 * force +
                         (v[a] - i(state.z[a].data())) * (1.0 / layer.relaxation_time) + carried +
                         remap * hyperdiffusion(z + a));
    }
    speed2 += dx * dx;
    divergence += G(a, a);
    dT += w[a] * G(T, a);
    dp += dx * G(p, a);
  }
  if (c.viscous_heating || c.adiabatic_heating)
    dT = one_by_one(i, [&](std::size_t k) { return with_heat(state, k, nu[k - i.first], dT[k - i.first]); });
  else if (state.sources.heat())
    dT += i(state.world.w.heating->data()) * (1.0 / layer.heat_capacity);
  set(D + T, dT);
  set(D + p, dp - f.rho * layer.c_eff * layer.c_eff * xi2 * divergence);
  double largest = 0.0;
  i.each([&](std::size_t, const auto& of) { largest = std::max(largest, of(speed2)); });
  return largest;
}

template <int D>
void rates_of_change(convection_state<D>& state, std::span<double* const> rate) {
  auto& w = state.world.w;
  const auto& s = w.s;
  const foundation::stage timed(w.times, "rates");
  double speed2 = 0.0;  // m2/s2
  const auto rows = w.fluid();
  const std::size_t n = rows.clusters();
#pragma omp parallel for schedule(static) reduction(max : speed2) if (s.fluid > foundation::rows_worth_threads)
  for (std::size_t r = 0; r < n; ++r) {
    const auto m = rows.cluster(r);
    speed2 = std::max(speed2, rates_of(state, several{m.first, m.mask, {}}, rate));
  }
  state.displacing = std::sqrt(speed2);
}

}  // namespace tetsuame::convection
