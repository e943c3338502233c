// What a run computes on: particles with their lists and kernel, and the walls of their box.
#pragma once

#include <output/snapshot.hpp>
#include <pairs/workspace.hpp>
#include <walls/treatments.hpp>

namespace tetsuame::run {

template <int D>
struct state {
  pairs::workspace<D> w;
  walls::any treatment = walls::mirror{};
  walls::wall_set<D> walls;
  double skin = 0.0;  // m
  std::int64_t fluid_total = 0;

  bool mirrors() const { return std::holds_alternative<walls::mirror>(treatment); }
};

// m, the largest displacement on this rank since the lists were made.
template <int D>
double moved_since_lists(const state<D>& box) {
  return std::sqrt(particles::moved_since_lists(box.w.s));
}

// m/s, the largest on this rank.
template <int D>
double largest_speed(const state<D>& box) {
  const auto& s = box.w.s;
  double speed2 = 0.0;
#pragma omp parallel for schedule(static) reduction(max : speed2) if (s.fluid > foundation::values_worth_threads)
  for (std::size_t i = 0; i < s.fluid; ++i) {
    double v2 = 0.0;
    for (std::size_t a = 0; a < D; ++a) v2 += s.v[a][i] * s.v[a][i];
    speed2 = std::max(speed2, v2);
  }
  return std::sqrt(speed2);
}

template <int D>
output::snapshot_header snapshot_header(const state<D>& box) {
  output::snapshot_header header;
  header.dimension = D;
  for (std::size_t a = 0; a < D; ++a) {
    header.box_lengths[a] = box.w.d.region.length[a];
    header.periodic[a] = box.w.d.region.periodic[a];
  }
  return header;
}

}  // namespace tetsuame::run
