// The smoothing kernels by name. A kernel is a small value with
//   value(r)            W, 1/m^D              gradient_over_r(r)   W'(r)/r, 1/m^(D+2)
//   both(r, w, f)       the two at once; grad_i W_ij = f x_ij
//   both(r, 1/r, w, f)  for the pair loop, which has 1/r anyway
//   support(), self()   S in m, W(0) in 1/m^D
// for r a double or several lanes (std::experimental::simd), without branches: beyond
// the support both are exactly zero (to r = 1e90 S, where the polynomials would overflow:
// fill idle lanes with a finite r). At r = 0 f is finite: the analytic limit for the
// Wendland kernels, nearly zero for the splines; either way the force f x_ij is zero.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include <kernels/splines.hpp>
#include <kernels/wendland.hpp>

namespace tetsuame::kernels {

template <int D>
using any = std::variant<quintic_spline<D>, cubic_spline<D>, wendland_c2<D>, wendland_c4<D>, wendland_c6<D>>;

// Whether one of these kernels, a variant, is this one.
template <class Kernels, class Kernel>
inline constexpr bool has = false;
template <class... Some, class Kernel>
inline constexpr bool has<std::variant<Some...>, Kernel> = (std::is_same_v<Some, Kernel> || ...);

// Of a variant of kernels.
template <class... Some>
std::vector<std::string> names_of(std::type_identity<std::variant<Some...>>) {
  return {std::string(Some::name)...};
}

// The support S is support_over_h * h, with h = h_over_dx * dx.
struct entry {
  std::string_view name;
  double support_over_h;
  double default_h_over_dx;
};

// Default h_over_dx: why, docs/theory/kernels.md.
inline constexpr auto table = []<class... Kernel>(std::type_identity<std::variant<Kernel...>>) {
  return std::array{entry{Kernel::name, Kernel::support_over_h, Kernel::default_h_over_dx}...};
}(std::type_identity<any<2>>{});

// The table's line of that name; fail_input with all the names if there is none.
const entry& find(std::string_view name);

// The kernel of that name and smoothing length h > 0 (m); fail_input for an unknown name.
template <int D>
any<D> make(std::string_view name, double h);

}  // namespace tetsuame::kernels
