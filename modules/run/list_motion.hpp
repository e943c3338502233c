// How particles are expected to move while neighbour lists live, so that lists hold who will be near: bodies that fly,
// turn and shear end no list. A particle goes on with the mean velocity ū of its neighbourhood, and within a distance
// of where that takes it that grows with its own velocity against ū, so that what falls onto a body may come to rest
// there.
//
//   x(t) = x_list + ū (t - t_list) + δ,  |δ| <= range = a + |v - ū| T,  t - t_list <= T
//
// A pair that a list made for a time T lacks was farther apart than its support and range_i + range_j + |ū_i - ū_j| T.
#pragma once

#include <cells/grid.hpp>
#include <map>
#include <run/lists.hpp>

namespace tetsuame::run {

// Fields of the particles that follow it, in space without periods; the time is state::list_lifetime.
template <int D>
struct list_motion {
  particles::vector_field<D> velocity;  // m/s, ū
  particles::array& range;              // m
};

namespace detail {

// The velocities in a cell, in units of which they are whole numbers: sums are the same on any number of ranks.
template <int D>
struct velocity_sum {
  double particles = 0.0;
  std::array<double, D> v{};

  void operator+=(const velocity_sum& other) {
    particles += other.particles;
    for (std::size_t a = 0; a < D; ++a) v[a] += other.v[a];
  }
};
template <int D>
using velocity_sums = std::map<cells::index<D>, velocity_sum<D>>;

// Each rank's cells are rows of numbers, as many as the rank with the most cells has.
template <int D>
void add_other_ranks(const domain::communicator& ranks, velocity_sums<D>& sums) {
  constexpr std::size_t row = 2 * D + 1;
  const auto rows = static_cast<std::size_t>(ranks.maximum(static_cast<double>(sums.size())));
  std::vector<double> mine;
  mine.reserve(rows * row);
  for (const auto& [cell, own] : sums) {
    for (const std::int64_t c : cell) mine.push_back(static_cast<double>(c));
    mine.push_back(own.particles);
    mine.insert(mine.end(), own.v.begin(), own.v.end());
  }
  mine.resize(rows * row, 0.0);
  const auto all = ranks.every(std::span<const double>(mine));
  sums.clear();
  for (auto at = all.begin(); at != all.end(); at += row) {
    velocity_sum<D> one{at[D], {}};
    if (one.particles == 0.0) continue;
    cells::index<D> cell;
    for (std::ptrdiff_t a = 0; a < D; ++a) {
      cell[static_cast<std::size_t>(a)] = static_cast<std::int64_t>(at[a]);
      one.v[static_cast<std::size_t>(a)] = at[D + 1 + a];
    }
    sums[cell] += one;
  }
}

// Of the cell and those beside it.
template <int D>
velocity_sum<D> sum_about(const velocity_sums<D>& sums, const cells::index<D>& cell) {
  velocity_sum<D> all;
  const auto along = [&](const auto& self, std::size_t a, cells::index<D> c) -> void {
    if (a == D) {
      if (const auto at = sums.find(c); at != sums.end()) all += at->second;
      return;
    }
    for (c[a] = cell[a] - 1; c[a] <= cell[a] + 1; ++c[a]) self(self, a + 1, c);
  };
  along(along, 0, cell);
  return all;
}

}  // namespace detail

// Collective. The mean over the particles of a cell of a coarse grid, with edges of so many m, and of the cells beside
// it.
template <int D>
void set_mean_velocities(const state<D>& box, double edge, const particles::vector_field<D>& mean) {
  const auto& s = box.w.s;
  const double unit = box.w.d.ranks.maximum(largest_speed(box)) * 0x1p-20;
  const auto grid = cells::make_grid<D>(s.x, s.id, s.fluid, edge);
  const auto for_each_cell = [&](auto&& f) {
    for (std::size_t c = 0; c < grid.cells(); ++c)
      if (grid.start[c] < grid.start[c + 1])
        f(grid.cell_of_members(c), std::span(grid.members).subspan(grid.start[c], grid.start[c + 1] - grid.start[c]));
  };
  detail::velocity_sums<D> sums;
  for_each_cell([&](const auto& cell, const auto& members) {
    auto& all = sums[cell];
    all.particles = static_cast<double>(members.size());
    for (const std::uint32_t i : members)
      for (std::size_t a = 0; a < D; ++a) all.v[a] += unit > 0.0 ? std::round(s.v[a][i] / unit) : 0.0;
  });
  if (box.w.d.ranks.size > 1) detail::add_other_ranks<D>(box.w.d.ranks, sums);
  for_each_cell([&](const auto& cell, const auto& members) {
    const auto about = detail::sum_about<D>(sums, cell);
    for (const std::uint32_t i : members)
      for (std::size_t a = 0; a < D; ++a) mean[a][i] = about.v[a] / about.particles * unit;
  });
}

// m/s, the velocity of particle i against its neighbourhood.
template <int D>
double own_speed(const state<D>& box, const particles::vector_field<D>& mean, std::size_t i) {
  double square = 0.0;
  for (std::size_t a = 0; a < D; ++a) square += (box.w.s.v[a][i] - mean[a][i]) * (box.w.s.v[a][i] - mean[a][i]);
  return std::sqrt(square);
}

// Collective. s, how long lists live whose particles move so: some steps, but no longer than until particles have moved
// against each other by a part of a mean support (m), most of them by a smaller part; at least two.
template <int D>
double lifetime_of_lists(const state<D>& box, const particles::vector_field<D>& mean, double mean_support) {
  constexpr double most_steps = 16.0, least_steps = 2.0, of_support = 0.5, of_usual = 0.05;
  const auto& s = box.w.s;
  foundation::exact_sum all;
  std::array<double, 1 + 2 * D>
      most;  // m/s: own speed; the largest component of a mean velocity, and -1 times the least
  most.fill(-std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const double own = own_speed<D>(box, mean, i);
    all.add(own);
    most[0] = std::max(most[0], own);
    for (std::size_t a = 0; a < D; ++a) {
      most[1 + a] = std::max(most[1 + a], mean[a][i]);
      most[1 + D + a] = std::max(most[1 + D + a], -mean[a][i]);
    }
  }
  const double usual = box.w.d.ranks.exact(all) / static_cast<double>(box.fluid_total);
  box.w.d.ranks.maximum(most);
  double between = 0.0;
  for (std::size_t a = 0; a < D; ++a) between = std::hypot(between, most[1 + a] + most[1 + D + a]);
  double lives = most_steps * box.next_dt;
  const auto at_most = [&](double length, double speed) {
    if (speed > 0.0) lives = std::min(lives, length / speed);
  };
  at_most(of_support * mean_support, std::max(most[0], between));
  at_most(of_usual * mean_support, usual);
  lives = std::max(lives, least_steps * box.next_dt);
  return std::isfinite(lives) ? lives : 0.0;  // all are at rest, and no step is known
}

// Collective, before lists of the present places are made. Where no step is known yet, lists have no time: ū = 0.
template <int D>
void expect_motion(state<D>& box, const list_motion<D>& by, double mean_support, double allowance) {
  auto& s = box.w.s;
  box.list_lifetime = 0.0;
  if (box.next_dt > 0.0) {
    set_mean_velocities<D>(box, mean_support, by.velocity);
    box.list_lifetime = lifetime_of_lists<D>(box, by.velocity, mean_support);
  }
  if (box.list_lifetime == 0.0)
    for (std::size_t a = 0; a < D; ++a) std::fill_n(by.velocity[a].begin(), s.fluid, 0.0);
  foundation::for_all(s.fluid, [&](std::size_t i) {
    by.range[i] = allowance + (box.list_lifetime > 0.0 ? own_speed<D>(box, by.velocity, i) * box.list_lifetime : 0.0);
  });
}

// On this rank, in units of which `allowance` (m) is the whole range: how much of their ranges particles have used
// since the lists were made, or of these lists' time; and how fast they use them, 1/s.
template <int D>
apart ranges_used(const state<D>& box, const list_motion<D>& by, double allowance) {
  const auto& s = box.w.s;
  const double gone = box.state_time - box.list_time;
  apart all = apart_of<D>(s.fluid, {}, [&](std::size_t a, std::size_t i) {
    return (s.x[a][i] - s.x_list[a][i] - by.velocity[a][i] * gone) * (allowance / by.range[i]);
  });
  all.numbers[apart::at_least] = allowance * (gone / box.list_lifetime);
  return all;
}
template <int D>
apart speeds_of_use(const state<D>& box, const list_motion<D>& by, double allowance) {
  const auto& s = box.w.s;
  apart all = apart_of<D>(s.fluid, {}, [&](std::size_t a, std::size_t i) {
    return (s.v[a][i] - by.velocity[a][i]) * (allowance / by.range[i]);
  });
  all.numbers[apart::at_least] = allowance / box.list_lifetime;
  return all;
}

}  // namespace tetsuame::run
