// Small fixed-size vectors over a real type R: double, or several lanes of it.
#pragma once

#include <array>
#include <cstddef>

namespace tetsuame::foundation {

template <class R, int D>
struct vec {
  std::array<R, D> c;

  R& operator[](std::size_t k) { return c[k]; }
  const R& operator[](std::size_t k) const { return c[k]; }

  vec& operator+=(const vec& b) {
    for (std::size_t k = 0; k < D; ++k) c[k] += b.c[k];
    return *this;
  }
  vec& operator-=(const vec& b) {
    for (std::size_t k = 0; k < D; ++k) c[k] -= b.c[k];
    return *this;
  }
  friend vec operator+(vec a, const vec& b) { return a += b; }
  friend vec operator-(vec a, const vec& b) { return a -= b; }
  friend vec operator*(const R& s, vec a) {
    for (std::size_t k = 0; k < D; ++k) a.c[k] = s * a.c[k];
    return a;
  }
};

template <class R, int D>
R dot(const vec<R, D>& a, const vec<R, D>& b) {
  R sum = a[0] * b[0];
  for (std::size_t k = 1; k < D; ++k) sum += a[k] * b[k];
  return sum;
}

template <class R, int D>
vec<R, D> zero() {
  vec<R, D> a;
  for (std::size_t k = 0; k < D; ++k) a[k] = R(0.0);
  return a;
}

}  // namespace tetsuame::foundation
