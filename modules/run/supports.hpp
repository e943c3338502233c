// Neighbour lists of particles with supports of their own, and a box whose lists are such.
#pragma once

#include <foundation/error.hpp>
#include <foundation/exact_sum.hpp>
#include <run/lists.hpp>
#include <utility>

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

// The few particles whose supports are far larger than most: thrown out, they have no near neighbours. They are looked
// for by themselves, so that not all that is near one of them searches as far as it reaches.
template <int D>
class wide_supports {
 public:
  wide_supports(const particles::array& S, std::size_t n, const cells::grid<D>& all) : wide_(n, 0) {
    constexpr double far_larger = 2.0, few = 1.0 / 16.0;
    double sum = 0.0;
    for (std::size_t i = 0; i < n; ++i) sum += S[i];
    const double least = far_larger * sum / static_cast<double>(n);
    std::array<particles::array, D> x;
    std::vector<std::int64_t> id;
    for (std::uint32_t at = 0; at < all.members.size(); ++at) {
      const std::size_t i = all.members[at];
      if (!(S[i] > least)) continue;
      wide_[i] = 1;
      most_ = std::max(most_, S[i]);
      for (std::size_t a = 0; a < D; ++a) x[a].push_back(all.sorted[a][at]);
      id.push_back(at);
    }
    if (static_cast<double>(id.size()) > few * static_cast<double>(n)) {
      std::ranges::fill(wide_, 0);
      return;
    }
    places_ = std::move(id);
    if (!places_.empty()) cells_ = cells::make_grid<D>(x, places_, places_.size(), most_);
  }
  bool has(std::size_t i) const { return wide_[i] != 0; }
  // Places in the grid of all, in their order.
  void find(const std::array<double, D>& low, const std::array<double, D>& high, double skin,
            std::vector<std::uint32_t>& found) const {
    found.clear();
    if (places_.empty()) return;
    cells::for_each_near<D>(cells_, low, high, most_ + skin, [&](std::uint32_t k, std::uint64_t near) {
      for (; near != 0; near &= near - 1)
        found.push_back(static_cast<std::uint32_t>(
            places_[cells_.members[k + static_cast<std::uint32_t>(std::countr_zero(near))]]));
    });
    std::ranges::sort(found);
  }

 private:
  std::vector<char> wide_;
  std::vector<std::int64_t> places_;
  double most_ = 0.0;  // m
  cells::grid<D> cells_;
};

// The reach of a pair: the larger of the two supports, and the skin.
template <int D>
struct larger_support {
  const particles::particles<D>& s;
  const particles::array& S;
  double skin;  // m
  wide_supports<D> wide;
  largest_near<D> largest;  // but for wide ones

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
    for (std::size_t i = first; i < first + n; ++i) most = std::max({most, S[i], largest(cells::position<D>(s.x, i))});
    return {most + skin, cells::of_members(S.data() + first, n), S.data(), skin};
  }
  void find_wide(const std::array<double, D>& low, const std::array<double, D>& high,
                 std::vector<std::uint32_t>& found) const {
    wide.find(low, high, skin, found);
  }
};

// Of clusters whose particles have supports of their own, and some room for those of no cluster behind them.
template <int D>
void make_list(pairs::workspace<D>& w, const particles::array& S, double skin, const cells::grid<D>& grid) {
  auto& s = w.s;
  wide_supports<D> wide(S, s.total(), grid);
  particles::array others = S;
  double most = 0.0;
  for (std::size_t i = 0; i < s.total(); ++i) {
    if (wide.has(i)) others[i] = 0.0;
    most = std::max(most, others[i]);
  }
  cells::make_list<D>(w.list, grid, s.x, s.fluid,
                      larger_support<D>{s, S, skin, std::move(wide), largest_near<D>(s, others, most + skin)});
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
