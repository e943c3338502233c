// Expansions in three dimensions: in Cartesian coordinates, n a multi-index (expansion.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <foundation/lanes.hpp>
#include <foundation/vec.hpp>
#include <gravity/expansion.hpp>

namespace tetsuame::gravity {

namespace detail {

struct multi_index {
  std::size_t a, b, c;
  constexpr std::size_t order() const { return a + b + c; }
};

constexpr std::size_t full_size(std::size_t order) { return (order + 1) * (order + 2) * (order + 3) / 6; }

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
constexpr auto make_full_set() {
  std::array<multi_index, full_size(P)> all{};
  for (std::size_t l = 0; l <= P; ++l)
    for (std::size_t below = 0; below <= l; ++below)
      for (std::size_t c = 0; c <= below; ++c) {
        const multi_index n{l - below, below - c, c};
        all[full_index(n)] = n;
      }
  return all;
}
template <std::size_t P>
inline constexpr std::array<multi_index, full_size(P)> full_set = make_full_set<P>();
template <std::size_t P>
constexpr auto make_reduced_set() {
  std::array<multi_index, (P + 1) * (P + 1)> all{};
  for (const auto& n : full_set<P>)
    if (n.c <= 1) all[reduced_index(n)] = n;
  return all;
}
template <std::size_t P>
inline constexpr std::array<multi_index, (P + 1) * (P + 1)> reduced_set = make_reduced_set<P>();

// Terms of a product of two sets: to[both] += first[n] second[k].
struct term {
  std::size_t n, k, both;
};
// f(n, k) for all terms that are wanted, written into an array of N.
template <std::size_t N, class First, class Second, class Wanted, class Term>
constexpr std::array<term, N> terms_of(const First& first, const Second& second, const Wanted& wanted,
                                       const Term& term_of) {
  std::array<term, N> all{};
  std::size_t count = 0;
  for (const auto& n : first)
    for (const auto& k : second)
      if (wanted(n, k)) all[count++] = term_of(n, k);
  return all;
}
template <class First, class Second, class Wanted>
constexpr std::size_t number_of_terms(const First& first, const Second& second, const Wanted& wanted) {
  std::size_t count = 0;
  for (const auto& n : first)
    for (const auto& k : second) count += wanted(n, k);
  return count;
}
constexpr multi_index operator+(const multi_index& n, const multi_index& k) {
  return {n.a + k.a, n.b + k.b, n.c + k.c};
}

// Multipoles n moved by monomials k; local terms n + k moved by monomials k.
template <std::size_t P>
constexpr auto make_multipoles_moved() {
  constexpr auto wanted = [](const multi_index& n, const multi_index& k) {
    return n.order() != 1 && n.order() + k.order() <= P;
  };
  return terms_of<number_of_terms(reduced_set<P>, full_set<P>, wanted)>(
      reduced_set<P>, full_set<P>, wanted, [](const multi_index& n, const multi_index& k) {
        return term{reduced_index(n), full_index(k), full_index(n + k)};
      });
}
template <std::size_t P>
inline constexpr auto multipoles_moved = make_multipoles_moved<P>();
template <std::size_t P>
constexpr auto make_locals_moved() {
  constexpr auto wanted = [](const multi_index& n, const multi_index& k) { return n.order() + k.order() <= P; };
  return terms_of<number_of_terms(reduced_set<P>, full_set<P>, wanted)>(
      reduced_set<P>, full_set<P>, wanted, [](const multi_index& n, const multi_index& k) {
        return term{reduced_index(n), full_index(k), full_index(n + k)};
      });
}
template <std::size_t P>
inline constexpr auto locals_moved = make_locals_moved<P>();

// u^n/n! for all n up to order P.
template <std::size_t P, class R>
[[gnu::always_inline]] inline std::array<R, full_size(P)> monomials(const foundation::vec<R, 3>& u) {
  std::array<R, full_size(P)> all;
  all[0] = 1.0;
  unroll<full_size(P) - 1>([&](auto i) {
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
  static constexpr std::size_t order = P, size = (P + 1) * (P + 1), full = detail::full_size(P);
  using set = std::array<double, size>;
  using multi_index = detail::multi_index;

  template <class R>
  static void add_mass(std::array<R, full>& M, const foundation::vec<R, 3>& s, const R& m) {
    const auto power = detail::monomials<order, R>({-s[0], -s[1], -s[2]});
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
    const auto power = detail::monomials<order, double>({-d[0], -d[1], -d[2]});
    std::array<double, full> moved{};
    detail::unroll<detail::multipoles_moved<order>.size()>([&](auto i) {
      constexpr auto term = detail::multipoles_moved<order>[i];
      moved[term.both] += M[term.n] * power[term.k];
    });
    fold(moved, to);
  }
  static void local_to_local(const set& L, const foundation::vec<double, 3>& d, set& to) {
    const auto power = detail::monomials<order, double>(d);
    const auto all = unfold(L);
    detail::unroll<detail::locals_moved<order>.size()>([&](auto i) {
      constexpr auto term = detail::locals_moved<order>[i];
      to[term.n] += all[term.both] * power[term.k];
    });
  }

  // Partial derivatives of 1/r of order up to Q with c <= 2, at full_index; by the recurrence over (d/dr/r)^m of it
  // [L. E. McMurchie, E. R. Davidson, J. Comput. Phys. 26, 218 (1978)].
  template <std::size_t Q, class R>
  [[gnu::always_inline]] static std::array<R, detail::full_size(Q)> derivatives(const foundation::vec<R, 3>& x) {
    using detail::full_index;
    const R inverse = foundation::both_roots(foundation::dot(x, x)).inverse, per_r2 = -inverse * inverse;
    std::array<R, Q + 1> radial;
    radial[0] = inverse;
    detail::unroll<Q>([&](auto m) { radial[m + 1] = radial[m] * (per_r2 * static_cast<double>(2 * m + 1)); });
    std::array<R, detail::full_size(Q)> d;
    d[0] = radial[Q];
    // Downwards in m; orders descending, so that those of m + 1 are still there when they are read.
    detail::unroll<Q>([&](auto step) {
      constexpr std::size_t m = Q - 1 - step;
      detail::unroll<Q - m>([&](auto below) {
        constexpr std::size_t l = Q - m - below;
        if constexpr (m == 0)
          detail::unroll<l>([&](auto b) {
            d[full_index({l - 1 - b, b, 1})] = x[2] * d[full_index({l - 1 - b, b, 0})];
          });
        detail::unroll<l + 1>([&](auto b) { d[full_index({l - b, b, 0})] = raised<l - b, b>(x, d); });
      });
      d[0] = radial[m];
    });
    detail::unroll<detail::full_size(Q)>([&](auto i) {
      constexpr auto n = detail::full_set<Q>[i];
      if constexpr (n.c == 2) d[i] = -(d[full_index({n.a + 2, n.b, 0})] + d[full_index({n.a, n.b + 2, 0})]);
    });
    return d;
  }

  template <std::size_t Q, class R>
  [[gnu::always_inline]] static void multipole_to_local(const std::array<R, size>& M, const foundation::vec<R, 3>& x,
                                                        std::array<R, size>& L) {
    const auto d = derivatives<Q>(x);
    add_terms<Q, 0, 2>(M, d, L);
    detail::unroll<Q - 1>([&](auto l) { add_terms<Q, l + 2, l + 3>(M, d, L); });
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
  // Local terms of the orders [l, end), which stay in registers.
  template <std::size_t Q, std::size_t l, std::size_t end, class R, std::size_t N>
  [[gnu::always_inline]] static void add_terms(const std::array<R, size>& M, const std::array<R, N>& d,
                                               std::array<R, size>& L) {
    constexpr std::size_t begin = l * l, count = end * end - begin;
    std::array<R, count> sum;
    detail::unroll<count>(
        [&](auto k) { sum[k] = M[0] * d[detail::full_index(detail::reduced_set<order>[begin + k])]; });
    detail::unroll<(Q - l + 1) * (Q - l + 1)>([&](auto i) {
      constexpr auto n = detail::reduced_set<order>[i];
      if constexpr (n.order() > 1)
        detail::unroll<count>([&](auto k) {
          constexpr auto local = detail::reduced_set<order>[begin + k];
          if constexpr (n.order() + local.order() <= Q) sum[k] += M[i] * d[detail::full_index(n + local)];
        });
    });
    detail::unroll<count>([&](auto k) { L[begin + k] += sum[k]; });
  }
  // ∂x^a ∂y^b of the function of m from what d holds of that of m + 1.
  template <std::size_t a, std::size_t b, class R, std::size_t n>
  [[gnu::always_inline]] static R raised(const foundation::vec<R, 3>& x, const std::array<R, n>& d) {
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

}  // namespace tetsuame::gravity
