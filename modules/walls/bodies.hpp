// Wall particles of bodies of any shape, in a box whose plane sides are mirrors; each has a marker in the fluid, from
// whose neighbourhood it has its values (docs/theory/water_and_bodies.md).
//
// A wall particle belongs to the rank whose cell holds its marker. Ranks whose fluid it may touch have it as a ghost,
// and every rank makes the images, in the sides, of those that it has.
#pragma once

#include <bit>
#include <cells/grid.hpp>
#include <cmath>
#include <map>
#include <walls/wall_set.hpp>

namespace tetsuame::walls {

// When cuts have moved: gives places to the ranks in whose cells their markers are, there by number. Collective.
template <int D>
void hand_over(domain::decomposition<D>& d, std::vector<body_place<D>>& places) {
  constexpr std::size_t row = sizeof(body_place<D>) / sizeof(double);
  const auto cell = d.cell();
  std::map<int, std::vector<double>> leave;
  std::vector<body_place<D>> here;
  for (const auto& p : places) {
    if (d.within(cell, p.marker)) {
      here.push_back(p);
      continue;
    }
    const auto values = std::bit_cast<std::array<double, row>>(p);
    auto& to = leave[d.owner(p.marker)];
    to.insert(to.end(), values.begin(), values.end());
  }
  std::vector<domain::message> out;
  for (auto& [rank, values] : leave) out.push_back({rank, std::move(values)});
  for (const auto& l : domain::sparse_exchange(d.ranks, out, domain::detail::next_tag(d)))
    for (std::size_t k = 0; k < l.values.size(); k += row) {
      std::array<double, row> values;
      std::copy_n(l.values.begin() + static_cast<std::ptrdiff_t>(k), row, values.begin());
      here.push_back(std::bit_cast<body_place<D>>(values));
    }
  std::ranges::sort(here, {}, &body_place<D>::number);
  places = std::move(here);
}

// Particles of this rank's cell into the empty block of walls, each with its body for a material. Images of the fluid
// take IDs below those of bodies.
template <int D>
void place_bodies(pairs::workspace<D>& w, wall_set<D>& set, std::int64_t fluid_total) {
  auto& s = w.s;
  const auto& bodies = set.bodies;
  const std::int64_t first_id = fluid_total << set.sides.size();
  particles::allocate(s, s.fluid, s.fluid_ghosts, bodies.places.size(), 0);
  for (std::size_t r = 0; r < bodies.places.size(); ++r) {
    const std::size_t i = s.first_wall() + r;
    const auto& of = bodies.places[r];
    s.id[i] = first_id + of.number;
    s.material[i] = of.body;
    for (std::size_t a = 0; a < D; ++a) s.x[a][i] = of.x[a];
  }
}

// m, of a place and a particle.
template <int D>
double distance_between(const pairs::workspace<D>& w, const std::array<double, D>& x, std::size_t j) {
  double r2 = 0.0;
  for (std::size_t a = 0; a < D; ++a) r2 += (x[a] - w.s.x[a][j]) * (x[a] - w.s.x[a][j]);
  return std::sqrt(r2);
}

// Lists of the fluid, and of its images, near the markers of this rank, until it has moved so far (m); and how much of
// each marker's neighbourhood the fluid may fill: what the bodies leave.
template <int D>
void list_bodies(const pairs::workspace<D>& w, wall_set<D>& set, const cells::grid<D>& grid, double moved) {
  const auto& s = w.s;
  auto& bodies = set.bodies;
  const std::size_t first = s.first_wall(), behind = first + set.body_particles;
  const double support = w.support(), volume = std::pow(w.dx, D);
  const auto marker = [&](std::size_t r) { return bodies.places[r].marker; };
  const auto is_fluid = [&](std::uint32_t j) { return j < first || (j >= behind && set.source[j - behind] < first); };
  cells::make_list_of_points<D>(bodies.near, grid, bodies.places.size(), support + moved,
                                static_cast<std::uint32_t>(s.null()), 1, marker, is_fluid);
  bodies.room.assign(bodies.places.size(), 1.0);
  foundation::for_all(bodies.places.size(), [&](std::size_t r) {
    const auto x = marker(r);
    cells::for_each_near<D>(grid, x, x, support, [&](std::uint32_t k, std::uint64_t near) {
      for (; near != 0; near &= near - 1) {
        const auto j = grid.members[k + static_cast<std::uint32_t>(std::countr_zero(near))];
        if (is_fluid(j)) continue;
        if (const double away = distance_between<D>(w, x, j); away < support)
          bodies.room[r] -= volume * std::visit([&](const auto& of) { return of.value(away); }, w.kernel);
      }
    });
  });
}

// How much of a wall particle there is, by the part of its marker's neighbourhood that is filled, of what the bodies
// leave: all of it from two thirds on, nothing up to one third. At a plane surface, where half is filled, these are
// about half a spacing below and above it: the first row of markers in the fluid, and the first outside. Spray fills
// less; so at least the sum of hats about particles, 1 - r/Δx, whose integral is that of their own volume: pi/3 Δx^D,
// in two and three dimensions.
inline double wetness(double filled, double hats) { return std::clamp(std::max(3.0 * filled - 1.0, hats), 0.0, 1.0); }

// Of N values of the fluid about a marker, weighted by kernel and volume: means, and for the first `Linear` of them,
// which vanish at the surface or do not change across it, straight lines in the distance from the surface.
template <std::size_t N, std::size_t Linear>
struct marker_sums {
  double filled = 0.0, distance = 0.0, distance2 = 0.0;
  std::array<double, N> first{};
  std::array<double, Linear> slope{}, least{}, most{};

