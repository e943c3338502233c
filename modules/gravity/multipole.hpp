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
#include <foundation/lanes_math.hpp>
#include <foundation/vec.hpp>
#include <utility>

namespace tetsuame::gravity {

// Of order P: `size` numbers a set (units: kg m^l for multipoles, kg/m^(l+1) for local expansions of order l).
//   add_mass(M, s, m): adds masses at s, a register of them (3-D: into `full` sets, which fold() reduces)
//   multipole_to_multipole(M, d, to): adds M about a centre that lies d from that of `to`
//   multipole_to_local(M, R, L): adds, each in lanes
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

struct multi_index {
  std::size_t a, b, c;
  constexpr std::size_t order() const { return a + b + c; }
};

// All of order up to P, by order; those with c <= 1 likewise.
constexpr std::size_t full_index(const multi_index& n) {
  const std::size_t l = n.order(), below = n.b + n.c;
  return l * (l + 1) * (l + 2) / 6 + below * (below + 1) / 2 + n.c;
}
constexpr std::size_t reduced_index(const multi_index& n) {
  const std::size_t l = n.order();
  return l * l + (n.c == 0 ? n.b : l + 1 + n.b);
}
template <std::size_t P>
inline constexpr auto full_set = [] {
  std::array<multi_index, (P + 1) * (P + 2) * (P + 3) / 6> all{};
  for (std::size_t l = 0; l <= P; ++l)
    for (std::size_t below = 0; below <= l; ++below)
      for (std::size_t c = 0; c <= below; ++c) {
        const multi_index n{l - below, below - c, c};
        all[full_index(n)] = n;
      }
  return all;
}();
template <std::size_t P>
inline constexpr auto reduced_set = [] {
  std::array<multi_index, (P + 1) * (P + 1)> all{};
  for (const auto& n : full_set<P>)
    if (n.c <= 1) all[reduced_index(n)] = n;
  return all;
}();

// Pairs of reduced indices n, k with |n| + |k| <= P.
struct index_pair {
  std::size_t n, k, both;
};
template <std::size_t P>
constexpr std::size_t number_of_pairs() {
  std::size_t count = 0;
  for (const auto& n : reduced_set<P>)
    for (const auto& k : reduced_set<P>) count += n.order() + k.order() <= P;
  return count;
}
template <std::size_t P>
inline constexpr auto pair_set = [] {
  std::array<index_pair, number_of_pairs<P>()> all{};
  std::size_t count = 0;
  for (const auto& n : reduced_set<P>)
    for (const auto& k : reduced_set<P>)
      if (n.order() + k.order() <= P)
        all[count++] = {reduced_index(n), reduced_index(k), full_index({n.a + k.a, n.b + k.b, n.c + k.c})};
  return all;
}();

// u^n/n! for all n up to order P.
template <std::size_t P, class R>
[[gnu::always_inline]] inline std::array<R, full_set<P>.size()> monomials(const foundation::vec<R, 3>& u) {
  std::array<R, full_set<P>.size()> all;
  all[0] = 1.0;
  unroll<full_set<P>.size() - 1>([&](auto i) {
    constexpr auto n = full_set<P>[i + 1];
    if constexpr (n.c > 0)
      all[i + 1] = all[full_index({n.a, n.b, n.c - 1})] * (u[2] * (1.0 / static_cast<double>(n.c)));
    else if constexpr (n.b > 0)
      all[i + 1] = all[full_index({n.a, n.b - 1, 0})] * (u[1] * (1.0 / static_cast<double>(n.b)));
    else
      all[i + 1] = all[full_index({n.a - 1, 0, 0})] * (u[0] * (1.0 / static_cast<double>(n.a)));
  });
  return all;
}

}  // namespace detail

template <int P>
struct expansion<3, P> {
  static constexpr std::size_t order = P, size = (P + 1) * (P + 1), full = (P + 1) * (P + 2) * (P + 3) / 6;
  using set = std::array<double, size>;
  using multi_index = detail::multi_index;

  template <class R>
  static void add_mass(std::array<R, full>& M, const foundation::vec<R, 3>& s, const R& m) {
    const auto power = detail::monomials<order, R>(foundation::vec<R, 3>::of([&](std::size_t a) { return -s[a]; }));
    for (std::size_t i = 0; i < full; ++i) M[i] += m * power[i];
  }

  // Second derivatives along z are minus those along x and y.
  static void fold(std::array<double, full> M, set& to) {
    for (std::size_t i = full; i-- > 0;) {
      const auto n = detail::full_set<order>[i];
      if (n.c < 2) continue;
      M[detail::full_index({n.a + 2, n.b, n.c - 2})] -= M[i];
      M[detail::full_index({n.a, n.b + 2, n.c - 2})] -= M[i];
    }
    for (std::size_t i = 0; i < size; ++i) to[i] += M[detail::full_index(detail::reduced_set<order>[i])];
  }
  static std::array<double, full> unfold(const set& L) {
    std::array<double, full> all;
    for (std::size_t i = 0; i < full; ++i) {
      const auto n = detail::full_set<order>[i];
      all[i] =
          n.c < 2
              ? L[detail::reduced_index(n)]
              : -(all[detail::full_index({n.a + 2, n.b, n.c - 2})] + all[detail::full_index({n.a, n.b + 2, n.c - 2})]);
    }
    return all;
  }

