// exp, log and pow of a double or of several lanes at a time. For lanes glibc's vector mathematics library
// (libmvec) does it where there is one, to 4 units in the last place and the same for a value in whatever lane it
// stands; elsewhere one lane after the other.
#pragma once

#include <cmath>
#include <experimental/simd>
#include <foundation/lanes.hpp>

#if defined(__x86_64__) && defined(__GLIBC__) && defined(__AVX2__)
#include <immintrin.h>
// The vector ABI's names [glibc manual; x86-64 psABI's vector function ABI]: d is AVX2, e AVX-512.
extern "C" {
__m256d _ZGVdN4v_exp(__m256d);
__m256d _ZGVdN4v_log(__m256d);
__m256d _ZGVdN4vv_pow(__m256d, __m256d);
#if defined(__AVX512F__)
__m512d _ZGVeN8v_exp(__m512d);
__m512d _ZGVeN8v_log(__m512d);
#endif
}
#define TETSUAME_LIBMVEC 1
#endif

namespace tetsuame::foundation {

inline double exp(double x) { return std::exp(x); }
inline double log(double x) { return std::log(x); }
inline double pow(double x, double y) { return std::pow(x, y); }

template <class Abi>
std::experimental::simd<double, Abi> exp(const std::experimental::simd<double, Abi>& x) {
  using R = std::experimental::simd<double, Abi>;
#if defined(TETSUAME_LIBMVEC)
#if defined(__AVX512F__)
  if constexpr (is_register<R, 8>) return R(_ZGVeN8v_exp(static_cast<__m512d>(x)));
#endif
  if constexpr (is_register<R, 4>) return R(_ZGVdN4v_exp(static_cast<__m256d>(x)));
#endif
  return R([&](auto lane) { return std::exp(x[lane]); });
}

template <class Abi>
std::experimental::simd<double, Abi> log(const std::experimental::simd<double, Abi>& x) {
  using R = std::experimental::simd<double, Abi>;
#if defined(TETSUAME_LIBMVEC)
#if defined(__AVX512F__)
  if constexpr (is_register<R, 8>) return R(_ZGVeN8v_log(static_cast<__m512d>(x)));
#endif
  if constexpr (is_register<R, 4>) return R(_ZGVdN4v_log(static_cast<__m256d>(x)));
#endif
  return R([&](auto lane) { return std::log(x[lane]); });
}

template <class Abi>
std::experimental::simd<double, Abi> pow(const std::experimental::simd<double, Abi>& x,
                                         const std::experimental::simd<double, Abi>& y) {
  using R = std::experimental::simd<double, Abi>;
#if defined(TETSUAME_LIBMVEC)
  if constexpr (is_register<R, 4>) return R(_ZGVdN4vv_pow(static_cast<__m256d>(x), static_cast<__m256d>(y)));
#endif
  return R([&](auto lane) { return std::pow(x[lane], y[lane]); });
}

}  // namespace tetsuame::foundation
