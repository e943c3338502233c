// What a kernel does on the square (cubic) lattice of spacing dx: the sum it smooths a
// constant with, and its transfer function, the factor for a wave of wave vector k,
//   S(k) = sum_j dx^D W_ij cos(k . x_ij).
// S has the period 2 pi/dx and is even in each component, so [0, pi/dx]^D shows all of it.
// One pass of the Hosono iteration multiplies a wave in ln Y by (1 - kappa)(1 - S(k)) with
// kappa = K_T/p: it converges if |kappa - 1| (1 - S_min) < 1 (docs/theory/kernels.md).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <kernels/kernel.hpp>

namespace tetsuame::kernels {

// sum_j dx^D W_ij, the particle itself included (dimensionless); dx > 0 in m.
template <class Kernel>
double lattice_sum(const Kernel& kernel, double dx);

// S(k), dimensionless; k in 1/m, x in directions of the lattice.
template <class Kernel>
double transfer(const Kernel& kernel, double dx, const std::array<double, Kernel::dimension>& k);

struct transfer_extremum {
  double value;                // S_min, dimensionless
  std::array<double, 3> k_dx;  // where, k dx in [0, pi]; components beyond D are zero
};

// The least S over all k: every node of a grid of 25 (3-D: 17) a direction, then a search
// around the best down to 1e-8 in k dx.
template <class Kernel>
transfer_extremum transfer_minimum(const Kernel& kernel, double dx);

// The elasticity that a fluid does not have. With volumes from the number density, dV_i = s/sum_j W_ij, a lattice under
// uniform pressure p has the energy -p dV per particle, which a shear at fixed area (volume) changes in second order:
//   mu/p = 1/s d^2 s/d gamma^2,  gamma the angle of shear,  s the lattice sum of the sheared lattice.
// The same follows from the force -sum (p_i dV_i^2 + p_j dV_j^2) grad W, however dV comes about. Negative: the lattice
// yields by itself.
struct shear_moduli {
  double simple;  // mu/p where rows glide along each other, x += gamma y
  double pure;    // along the diagonals: x stretched and y compressed by exp(+-gamma/2)
  double largest() const { return std::max(std::abs(simple), std::abs(pure)); }
};

// Of the square or cubic lattice, D = 2, 3; in 3-D of shear in a plane of its axes. Fourth-order differences in gamma.
template <class Kernel>
shear_moduli spurious_shear_moduli(const Kernel& kernel, double dx);

// Of a kernel chosen at run time.
template <int D>
shear_moduli spurious_shear_moduli(const any<D>& kernel, double dx) {
  return std::visit([&](const auto& k) { return spurious_shear_moduli(k, dx); }, kernel);
}
template <int D>
double lattice_sum(const any<D>& kernel, double dx) {
  return std::visit([&](const auto& k) { return lattice_sum(k, dx); }, kernel);
}
template <int D>
transfer_extremum transfer_minimum(const any<D>& kernel, double dx) {
  return std::visit([&](const auto& k) { return transfer_minimum(k, dx); }, kernel);
}

}  // namespace tetsuame::kernels
