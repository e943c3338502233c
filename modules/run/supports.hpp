// Lists of particles whose supports are their own and grow.
#pragma once

#include <foundation/error.hpp>
#include <foundation/exact_sum.hpp>
#include <run/reach.hpp>

namespace tetsuame::run {

// Supports of the particles, and how large lists let them become.
struct growing_supports {
  double over_dx;                                            // a support in spacings
  const particles::array& now;                               // m
  particles::array& allowed;                                 // m, while the lists live
  double room;                                               // m, that each may grow
  double largest = std::numeric_limits<double>::infinity();  // m, of any
  const particles::array* growth = nullptr;                  // m, of each in the last step; none: not known

  // Whether one of so many particles has grown as far as lists let it, or may do so in a step in which it grows twice
  // as much as in the last one.
  bool have_no_room(std::size_t n) const {
    return foundation::largest_of(n, 0.0, [&](std::size_t i) {
             const double grows = growth != nullptr ? std::max(0.0, 2.0 * (*growth)[i]) : 0.0;
             return allowed[i] < largest && now[i] + grows >= allowed[i] * (1.0 - 1e-9) ? 1.0 : 0.0;
           }) > 0.0;
  }
};

namespace detail {

// m, the mean over all ranks.
template <int D>
double mean_support(const state<D>& box, const particles::array& support) {
  foundation::exact_sum all;
  for (std::size_t i = 0; i < box.w.s.fluid; ++i) all.add(support[i]);
  return box.w.d.ranks.exact(all) / static_cast<double>(box.fluid_total);
}

// A kernel that is wider than a period would meet itself. widest: m, of a pair.
template <int D>
void expect_within_periods(const state<D>& box, double widest) {
  for (std::size_t a = 0; a < D; ++a)
    if (box.w.d.region.periodic[a] && widest * (1.0 + 1e-6) > box.w.d.region.length[a])
      foundation::fail_calculation("a particle's kernel has grown wider than the periodic box");
}

// Each may grow by the same room, or as much as it would in the time of the lists by its growth in the last step, as
// supports of what is thrown out do.
template <int D>
void allow_growth(const state<D>& box, const growing_supports& supports) {
  constexpr double faster = 1.5;
  const double steps = box.list_lifetime > 0.0 ? faster * box.list_lifetime / box.next_dt : 0.0;
  foundation::for_all(box.w.s.fluid, [&](std::size_t i) {
    const double S = supports.now[i];
    const double grows = supports.growth != nullptr ? std::min(steps * (*supports.growth)[i], S) : 0.0;
    supports.allowed[i] = std::max(S, std::min(S + std::max(supports.room, grows), supports.largest));
  });
}

}  // namespace detail

// rebuild() where every particle has a support: lists are made for the supports as they then are, or were. With a
// motion, for the particles as they are expected to go on; they may leave it by `allowance`, m.
template <int D>
void rebuild_with_supports(state<D>& box, bool as_they_were, const growing_supports& supports,
                           const list_motion<D>* motion = nullptr, double allowance = 0.0) {
  auto& w = box.w;
  auto& s = w.s;
  const double skin = box.skin - supports.room;
  const auto reach = [&] {
    return reach_of_pairs<D>{supports.allowed, motion != nullptr ? skin - 2.0 * allowance : skin, motion,
                             box.list_lifetime};
  };
  const auto widest = [&](const particles::array& support) {
    return w.d.ranks.maximum(foundation::largest_of(s.fluid, 0.0, [&](std::size_t i) { return support[i]; }));
  };
  const auto lengths = [&] {
    if (!as_they_were) {
      detail::expect_within_periods(box, widest(supports.now) + box.skin);
      if (motion != nullptr) expect_motion<D>(box, *motion, detail::mean_support(box, supports.now), allowance);
      detail::allow_growth(box, supports);
    }
    double most = widest(supports.allowed) + skin;
    if (motion != nullptr) {
      largest_reach<D> largest;
      for (std::size_t i = 0; i < s.fluid; ++i) largest.include(reach(), i);
      largest.include_ranks(w.d.ranks);
      most = largest.with(largest, reach());
    }
    w.d.width = most * (1.0 + 1e-6);
    const double mean = detail::mean_support(box, supports.allowed) - supports.room;
    return list_lengths{cells::cell_edge(mean / supports.over_dx), most};
  };
  rebuild_by(box, as_they_were, lengths, [&](const list_lengths&, const cells::grid<D>& grid) {
    auto fields = walls::even({&supports.allowed});
    if (motion != nullptr) {
      fields.push_back({&motion->range});
      for (const auto& component : walls::vector(motion->velocity)) fields.push_back(component);
    }
    walls::update_ghosts_and_images(w, box.walls, fields);
    make_list<D>(w, reach(), grid);
  });
}

}  // namespace tetsuame::run
