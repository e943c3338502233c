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

// extra: what is made for the snapshot
template <int D>
output::particle_group snapshot(world<D>& g, double t, std::vector<particles::array>& extra) {
  const auto& s = g.w.s;
  auto group = output::group_of(s, 0, 0, s.fluid);
  const auto add = [&](const char* name, const double* values) { output::add_quantity(group, name, {values}); };
  const auto make = [&](auto&& value) { return output::make_array(extra, s.fluid, value); };
  add("Masses", s.m.data());
  add("Density", g.told_density().data());
  add("Pressure", s.p.data());
  add("Temperature", g.o.any_eos() ? s.T.data() : make([](auto) { return 0.0; }));
  add("SmoothingLength", make([&](auto i) { return g.S[i] / g.support_over_h; }));
  add("Material", make([&](auto i) { return s.material[i]; }));
  add("InternalEnergy", s.u.data());
  if (g.has_alpha()) add("ArtificialViscosity", g.alpha.data());
  if (!g.test.exact) return group;
  std::vector<state> exact;
  for (std::size_t i = 0; i < s.fluid; ++i) exact.push_back(g.test.exact(g.place(i), t));
  add("DensityReference", make([&](auto i) { return exact[i].rho; }));
  add("PressureReference", make([&](auto i) { return exact[i].p; }));
  std::vector<const double*> v;
  for (std::size_t a = 0; a < D; ++a) v.push_back(make([&](auto i) { return exact[i].v[a]; }));
  output::add_quantity(group, "VelocitiesReference", v);
  return group;
}

}  // namespace tetsuame::gas
