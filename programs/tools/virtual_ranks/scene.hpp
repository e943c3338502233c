// The particles of a virtual run: places, kinds and the bins that find who is near whom.
#pragma once

#include <array>
#include <balance/cuts.hpp>
#include <cstdint>
#include <vector>
#include <virtual_ranks/options.hpp>

namespace tetsuame::virtual_ranks {

enum class kind : std::uint8_t { fluid, wall, marker, metal };

template <int D>
struct scene {
  std::array<double, D> length{};  // m
  double spacing = 0.0;            // m
  std::vector<std::array<double, D>> x;
  std::vector<kind> kinds;

  // Bins of the halo's width; particles stand in the order of their bins.
  double bin_width = 0.0;                    // m
  std::array<std::int64_t, D> bins{};        // along each axis
  std::vector<std::size_t> first;            // of each bin; one more than bins
  std::vector<std::array<double, D>> blobs;  // centres at the start

  std::size_t size() const { return x.size(); }
};

// Dimension and box of the snapshot o.file. Throws fail_file.
void read_box(distribution_options& o);

// Throws fail_input (no particle, an unfit snapshot) and fail_file.
template <int D>
scene<D> make_scene(const distribution_options& o, double halo_width);

// Kinds after so many steps; true if any has changed. Only falling blobs change theirs.
template <int D>
bool move_blobs(scene<D>& s, const distribution_options& o, std::int64_t steps);

// Cuts with as many particles in each cell, as far as whole particles allow.
template <int D>
balance::cuts<D> equal_count_cuts(const scene<D>& s, const std::array<int, D>& counts);

// In [0, 1), the same for the same numbers on any machine [SplitMix64, G. Steele et al., OOPSLA 2014].
double uniform_at(std::uint64_t seed, std::uint64_t stream, std::uint64_t index);
double normal_at(std::uint64_t seed, std::uint64_t stream, std::uint64_t index);

}  // namespace tetsuame::virtual_ranks