  // distance: in spacings.
  void add(double share, double d, const std::array<double, N>& value) {
    filled += share;
    distance += share * d;
    distance2 += share * d * d;
    for (std::size_t n = 0; n < N; ++n) first[n] += share * value[n];
    for (std::size_t n = 0; n < Linear; ++n) {
      slope[n] += share * d * value[n];
      least[n] = std::min(least[n], value[n]);
      most[n] = std::max(most[n], value[n]);
    }
  }
  // At this distance: between the smallest and the largest of the values and 0. All are 0 without fluid.
  std::array<double, N> at(double d) const {
    if (!(filled > 0.0)) return {};
    constexpr double slight = 0.01;  // spacings squared: fluid no deeper than a tenth has no slope
    std::array<double, N> values;
    for (std::size_t n = 0; n < N; ++n) values[n] = first[n] / filled;
    const double mean = distance / filled, variance = distance2 / filled - mean * mean;
    for (std::size_t n = 0; n < Linear; ++n) {
      const double rise = (slope[n] / filled - mean * values[n]) / (std::max(variance, 0.0) + slight);
      values[n] = std::clamp(values[n] + rise * (d - mean), least[n], most[n]);
    }
    return values;
  }
};

// Of the fluid at each marker: put(i, its place, wetness, values) for the wall particle i, of what value(j, i) says of
// the fluid j, N numbers.
template <std::size_t N, std::size_t Linear, int D, class Value, class Put>
void at_bodies(const pairs::workspace<D>& w, const wall_set<D>& set, const Value& value, const Put& put) {
  constexpr double least_room = 0.1;  // in a corner that bodies all but close
  const auto& s = w.s;
  const auto& bodies = set.bodies;
  const double support = w.support();
  const auto kernel = [&](double r) { return std::visit([&](const auto& k) { return k.value(r); }, w.kernel); };
  foundation::for_all(bodies.places.size(), [&](std::size_t r) {
    const std::size_t i = s.first_wall() + r;
    const auto& of = bodies.places[r];
    double hats = 0.0;
    marker_sums<N, Linear> sums;
    for (const std::uint32_t j : bodies.near.row(r)) {
      const double away = distance_between<D>(w, of.marker, j);
      if (!(away < support)) continue;
      double above = of.height;
      for (std::size_t a = 0; a < D; ++a) above += (s.x[a][j] - of.marker[a]) * of.normal[a];
      hats += std::max(0.0, 1.0 - away / w.dx);
      sums.add(kernel(away) * s.dV[j], above / w.dx, value(j, i));
    }
    const double wet = wetness(sums.filled / std::max(bodies.room[r], least_room), hats);
    put(i, of, wet, sums.at(of.height / w.dx));
  });
}

// m/s, of a wall particle whose marker has this velocity: odd across the surface, and at one of no slip altogether.
template <int D>
std::array<double, D> reflected_velocity(const body_place<D>& of, std::array<double, D> v, bool sticks) {
  if (sticks) {
    for (double& component : v) component *= -of.reflection_ratio;
    return v;
  }
  double across = 0.0;
  for (std::size_t a = 0; a < D; ++a) across += v[a] * of.normal[a];
  for (std::size_t a = 0; a < D; ++a) v[a] -= (1.0 + of.reflection_ratio) * across * of.normal[a];
  return v;
}

}  // namespace tetsuame::walls
