// Small fixed-size vectors over a real type R: double, or several lanes of it.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

namespace tetsuame::foundation {

// f(0), …, f(N - 1), written out: the compiler keeps small arrays of lanes in registers if no loop runs over them.
template <std::size_t N, class F>
[[gnu::always_inline]] inline void for_each_of(F&& f) {
  [&]<std::size_t... k>(std::index_sequence<k...>) { (f(k), ...); }(std::make_index_sequence<N>{});
}

template <class R, int D>
struct vec {
  std::array<R, D> c;

  R& operator[](std::size_t k) { return c[k]; }
  const R& operator[](std::size_t k) const { return c[k]; }

  vec& operator+=(const vec& b) {
    for_each_of<D>([&](std::size_t k) { c[k] += b.c[k]; });
    return *this;
  }
  vec& operator-=(const vec& b) {
    for_each_of<D>([&](std::size_t k) { c[k] -= b.c[k]; });
    return *this;
  }
  friend vec operator+(vec a, const vec& b) { return a += b; }
  friend vec operator-(vec a, const vec& b) { return a -= b; }
  friend vec operator*(const R& s, vec a) {
    for_each_of<D>([&](std::size_t k) { a.c[k] = s * a.c[k]; });
    return a;
  }
};

template <class R, int D>
R dot(const vec<R, D>& a, const vec<R, D>& b) {
  R sum = a[0] * b[0];
  for_each_of<D - 1>([&](std::size_t k) { sum += a[k + 1] * b[k + 1]; });
  return sum;
}

template <class R, int D>
vec<R, D> zero() {
  vec<R, D> a;
  for_each_of<D>([&](std::size_t k) { a[k] = R(0.0); });
  return a;
}

}  // namespace tetsuame::foundation
