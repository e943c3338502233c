// The right-hand side: state (state.hpp); gradients, of p, ρ, v for the second order, of u, ρ, v for REMIX; the
// kernels' corrections (REMIX); forces and power, with artificial viscosity or Riemann problems; and
//   dx/dt = v, dv/dt = F/m, du/dt = power/m, dα/dt or dρ/dt where these are integrated
#pragma once

#include <gas/lists.hpp>
#include <gas/state.hpp>
#include <integrators/explicit_integrator.hpp>
#include <schemes/disph.hpp>
#include <schemes/gdisph.hpp>
#include <schemes/gradients.hpp>
#include <schemes/gsph.hpp>
#include <schemes/remix.hpp>
#include <schemes/ssph.hpp>

namespace tetsuame::gas {

template <int D, class Kernel>
void find_gradients(world<D>& g, const Kernel& unit) {
  const foundation::stage timed(g.w.times, "gradients");
  auto& s = g.w.s;
  schemes::gradients<D, Kernel> term{
      unit,       s.dV.data(), g.o.evolves_density() ? s.u.data() : s.p.data(), s.rho.data(), pairs::pointers<D>(s.v),
      g.S.data(), {}};
  std::array<double*, world<D>::G> all;
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = term.out[k] = g.gradient[k].data();
  sum(g, g.w.fluid(), term);
  domain::exchange<D>(g.w.d.ranks, g.w.d.fluid_halo, std::span<double* const>(all));
  for_each_image(g, [&](std::size_t i, std::size_t j, const std::array<double, D>& sign) {
    for (std::size_t k = 0; k < D + 2; ++k)
      for (std::size_t b = 0; b < D; ++b) {
        const double of_field = k < 2 ? 1.0 : sign[k - 2];
        all[D * k + b][i] = of_field * sign[b] * all[D * k + b][j];
      }
  });
}

// Where A, B and their gradients are, for what finds and for what reads them.
template <int D, class Fields>
void place_corrections(world<D>& g, Fields& to) {
  const auto at = [&](std::size_t k) { return g.reproducing[k].data(); };
  to.A = at(1);
  for (std::size_t a = 0; a < D; ++a) {
    to.B[a] = at(2 + a);
    to.grad_A[a] = at(2 + D + a);
  }
  for (std::size_t k = 0; k < to.grad_B.size(); ++k) to.grad_B[k] = at(2 + 2 * D + k);
}

template <int D, class Kernel>
void find_corrections(world<D>& g, const Kernel& unit) {
  const foundation::stage timed(g.w.times, "corrections");
  schemes::reproducing<D, Kernel> term{unit, g.w.s.dV.data(), g.per_S.data(), {}};
  std::array<double*, world<D>::R> all;
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = g.reproducing[k].data();
  term.out.m0 = all[0];
  place_corrections(g, term.out);
  sum(g, g.w.fluid(), term);
  domain::exchange<D>(g.w.d.ranks, g.w.d.fluid_halo, std::span<double* const>(all));
  for_each_image(g, [&](std::size_t i, std::size_t j, const std::array<double, D>& sign) {
    all[0][i] = all[0][j];
    all[1][i] = all[1][j];
    for (std::size_t a = 0; a < D; ++a) {
      term.out.B[a][i] = sign[a] * term.out.B[a][j];
      term.out.grad_A[a][i] = sign[a] * term.out.grad_A[a][j];
      for (std::size_t b = 0; b < D; ++b)
        term.out.grad_B[D * a + b][i] = sign[a] * sign[b] * term.out.grad_B[D * a + b][j];
    }
  });
}

// What the schemes read.
template <int D>
schemes::gas<D> fields_of(world<D>& g) {
  auto& s = g.w.s;
  schemes::gas<D> gas{pairs::pointers<D>(s.v),
                      s.m.data(),
                      g.weight.data(),
                      s.rho.data(),
                      s.p.data(),
                      s.c.data(),
                      g.slope.data(),
                      g.correction.data(),
                      g.per_S.data(),
                      g.dissipation.data(),
                      g.gamma.data(),
                      g.stiffness.data(),
                      {},
                      {},
                      {},
                      g.o.shock.limiter == "minmod" ? 1.0 : 2.0,
                      g.o.shock.solver == "exact"};
  for (std::size_t b = 0; b < D; ++b) {
    gas.grad_p[b] = g.gradient[b].data();
    gas.grad_rho[b] = g.gradient[D + b].data();
  }
  for (std::size_t k = 0; k < gas.grad_v.size(); ++k) gas.grad_v[k] = g.gradient[2 * D + k].data();
  return gas;
}

template <int D, class Kernel>
void find_forces(world<D>& g, const Kernel& unit, const pairs::stretch& rows) {
  const foundation::stage timed(g.w.times, "forces");
  const auto& scheme = g.o.shock.scheme;
  const auto gas = fields_of(g);
  schemes::rates<D> out{{}, g.power.data(), g.signal.data()};
  for (std::size_t a = 0; a < D; ++a) out.force[a] = g.force[a].data();
  if (scheme == "ssph") return sum(g, rows, schemes::ssph<D, Kernel>{unit, gas, out});
  if (scheme == "disph") return sum(g, rows, schemes::disph<D, Kernel>{unit, gas, out});
  schemes::reproducing_fields<D> corrections;
  place_corrections(g, corrections);
  if (scheme == "remix")
    return sum(
        g, rows,
        schemes::remix<D, Kernel>{unit, gas, corrections, g.w.s.dV.data(), g.w.s.u.data(), g.reproducing[0].data(),
                                  g.kind.data(), g.support_over_dx, out, g.density_rate.data()});
  const bool second = g.o.second_order();
  if (scheme == "gsph")
    return second ? sum(g, rows, schemes::gsph<D, Kernel, true>{unit, gas, out})
                  : sum(g, rows, schemes::gsph<D, Kernel, false>{unit, gas, out});
  return second ? sum(g, rows, schemes::gdisph<D, Kernel, true>{unit, gas, out})
                : sum(g, rows, schemes::gdisph<D, Kernel, false>{unit, gas, out});
}

template <int D>
std::vector<integrators::field> integrated_fields(world<D>& g) {
  auto& s = g.w.s;
  constexpr std::array<const char*, 3> axis{"x", "y", "z"};
  const double speed = g.speed_scale;
  std::vector<integrators::field> all;
  for (std::size_t a = 0; a < D; ++a) all.push_back({axis[a], s.x[a].data(), 0.0, g.w.dx});
  for (std::size_t a = 0; a < D; ++a) all.push_back({std::string("v") + axis[a], s.v[a].data(), 0.0, speed});
  all.push_back({"u", s.u.data(), 0.0, speed * speed});
  if (g.has_alpha()) all.push_back({"alpha", g.alpha.data(), 0.0, 1.0});
  if (g.o.evolves_density()) all.push_back({"density", g.evolved.data(), 0.0, g.density_scale});
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
    if (g.o.evolves_density()) rate[2 * D + 1][i] = g.density_rate[i];
    if (g.has_alpha())
      rate[2 * D + 1][i] =
          schemes::alpha_rate(g.alpha[i], q.alpha_min, q.alpha, g.divergence[i], s.c[i], g.S[i] / g.support_over_h);
  });
  for (std::size_t i = 0; i < s.fluid; ++i)
    if (!std::isfinite(rate[D][i] + rate[2 * D][i])) {
      g.w.first_fault.report(s.id[i], fmt::format("a rate is not finite at particle {}", s.id[i]));
      break;
    }
}

// Collective.
template <int D>
void evaluate(world<D>& g, std::span<double* const> rate) {
  const auto& w = g.w;
  const bool from_state = !g.o.second_order() && !g.o.evolves_density();  // forces need no gradients of the ghosts
  begin_state(g);
  std::visit(
      [&](const auto& unit) {
        sum_densities(g, unit, w.interior());
        end_state(g);
        sum_densities(g, unit, w.at_border());
        begin_found(g);
        if (from_state) find_forces(g, unit, w.interior());
        end_found(g);
        if (g.o.evolves_density()) find_corrections(g, unit);
        if (!from_state) find_gradients(g, unit);
        find_forces(g, unit, from_state ? w.at_border() : w.fluid());
      },
      g.unit);
  combine(g, rate);
  g.w.agree();
}

}  // namespace tetsuame::gas
