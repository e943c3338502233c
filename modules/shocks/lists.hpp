// Neighbour lists of particles whose supports are their own, ghosts, images, and what these take from their sources.
#pragma once

#include <shocks/world.hpp>

namespace tetsuame::shocks {

// x, v, u of ghosts and images, and everyone's weight.
template <int D>
void refresh_state(world<D>& g) {
  auto& s = g.w.s;
  const foundation::stage timed(g.w.times, "halo");
  std::array<double*, D + 1> state;
  for (std::size_t a = 0; a < D; ++a) state[a] = s.v[a].data();
  state[D] = s.u.data();
  domain::exchange<D>(g.w.d.ranks, g.w.d.fluid_halo, std::span<double* const>(state), &s.x);
  images::move(g.walls, s);
  for_each_image(g, [&](std::size_t i, std::size_t j, const std::array<double, D>& sign) {
    for (std::size_t a = 0; a < D; ++a) s.v[a][i] = sign[a] * s.v[a][j];
    s.u[i] = s.u[j];
  });
  foundation::for_all(s.total(), [&](std::size_t i) {
    g.weight[i] = g.o.weighs_energy() ? s.m[i] * s.u[i] : g.o.weighs_volume() ? g.start_volume()[i] : s.m[i];
  });
}

// The particles of this rank, by cell. Returns the cells' edge and the largest support, m.
struct list_widths {
  double edge, most;
};
template <int D>
list_widths sort_particles(world<D>& g, bool as_they_were) {
  auto& s = g.w.s;
  if (!as_they_were) domain::wrap(g.w.d.region, s);
  domain::migrate(g.w.d, s);
  if (!as_they_were) std::copy_n(g.support().begin(), s.fluid, g.list_support().begin());
  double most = 0.0;
  foundation::exact_sum all;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    most = std::max(most, g.list_support()[i]);
    all.add(g.list_support()[i]);
  }
  most = g.ranks().maximum(most);
  const double mean = g.ranks().exact(all) / static_cast<double>(g.fluid_total);
  const double edge = cells::cell_edge(mean + g.skin);
  const auto cells_of_fluid = cells::make_grid<D>(s.x, s.id, s.fluid, edge);
  std::vector<std::size_t> order(cells_of_fluid.members.begin(), cells_of_fluid.members.end());
  particles::reorder(s, 0, std::span<const std::size_t>(order));
  if (!as_they_were)
    for (std::size_t a = 0; a < D; ++a) std::copy_n(s.x[a].begin(), s.fluid, s.x_list[a].begin());
  return {edge, most};
}

// With what they keep while the lists live.
template <int D>
void make_ghosts_and_images(world<D>& g, double most) {
  auto& s = g.w.s;
  g.w.d.width = (most + g.skin) * (1.0 + 1e-6);
  for (std::size_t a = 0; a < D; ++a)
    if (g.w.d.region.periodic[a] && g.w.d.width > g.w.d.region.length[a])
      foundation::fail_calculation("a particle's kernel has grown wider than the periodic box");
  domain::make_halo<D>(g.w.d, s, 0, s.fluid, s.fluid, g.w.d.fluid_halo,
                       [&](std::size_t ghosts) { particles::allocate(s, s.fluid, ghosts, 0, 0); });
  images::make(g.walls, s, g.fluid_total, most + g.skin);
  for (auto* a : {&g.gamma, &g.stiffness}) a->assign(s.total() + 1, 0.0);
  for (std::size_t i = 0; i < s.fluid; ++i) std::tie(g.gamma[i], g.stiffness[i]) = gas_of(g, s.material[i]);
  g.gamma[s.null()] = g.o.shock.gamma;
  g.kind.assign(s.total() + 1, 0.0);
  const bool two = g.o.any_eos() || gas_of(g, 0) != gas_of(g, 1);
  for (std::size_t i = 0; i < s.fluid; ++i) g.kind[i] = two ? s.material[i] : 0;
  const std::array<double*, 6> fixed{s.m.data(),     g.list_support().data(), g.start_volume().data(),
                                     g.gamma.data(), g.stiffness.data(),      g.kind.data()};
  domain::exchange<D>(g.w.d.ranks, g.w.d.fluid_halo, std::span<double* const>(fixed));
  foundation::for_all(g.walls.source.size(), [&](std::size_t r) {
    for (double* a : fixed) a[s.first_wall() + r] = a[g.walls.source[r]];
  });
}

template <int D>
void resize_arrays(world<D>& g) {
  const auto& s = g.w.s;
  for (auto* a : {&g.S, &g.per_S, &g.weight, &g.slope, &g.correction, &g.dissipation}) a->assign(s.total() + 1, 0.0);
  for (auto* a : {&g.y, &g.f, &g.z, &g.divergence, &g.curl, &g.number, &g.number_volume, &g.count, &g.count_slope,
                  &g.power, &g.signal, &g.mass_density})
    a->resize(s.fluid);
  for (auto& a : g.force) a.resize(s.fluid);
  if (g.o.evolves_density()) {
    for (auto& a : g.reproducing) a.assign(s.total() + 1, 0.0);
    g.density_rate.resize(s.fluid);
  }
  if (g.o.second_order() || g.o.evolves_density())
    for (auto& a : g.gradient) a.assign(s.total() + 1, 0.0);
}

// As images::rebuild, with supports of the particles' own.
template <int D>
void make_lists(world<D>& g, bool as_they_were) {
  auto& s = g.w.s;
  const foundation::stage timed(g.w.times, "lists");
  const auto exchange_positions = [&] {
    for (std::size_t a = 0; a < D; ++a)
      std::swap_ranges(s.x[a].begin(), s.x[a].begin() + static_cast<std::ptrdiff_t>(s.fluid), s.x_list[a].begin());
  };
  particles::allocate(s, s.fluid, 0, 0, 0);
  if (as_they_were) exchange_positions();
  const auto [edge, most] = sort_particles(g, as_they_were);
  make_ghosts_and_images(g, most);
  images::make_list<D>(g.w, g.list_support(), g.skin, edge);
  if (as_they_were) exchange_positions();
  resize_arrays(g);
  std::copy_n(g.support().begin(), s.fluid, g.S.begin());
  std::fill(g.signal.begin(), g.signal.end(), 0.0);
  refresh_state(g);
}

}  // namespace tetsuame::shocks
