#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <virtual_ranks/machine.hpp>

namespace tetsuame::virtual_ranks {

namespace {

std::array<double, 4> by_kind(const cost_options& c) { return {c.fluid, c.wall, c.marker, c.metal}; }

struct share {
  int rank;
  double particles;
};

// Who has how many particles in a bin.
void shares_of(const std::vector<int>& owner, std::size_t begin, std::size_t end, std::vector<share>& found) {
  found.clear();
  for (std::size_t i = begin; i < end; ++i) {
    auto at = std::find_if(found.begin(), found.end(), [&](const share& s) { return s.rank == owner[i]; });
    if (at == found.end())
      found.push_back({owner[i], 1.0});
    else
      at->particles += 1.0;
  }
}

// The bins around a bin, itself included.
template <int D, class F>
void visit_around(const scene<D>& s, std::size_t bin, const F& visit) {
  std::array<std::int64_t, D> at{};
  auto rest = static_cast<std::int64_t>(bin);
  for (std::size_t a = 0; a < D; ++a) {
    at[a] = rest % s.bins[a];
    rest /= s.bins[a];
  }
  const auto along = [&](auto&& self, std::size_t axis, std::int64_t sum) -> void {
    for (std::int64_t i = std::max<std::int64_t>(at[axis] - 1, 0); i <= std::min(at[axis] + 1, s.bins[axis] - 1); ++i)
      if (axis == 0)
        visit(static_cast<std::size_t>(sum * s.bins[0] + i));
      else
        self(self, axis - 1, sum * s.bins[axis] + i);
  };
  along(along, D - 1, 0);
}

}  // namespace

template <int D>
load load_of(const scene<D>& s, const std::vector<int>& owner, const cost_options& cost,
             const std::vector<double>& slowness) {
  const std::size_t ranks = slowness.size(), bins = s.first.size() - 1;
  load l;
  l.particles.assign(ranks, 0.0);
  l.time.computing.assign(ranks, 0.0);
  l.time.communication.assign(ranks, 0.0);
  const auto seconds = by_kind(cost);
  for (std::size_t i = 0; i < s.size(); ++i) {
    const auto r = static_cast<std::size_t>(owner[i]);
    l.particles[r] += 1.0;
    l.time.computing[r] += seconds[static_cast<std::size_t>(s.kinds[i])];
  }
  l.work = l.time.computing;
  for (std::size_t r = 0; r < ranks; ++r) l.time.computing[r] *= slowness[r];

  constexpr int nobody = -1, several = -2;
  std::vector<int> only(bins, nobody);
  for (std::size_t b = 0; b < bins; ++b)
    for (std::size_t i = s.first[b]; i < s.first[b + 1]; ++i) {
      if (only[b] == nobody) only[b] = owner[i];
      if (only[b] != owner[i]) {
        only[b] = several;
        break;
      }
    }
  std::vector<std::uint64_t> pairs;
  std::vector<share> here, there;
  std::vector<int> near;
  for (std::size_t b = 0; b < bins; ++b) {
    if (only[b] == nobody) continue;
    bool border = only[b] == several;
    if (!border)
      visit_around<D>(s, b, [&](std::size_t n) { border = border || (only[n] != nobody && only[n] != only[b]); });
    if (!border) continue;
    shares_of(owner, s.first[b], s.first[b + 1], here);
    near.clear();
    visit_around<D>(s, b, [&](std::size_t n) {
      if (only[n] >= 0) {
        near.push_back(only[n]);
      } else if (only[n] == several) {
        shares_of(owner, s.first[n], s.first[n + 1], there);
        for (const auto& t : there) near.push_back(t.rank);
      }
    });
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    const auto all = static_cast<double>(s.first[b + 1] - s.first[b]);
    for (const int p : near) {
      double others = all;
      for (const auto& h : here) {
        if (h.rank == p)
          others -= h.particles;
        else
          pairs.push_back(static_cast<std::uint64_t>(p) * ranks + static_cast<std::uint64_t>(h.rank));
      }
      l.time.communication[static_cast<std::size_t>(p)] += cost.halo * others;
    }
    if (pairs.size() > (std::size_t{1} << 24)) {
      std::sort(pairs.begin(), pairs.end());
      pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  for (const auto pair : pairs) l.time.communication[pair / ranks] += cost.latency;
  return l;
}

template <int D>
std::vector<int> owners(const scene<D>& s, const balance::cuts<D>& c) {
  std::vector<int> owner(s.size());
  for (std::size_t i = 0; i < s.size(); ++i) owner[i] = c.owner(s.x[i]);
  return owner;
}

template <int D>
balance::extents<D> extents_of(const scene<D>& s, const std::vector<int>& owner, std::size_t ranks,
                               const cost_options& cost) {
  balance::extents<D> all(ranks);
  for (std::size_t i = 0; i < s.size(); ++i) all[static_cast<std::size_t>(owner[i])].include(s.x[i]);
  const auto seconds = by_kind(cost);
  for (auto& of_rank : all)
    if (of_rank.lower[0] <= of_rank.upper[0]) of_rank.begin_costs();
  for (std::size_t i = 0; i < s.size(); ++i)
    all[static_cast<std::size_t>(owner[i])].add_cost(s.x[i], seconds[static_cast<std::size_t>(s.kinds[i])]);
  return all;
}

std::vector<double> slowness_of(const machine_options& o) {
  const auto ranks = static_cast<std::size_t>(o.ranks);
  const auto slow = static_cast<std::size_t>(std::lround(o.slow_fraction * static_cast<double>(ranks)));
  std::vector<std::size_t> order(ranks);
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (o.slow_pattern == "random") {
    const auto place = [&](std::size_t r) { return uniform_at(static_cast<std::uint64_t>(o.seed), 1000, r); };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
  }
  std::vector<double> slowness(ranks, 1.0);
  for (std::size_t k = 0; k < slow; ++k) slowness[order[k]] = o.slow_factor;
  return slowness;
}

std::vector<double> measured(const std::vector<double>& time, const machine_options& o, std::int64_t reading) {
  std::vector<double> shown(time);
  for (std::size_t r = 0; r < shown.size(); ++r)
    shown[r] *= std::max(0.0, 1.0 + o.noise * normal_at(static_cast<std::uint64_t>(o.seed),
                                                        2000 + static_cast<std::uint64_t>(reading), r));
  return shown;
}

migration migration_between(const std::vector<int>& from, const std::vector<int>& to, std::size_t ranks,
                            const cost_options& cost) {
  migration m;
  std::vector<std::int64_t> moved(ranks, 0), held(ranks, 0);
  for (std::size_t i = 0; i < from.size(); ++i) {
    ++held[static_cast<std::size_t>(to[i])];
    if (from[i] == to[i]) continue;
    ++m.particles;
    ++moved[static_cast<std::size_t>(from[i])];
    ++moved[static_cast<std::size_t>(to[i])];
  }
  m.seconds = cost.migrate * static_cast<double>(*std::max_element(moved.begin(), moved.end())) +
              cost.list * static_cast<double>(*std::max_element(held.begin(), held.end()));
  return m;
}

template <int D>
std::vector<float> weights_of(const scene<D>& s, const cost_options& cost) {
  const auto seconds = by_kind(cost);
  const double largest = std::max(1e-300, *std::max_element(seconds.begin(), seconds.end()));
  std::vector<float> w(s.size());
  for (std::size_t i = 0; i < s.size(); ++i)
    w[i] = static_cast<float>(seconds[static_cast<std::size_t>(s.kinds[i])] / largest);
  return w;
}

template load load_of(const scene<2>&, const std::vector<int>&, const cost_options&, const std::vector<double>&);
template load load_of(const scene<3>&, const std::vector<int>&, const cost_options&, const std::vector<double>&);
template std::vector<int> owners(const scene<2>&, const balance::cuts<2>&);
template std::vector<int> owners(const scene<3>&, const balance::cuts<3>&);
template balance::extents<2> extents_of(const scene<2>&, const std::vector<int>&, std::size_t, const cost_options&);
template balance::extents<3> extents_of(const scene<3>&, const std::vector<int>&, std::size_t, const cost_options&);
template std::vector<float> weights_of(const scene<2>&, const cost_options&);
template std::vector<float> weights_of(const scene<3>&, const cost_options&);

}  // namespace tetsuame::virtual_ranks
