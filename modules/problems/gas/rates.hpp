// The right-hand side. Supports, densities, and the state that follows from them:
//   y, f, z, ∇·v, ∇×v over neighbours (schemes/common.hpp); ρ, and P, c of ρ and u (here of an ideal gas)
//     SSPH, GSPH   P = (γ - 1) ρ u, ρ = y         DISPH, GDISPH   P = (γ - 1) q, q = y; ρ = m q/U
// then gradients, of p, ρ, v for the second order, of u, ρ, v for REMIX; the kernels' corrections (REMIX); forces and
// power, with artificial viscosity or Riemann problems; and
//   dx/dt = v, dv/dt = F/m, du/dt = power/m, dα/dt or dρ/dt where these are integrated
#pragma once

#include <fmt/format.h>

#include <gas/lists.hpp>
#include <integrators/explicit_integrator.hpp>
#include <schemes/godunov.hpp>
#include <schemes/gradients.hpp>
#include <schemes/remix.hpp>
#include <schemes/viscous.hpp>

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

template <int D>
void sum_densities(world<D>& g, const pairs::row_range& rows) {
  const foundation::stage timed(g.w.times, "densities");
  std::visit(
      [&]<class Kernel>(const Kernel& unit) {
        sum(g, rows, schemes::density<D, Kernel>{unit, g.fields()});
      },
      g.unit);
}

// What no state follows from.
template <int D>
void check_sums(world<D>& g) {
  const auto& s = g.w.s;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const auto fault = [&](const char* what, double value, const char* unit) {
      g.w.first_fault.report(s.id[i], fmt::format("the {} is {:.3g} {}, not above 0: {}", what, value, unit,
                                                  pairs::describe_position(s, i)));
    };
    if (g.evolves_density && !(g.evolved[i] > 0.0))
      fault("density", g.evolved[i], "kg/m^D");
    else if (!(s.u[i] > 0.0 || g.any_eos))
      fault("internal energy", s.u[i], "J/kg");
    else if (!(g.y[i] > 0.0 && std::isfinite(g.y[i])))
      fault("sum for the density", g.y[i], "in SI units");
  }
}

template <int D>
void check_sound(world<D>& g) {
  const auto& s = g.w.s;
  for (std::size_t i = 0; i < s.fluid; ++i)
    if (!(s.c[i] > 0.0)) {
      g.w.first_fault.report(
          s.id[i], fmt::format("no sound at {:.4g} kg/m^3 and {:.4g} J/kg, where '{}' does not reach: {}", s.rho[i],
                               s.u[i], eos::about(g.caloric_of(i).material()).name, pairs::describe_position(s, i)));
    }
}

// ρ, p, T, c of y and u. dU = -p dV with V = k w/y.
template <int D>
void find_pressure(world<D>& g, std::size_t i, double k) {
  auto& s = g.w.s;
  s.rho[i] = g.evolves_density ? g.evolved[i]
             : g.weighs_energy ? g.y[i] / s.u[i]
             : g.weighs_volume ? s.m[i] * g.y[i] / (k * g.weight[i])
                               : g.y[i];
  if (g.any_eos) {
    const eos::caloric_state now = g.state_of(i);
    s.p[i] = now.p;
    s.T[i] = now.T;
    s.c[i] = now.c;
    // The stiffened gas with K_S and K_S' (riemann/exact.hpp); where vapour is softer than that, a gas
    g.stiffness[i] = std::max(s.rho[i] * now.c * now.c / g.gamma[i] - now.p, 0.0);
    return;
  }
  s.p[i] = (g.gamma[i] - 1.0) * (g.weighs_energy ? g.y[i] : s.rho[i] * s.u[i]) - g.gamma[i] * g.stiffness[i];
  s.c[i] = g.sound_speed(i);
}

// What the pair takes of the viscosity, or of the star pressure.
template <int D>
double dissipation_of(world<D>& g, std::size_t i) {
  const bool switched = g.o.shock.balsara || g.part_of_star || g.evolves_density;
  const double balsara =
      switched ? schemes::balsara_factor(g.divergence[i], g.curl[i], g.w.s.c[i], g.S[i] / g.support_over_h) : 1.0;
  return g.evolves_density ? balsara : !g.godunov ? g.alpha[i] * balsara : g.part_of_star ? balsara : 1.0;
}

// Fields that ghosts and images have of what was found.
template <int D>
walls::signed_fields found_fields(world<D>& g) {
  auto& s = g.w.s;
  return walls::even({&g.correction, &s.rho, &s.p, &s.c, &s.dV, &g.per_S, &g.slope, &g.dissipation, &g.stiffness});
}

// The state that follows from the sums, set out to the ghosts; it is there, and that of images, after
// end_derived_exchange().
template <int D>
void begin_derived_exchange(world<D>& g) {
  const foundation::stage timed(g.w.times, "densities");
  auto& s = g.w.s;
  const auto& o = g.o;
  check_sums(g);
  const bool with_z = o.density_independent() && (o.shock.support_terms == "number" || o.terms_fade());
  const bool with_f = !with_z && o.shock.scheme != "gsph" && o.shock.support_terms != "none";
  foundation::for_all(s.fluid, [&](std::size_t i) {
    const double k = g.weighs_volume ? g.start_sum[i] : 1.0;
    find_pressure(g, i, k);
    g.number_volume[i] = 1.0 / g.number[i];
    s.dV[i] = g.evolves_density ? s.m[i] / s.rho[i] : g.number_volume[i];
    g.per_S[i] = 1.0 / g.S[i];
    g.slope[i] = o.terms_fade() ? std::sqrt(k) / g.y[i]
                                : (with_f ? g.f[i] : 1.0) * (g.godunov ? 1.0 : s.p[i]) * k / (g.y[i] * g.y[i]);
    g.correction[i] = with_z ? g.z[i] : 0.0;
    g.dissipation[i] = dissipation_of(g, i);
  });
  if (g.any_eos) check_sound(g);
  g.per_S[s.null()] = g.slope[s.null()] = 0.0;
  std::vector<double*> all;
  found_fields(g).each_array([&](double* a) { all.push_back(a); });
  domain::begin_exchange<D>(g.w.d.ranks, g.w.d.fluid_halo, std::span<double* const>(all));
}

