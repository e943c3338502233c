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
    const std::size_t n = cells_.cells();
    std::vector<double> own(n, 0.0);
    for (std::size_t c = 0; c < n; ++c)
      for (std::uint32_t k = cells_.start[c]; k < cells_.start[c + 1]; ++k)
        own[c] = std::max(own[c], S[cells_.members[k]]);
    largest_ = own;
    for (std::size_t c = 0; c < n; ++c)
      if (own[c] > 0.0) spread_to_neighbours(cells_.cell_of_members(c), own[c]);
  }
  double operator()(const std::array<double, D>& x) const { return largest_[cells_.stored(cells_.cell(x))]; }

 private:
  void spread_to_neighbours(cells::index<D> centre, double support) {
    const auto along = [&](const auto& self, std::size_t a, cells::index<D> c) -> void {
      if (a == D) {
        if (const std::size_t at = cells_.stored(c); at != cells::no_cell)
          largest_[at] = std::max(largest_[at], support);
        return;
      }
      for (c[a] = centre[a] - 1; c[a] <= centre[a] + 1; ++c[a]) self(self, a + 1, c);
    };
    along(along, 0, centre);
  }

  cells::grid<D> cells_;
  std::vector<double> largest_;
};

// The reach of a pair: the larger of the two supports, and the skin.
template <int D>
struct larger_support {
  const particles::particles<D>& s;
  const particles::array& S;
  double skin;  // m
  largest_near<D> largest;

  struct of_cluster {
    double most;         // m
    foundation::real S;  // m, of the members
    const double* S_j;
    double skin;

    foundation::real squared(std::uint32_t j) const {
      const foundation::real reach = foundation::greater(S, foundation::real(S_j[j])) + skin;
      return reach * reach;
    }
  };
  of_cluster of(std::size_t first, std::size_t n) const {
    double most = 0.0;
    for (std::size_t i = first; i < first + n; ++i) most = std::max(most, largest(cells::position<D>(s.x, i)));
    return {most + skin, cells::of_members(S.data() + first, n), S.data(), skin};
  }
};

// Of clusters whose particles have supports of their own, and some room for those of no cluster behind them.
template <int D>
void make_list(pairs::workspace<D>& w, const particles::array& S, double skin, const cells::grid<D>& grid) {
  auto& s = w.s;
  double most = 0.0;
  for (std::size_t i = 0; i < s.total(); ++i) most = std::max(most, S[i]);
  cells::make_list<D>(w.list, grid, s.x, s.fluid, larger_support<D>{s, S, skin, largest_near<D>(s, S, most + skin)});
}

// rebuild() where every particle has a support, m, so many spacings about it, which may grow until `list_support` and a
// part of the skin: lists are made for the supports as they then are, or were.
template <int D>
void rebuild_with_supports(state<D>& box, bool as_they_were, double support_over_dx, const particles::array& support,
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
    return list_lengths{cells::cell_edge(mean / support_over_dx), most};
  };
  rebuild_by(box, as_they_were, lengths, [&](const list_lengths&, const cells::grid<D>& grid) {
    walls::update_ghosts_and_images(w, box.walls, walls::even({&list_support}));
    make_list<D>(w, list_support, box.skin, grid);
  });
}

}  // namespace tetsuame::run
