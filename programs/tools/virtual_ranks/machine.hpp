// The virtual machine: what a step would take on each rank, for any partition of the particles.
#pragma once

#include <balance/balancer.hpp>
#include <cstdint>
#include <vector>
#include <virtual_ranks/scene.hpp>

namespace tetsuame::virtual_ranks {

// s per rank and step, by the costs of the input; `slowness` multiplies a rank's computing time. The halo
// is counted on bins of its width: to a rank's halo belong other ranks' particles in bins where it has
// particles, and in the bins around these; so it is one to two widths thick.
struct load {
  balance::costs time;
  std::vector<double> particles;  // of each rank
  std::vector<double> work;       // s, computing time of each rank if none were slow: what a run counts by its pairs
};
template <int D>
load load_of(const scene<D>& s, const std::vector<int>& owner, const cost_options& cost,
             const std::vector<double>& slowness);

template <int D>
std::vector<int> owners(const scene<D>& s, const balance::cuts<D>& c);

// The box around each rank's particles, and where in it their computing time goes.
template <int D>
balance::extents<D> extents_of(const scene<D>& s, const std::vector<int>& owner, std::size_t ranks,
                               const cost_options& cost);

std::vector<double> slowness_of(const machine_options& o);
// As a clock would show it: scattered by machine.noise, the same for the same seed and reading.
std::vector<double> measured(const std::vector<double>& time, const machine_options& o, std::int64_t reading);

struct migration {
  std::int64_t particles = 0;  // that change their rank
  double seconds = 0.0;        // of the slowest rank: what it sends and receives, and new lists
};
migration migration_between(const std::vector<int>& from, const std::vector<int>& to, std::size_t ranks,
                            const cost_options& cost);

// One weight for each particle, its computing time; for partitioners that see particles.
template <int D>
std::vector<float> weights_of(const scene<D>& s, const cost_options& cost);

}  // namespace tetsuame::virtual_ranks
