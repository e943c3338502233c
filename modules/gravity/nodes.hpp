// The tree itself: particles in its order, groups of them, and the multipoles of each. Down to blocks of some hundred
// particles it is the binary form of an octree (quadtree) along the Morton curve; a block is halved across the longest
// side of the box around its particles, so that leaves are full.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <foundation/lanes.hpp>
#include <foundation/vec.hpp>
#include <gravity/cloud.hpp>
#include <gravity/expansion.hpp>
#include <gravity/morton.hpp>
#include <vector>

namespace tetsuame::gravity {

// Orders by measurement (docs/theory/self_gravity.md).
template <int D>
using far_field = expansion<D, D == 3 ? 6 : 10>;

// Particles in a leaf, at most: registers of targets are full.
inline constexpr std::size_t leaf_size = 16;

// A group of particles, in the tree's units of length and mass (node_tree::length, node_tree::unit_mass).
template <int D>
struct alignas(64) node {
  foundation::vec<double, D> centre;  // of mass
  double radius;                      // around the centre; all particles are within
  double spread;                      // sixth root of the mean sixth power of the distance from the centre, by mass
  double support;                     // the largest one
  double mass;
  double per_field;                         // at least 1/Σ m/r^(D-1) of all particles outside, for any place within
  foundation::vec<double, D> middle, half;  // of the box around the particles: its centre, and half of its edges
};

// Where a node stands: particles [first, last). Nodes are in preorder: the first part of a node that is divided follows
// it, then the second one, and all below a node stand before `end`.
struct range {
  std::uint32_t first, last, end;
};

template <int D>
struct node_tree {
  using far = far_field<D>;

  std::vector<node<D>> nodes;                 // none if there is no particle
  std::vector<range> ranges;                  // of each node
  std::vector<typename far::set> multipoles;  // of each node
  std::vector<std::uint32_t> order;           // index of each particle in the cloud
  // Particles in the order of the tree; lanes may read a register beyond the last one.
  std::array<std::vector<double>, D> x;
  std::vector<double> mass, inverse_support;
  std::array<double, D> origin{};        // m
  double length = 1.0, unit_mass = 1.0;  // m and kg (2-D: kg/m), powers of two: a product with them is not rounded

  // Of a cloud that was checked.
  void build(const cloud<D>& particles);

  bool is_leaf(std::size_t index) const { return ranges[index].end == index + 1; }
  std::size_t second(std::size_t index) const { return ranges[index + 1].end; }  // the other part
  std::size_t particles(std::size_t index) const { return ranges[index].last - ranges[index].first; }

 private:
  struct box {
    std::array<double, D> low, high;
    std::size_t longest_axis() const;
    double edge() const { return high[longest_axis()] - low[longest_axis()]; }
    void include(const box& other);
  };
  // A particle of a block, and its place along the Morton curve, by which ties are broken.
  struct entry {
    std::array<double, D> x;
    std::uint32_t place;
  };

  template <class Position>
  static box bounds(std::size_t first, std::size_t last, const Position& position);
  void set_frame(const box& all);
  // Keys of [first, last) in the cube around these, sorted; false if all are at one place.
  bool sort_range(const cloud<D>& particles, std::size_t first, std::size_t last);
  std::size_t division(const cloud<D>& particles, std::size_t first, std::size_t last);
  void divide(const cloud<D>& particles, std::size_t first, std::size_t last);
  void fill_block(const cloud<D>& particles, std::size_t index, std::vector<entry>& entries);
  void halve(std::size_t index, entry* entries, std::size_t first, std::size_t last);
  void gather(const cloud<D>& particles, std::size_t first, std::size_t last);
  void tell_box(std::size_t index);
  void sum_leaf(std::size_t index);
  void sum_parts(std::size_t index);
  void bound_fields();

  std::vector<sorted_key> keys_, buffer_;
  std::vector<box> boxes_;                     // around the particles of each node
  std::vector<std::uint32_t> blocks_, above_;  // nodes
};

extern template struct node_tree<2>;
extern template struct node_tree<3>;

}  // namespace tetsuame::gravity
