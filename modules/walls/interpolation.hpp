// Shape functions φ_j of a marker, f(x_m) = Σ_j φ_j f_j over fluid particles only:
//   shepard  φ_j = ΔV_j W_mj / Σ_k ΔV_k W_mk                  exact for constants [S2, appendix]
//   mls      φ_j = W_mj P_j·c,  Σ_k W_mk P_k P_kᵀ c = P(0)    P = (1, x, y, z): exact for linear fields
//   mls2     the same with the quadratic terms in P           exact for quadratic fields
// ΔV is the volume that the walls' kinematics take (wall_set::volumes), Y/p with the equation of state's p: where that
// of Y is smoothed, its sums need what stands behind the walls. The polynomials' conditions hold without volumes.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <foundation/lanes.hpp>
#include <foundation/vec.hpp>
#include <operators/symmetric.hpp>
#include <string>
#include <type_traits>

namespace tetsuame::walls {

using foundation::lanes, foundation::real, foundation::single, foundation::vec;

// Number of terms of a polynomial of the order in D dimensions.
constexpr std::size_t terms(int order, int D) {
  return order == 0   ? 1
         : order == 1 ? 1 + static_cast<std::size_t>(D)
                      : static_cast<std::size_t>((D + 1) * (D + 2) / 2);
}

// P to the given order at the offset e (in units of the marker's reach, so that the moments are of order one).
template <int D, int Order = 2, class R>
std::array<R, terms(Order, D)> polynomial(const vec<R, D>& e) {
  std::array<R, terms(Order, D)> P;
  std::size_t n = 0;
  P[n++] = R(1.0);
  if constexpr (Order > 0)
    for (std::size_t a = 0; a < D; ++a) P[n++] = e[a];
  if constexpr (Order > 1)
    for (std::size_t a = 0; a < D; ++a)
      for (std::size_t b = a; b < D; ++b) P[n++] = e[a] * e[b];
  return P;
}

// Neighbours of a marker, one a lane; R is `real`, or `single`, which holds twice as many.
template <int D, class R = real>
struct seen {
  R weight;          // W_mj, times reach^D, of shepard ΔV_j W_mj in other units; zero in a lane without a particle
  vec<R, D> offset;  // (x_j - x_m)/reach
};

// Σ_k W_mk P_k P_kᵀ of a marker, of each lane's particles: its lower half, row by row.
template <int D, int Order, class R = real>
struct moments {
  static constexpr std::size_t N = terms(Order, D), size = N * (N + 1) / 2;
  std::array<R, size> sums;

  moments() {
    for (R& sum : sums) sum = 0.0;
  }
  [[gnu::always_inline]] void add(const seen<D, R>& j) {
    const auto P = polynomial<D, Order>(j.offset);
    for (std::size_t a = 0; a < N; ++a) {
      const R weighted = j.weight * P[a];
      for (std::size_t b = 0; b <= a; ++b) sums[a * (a + 1) / 2 + b] += weighted * P[b];
    }
  }
};

// The systems of as many markers as a register has lanes, one a lane.
template <int D, int Order>
class systems {
 public:
  static constexpr std::size_t N = terms(Order, D);

  systems() {
    for (std::size_t a = 0; a < N; ++a)
      for (std::size_t b = 0; b < N; ++b) A_[a][b].fill(a == b ? 1.0 : 0.0);
  }
  template <class R>
  void put(std::size_t lane, const moments<D, Order, R>& of_marker) {
    for (std::size_t a = 0; a < N; ++a)
      for (std::size_t b = 0; b <= a; ++b) A_[a][b][lane] = foundation::sum(of_marker.sums[a * (a + 1) / 2 + b]);
  }
  // c of each marker, A c = (1, 0, …) of the order, or of the next lower one for which the particles suffice; c is zero
  // where none does.
  // singular: what of a diagonal is lost in the rounding of the moments.
  std::array<std::array<double, N>, lanes> coefficients(double singular = 1e-10) const {
    std::array<real, N> in_lanes;
    for (real& c : in_lanes) c = 0.0;
    solve<Order>(real::mask_type(true), singular, in_lanes);
    std::array<std::array<double, N>, lanes> c;
    for (std::size_t lane = 0; lane < lanes; ++lane)
      for (std::size_t a = 0; a < N; ++a) c[lane][a] = in_lanes[a][lane];
    return c;
  }

 private:
  // Of the markers in these lanes, of no higher order than this.
  template <int Highest>
  void solve(const real::mask_type& open, double singular, std::array<real, N>& c) const {
    constexpr std::size_t n = terms(Highest, D);
    std::array<std::array<real, n>, n> L;
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b <= a; ++b) L[a][b].copy_from(A_[a][b].data(), std::experimental::vector_aligned);
    const auto solved = open && operators::factorise(L, singular);
    std::array<real, n> first;
    for (std::size_t a = 0; a < n; ++a) first[a] = a == 0 ? 1.0 : 0.0;
    const auto solution = operators::solve(L, first);
    for (std::size_t a = 0; a < n; ++a) c[a] = foundation::select(solved, solution[a], c[a]);
    if constexpr (Highest > 0)
      if (const auto rest = open && !solved; any_of(rest)) solve<Highest - 1>(rest, singular, c);
  }

  struct alignas(std::experimental::memory_alignment_v<real>) of_lanes : std::array<double, lanes> {};
  std::array<std::array<of_lanes, N>, N> A_;
};

// φ_j of these neighbours, by their marker's coefficients.
template <int D, int Order, class R>
[[gnu::always_inline]] inline R shape_function(const seen<D, R>& j, const std::array<double, terms(Order, D)>& c) {
  const auto P = polynomial<D, Order>(j.offset);
  R value(c[0]);
  foundation::for_each_of<terms(Order, D) - 1>([&](std::size_t a) { value += P[a + 1] * c[a + 1]; });
  return j.weight * value;
}

// f(order as a constant).
template <class F>
void with_order(const std::string& interpolation, F&& f) {
  if (interpolation == "shepard") f(std::integral_constant<int, 0>{});
  if (interpolation == "mls") f(std::integral_constant<int, 1>{});
  if (interpolation == "mls2") f(std::integral_constant<int, 2>{});
}

}  // namespace tetsuame::walls
