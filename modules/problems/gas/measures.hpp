// What is told of the state: totals, errors against the exact solution, columns of the snapshots.
#pragma once

#include <gas/world.hpp>
#include <nlohmann/json.hpp>
#include <output/groups.hpp>

namespace tetsuame::gas {

template <int D>
totals<D> sum_up(const world<D>& g) {
  const auto& s = g.w.s;
  foundation::exact_sum mass, kinetic, internal, potential, scale;
  std::array<foundation::exact_sum, D> momentum;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    double v2 = 0.0;
    for (std::size_t a = 0; a < D; ++a) {
      v2 += s.v[a][i] * s.v[a][i];
      momentum[a].add(s.m[i] * s.v[a][i]);
    }
    mass.add(s.m[i]);
    kinetic.add(0.5 * s.m[i] * v2);
    internal.add(s.m[i] * s.u[i]);
    if constexpr (D > 1) potential.add(s.m[i] * g.o.shock.gravity * s.x[1][i]);
    scale.add(s.m[i] * (std::sqrt(v2) + g.sound_speed(i)));
  }
  const auto& ranks = g.ranks();
  totals<D> t{ranks.exact(mass),      ranks.exact(kinetic), ranks.exact(internal),
              ranks.exact(potential), ranks.exact(scale),   {}};
  for (std::size_t a = 0; a < D; ++a) t.momentum[a] = ranks.exact(momentum[a]);
  return t;
}

// Largest change of a component that is kept, over the sum of m (|v| + c).
template <int D>
double momentum_change(const world<D>& g, const totals<D>& now, const totals<D>& first) {
  double momentum = 0.0;
  for (std::size_t a = 0; a < D; ++a)
    if (a != 1 || g.o.shock.gravity == 0.0)
      momentum = std::max(momentum, std::abs(now.momentum[a] - first.momentum[a]) / now.momentum_scale);
  return momentum;
}

template <int D>
double largest_density(const world<D>& g) {
  double densest = 0.0;
  for (std::size_t i = 0; i < g.w.s.fluid; ++i) densest = std::max(densest, g.told_density()[i]);
  return g.ranks().maximum(densest);
}

template <int D>
view particles_seen(const world<D>& g) {
  const auto& s = g.w.s;
  view seen{g.ranks(),        s.fluid, {}, {}, s.m.data(), g.told_density().data(), s.p.data(), g.number_volume.data(),
            s.material.data()};
  for (std::size_t a = 0; a < D; ++a) {
    seen.x[a] = s.x[a].data();
    seen.v[a] = s.v[a].data();
  }
  return seen;
}

// Means of |value - exact| over the volume of the particles measured; null where there are none.
template <int D>
nlohmann::ordered_json errors(const world<D>& g, double t) {
  const auto& s = g.w.s;
  foundation::exact_sum volume, rho, v, p;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const point x = g.place(i);
    if (g.test.measured && !g.test.measured(x, t)) continue;
    const state right = g.test.exact(x, t);
    double dv2 = 0.0;
    for (std::size_t a = 0; a < D; ++a) dv2 += (s.v[a][i] - right.v[a]) * (s.v[a][i] - right.v[a]);
    const double V = g.number_volume[i];
    volume.add(V);
    rho.add(V * std::abs(g.told_density()[i] - right.rho));
    v.add(V * std::sqrt(dv2));
    p.add(V * std::abs(s.p[i] - right.p));
  }
  const double all = g.ranks().exact(volume);
  const auto mean = [&](const foundation::exact_sum& sum) {
    const double of_all = g.ranks().exact(sum);
    return run::or_null(all != 0.0 ? std::optional(of_all / all) : std::nullopt);
  };
  return {{"density_l1", mean(rho)}, {"velocity_l1", mean(v)}, {"pressure_l1", mean(p)}};
}

// extra: h, and the exact density, pressure and velocity where there are any
template <int D>
output::particle_group snapshot(world<D>& g, double t, std::vector<particles::array>& extra) {
  const auto& s = g.w.s;
  auto group = output::fluid_in_motion(s);
  extra.assign(g.test.exact ? 3 + D : 1, particles::array(s.fluid));
  for (std::size_t i = 0; i < s.fluid; ++i) extra[0][i] = g.S[i] / g.support_over_h;
  const auto scalar = [&](const char* name, const char* unit, const char* about, const particles::array& a) {
    group.columns.push_back({name, unit, about, {a.data()}, false});
  };
  scalar("Masses", "kg", "mass", s.m);
  scalar("Density", "kg/m^3", "mass density", g.told_density());
  scalar("Pressure", "Pa", "pressure", s.p);
  scalar("InternalEnergy", "J/kg", "specific internal energy", s.u);
  if (g.o.any_eos()) scalar("Temperature", "K", "temperature", s.T);
  scalar("SmoothingLength", "m", "smoothing length h", extra[0]);
  if (g.has_alpha()) scalar("ArtificialViscosity", "1", "alpha", g.alpha);
  if (!g.test.exact) return group;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const state right = g.test.exact(g.place(i), t);
    extra[1][i] = right.rho;
    extra[2][i] = right.p;
    for (std::size_t a = 0; a < D; ++a) extra[3 + a][i] = right.v[a];
  }
  scalar("DensityReference", "kg/m^3", "exact mass density at this place", extra[1]);
  scalar("PressureReference", "Pa", "exact pressure at this place", extra[2]);
  group.columns.push_back(
      output::vector_column("VelocitiesReference", "m/s", "exact velocity at this place", std::span(extra).subspan(3)));
  return group;
}

}  // namespace tetsuame::gas
