// The pair loop: every sum over neighbours in the physics runs through here.
//
// A term is a small struct that writes one sum of the notes. It names what it keeps of
// particle i (`begin`), what a neighbour j adds (`add`, for several neighbours at once: `real`
// holds one value a lane), and where the finished sum goes (`end`):
//
//   struct divergence {                                  // Σ_j ΔV_j v_ij·∇_i W_ij
//     auto begin(std::size_t i) const;                   // -> what the sum needs of i, and its zero
//     void add(me& a, const pair<D>& ij) const;          // a.sum += gather(dV, ij.j) * dot(v_ij, ij.gradient())
//     void end(std::size_t i, const me& a) const;        // out[i] = sum(a.sum)
//   };
//
// Several terms in one call share the neighbour's distance and kernel: one pass for the
// whole right-hand side. Neighbours are added in the list's order, lane by lane, and the
// lanes in a fixed tree, so the result depends on neither ranks nor threads.
#pragma once

#include <array>
#include <cells/neighbour_list.hpp>
#include <cstddef>
#include <cstdint>
#include <experimental/simd>
#include <foundation/threads.hpp>
#include <foundation/vec.hpp>
#include <particles/particles.hpp>
#include <span>
#include <tuple>
#include <utility>

namespace tetsuame::pairs {

namespace stdx = std::experimental;

using real = stdx::native_simd<double>;
inline constexpr std::size_t lanes = real::size();
static_assert(cells::neighbour_list::lanes % lanes == 0);

using foundation::vec;

inline real gather(const double* a, const std::int32_t* j) {
  return real([&](auto lane) { return a[j[lane]]; });
}

template <int D>
vec<real, D> gather(const std::array<const double*, D>& a, const std::int32_t* j) {
  vec<real, D> values;
  for (std::size_t k = 0; k < D; ++k) values[k] = gather(a[k], j);
  return values;
}

inline double sum(const real& a) {
  std::array<double, lanes> part;
  a.copy_to(part.data(), stdx::element_aligned);
  for (std::size_t half = lanes / 2; half > 0; half /= 2)
    for (std::size_t k = 0; k < half; ++k) part[k] += part[k + half];
  return part[0];
}

template <int D>
std::array<const double*, D> pointers(const std::array<particles::array, D>& a) {
  std::array<const double*, D> p;
  for (std::size_t k = 0; k < D; ++k) p[k] = a[k].data();
  return p;
}

template <int D>
struct pair {
  const std::int32_t* j;  // local indices of the neighbours, one a lane
  vec<real, D> x_ij;      // m, x_i - x_j
  real r2;                // m2
  real W;                 // 1/m^D
  real F;                 // 1/m^(D+2), W'(r)/r
  vec<real, D> gradient() const { return F * x_ij; }  // ∇_i W_ij
};

template <class Mine, class Pair, std::size_t... T, class... Terms>
void add_all(Mine& mine, const Pair& ij, std::index_sequence<T...>, const Terms&... terms) {
  (terms.add(std::get<T>(mine), ij), ...);
}

template <class Mine, std::size_t... T, class... Terms>
void end_all(const Mine& mine, std::size_t i, std::index_sequence<T...>, const Terms&... terms) {
  (terms.end(i, std::get<T>(mine)), ...);
}

// For each particle i = rows[r]: begin, its neighbours from row i of the list, end.
template <int D, class Kernel, class Rows, class... Terms>
void sum_over(const Rows& rows, const cells::neighbour_list& list, const std::array<const double*, D>& x,
              const Kernel& kernel, const Terms&... terms) {
  const std::size_t n = rows.size();
#pragma omp parallel for schedule(static) if (n > foundation::rows_worth_threads)
  for (std::size_t r = 0; r < n; ++r) {
    const std::size_t i = rows[r];
    vec<real, D> x_i;
    for (std::size_t k = 0; k < D; ++k) x_i[k] = real(x[k][i]);
    std::tuple mine{terms.begin(i)...};
    const std::int32_t* end = list.neighbours.data() + list.start[i + 1];
    for (const std::int32_t* j = list.neighbours.data() + list.start[i]; j < end; j += lanes) {
      pair<D> ij;
      ij.j = j;
      ij.x_ij = x_i - gather<D>(x, j);
      ij.r2 = foundation::dot(ij.x_ij, ij.x_ij);
      kernel.both(stdx::sqrt(ij.r2), ij.W, ij.F);
      add_all(mine, ij, std::index_sequence_for<Terms...>{}, terms...);
    }
    end_all(mine, i, std::index_sequence_for<Terms...>{}, terms...);
  }
}

// Rows of sum_over: all particles in [0, n).
struct every {
  std::size_t n;
  std::size_t size() const { return n; }
  std::size_t operator[](std::size_t r) const { return r; }
};

}  // namespace tetsuame::pairs
