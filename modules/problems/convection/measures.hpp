// Fields between the particles, means over the box, and heat through its walls.
#pragma once

#include <algorithm>
#include <cells/grid.hpp>
#include <convection/options.hpp>
#include <foundation/exact_sum.hpp>
#include <limits>
#include <operators/symmetric.hpp>
#include <optional>
#include <run/lists.hpp>
#include <walls/interpolation.hpp>

namespace tetsuame::convection {

// Fields of particles at other places: least squares of a polynomial of second degree about the place,
//   f(x) = a + b·(x - place) + (x - place)·c (x - place),  weights (1 - r²/radius²)²;  a is the value
// Ghosts and images take part, with the values that they have: what a wall asks of a field the interpolated one has
// too. Sums run in the order of the grid, so that the result does not depend on ranks.
template <int D>
class interpolation {
 public:
  // radius: m; no more than the width in which ghosts and images stand.
  interpolation(const particles::particles<D>& s, double radius)
      : s_(s), radius_(radius), grid_(cells::make_grid<D>(s.x, s.id, s.total(), 0.5 * radius)) {}

  // Values of the fields f, which reach over fluid, ghosts and images, at the place; none where too few particles are
  // near.
  template <std::size_t K>
  std::optional<std::array<double, K>> operator()(const std::array<double, D>& place,
                                                  const std::array<const double*, K>& f) const {
    std::array<std::array<double, terms>, terms> A{};
    std::array<std::array<double, terms>, K> b{};
    std::vector<std::uint32_t> near;
    cells::for_each_near<D>(grid_, place, place, radius_, [&](std::uint32_t k, std::uint64_t bits) {
      for (; bits != 0; bits &= bits - 1)
        near.push_back(grid_.members[k + static_cast<std::size_t>(std::countr_zero(bits))]);
    });
    for (const std::uint32_t j : near) {
      walls::vec<double, D> r;
      double left = 1.0;
      for (std::size_t a = 0; a < D; ++a) {
        r[a] = (s_.x[a][j] - place[a]) / radius_;
        left -= r[a] * r[a];
      }
      if (left <= 0.0) continue;
      const auto P = walls::polynomial<D>(r);
      for (std::size_t k = 0; k < terms; ++k) {
        const double weighted = left * left * P[k];
        for (std::size_t l = 0; l <= k; ++l) A[k][l] += weighted * P[l];
        for (std::size_t m = 0; m < K; ++m) b[m][k] += weighted * f[m][j];
      }
    }
    if (!operators::factorise(A)) return std::nullopt;
    std::array<double, K> values;
    for (std::size_t m = 0; m < K; ++m) values[m] = operators::solve(A, b[m])[0];
    return values;
  }

 private:
  static constexpr std::size_t terms = walls::terms(2, D);

  const particles::particles<D>& s_;
  double radius_;
  cells::grid<D> grid_;
};

// The gradient of temperature at a wall of fixed temperature, from the particles near a place of it: least squares of
//   T - T_w = y (a + b·t + t·c t) + y³ (d + e·t) + y⁵ f
// with y the distance from the wall and t the way along it from the place; a is the gradient. Only odd powers of y: the
// temperature less the wall's is odd about it as far as ∇²T = 0 there.
struct near_wall {
  double y;                 // m, from the wall
  std::array<double, 2> t;  // m, coordinates along it (2-D: the second is 0)
  double excess;            // K, T - T_w
  std::int64_t id;
};

// Sorts the samples; the result then depends on neither their order nor on ranks.
void sort(std::vector<near_wall>& samples);

// K/m, at `place` along the wall, from samples (sorted) within `radius` of it, weighted by (1 - r²/radius²)². dimension
// 2 or 3. Not-a-number where too few are near.
double wall_gradient(const std::vector<near_wall>& samples, const std::array<double, 2>& place, double radius,
                     int dimension);

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

// Axes along a wall: the first two that are not its own (2-D: the second is none).
inline std::array<std::size_t, 2> along_wall(std::size_t axis) {
  return {axis == 0 ? std::size_t{1} : std::size_t{0}, axis == 2 ? std::size_t{1} : std::size_t{2}};
}

// The mean of the inward gradient of temperature at a wall, and those at its ends along the first of along_wall, times
// `unit`.
template <int D>
std::array<double, 3> wall_gradients(const run::state<D>& scene, const walls::side<D>& wall,
                                     const std::array<std::int64_t, 3>& n, const std::array<double, 3>& lengths,
                                     double unit) {
  const auto& s = scene.w.s;
  const auto& ranks = scene.w.d.ranks;
  const auto [first, second] = along_wall(wall.axis);
  const double dx = scene.w.dx, radius = fit_radius * dx, length = lengths[first];
  std::vector<near_wall> near;
  for (std::size_t i = 0; i < s.total(); ++i) {
    const double y = wall.distance(s.x[wall.axis][i]);
    if (y <= 0.0 || y >= radius) continue;
    near.push_back({y, {s.x[first][i], D == 3 ? s.x[second % D][i] : 0.0}, s.T[i] - wall.temperature, s.id[i]});
  }
  sort(near);
  const auto cell = scene.w.d.cell();
  const auto here = [&](double x, double z) {
    std::array<double, D> place;
    place[first] = x;
    place[wall.axis] = wall.position + wall.inward * 1e-6 * dx;
    if (D == 3) place[second % D] = z;
    return scene.w.d.within(cell, place);
  };
  foundation::exact_sum sum;
  std::int64_t places = 0;
  const std::int64_t depth = D == 3 ? n[second] : 1;
  for (std::int64_t k = 0; k < n[first]; ++k)
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
  std::array<double, 6> nusselt;  // in the order of walls::side_names
  std::array<double, 4> corners;  // top left, top right, bottom right, bottom left
};

// Heat along each axis through its sides over that of conduction, and gradients at the corners of top and bottom, for
// unit = ℓ/ΔT, ℓ the way of conduction; where the flux of heat is given, which is conducted with `conductivity` (W/(m
// K)), those that it makes. A side that is not there has none.
template <int D>
wall_measures wall_heat(const run::state<D>& scene, const std::array<std::int64_t, 3>& n,
                        const std::array<double, 3>& lengths, double unit, double conductivity) {
  wall_measures m{};
  for (const auto& wall : scene.walls.sides) {
    const bool high = wall.inward < 0.0;
    const double given = -wall.flux / conductivity * unit;
    const auto [mean, left, right] = wall.thermal == walls::heat::fixed_temperature
                                         ? wall_gradients(scene, wall, n, lengths, unit)
                                         : std::array{given, given, given};
    const double sign = high ? 1.0 : -1.0;  // heat goes up: T falls from the bottom, rises from the top into the fluid
    m.nusselt[2 * wall.axis + (high ? 1 : 0)] = sign * mean;
    if (wall.axis != 1) continue;
    m.corners[high ? 0 : 3] = sign * left;
    m.corners[high ? 1 : 2] = sign * right;
  }
  return m;
}

}  // namespace tetsuame::convection
