// Neighbour lists of particles with reaches of their own: supports that differ, motions that are expected.
#pragma once

#include <bit>
#include <run/list_motion.hpp>
#include <utility>

namespace tetsuame::run {

// The reach of a pair while lists live, m: the larger of the two supports, the ranges of both, how far their mean
// velocities part them, and what supports may grow. Without ranges these are a part of `rest`.
template <int D>
struct reach_of_pairs {
  const particles::array& S;
  double rest = 0.0;                       // m
  const list_motion<D>* motion = nullptr;  // none: all go on alike
  double lifetime = 0.0;                   // s; 0: mean velocities are those of none

  double range(std::size_t i) const { return motion != nullptr ? motion->range[i] : 0.0; }
  double velocity(std::size_t a, std::size_t i) const { return motion != nullptr ? motion->velocity[a][i] : 0.0; }
  // m, of the components of a velocity the largest and the sum: half of both together is no less than the vector's
  // length, and at most 1.16 times that.
  template <class Number>
  Number parted(const Number& largest, const Number& sum) const {
    return (largest + sum) * (0.5 * lifetime);
  }
};

// Of some particles: what no pair of them reaches beyond.
template <int D>
struct largest_reach {
  double S = 0.0, range = 0.0;  // m
  // m/s, the largest component of a mean velocity, and -1 times the least
  std::array<double, D> up = none(), down = none();

  static std::array<double, D> none() {
    std::array<double, D> all;
    all.fill(-std::numeric_limits<double>::infinity());
    return all;
  }
  void include(const reach_of_pairs<D>& reach, std::size_t i) {
    S = std::max(S, reach.S[i]);
    range = std::max(range, reach.range(i));
    for (std::size_t a = 0; a < D; ++a) {
      up[a] = std::max(up[a], reach.velocity(a, i));
      down[a] = std::max(down[a], -reach.velocity(a, i));
    }
  }
  // m, of a pair of one of these and one of those.
  double with(const largest_reach& other, const reach_of_pairs<D>& reach) const {
    double largest = 0.0, sum = 0.0;
    for (std::size_t a = 0; a < D; ++a) {
      const double component = std::max({0.0, up[a] + other.down[a], other.up[a] + down[a]});  // of none: less
      largest = std::max(largest, component);
      sum += component;
    }
    return std::max(S, other.S) + range + other.range + reach.parted(largest, sum) + reach.rest;
  }
  // Collective.
  void include_ranks(const domain::communicator& ranks) {
    std::array<double, 2 + 2 * D> all{S, range};
    std::copy_n(up.begin(), D, all.begin() + 2);
    std::copy_n(down.begin(), D, all.begin() + 2 + D);
    ranks.maximum(all);
    S = all[0];
    range = all[1];
    std::copy_n(all.begin() + 2, D, up.begin());
    std::copy_n(all.begin() + 2 + D, D, down.begin());
  }
};

// Members of a grid that follow each other, some of which are left out: the box around them and their largest reach.
template <int D>
struct block_of_members {
  static constexpr std::size_t size = 8;
  std::array<double, D> low, high;
  largest_reach<D> largest;

  double gap2(const std::array<double, D>& from, const std::array<double, D>& to) const {
    double all = 0.0;
    for (std::size_t a = 0; a < D; ++a) {
      const double gap = std::max({low[a] - to[a], from[a] - high[a], 0.0});
      all += gap * gap;
    }
    return all;
  }
};
template <int D, class Taken>
std::vector<block_of_members<D>> blocks_of(const cells::grid<D>& g, const reach_of_pairs<D>& reach,
                                           const Taken& taken) {
  using block = block_of_members<D>;
  std::vector<block> all((g.members.size() + block::size - 1) / block::size);
  foundation::for_all(all.size(), [&](std::size_t n) {
    block& b = all[n];
    b.low.fill(std::numeric_limits<double>::infinity());
    b.high.fill(-std::numeric_limits<double>::infinity());
    for (std::size_t k = n * block::size; k < std::min(g.members.size(), (n + 1) * block::size); ++k) {
      if (!taken(g.members[k])) continue;
      b.largest.include(reach, g.members[k]);
      for (std::size_t a = 0; a < D; ++a) {
        b.low[a] = std::min(b.low[a], g.sorted[a][k]);
        b.high[a] = std::max(b.high[a], g.sorted[a][k]);
      }
    }
  });
  return all;
}

// The few particles that reach far further than most: thrown out, they have no near neighbours, or move against all
// others. They are looked for by themselves, so that not all that is near one of them searches as far as it reaches.
template <int D>
class far_reaching {
 public:
  far_reaching(const reach_of_pairs<D>& reach, std::size_t n, const cells::grid<D>& all) : far_(n, 0) {
    constexpr double far_larger = 1.5, few = 1.0 / 16.0;
    std::array<double, D> mean{};
    for (std::size_t a = 0; a < D && reach.lifetime > 0.0; ++a) {
      for (std::size_t i = 0; i < n; ++i) mean[a] += reach.velocity(a, i);
      mean[a] /= static_cast<double>(n);
    }
    const auto own = [&](std::size_t i) {
      double v2 = 0.0;
      for (std::size_t a = 0; a < D && reach.lifetime > 0.0; ++a) v2 += std::pow(reach.velocity(a, i) - mean[a], 2);
      return reach.S[i] + reach.range(i) + std::sqrt(v2) * reach.lifetime;
    };
    double sum = 0.0;
    for (std::size_t i = 0; i < n; ++i) sum += own(i);
    const double least = far_larger * sum / static_cast<double>(n);
    std::array<particles::array, D> x;
    std::vector<std::int64_t> id;
    largest_reach<D> largest;
    for (std::uint32_t at = 0; at < all.members.size(); ++at) {
      const std::size_t i = all.members[at];
      largest.include(reach, i);
      if (!(own(i) > least)) continue;
      far_[i] = 1;
      for (std::size_t a = 0; a < D; ++a) x[a].push_back(all.sorted[a][at]);
      id.push_back(at);
    }
    if (static_cast<double>(id.size()) > few * static_cast<double>(n)) {
      std::ranges::fill(far_, 0);
      return;
    }
    places_ = std::move(id);
    most_ = largest.with(largest, reach);
    if (!places_.empty()) cells_ = cells::make_grid<D>(x, places_, places_.size(), most_);
  }
  bool has(std::size_t i) const { return far_[i] != 0; }
  double most() const { return most_; }  // m, of a pair with one of them
  // Places in the grid of all, in their order.
  void find(const std::array<double, D>& low, const std::array<double, D>& high,
            std::vector<std::uint32_t>& found) const {
    found.clear();
    if (places_.empty()) return;
    cells::for_each_near<D>(cells_, low, high, most_, [&](std::uint32_t k, std::uint64_t near) {
      for (; near != 0; near &= near - 1)
        found.push_back(static_cast<std::uint32_t>(
            places_[cells_.members[k + static_cast<std::uint32_t>(std::countr_zero(near))]]));
    });
    std::ranges::sort(found);
  }

