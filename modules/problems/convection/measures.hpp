// Means over the box, and heat through its walls.
#pragma once

#include <convection/interpolation.hpp>
#include <convection/wall_gradient.hpp>
#include <foundation/exact_sum.hpp>
#include <limits>
#include <run/lists.hpp>

namespace tetsuame::convection {

// visit(number, place) for those of a lattice of n places, dx apart, that are in this rank's cell, by ascending number.
template <int D>
void for_each_place(const run::state<D>& scene, const std::array<std::int64_t, 3>& n, double dx, const auto& visit) {
  const auto cell = scene.w.d.cell();
  std::int64_t total = 1;
  for (std::size_t a = 0; a < D; ++a) total *= n[a];
  for (std::int64_t id = 0; id < total; ++id) {
    std::array<double, D> x;
    std::int64_t rest = id;
    for (std::size_t a = 0; a < D; ++a) {
      x[a] = (static_cast<double>(rest % n[a]) + 0.5) * dx;
      rest /= n[a];
    }
    if (scene.w.d.within(cell, x)) visit(id, x);
  }
}

// Of values at fluid, ghosts and images: interpolated to the places of the lattice of n particles and summed there.
// Particles at walls stand in rows, whose volumes 1/ΣW has wrong by a hundredth: sums with those are of the first order
// (docs/theory/convection.md). Where places have too few particles near (the flow blows up) the particles' own mean.
template <int D, std::size_t K>
std::array<double, K> mean_over_box(const run::state<D>& scene, const std::array<std::int64_t, 3>& n,
                                    const std::array<particles::array, K>& values) {
  const auto& ranks = scene.w.d.ranks;
  std::array<const double*, K> f;
  for (std::size_t k = 0; k < K; ++k) f[k] = values[k].data();
  std::vector<std::array<double, D>> places;
  for_each_place(scene, n, scene.w.dx, [&](std::int64_t, const auto& x) { places.push_back(x); });
  const interpolation<D> at(scene.w.s, scene.w.support());
  std::vector<std::optional<std::array<double, K>>> found(places.size());
  foundation::for_all(places.size(), [&](std::size_t i) { found[i] = at(places[i], f); });
  std::array<foundation::exact_sum, K> sum;
  bool covered = true;
  for (const auto& values_there : found) {
    covered = covered && values_there.has_value();
    for (std::size_t k = 0; k < K && values_there; ++k) sum[k].add((*values_there)[k]);
  }
  if (ranks.minimum(covered ? 1.0 : 0.0) == 0.0) {
    sum = {};
    for (std::size_t k = 0; k < K; ++k)
      for (std::size_t i = 0; i < scene.w.s.fluid; ++i) sum[k].add(values[k][i]);
  }
  std::array<double, K> mean;
  for (std::size_t k = 0; k < K; ++k) mean[k] = ranks.exact(sum[k]) / static_cast<double>(scene.fluid_total);
  return mean;
}

// The mean of the inward gradient of temperature at a wall, and those at its ends x = 0 and x = length, times `unit`.
template <int D>
std::array<double, 3> wall_gradients(const run::state<D>& scene, const walls::side<D>& wall,
                                     const std::array<std::int64_t, 3>& n, double length, double unit) {
  const auto& s = scene.w.s;
  const auto& ranks = scene.w.d.ranks;
  const double dx = scene.w.dx, radius = fit_radius * dx;
  std::vector<near_wall> near;
  for (std::size_t i = 0; i < s.total(); ++i) {
    const double y = wall.distance(s.x[1][i]);
    if (y <= 0.0 || y >= radius) continue;
    near.push_back({y, {s.x[0][i], D == 3 ? s.x[2 % D][i] : 0.0}, s.T[i] - wall.temperature, s.id[i]});
  }
  sort(near);
  const auto cell = scene.w.d.cell();
  const auto here = [&](double x, double z) {
    std::array<double, D> place;
    place[0] = x;
    place[1] = wall.position + wall.inward * 1e-6 * dx;
    if (D == 3) place[2 % D] = z;
    return scene.w.d.within(cell, place);
  };
  foundation::exact_sum sum;
  std::int64_t places = 0;
  const std::int64_t depth = D == 3 ? n[2] : 1;
  for (std::int64_t k = 0; k < n[0]; ++k)
    for (std::int64_t l = 0; l < depth; ++l) {
      const double x = (static_cast<double>(k) + 0.5) * dx, z = D == 3 ? (static_cast<double>(l) + 0.5) * dx : 0.0;
      ++places;
      if (here(x, z)) sum.add(unit * wall_gradient(near, {x, z}, radius, D));
    }
  const auto corner = [&](double x) {
    const double lowest = std::numeric_limits<double>::lowest();
    const double inside = std::min(std::max(x, 1e-6 * dx), length - 1e-6 * dx);
    return ranks.maximum(here(inside, 0.0) ? unit * wall_gradient(near, {x, 0.0}, radius, D) : lowest);
  };
  return {ranks.exact(sum) / static_cast<double>(places), corner(0.0), corner(length)};
}

struct wall_measures {
  double top, bottom;
  std::array<double, 4> corners;  // top left, top right, bottom right, bottom left
};

// Heat through top and bottom over that of conduction, and gradients at the corners, for unit = L/ΔT; where the flux of
// heat is given, which is conducted with `conductivity` (W/(m K)), those that it makes.
template <int D>
wall_measures wall_heat(const run::state<D>& scene, const std::array<std::int64_t, 3>& n, double length, double unit,
                        double conductivity) {
  wall_measures m{};
  for (const auto& wall : scene.walls.sides) {
    if (wall.axis != 1) continue;
    const bool top = wall.inward < 0.0;
    const double given = -wall.flux / conductivity * unit;
    const auto [mean, left, right] = wall.thermal == walls::heat::fixed_temperature
                                         ? wall_gradients(scene, wall, n, length, unit)
                                         : std::array{given, given, given};
    const double sign = top ? 1.0 : -1.0;  // heat goes up: T falls from the bottom, rises from the top into the fluid
    (top ? m.top : m.bottom) = sign * mean;
    m.corners[top ? 0 : 3] = sign * left;
    m.corners[top ? 1 : 2] = sign * right;
  }
  return m;
}

}  // namespace tetsuame::convection
