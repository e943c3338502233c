// What is measured of a state: errors against the exact solution, what should be conserved,
// and the largest stable steps. Sums are exact, so they do not depend on the ranks.
#pragma once

#include <hydrostatic/setup.hpp>
#include <integrators/explicit_integrator.hpp>
#include <liquid/sums.hpp>
#include <output/checkpoint.hpp>

namespace tetsuame::hydrostatic {

struct errors {
  double pressure_mean = 0.0;  // mean |p - p_exact|/p_exact
  double pressure_max = 0.0;
  double density_max = 0.0;  // max |ρ - ρ_exact|/ρ_exact
  double displacement_max_over_dx = 0.0;
  double density_excess = 0.0;  // the largest of ρ/ρ_most and ρ_least/ρ of the exact profile, on this rank
};

// Needs p and ρ of an evaluation at this state. Exact is the profile at the start position.
template <int D>
errors measure_errors(const scene<D>& scene) {
  const auto& s = scene.w.s;
  const auto& ranks = scene.w.d.ranks;
  const auto [least, most] = std::ranges::minmax(scene.rho_exact);
  errors e;
  const auto [sum] = liquid::exact_sums<1>(scene, [&](std::size_t i, const auto& add) {
    const auto row = row_of(scene, i);
    const double dp = std::abs(s.p[i] / scene.p_exact[row] - 1.0);
    add(dp);
    e.pressure_max = std::max(e.pressure_max, dp);
    e.density_max = std::max(e.density_max, std::abs(s.rho[i] / scene.rho_exact[row] - 1.0));
    e.density_excess = std::max({e.density_excess, s.rho[i] / most, least / s.rho[i]});
    double r2 = 0.0;
    for (const double d : displacement(scene, i)) r2 += d * d;
    e.displacement_max_over_dx = std::max(e.displacement_max_over_dx, std::sqrt(r2) / scene.w.dx);
  });
  e.pressure_mean = sum / static_cast<double>(scene.fluid_total);
  e.pressure_max = ranks.maximum(e.pressure_max);
  e.density_max = ranks.maximum(e.density_max);
  e.displacement_max_over_dx = ranks.maximum(e.displacement_max_over_dx);
  return e;
}

template <int D>
struct totals {
  double mass = 0.0;                                      // kg (2-D: kg/m)
  std::array<double, D> momentum{};                       // kg m/s
  double kinetic = 0.0, potential = 0.0, internal = 0.0;  // J; internal: gained since the start
  double pressure_volume = 0.0;                           // J, Σ p ΔV: the scale of energies
  double sound_momentum = 0.0;                            // kg m/s, Σ m c: the scale of momenta
  double energy() const { return kinetic + potential + internal; }
};

// Needs p, ΔV and c of an evaluation.
template <int D>
totals<D> measure_totals(const scene<D>& scene) {
  const auto& s = scene.w.s;
  const auto momentum = liquid::exact_sums<D>(scene, [&](std::size_t i, const auto& add) {
    std::array<double, D> of_particle;
    for (std::size_t a = 0; a < D; ++a) of_particle[a] = s.m[i] * s.v[a][i];
    std::apply(add, of_particle);
  });
  const auto [kinetic, potential, internal, mass, pressure_volume, sound] =
      liquid::exact_sums<6>(scene, [&](std::size_t i, const auto& add) {
        for (std::size_t a = 0; a < D; ++a)
          add(0.5 * s.m[i] * s.v[a][i] * s.v[a][i], -s.m[i] * scene.w.g[a] * s.x[a][i]);
        const double of_walls = walls::boundary_potential(scene.walls.force, scene.walls.sides, s, i);
        add(0.0, s.m[i] * of_walls, s.m[i] * s.u[i], s.m[i], s.p[i] * s.dV[i], s.m[i] * s.c[i]);
      });
  return {mass, momentum, kinetic, potential, internal, pressure_volume, sound};
}

struct step_limits {
  double cfl, viscous, thermal;  // s; infinite where there is no such limit

  integrators::step_limit least() const {
    if (cfl <= viscous && cfl <= thermal) return {cfl, "cfl"};
    return viscous <= thermal ? integrators::step_limit{viscous, "viscous"}
                              : integrators::step_limit{thermal, "thermal"};
  }
};

// CFL Δx/c, momentum ρ_min Δx²/η, heat ρ_min c_V Δx²/k [S0 (9)–(11)], times the input's fractions.
// Needs ρ, c and c_V of an evaluation.
template <int D>
step_limits measure_limits(const scene<D>& scene, const run::time_options& o) {
  const auto& s = scene.w.s;
  const auto largest = [&](const auto& value) { return foundation::largest_of(s.fluid, 0.0, value); };
  const double c = largest([&](std::size_t i) { return std::isfinite(s.c[i]) ? s.c[i] : 0.0; }),
               nu = largest([&](std::size_t i) { return s.eta[i] / s.rho[i]; }),
               kappa = largest([&](std::size_t i) { return s.k[i] / (s.rho[i] * s.c_V[i]); });
  const auto& ranks = scene.w.d.ranks;
  const double dx = scene.w.dx;
  return {*o.cfl * dx / ranks.maximum(c), *o.diffusive * dx * dx / ranks.maximum(nu),
          *o.diffusive * dx * dx / ranks.maximum(kappa)};
}

// The totals of the start, against which conservation is measured, in a checkpoint.
template <int D>
void save(const totals<D>& start, output::checkpoint_globals& g) {
  g.reals["mass_start"] = start.mass;
  for (std::size_t a = 0; a < D; ++a) g.reals["momentum_start_" + std::to_string(a)] = start.momentum[a];
  g.reals["energy_start"] = start.energy();
  g.reals["pressure_volume_start"] = start.pressure_volume;
  g.reals["sound_momentum_start"] = start.sound_momentum;
}

// Of the energies only the sum is kept: it stands as the potential.
template <int D>
totals<D> totals_of_start(const output::checkpoint_globals& g) {
  totals<D> start;
  start.mass = g.reals.at("mass_start");
  for (std::size_t a = 0; a < D; ++a) start.momentum[a] = g.reals.at("momentum_start_" + std::to_string(a));
  start.potential = g.reals.at("energy_start");
  start.pressure_volume = g.reals.at("pressure_volume_start");
  start.sound_momentum = g.reals.at("sound_momentum_start");
  return start;
}

}  // namespace tetsuame::hydrostatic