 private:
  std::vector<char> far_;
  std::vector<std::int64_t> places_;
  double most_ = 0.0;
  cells::grid<D> cells_;
};

// What cells::make_list() asks of a reach.
template <int D>
struct reach_of_clusters {
  const particles::particles<D>& s;
  const reach_of_pairs<D>& reach;
  const cells::grid<D>& grid;
  far_reaching<D> far;
  double most;                              // m, of pairs without those
  std::vector<block_of_members<D>> blocks;  // without those

  struct of_cluster {
    std::size_t first, n;
    const reach_of_pairs<D>& reach;
    foundation::real S, own;                     // m, of the members: supports; ranges and the rest
    std::array<foundation::real, D> velocity{};  // m/s

    foundation::real squared(std::uint32_t j) const {
      using foundation::real;
      real all = foundation::greater(S, real(reach.S[j])) + (own + reach.range(j));
      if (reach.lifetime > 0.0) {
        real largest(0.0), sum(0.0);
        for (std::size_t a = 0; a < D; ++a) {
          const real component = foundation::stdx::abs(velocity[a] - reach.velocity(a, j));
          largest = foundation::greater(largest, component);
          sum += component;
        }
        all += reach.parted(largest, sum);
      }
      return all * all;
    }
  };
  of_cluster of(std::size_t first, std::size_t n) const {
    of_cluster all{first, n, reach, cells::of_members(reach.S.data() + first, n), reach.rest};
    if (reach.motion == nullptr) return all;
    all.own += cells::of_members(reach.motion->range.data() + first, n);
    for (std::size_t a = 0; a < D; ++a)
      all.velocity[a] = cells::of_members(reach.motion->velocity[a].data() + first, n);
    return all;
  }
  // About each member where one reaches far, or is far from the others.
  template <class F>
  void for_each_near(const of_cluster& c, const cells::cluster_positions<D>& at, cells::spread_cluster& spread,
                     F&& f) const {
    largest_reach<D> all;
    bool spreads = at.longest_edge() > 2.0 * most;
    for (std::size_t i = c.first; i < c.first + c.n; ++i) {
      all.include(reach, i);
      spreads = spreads || far.has(i);
    }
    if (!spreads) return search(at.low, at.high, all, most, f);
    spread.for_each_near(
        c.first, c.n,
        [&](std::size_t i, auto&& found) {
          largest_reach<D> own;
          own.include(reach, i);
          const auto x = cells::position<D>(s.x, i);
          search(x, x, own, far.has(i) ? far.most() : most, found);
        },
        f);
  }
  void find_wide(const std::array<double, D>& low, const std::array<double, D>& high,
                 std::vector<std::uint32_t>& found) const {
    far.find(low, high, found);
  }

 private:
  // Of blocks within the reach of `own` in that box; no further than `farthest`.
  template <class F>
  void search(const std::array<double, D>& low, const std::array<double, D>& high, const largest_reach<D>& own,
              double farthest, F&& f) const {
    constexpr std::uint32_t size = block_of_members<D>::size;
    cells::for_each_stretch<D>(grid, low, high, farthest, [&](std::uint32_t from, std::uint32_t to) {
      for (std::uint32_t b = from / size; b <= (to - 1) / size; ++b) {
        const double length = own.with(blocks[b].largest, reach), length2 = length * length * (1.0 + 1e-12);
        if (!(blocks[b].gap2(low, high) <= length2)) continue;
        const std::uint32_t k = std::max(from, b * size), end = std::min(to, (b + 1) * size);
        if (const std::uint64_t near = cells::near_box<D>(grid, k, end - k, low, high, length2); near != 0) f(k, near);
      }
    });
  }
};

// Of clusters whose particles have reaches of their own.
template <int D>
void make_list(pairs::workspace<D>& w, const reach_of_pairs<D>& reach, const cells::grid<D>& grid) {
  auto& s = w.s;
  far_reaching<D> far(reach, s.total(), grid);
  const auto taken = [&](std::size_t i) { return !far.has(i); };
  largest_reach<D> most;
  for (std::size_t i = 0; i < s.total(); ++i)
    if (taken(i)) most.include(reach, i);
  auto blocks = blocks_of<D>(grid, reach, taken);
  cells::make_list<D>(w.list, grid, s.x, s.fluid,
                      reach_of_clusters<D>{s, reach, grid, std::move(far), most.with(most, reach), std::move(blocks)});
}

}  // namespace tetsuame::run
