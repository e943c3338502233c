// Expansions of the field of a group of masses about a centre: multipoles outside of it, local (Taylor) expansions
// within another group, and what turns one into the other. With g = 1/r in 3-D, ln r in 2-D, sources at z_S + s,
// targets at z_T + u and R = z_T - z_S,
//
//   Σ_j m_j g(R + u - s_j) = Σ_k L_k u^k/k!,   L_k = Σ_n M_n g^(n+k)(R),   M_n = Σ_j m_j (-s_j)^n/n!,
//
// cut at |n| + |k| = P, so that the forces of two groups on each other stay opposite [W. Dehnen, J. Comput. Phys. 179,
// 27 (2002)]. In 3-D n and k are multi-indices and g^(n) the partial derivatives. As g is harmonic, those with three
// or two indices z follow from others: each set holds those with none or one of them, 2 l + 1 of order l
// [J. Applequist, J. Phys. A 22, 4303 (1989)]. In 2-D positions are complex numbers, n
// and k numbers, and the real part counts [L. Greengard, V. Rokhlin, J. Comput. Phys. 73, 325 (1987)].
#pragma once

#include <array>
#include <cstddef>
#include <foundation/lanes.hpp>
#include <foundation/vec.hpp>
#include <type_traits>
#include <utility>

namespace tetsuame::gravity {

// Of order P: sets of `size` numbers (units: kg m^l for multipoles, kg/m^(l+D-2) for local expansions, of order l).
// Centres are centres of mass: multipoles of order 1 vanish and are not read.
//   add_mass(M, s, m): adds masses at s, in lanes, to sums of `full` numbers, which fold() makes a set
//   multipole_to_multipole(M, d, to): adds M about a centre that lies d from that of `to`
//   multipole_to_local<Q>(M, R, L): adds, in lanes, what is of order Q <= P
//   local_to_local(L, d, to): adds L to an expansion about a centre at d
//   evaluate(L, u): Σ m g and its gradient
template <int D, int P>
struct expansion;

// Gradient and value of Σ m g.
template <int D, class R>
struct harmonic {
  foundation::vec<R, D> gradient;
  R value;
};

namespace detail {

// f(0), …, f(N - 1) with constants that f may use as such.
template <std::size_t N, class F>
[[gnu::always_inline]] inline void unroll(F&& f) {
  [&]<std::size_t... k>(std::index_sequence<k...>) { (f(std::integral_constant<std::size_t, k>{}), ...); }
  (std::make_index_sequence<N>{});
}

}  // namespace detail

}  // namespace tetsuame::gravity

#include <gravity/expansion_2d.hpp>
#include <gravity/expansion_3d.hpp>
