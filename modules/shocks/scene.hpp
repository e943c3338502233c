// A box of gas whose particles have supports of their own: start, neighbour lists, walls that reflect.
#pragma once

#include <images/scene.hpp>
#include <shocks/setups.hpp>

namespace tetsuame::shocks {

// Walls where the box is not periodic: free slip, no heat.
template <int D>
std::vector<images::side<D>> reflecting_walls(const domain::box<D>& box) {
  std::vector<images::side<D>> all;
  for (std::size_t axis = 0; axis < D; ++axis)
    for (const bool high : {false, true}) {
      if (box.periodic[axis]) continue;
      images::side<D> s;
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

// The largest support of each cell of a coarse grid and its neighbours: how far from a particle one may lie whose
// support reaches it.
template <int D>
class largest_near {
 public:
  largest_near(const particles::particles<D>& s, const particles::array& S, double reach)
      : cells_(cells::make_grid<D>(s.x, s.id, s.total(), reach)) {
    const std::size_t n = cells_.start.size() - 1;
    std::vector<double> own(n, 0.0);
    for (std::size_t c = 0; c < n; ++c)
      for (std::uint32_t k = cells_.start[c]; k < cells_.start[c + 1]; ++k)
        own[c] = std::max(own[c], S[cells_.members[k]]);
    largest_ = own;
    // Axis after axis: cells are ordered with the last axis fastest.
    std::size_t stride = 1;
    for (std::size_t a = D; a-- > 0;) {
      const auto extent = static_cast<std::size_t>(cells_.extent[a]);
      own = largest_;
      for (std::size_t c = 0; c < n; ++c) {
        const std::size_t at = c / stride % extent;
        if (at > 0) largest_[c] = std::max(largest_[c], own[c - stride]);
        if (at + 1 < extent) largest_[c] = std::max(largest_[c], own[c + stride]);
      }
      stride *= extent;
    }
  }
  double operator()(const std::array<double, D>& x) const { return largest_[cells_.linear(cells_.cell(x))]; }

 private:
  cells::grid<D> cells_;
  std::vector<double> largest_;
};

// Row i lists the particles nearer than the larger of the two supports and the skin. `edge`: m, the same on all ranks.
template <int D>
void make_list(pairs::workspace<D>& w, const particles::array& S, double skin, double edge) {
  auto& s = w.s;
  double most = 0.0;
  for (std::size_t i = 0; i < s.total(); ++i) most = std::max(most, S[i]);
  const largest_near<D> largest(s, S, most + skin);
  const auto grid = cells::make_grid<D>(s.x, s.id, s.total(), edge);
  cells::make_list<D>(
      w.list, grid, s.fluid, [&](std::size_t i) { return largest(cells::position<D>(s.x, i)) + skin; }, s.null(),
      [&](std::size_t i) { return cells::position<D>(s.x, i); },
      [&](std::size_t i, std::uint32_t j) {
        double r2 = 0.0;
        for (std::size_t a = 0; a < D; ++a) r2 += (s.x[a][i] - s.x[a][j]) * (s.x[a][i] - s.x[a][j]);
        const double reach = std::max(S[i], S[j]) + skin;
        return i != j && r2 < reach * reach;
      });
}

}  // namespace tetsuame::shocks