  static void multipole_to_multipole(const set& M, const foundation::vec<double, 3>& d, set& to) {
    const auto power =
        detail::monomials<order, double>(foundation::vec<double, 3>::of([&](std::size_t a) { return -d[a]; }));
    std::array<double, full> moved{};
    for (std::size_t i = 0; i < size; ++i) {
      const auto n = detail::reduced_set<order>[i];
      for (std::size_t j = 0; j < full; ++j) {
        const auto k = detail::full_set<order>[j];
        if (n.order() + k.order() > order) break;
        moved[detail::full_index({n.a + k.a, n.b + k.b, n.c + k.c})] += M[i] * power[j];
      }
    }
    fold(moved, to);
  }
  static void local_to_local(const set& L, const foundation::vec<double, 3>& d, set& to) {
    const auto power = detail::monomials<order, double>(d);
    const auto all = unfold(L);
    for (std::size_t i = 0; i < size; ++i) {
      const auto n = detail::reduced_set<order>[i];
      for (std::size_t j = 0; j < full; ++j) {
        const auto k = detail::full_set<order>[j];
        if (n.order() + k.order() > order) break;
        to[i] += all[detail::full_index({n.a + k.a, n.b + k.b, n.c + k.c})] * power[j];
      }
    }
  }

  // Partial derivatives of 1/r of order up to P with c <= 2, at full_index; by the recurrence over (d/dr/r)^m of it
  // [L. E. McMurchie, E. R. Davidson, J. Comput. Phys. 26, 218 (1978)].
  template <class R>
  [[gnu::always_inline]] static std::array<R, full> derivatives(const foundation::vec<R, 3>& x) {
    using detail::full_index;
    const R inverse = foundation::both_roots(foundation::dot(x, x)).inverse, per_r2 = -inverse * inverse;
    std::array<R, order + 1> radial;
    radial[0] = inverse;
    detail::unroll<order>([&](auto m) { radial[m + 1] = radial[m] * (per_r2 * static_cast<double>(2 * m + 1)); });
    std::array<R, full> d;
    d[0] = radial[order];
    // Downwards in m; orders descending, so that those of m + 1 are still there when they are read.
    detail::unroll<order>([&](auto step) {
      constexpr std::size_t m = order - 1 - step;
      detail::unroll<order - m>([&](auto below) {
        constexpr std::size_t l = order - m - below;
        if constexpr (m == 0)
          detail::unroll<l>([&](auto b) {
            d[full_index({l - 1 - b, b, 1})] = x[2] * d[full_index({l - 1 - b, b, 0})];
          });
        detail::unroll<l + 1>([&](auto b) { d[full_index({l - b, b, 0})] = raised<l - b, b>(x, d); });
      });
      d[0] = radial[m];
    });
    detail::unroll<full>([&](auto i) {
      constexpr auto n = detail::full_set<order>[i];
      if constexpr (n.c == 2) d[i] = -(d[full_index({n.a + 2, n.b, 0})] + d[full_index({n.a, n.b + 2, 0})]);
    });
    return d;
  }

  template <class R>
  [[gnu::always_inline]] static void multipole_to_local(const std::array<R, size>& M, const foundation::vec<R, 3>& x,
                                                        std::array<R, size>& L) {
    const auto d = derivatives(x);
    detail::unroll<detail::pair_set<order>.size()>([&](auto i) {
      constexpr auto pair = detail::pair_set<order>[i];
      L[pair.n] += M[pair.k] * d[pair.both];
    });
  }

  template <class R>
  static harmonic<3, R> evaluate(const set& expanded, const foundation::vec<R, 3>& u) {
    using detail::full_index;
    const auto L = unfold(expanded);
    const auto power = detail::monomials<order, R>(u);
    harmonic<3, R> all{foundation::zero<R, 3>(), R(L[0])};
    detail::unroll<full - 1>([&](auto i) {
      constexpr auto n = detail::full_set<order>[i + 1];
      const R coefficient = L[i + 1];
      all.value += coefficient * power[i + 1];
      if constexpr (n.a > 0) all.gradient[0] += coefficient * power[full_index({n.a - 1, n.b, n.c})];
      if constexpr (n.b > 0) all.gradient[1] += coefficient * power[full_index({n.a, n.b - 1, n.c})];
      if constexpr (n.c > 0) all.gradient[2] += coefficient * power[full_index({n.a, n.b, n.c - 1})];
    });
    return all;
  }

