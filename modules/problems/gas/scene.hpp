// A box of gas whose particles have supports of their own: start, walls that reflect.
#pragma once

#include <gas/setups.hpp>
#include <run/supports.hpp>

namespace tetsuame::gas {

// Walls where the box is not periodic: free slip, no heat.
template <int D>
std::vector<walls::side<D>> reflecting_walls(const domain::box<D>& box) {
  std::vector<walls::side<D>> all;
  for (std::size_t axis = 0; axis < D; ++axis)
    for (const bool high : {false, true}) {
      if (box.periodic[axis]) continue;
      walls::side<D> s;
      s.axis = axis;
      s.position = high ? box.length[axis] : 0.0;
      s.inward = high ? -1.0 : 1.0;
      s.no_slip = false;
      all.push_back(s);
    }
  return all;
}

// f(x, mass over density: m^D, spacing) for every particle of the blocks, in the order of their IDs.
template <int D, class F>
void for_each_start(const setup& t, F&& f) {
  for (const block& b : t.blocks) {
    std::array<double, 3> step{};
    double volume = 1.0;
    std::int64_t count = 1;
    for (std::size_t a = 0; a < D; ++a) {
      step[a] = (b.high[a] - b.low[a]) / static_cast<double>(b.n[a]);
      volume *= step[a];
      count *= b.n[a];
    }
    for (std::int64_t k = 0; k < count; ++k) {
      point x{};
      std::int64_t rest = k;
      for (std::size_t a = 0; a < D; ++a) {
        x[a] = b.low[a] + (static_cast<double>(rest % b.n[a]) + 0.5) * step[a];
        rest /= b.n[a];
      }
      if (!b.holds || b.holds(x)) f(x, volume);
    }
  }
}

}  // namespace tetsuame::gas
