// The tree itself: particles in the order of their keys, groups of them, and the multipoles of each.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <foundation/lanes.hpp>
#include <foundation/vec.hpp>
#include <gravity/cloud.hpp>
#include <gravity/morton.hpp>
#include <gravity/multipole.hpp>
#include <vector>

namespace tetsuame::gravity {

// By measurement (docs/theory/self_gravity.md).
template <int D>
using far_field = expansion<D, D == 3 ? 5 : 8>;

// Particles [first, last) in the order of keys. Nodes stand in preorder: the first part of a node that is divided
// follows it, then the second one, and all below a node end before `end`.
template <int D>
struct node {
  std::uint32_t first, last, end;
  double radius;                      // m, around the centre; all particles are within
  double support;                     // m, the largest one
  double mass;                        // kg
  foundation::vec<double, D> centre;  // m, of mass
};

template <int D>
struct node_tree {
  std::vector<node<D>> nodes;                          // none if there is no particle
  std::vector<typename far_field<D>::set> multipoles;  // of each node
  std::vector<sorted_key> order;                       // of particles
  // In the order of keys; lanes may read a register beyond the last one.
  std::array<std::vector<double>, D> x;       // m
  std::vector<double> mass, inverse_support;  // kg, 1/m

  // Of a cloud that was checked.
  void build(const cloud<D>& particles, std::size_t leaf);

  static bool is_leaf(const node<D>& n, std::size_t index) { return n.end == index + 1; }
  std::size_t second(std::size_t index) const { return nodes[index + 1].end; }  // the other part
  // f(index) for parts that make up the whole tree, each of at most so many particles where it can be divided, and for
  // those above them, which are divided.
  template <class Part, class Above>
  void for_each_part(std::size_t most, const Part& part, const Above& above) const {
    for (std::size_t k = 0; k < nodes.size();) {
      const bool whole = nodes[k].last - nodes[k].first <= most || is_leaf(nodes[k], k);
      whole ? part(k) : above(k);
      k = whole ? nodes[k].end : k + 1;
    }
  }

 private:
  struct box {
    std::array<double, D> low, high;
  };

  box bounds(const cloud<D>& particles, std::size_t first, std::size_t last) const;
  // Keys of [first, last) in the cube around these, sorted; false if all are at one place.
  bool sort_range(const cloud<D>& particles, std::size_t first, std::size_t last);
  std::size_t division(const cloud<D>& particles, std::size_t first, std::size_t last);
  void divide(const cloud<D>& particles, std::size_t first, std::size_t last, std::size_t leaf);
  void gather(const cloud<D>& particles);
  void sum_leaf(std::size_t index);
  void sum_parts(std::size_t index);
  void sum_all();

  std::vector<box> boxes_;  // around the particles of each node
  std::vector<sorted_key> buffer_;
};

extern template struct node_tree<2>;
extern template struct node_tree<3>;

}  // namespace tetsuame::gravity
