// Supports, densities, and the state that follows from them:
//   y, f, z, ∇·v, ∇×v over neighbours (schemes/common.hpp); ρ, and P, c of ρ and u (here of an ideal gas)
//     SSPH, GSPH   P = (γ - 1) ρ u, ρ = y         DISPH, GDISPH   P = (γ - 1) q, q = y; ρ = m q/U
#pragma once

#include <fmt/format.h>

#include <gas/world.hpp>
#include <schemes/artificial_viscosity.hpp>

namespace tetsuame::gas {

// The next step of Newton's method, by no more than the lists allow. S is what the sums take.
template <int D>
void next_supports(world<D>& g) {
  const double target = std::pow(g.support_over_dx, D);
  foundation::for_all(g.w.s.fluid, [&](std::size_t i) {
    const double S = g.support[i], next = schemes::next_support(S, g.count[i], g.count_slope[i], target);
    g.support[i] = std::min(next, g.list_support[i] + g.room_to_grow());
    g.S[i] = g.support[i];
  });
}

template <int D, class Kernel>
void find_supports(world<D>& g, const Kernel& unit) {
  sum(g, g.w.fluid(), schemes::number_density<Kernel>{unit, g.support.data(), g.count.data(), g.count_slope.data()});
  next_supports(g);
}

template <int D, class Kernel>
void sum_densities(world<D>& g, const Kernel& unit, const pairs::stretch& rows) {
  auto& s = g.w.s;
  sum(g, rows,
      schemes::density<D, Kernel>{unit,
                                  g.weight.data(),
                                  s.m.data(),
                                  pairs::pointers<D>(s.v),
                                  g.S.data(),
                                  {g.y.data(), g.f.data(), g.z.data(), g.divergence.data(), g.curl.data(),
                                   g.number.data(), g.mass_density.data(), g.count.data(), g.count_slope.data()}});
}

// What no state follows from.
template <int D>
void check_sums(world<D>& g) {
  const auto& s = g.w.s;
  for (std::size_t i = 0; i < s.fluid; ++i)
    if (g.o.evolves_density() && !(g.evolved[i] > 0.0)) {
      g.w.first_fault.report(s.id[i], fmt::format("the density of particle {} is not above 0", s.id[i]));
      break;
    } else if (!((s.u[i] > 0.0 || g.o.any_eos()) && g.y[i] > 0.0 && std::isfinite(g.y[i]))) {
      g.w.first_fault.report(
          s.id[i], fmt::format("the internal energy of particle {} is {:.3g} J/kg, not above 0", s.id[i], s.u[i]));
      break;
    }
}

template <int D>
void check_sound(world<D>& g) {
  const auto& s = g.w.s;
  for (std::size_t i = 0; i < s.fluid; ++i)
    if (!(s.c[i] > 0.0)) {
      g.w.first_fault.report(
          s.id[i], fmt::format("particle {} has no sound at {:.4g} kg/m^3 and {:.4g} J/kg: '{}' does not reach there",
                               s.id[i], s.rho[i], s.u[i], eos::about(g.caloric_of(i).material()).name));
      break;
    }
}

// ρ, p, T, c of y and u. dU = -p dV with V = k w/y.
template <int D>
void find_pressure(world<D>& g, std::size_t i, double k) {
  auto& s = g.w.s;
  const bool energy = g.o.weighs_energy();
  s.rho[i] = g.o.evolves_density() ? g.evolved[i]
             : energy              ? g.y[i] / s.u[i]
             : g.o.weighs_volume() ? s.m[i] * g.y[i] / (k * g.weight[i])
                                   : g.y[i];
  if (g.o.any_eos()) {
    const eos::caloric_state now = g.caloric_of(i).at(s.rho[i], s.u[i]);
    s.p[i] = now.p;
    s.T[i] = now.T;
    s.c[i] = now.c;
    // The stiffened gas with K_S and K_S' (riemann/states.hpp)
    g.stiffness[i] = s.rho[i] * now.c * now.c / g.gamma[i] - now.p;
    return;
  }
  s.p[i] = (g.gamma[i] - 1.0) * (energy ? g.y[i] : s.rho[i] * s.u[i]) - g.gamma[i] * g.stiffness[i];
  s.c[i] = g.sound_speed(i);
}

// What the pair takes of the viscosity, or of the star pressure.
template <int D>
double dissipation_of(world<D>& g, std::size_t i) {
  const auto& o = g.o;
  const bool part_of_star = o.shock.star_pressure == "balsara", own_pressure = !o.godunov();
  const bool switched = o.shock.balsara || part_of_star || o.evolves_density();
  const double balsara =
      switched ? schemes::balsara_factor(g.divergence[i], g.curl[i], g.w.s.c[i], g.S[i] / g.support_over_h) : 1.0;
  return o.evolves_density() ? balsara : own_pressure ? g.alpha[i] * balsara : part_of_star ? balsara : 1.0;
}

// Fields that ghosts and images have of what was found.
template <int D>
std::array<double*, 9> found_fields(world<D>& g) {
  auto& s = g.w.s;
  return {g.correction.data(), s.rho.data(),   s.p.data(),           s.c.data(),        s.dV.data(),
          g.per_S.data(),      g.slope.data(), g.dissipation.data(), g.stiffness.data()};
}

// The state that follows from the sums, set out to the ghosts; it is there, and that of images, after end_found().
template <int D>
void begin_found(world<D>& g) {
  const foundation::stage timed(g.w.times, "densities");
  auto& s = g.w.s;
  const auto& o = g.o;
  check_sums(g);
  const bool number = o.density_independent() && o.shock.support_terms == "number";
  const bool none = o.shock.scheme == "gsph" || o.shock.support_terms == "none";
  const bool with_z = number, with_f = !number && !none;
  foundation::for_all(s.fluid, [&](std::size_t i) {
    const double k = o.weighs_volume() ? g.start_sum[i] : 1.0;
    find_pressure(g, i, k);
    g.number_volume[i] = 1.0 / g.number[i];
    s.dV[i] = o.evolves_density() ? s.m[i] / s.rho[i] : g.number_volume[i];
    g.per_S[i] = 1.0 / g.S[i];
    g.slope[i] = (with_f ? g.f[i] : 1.0) * (o.godunov() ? 1.0 : s.p[i]) * k / (g.y[i] * g.y[i]);
    g.correction[i] = with_z ? g.z[i] : 0.0;
    g.dissipation[i] = dissipation_of(g, i);
  });
  if (o.any_eos()) check_sound(g);
  g.per_S[s.null()] = g.slope[s.null()] = 0.0;
  const auto all = found_fields(g);
  domain::begin_exchange<D>(g.w.d.ranks, g.w.d.fluid_halo, std::span<double* const>(all));
}

template <int D>
void end_found(world<D>& g) {
  const foundation::stage timed(g.w.times, "halo");
  g.w.end_fluid();
  const auto all = found_fields(g);
  for_each_image(g, [&](std::size_t i, std::size_t j, const auto&) {
    for (double* a : all) a[i] = a[j];
  });
}

}  // namespace tetsuame::gas
