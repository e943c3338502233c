// Small fixed-size vectors over a real type R: double, or several lanes of it.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

namespace tetsuame::foundation {

// f(0), …, f(N - 1), written out: the compiler keeps small arrays of lanes in registers if no loop runs over them.
template <std::size_t N, class F>
[[gnu::always_inline]] inline void for_each_of(F&& f) {
  [&]<std::size_t... k>(std::index_sequence<k...>) { (f(k), ...); }
  (std::make_index_sequence<N>{});
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
  // Component by component, without a copy of a vector, which the compiler would keep in memory.
  friend vec operator+(const vec& a, const vec& b) {
    return of([&](std::size_t k) { return a.c[k] + b.c[k]; });
  }
  friend vec operator-(const vec& a, const vec& b) {
    return of([&](std::size_t k) { return a.c[k] - b.c[k]; });
  }
  friend vec operator*(const R& s, const vec& a) {
    return of([&](std::size_t k) { return s * a.c[k]; });
  }
  // {f(0), f(1), …}
  template <class F>
  [[gnu::always_inline]] static vec of(F&& f) {
    return [&]<std::size_t... k>(std::index_sequence<k...>) { return vec{{R(f(k))...}}; }
    (std::make_index_sequence<D>{});
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
  return vec<R, D>::of([](std::size_t) { return 0.0; });
}

}  // namespace tetsuame::foundation
