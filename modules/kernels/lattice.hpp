// What a kernel does on the square (cubic) lattice of spacing dx: the sum it smooths a
// constant with, and its transfer function, the factor for a wave of wave vector k,
//   S(k) = sum_j dx^D W_ij cos(k . x_ij).
// S has the period 2 pi/dx and is even in each component, so [0, pi/dx]^D shows all of it: docs/theory/kernels.md.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <kernels/kernel.hpp>
#include <type_traits>

namespace tetsuame::kernels {

// sum_j dx^D W_ij, the particle itself included (dimensionless); dx > 0 in m.
template <int D>
double lattice_sum(const any<D>& kernel, double dx);

// S(k), dimensionless; k in 1/m, x in directions of the lattice.
template <int D>
double transfer(const any<D>& kernel, double dx, const std::type_identity_t<std::array<double, D>>& k);

struct transfer_extremum {
  double value;                // S_min, dimensionless
  std::array<double, 3> k_dx;  // where, k dx in [0, pi]; components beyond D are zero
};

// The least S over all k: every node of a grid of 25 (3-D: 17) a direction, then a search
// around the best down to 1e-8 in k dx.
template <int D>
transfer_extremum transfer_minimum(const any<D>& kernel, double dx);

// The elasticity that a fluid does not have, but a lattice under pressure p (docs/theory/kernels.md):
//   mu/p = 1/s d^2 s/d gamma^2,  gamma the angle of shear,  s the lattice sum of the sheared lattice.
// Negative: the lattice yields by itself.
struct shear_moduli {
  double simple;  // mu/p where rows glide along each other, x += gamma y
  double pure;    // along the diagonals: x stretched and y compressed by exp(+-gamma/2)
  double largest() const { return std::max(std::abs(simple), std::abs(pure)); }
};

// Of the square or cubic lattice, D = 2, 3; in 3-D of shear in a plane of its axes. Fourth-order differences in gamma.
template <int D>
shear_moduli spurious_shear_moduli(const any<D>& kernel, double dx);

}  // namespace tetsuame::kernels
