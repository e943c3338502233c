// Neighbour lists of particles with supports of their own, and a box whose lists are such.
#pragma once

#include <foundation/error.hpp>
#include <foundation/exact_sum.hpp>
#include <run/lists.hpp>

namespace tetsuame::run {

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

// Row i lists the particles nearer than the larger of the two supports and the skin.
template <int D>
void make_list(pairs::workspace<D>& w, const particles::array& S, double skin, const cells::grid<D>& grid) {
  auto& s = w.s;
  double most = 0.0;
  for (std::size_t i = 0; i < s.total(); ++i) most = std::max(most, S[i]);
  const largest_near<D> largest(s, S, most + skin);
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

// rebuild() where every particle has a support, m, which may grow until `list_support` and a part of the skin: lists
// are made for the supports as they then are, or were.
template <int D>
void rebuild_with_supports(state<D>& box, bool as_they_were, const particles::array& support,
                           particles::array& list_support) {
  auto& w = box.w;
  auto& s = w.s;
  const auto lengths = [&] {
    if (!as_they_were) std::copy_n(support.begin(), s.fluid, list_support.begin());
    double most = 0.0;
    foundation::exact_sum all;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      most = std::max(most, list_support[i]);
      all.add(list_support[i]);
    }
    most = w.d.ranks.maximum(most) + box.skin;
    w.d.width = most * (1.0 + 1e-6);
    for (std::size_t a = 0; a < D; ++a)
      if (w.d.region.periodic[a] && w.d.width > w.d.region.length[a])
        foundation::fail_calculation("a particle's kernel has grown wider than the periodic box");
    const double mean = w.d.ranks.exact(all) / static_cast<double>(box.fluid_total);
    return list_lengths{cells::cell_edge(mean + box.skin), most};
  };
  rebuild_by(box, as_they_were, lengths, [&](const list_lengths&, const cells::grid<D>& grid) {
    w.exchange_fluid({list_support.data()});
    foundation::for_all(box.walls.source.size(),
                        [&](std::size_t r) { list_support[s.first_wall() + r] = list_support[box.walls.source[r]]; });
    make_list<D>(w, list_support, box.skin, grid);
  });
}

}  // namespace tetsuame::run