template <int D>
void end_derived_exchange(world<D>& g) {
  const foundation::stage timed(g.w.times, "halo");
  g.w.end_fluid();
  walls::fill_images(g.walls, g.w.s, found_fields(g));
}

template <int D, class Kernel>
void find_gradients(world<D>& g, const Kernel& unit) {
  const foundation::stage timed(g.w.times, "gradients");
  sum(g, g.w.fluid(), schemes::gradients<D, Kernel>{unit, g.fields(), g.evolves_density ? g.w.s.u : g.w.s.p});
  spread<D>(g, g.gradient.data(), 0);
}

template <int D, class Kernel>
void find_corrections(world<D>& g, const Kernel& unit) {
  const foundation::stage timed(g.w.times, "corrections");
  sum(g, g.w.fluid(), schemes::reproducing<D, Kernel>{unit, g.fields()});
  spread<D>(g, g.reproducing.data(), 2);
}

template <int D, class Kernel>
void find_forces(world<D>& g, const Kernel& unit, const pairs::row_range& rows) {
  const foundation::stage timed(g.w.times, "forces");
  const auto& q = g.o.shock;
  const auto all = g.fields();
  const double theta = q.limiter == "minmod" ? 1.0 : 2.0;
  const bool exact = q.solver == "exact";
  if (q.scheme == "ssph") return sum(g, rows, schemes::ssph<D, Kernel>{unit, all});
  if (q.scheme == "disph") return sum(g, rows, schemes::disph<D, Kernel>{unit, all});
  if (q.scheme == "gsph") return sum(g, rows, schemes::gsph<D, Kernel>{unit, all, theta, exact});
  if (g.o.terms_fade()) return sum(g, rows, schemes::gdisph_of_contacts<D, Kernel>{unit, all, theta, exact, q.fading});
  if (q.scheme == "gdisph") return sum(g, rows, schemes::gdisph<D, Kernel>{unit, all, theta, exact});
  sum(g, rows, schemes::remix<D, Kernel>{unit, all, g.support_over_dx});
}

template <int D>
std::vector<integrators::field> integrated_fields(world<D>& g) {
  auto& s = g.w.s;
  constexpr std::array<const char*, 3> axis{"x", "y", "z"};
  const double speed = g.speed_scale;
  std::vector<integrators::field> all;
  for (std::size_t a = 0; a < D; ++a) all.push_back({axis[a], s.x[a].data(), 0.0, g.w.dx, 0.0, g.w.frame[a]});
  for (std::size_t a = 0; a < D; ++a) all.push_back({std::string("v") + axis[a], s.v[a].data(), 0.0, speed});
  all.push_back({"u", s.u.data(), 0.0, speed * speed});
  if (g.o.has_alpha()) all.push_back({"alpha", g.alpha.data(), 0.0, 1.0});
  if (g.evolves_density) all.push_back({"density", g.evolved.data(), 0.0, g.density_scale});
  return all;
}

// Of the integrated fields, in their order.
template <int D>
void combine(world<D>& g, std::span<double* const> rate) {
  const auto& s = g.w.s;
  const auto& q = g.o.shock;
  foundation::for_all(s.fluid, [&](std::size_t i) {
    for (std::size_t a = 0; a < D; ++a) {
      rate[a][i] = s.v[a][i];
      rate[D + a][i] = g.force[a][i] / s.m[i];
    }
    if constexpr (D > 1) rate[D + 1][i] -= q.gravity;
    rate[2 * D][i] = g.power[i] / s.m[i];
    if (g.evolves_density) rate[2 * D + 1][i] = g.density_rate[i];
    if (g.o.has_alpha())
      rate[2 * D + 1][i] =
          schemes::alpha_rate(g.alpha[i], q.alpha_min, q.alpha, g.divergence[i], s.c[i], g.S[i] / g.support_over_h);
  });
}

// Collective.
template <int D>
void evaluate(world<D>& g, std::span<double* const> rate) {
  const auto& w = g.w;
  const bool from_state = !g.second_order && !g.evolves_density;  // forces need no gradients of the ghosts
  begin_halo_exchange(g);
  sum_densities(g, w.interior());
  end_halo_exchange(g);
  sum_densities(g, w.at_border());
  begin_derived_exchange(g);
  std::visit(
      [&](const auto& unit) {
        if (from_state) find_forces(g, unit, w.interior());
        end_derived_exchange(g);
        if (g.evolves_density) find_corrections(g, unit);
        if (!from_state) find_gradients(g, unit);
        find_forces(g, unit, from_state ? w.at_border() : w.fluid());
      },
      g.unit);
  combine(g, rate);
}

}  // namespace tetsuame::gas
