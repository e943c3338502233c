// Expansions in two dimensions: positions are complex numbers, real part first (expansion.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <foundation/lanes.hpp>
#include <foundation/lanes_math.hpp>
#include <foundation/vec.hpp>
#include <gravity/expansion.hpp>

namespace tetsuame::gravity {

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
  template <std::size_t Q, class R>
  [[gnu::always_inline]] static powers<R> derivatives(const foundation::vec<R, 2>& x) {
    const R r2 = foundation::dot(x, x), per_r2 = 1.0 / r2;
    const complex<R> inverse{x[0] * per_r2, -x[1] * per_r2};
    powers<R> d;
    d[0] = {0.5 * foundation::log(r2), R(0.0)};
    d[1] = inverse;
    for (std::size_t n = 2; n <= Q; ++n) d[n] = -static_cast<double>(n - 1) * (d[n - 1] * inverse);
    return d;
  }
  template <std::size_t Q, class R>
  [[gnu::always_inline]] static void multipole_to_local(const std::array<R, size>& M, const foundation::vec<R, 2>& x,
                                                        std::array<R, size>& L) {
    const auto d = derivatives<Q>(x);
    for (std::size_t n = 0; n <= Q; ++n) {
      complex<R> sum = complex<R>{M[0], M[1]} * d[n];
      for (std::size_t k = 2; n + k <= Q; ++k) sum += complex<R>{M[2 * k], M[2 * k + 1]} * d[n + k];
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
