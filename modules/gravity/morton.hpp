// Order of particles along a Morton curve: particles that follow each other are near each other, and the highest bit
// in which two keys differ tells the largest cell of an octree (quadtree) that parts them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tetsuame::gravity {

// A cube; a cell of it is a key.
template <int D>
struct cube {
  std::array<double, D> low;  // m
  double edge;                // m

  static constexpr int bits = D == 3 ? 21 : 32;  // of an index along an axis

  std::uint64_t key(const std::array<double, D>& x) const;
};

// The order of a subset of particles: index of each, ascending in (key, ID).
struct sorted_key {
  std::uint64_t key;
  std::uint32_t index;
};

// Sorts by key with a radix sort, and runs of equal keys by ID (by index where there is none). `buffer` is scratch
// memory, which grows to the size of `all`.
void sort_keys(std::span<sorted_key> all, const std::uint64_t* id, std::vector<sorted_key>& buffer);

extern template struct cube<2>;
extern template struct cube<3>;

}  // namespace tetsuame::gravity