 private:
  // ∂x^a ∂y^b of the function of m from what d holds of that of m + 1.
  template <std::size_t a, std::size_t b, class R>
  [[gnu::always_inline]] static R raised(const foundation::vec<R, 3>& x, const std::array<R, full>& d) {
    using detail::full_index;
    if constexpr (a > 1)
      return x[0] * d[full_index({a - 1, b, 0})] + static_cast<double>(a - 1) * d[full_index({a - 2, b, 0})];
    else if constexpr (a == 1)
      return x[0] * d[full_index({0, b, 0})];
    else if constexpr (b > 1)
      return x[1] * d[full_index({0, b - 1, 0})] + static_cast<double>(b - 1) * d[full_index({0, b - 2, 0})];
    else
      return x[1] * d[0];
  }
};

// Complex numbers, real part first.
template <int P>
struct expansion<2, P> {
  static constexpr std::size_t order = P, terms = P + 1, size = 2 * terms, full = size;
  using set = std::array<double, size>;

  template <class R>
  struct complex {
    R re, im;
    [[gnu::always_inline]] friend complex operator*(const complex& a, const complex& b) {
      return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
    }
    [[gnu::always_inline]] friend complex operator*(double a, const complex& b) { return {a * b.re, a * b.im}; }
    [[gnu::always_inline]] complex& operator+=(const complex& b) {
      re += b.re;
      im += b.im;
      return *this;
    }
  };
  template <class R>
  using powers = std::array<complex<R>, terms>;

  template <class R>
  [[gnu::always_inline]] static powers<R> monomials(const complex<R>& u) {
    powers<R> all;
    all[0] = {R(1.0), R(0.0)};
    for (std::size_t n = 1; n < terms; ++n) all[n] = (1.0 / static_cast<double>(n)) * (all[n - 1] * u);
    return all;
  }

  template <class R>
  static void add_mass(std::array<R, full>& M, const foundation::vec<R, 2>& s, const R& m) {
    const auto power = monomials<R>({-s[0], -s[1]});
    for (std::size_t n = 0; n < terms; ++n) {
      M[2 * n] += m * power[n].re;
      M[2 * n + 1] += m * power[n].im;
    }
  }
  static void fold(const set& M, set& to) {
    for (std::size_t i = 0; i < size; ++i) to[i] += M[i];
  }
  static void multipole_to_multipole(const set& M, const foundation::vec<double, 2>& d, set& to) {
    const auto power = monomials<double>({-d[0], -d[1]});
    for (std::size_t n = 0; n < terms; ++n)
      for (std::size_t k = 0; k <= n; ++k) add(term(M, k) * power[n - k], to, n);
  }
  static void local_to_local(const set& L, const foundation::vec<double, 2>& d, set& to) {
    const auto power = monomials<double>({d[0], d[1]});
    for (std::size_t n = 0; n < terms; ++n)
      for (std::size_t k = n; k < terms; ++k) add(term(L, k) * power[k - n], to, n);
  }

  // ln w, 1/w, -1/w², 2/w³, … The imaginary part of the logarithm is of no use.
  template <class R>
  [[gnu::always_inline]] static powers<R> derivatives(const foundation::vec<R, 2>& x) {
    const R r2 = foundation::dot(x, x), per_r2 = 1.0 / r2;
    const complex<R> inverse{x[0] * per_r2, -x[1] * per_r2};
    powers<R> d;
    d[0] = {0.5 * foundation::log(r2), R(0.0)};
    d[1] = inverse;
    for (std::size_t n = 2; n < terms; ++n) d[n] = -static_cast<double>(n - 1) * (d[n - 1] * inverse);
    return d;
  }
  template <class R>
  [[gnu::always_inline]] static void multipole_to_local(const std::array<R, size>& M, const foundation::vec<R, 2>& x,
                                                        std::array<R, size>& L) {
    const auto d = derivatives(x);
    for (std::size_t n = 0; n < terms; ++n) {
      complex<R> sum{R(0.0), R(0.0)};
      for (std::size_t k = 0; n + k < terms; ++k) sum += complex<R>{M[2 * k], M[2 * k + 1]} * d[n + k];
      L[2 * n] += sum.re;
      L[2 * n + 1] += sum.im;
    }
  }
  // The gradient of Re F is (Re F', -Im F').
  template <class R>
  static harmonic<2, R> evaluate(const set& L, const foundation::vec<R, 2>& u) {
    const auto power = monomials<R>({u[0], u[1]});
    harmonic<2, R> all{foundation::zero<R, 2>(), R(L[0])};
    for (std::size_t n = 1; n < terms; ++n) {
      const complex<R> c{R(L[2 * n]), R(L[2 * n + 1])};
      const auto slope = c * power[n - 1];
      all.value += (c * power[n]).re;
      all.gradient[0] += slope.re;
      all.gradient[1] -= slope.im;
    }
    return all;
  }

 private:
  static complex<double> term(const set& all, std::size_t n) { return {all[2 * n], all[2 * n + 1]}; }
  static void add(const complex<double>& c, set& to, std::size_t n) {
    to[2 * n] += c.re;
    to[2 * n + 1] += c.im;
  }
};

}  // namespace tetsuame::gravity
