// Self-gravity of N particles: a binary tree along the Morton curve, and the fast multipole method
// [H. Cheng, L. Greengard, V. Rokhlin, J. Comput. Phys. 155, 468 (1999); W. Dehnen, J. Comput.
// Phys. 179, 27 (2002); W. Dehnen, Comput. Astrophys. Cosmol. 1, 1 (2014)]. Isolated boundary condition: no particle
// outside of the cloud. 2-D: infinitely long cylinders, a = -2 G m r/r².
//
//   gravity::tree<3> attraction(gravity::tree_options{});
//   attraction({{x, y, z}, mass, support, id, n}, first, last, {{ax, ay, az}, potential});
//
// The result for a particle is the same to the last bit in whatever order particles are handed over, for any range of
// targets, on any number of threads: all follows from positions, masses, supports and IDs. Forces of two groups on each
// other are opposite but for rounding, so momentum is conserved.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <gravity/cloud.hpp>
#include <memory>

namespace tetsuame::gravity {

struct tree_options {
  double gravitational_constant = 6.67430e-11;  // m³/(kg s²) [CODATA 2018]
  // Above 0: the error of the force of one group on another, estimated, over a lower bound of the sum of the magnitudes
  // of all forces on it. The median of the relative errors of accelerations is about a tenth of it, in 99 % of
  // particles they are below it, in the clouds of docs/theory/self_gravity.md.
  double tolerance = 8e-4;
  // Above 0, below 1: two groups act on each other by multipoles only if the sum of their radii is below this part of
  // the distance between their centres of mass.
  double opening = 0.9;
};

// Pairs of near particles are summed in single numbers, with errors of some 1e-7 of the field, unless the tolerance is
// below this; in 2-D always in double ones.
inline constexpr double double_pairs_below = 1e-5;

template <int D>
class tree {
 public:
  // Throws std::invalid_argument if an option is out of range.
  explicit tree(const tree_options& options);
  tree(tree&&) noexcept;
  tree& operator=(tree&&) noexcept;
  ~tree();

  // Acceleration (m/s²) and potential (J/kg) of the particles [first, last) of the cloud, written to [0, last - first)
  // of `to`. Throws foundation::error, which names the particle, if positions are not finite, masses or supports
  // negative or not finite. Memory is kept for the next call: about 200 bytes a particle.
  void operator()(const cloud<D>& particles, std::size_t first, std::size_t last, const field<D>& to);

 private:
  struct workspace;
  std::unique_ptr<workspace> w_;
};

extern template class tree<2>;
extern template class tree<3>;

}  // namespace tetsuame::gravity
