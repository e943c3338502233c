// The virtual machine: what a step would take on each rank, for any partition of the particles.
#pragma once

#include <algorithm>
#include <array>
#include <balance/balancer.hpp>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <vector>
#include <virtual_ranks/scene.hpp>

namespace tetsuame::virtual_ranks {

// s per rank and step, by the costs of the input; `slowness` multiplies a rank's computing time. The halo
// is counted on bins of its width: to a rank's halo belong other ranks' particles in bins where it has
// particles, and in the bins around these; so it is one to two widths thick.
struct load {
  std::vector<double> computing, communication;
  std::vector<double> time;  // their sum
  std::vector<double> work;  // s, computing time if no rank were slow: what a run counts by its pairs
  std::vector<double> particles;
};

// s, to compute a particle.
inline double seconds_of(const cost_options& c, kind k) {
  return std::array{c.fluid, c.wall, c.marker, c.metal}[static_cast<std::size_t>(k)];
}

// The bins around a bin, itself included.
template <int D, class F>
void visit_around(const scene<D>& s, std::size_t bin, const F& visit) {
  std::array<std::int64_t, D> low{}, high{};
  auto rest = static_cast<std::int64_t>(bin);
  for (std::size_t a = 0; a < D; ++a) {
    const std::int64_t at = rest % s.bins[a];
    low[a] = std::max<std::int64_t>(at - 1, 0);
    high[a] = std::min(at + 1, s.bins[a] - 1);
    rest /= s.bins[a];
  }
  visit_indices<D>(low, high, [&](const std::array<std::int64_t, D>& at) { visit(s.bin(at)); });
}

void keep_each_once(auto& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

template <int D>
load load_of(const scene<D>& s, const std::vector<int>& owner, const cost_options& cost,
             const std::vector<double>& slowness) {
  const std::size_t ranks = slowness.size(), bins = s.first.size() - 1;
  load l;
  l.particles.assign(ranks, 0.0);
  l.work.assign(ranks, 0.0);
  l.communication.assign(ranks, 0.0);
  for (std::size_t i = 0; i < s.size(); ++i) {
    const auto r = static_cast<std::size_t>(owner[i]);
    l.particles[r] += 1.0;
    l.work[r] += seconds_of(cost, s.kinds[i]);
  }

  std::vector<std::map<int, double>> held(bins);  // who has how many particles in each bin
  for (std::size_t b = 0; b < bins; ++b)
    for (std::size_t i = s.first[b]; i < s.first[b + 1]; ++i) held[b][owner[i]] += 1.0;
  std::vector<std::uint64_t> pairs;  // of ranks that exchange messages
  std::vector<int> near;
  for (std::size_t b = 0; b < bins; ++b) {
    if (held[b].empty()) continue;
    near.clear();
    visit_around<D>(s, b, [&](std::size_t n) {
      for (const auto& there : held[n]) near.push_back(there.first);
    });
    keep_each_once(near);
    for (const int p : near) {
      double others = 0.0;
      for (const auto& [rank, particles] : held[b]) {
        if (rank == p) continue;
        others += particles;
        pairs.push_back(static_cast<std::uint64_t>(p) * ranks + static_cast<std::uint64_t>(rank));
      }
      l.communication[static_cast<std::size_t>(p)] += cost.halo * others;
    }
    if (pairs.size() > (std::size_t{1} << 24)) keep_each_once(pairs);
  }
  keep_each_once(pairs);
  for (const auto pair : pairs) l.communication[pair / ranks] += cost.latency;
  for (std::size_t r = 0; r < ranks; ++r) {
    l.computing.push_back(l.work[r] * slowness[r]);
    l.time.push_back(l.computing[r] + l.communication[r]);
  }
  return l;
}

template <int D>
std::vector<int> owners(const scene<D>& s, const balance::cuts<D>& c) {
  std::vector<int> owner(s.size());
  for (std::size_t i = 0; i < s.size(); ++i) owner[i] = c.owner(s.x[i]);
  return owner;
}

// The box around each rank's particles, and where in it their computing time goes.
template <int D>
balance::extents<D> extents_of(const scene<D>& s, const std::vector<int>& owner, std::size_t ranks,
                               const cost_options& cost) {
  balance::extents<D> all(ranks);
  for (std::size_t i = 0; i < s.size(); ++i) all[static_cast<std::size_t>(owner[i])].include(s.x[i]);
  for (auto& of_rank : all)
    if (of_rank.lower[0] <= of_rank.upper[0]) of_rank.begin_costs();
  for (std::size_t i = 0; i < s.size(); ++i)
    all[static_cast<std::size_t>(owner[i])].add_cost(s.x[i], seconds_of(cost, s.kinds[i]));
  return all;
}

inline std::vector<double> slowness_of(const machine_options& o) {
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

// As a clock would show it: scattered by machine.noise, the same for the same seed and reading.
inline std::vector<double> measured(const std::vector<double>& time, const machine_options& o, std::int64_t reading) {
  std::vector<double> shown(time);
  for (std::size_t r = 0; r < shown.size(); ++r)
    shown[r] *= std::max(0.0, 1.0 + o.noise * normal_at(static_cast<std::uint64_t>(o.seed),
                                                        2000 + static_cast<std::uint64_t>(reading), r));
  return shown;
}

struct migration {
  std::int64_t particles = 0;  // that change their rank
  double seconds = 0.0;        // of the slowest rank: what it sends and receives, and new lists
};
inline migration migration_between(const std::vector<int>& from, const std::vector<int>& to, std::size_t ranks,
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

// One weight for each particle, its computing time; for partitioners that see particles.
template <int D>
std::vector<float> weights_of(const scene<D>& s, const cost_options& cost) {
  const double largest = std::max({1e-300, cost.fluid, cost.wall, cost.marker, cost.metal});
  std::vector<float> w(s.size());
  for (std::size_t i = 0; i < s.size(); ++i) w[i] = static_cast<float>(seconds_of(cost, s.kinds[i]) / largest);
  return w;
}

}  // namespace tetsuame::virtual_ranks
