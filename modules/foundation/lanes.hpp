// Several doubles in one register, one neighbour a lane: what loops over neighbours need beside arithmetic.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <experimental/simd>
#include <type_traits>
#if defined(__AVX__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

namespace tetsuame::foundation {

namespace stdx = std::experimental;

using real = stdx::native_simd<double>;
inline constexpr std::size_t lanes = real::size();

// Whether R is a register of n doubles, for which there are the processor's own instructions.
template <class R, std::size_t n>
inline constexpr bool is_register = std::is_same_v<R, real>&& R::size() == n;

#if defined(__AVX2__)
namespace detail {
// All bits of lane n where bit n is set.
inline __m256i lanes_of(std::uint32_t bits) {
  const __m256i lane = _mm256_setr_epi64x(1, 2, 4, 8), all = _mm256_set1_epi64x(static_cast<long long>(bits));
  return _mm256_cmpeq_epi64(_mm256_and_si256(all, lane), lane);
}
}  // namespace detail
#endif

// The lanes' sum in the fixed order of a binary tree: (0 + 2) + (1 + 3) for four lanes.
template <class R>
double sum(const R& a) {
#if defined(__AVX__)
  const auto of_four = [](__m256d all) {
    const __m128d pair = _mm_add_pd(_mm256_castpd256_pd128(all), _mm256_extractf128_pd(all, 1));
    return _mm_cvtsd_f64(_mm_add_sd(pair, _mm_unpackhi_pd(pair, pair)));
  };
  if constexpr (is_register<R, 4>) return of_four(static_cast<__m256d>(a));
#endif
#if defined(__AVX512F__)
  if constexpr (is_register<R, 8>) {
    const auto all = static_cast<__m512d>(a);
    return of_four(_mm256_add_pd(_mm512_castpd512_pd256(all), _mm512_extractf64x4_pd(all, 1)));
  }
#endif
  std::array<double, lanes> part;
  a.copy_to(part.data(), stdx::element_aligned);
  for (std::size_t half = lanes / 2; half > 0; half /= 2)
    for (std::size_t k = 0; k < half; ++k) part[k] += part[k + half];
  return part[0];
}

// The greater and the lesser, lane by lane; b where one is not a number. Instead of std::experimental's max and min:
// those are compiled with an option of their own (finite-math-only), which g++ hands on to a small function that
// calls them, and does not inline that one into others any more, whatever is asked for.
inline double greater(double a, double b) { return b < a ? a : b; }
template <class R>
[[gnu::always_inline]] inline R greater(const R& a, const R& b) {
#if defined(__AVX512F__)
  if constexpr (is_register<R, 8>) return R(_mm512_max_pd(static_cast<__m512d>(a), static_cast<__m512d>(b)));
#endif
#if defined(__AVX__)
  if constexpr (is_register<R, 4>) return R(_mm256_max_pd(static_cast<__m256d>(a), static_cast<__m256d>(b)));
#endif
  R c = b;
  where(b < a, c) = a;
  return c;
}
template <class R>
[[gnu::always_inline]] inline R lesser(const R& a, const R& b) {
#if defined(__AVX512F__)
  if constexpr (is_register<R, 8>) return R(_mm512_min_pd(static_cast<__m512d>(a), static_cast<__m512d>(b)));
#endif
#if defined(__AVX__)
  if constexpr (is_register<R, 4>) return R(_mm256_min_pd(static_cast<__m256d>(a), static_cast<__m256d>(b)));
#endif
  R c = b;
  where(a < b, c) = a;
  return c;
}

// Values from `a` on in the lanes whose bit is set, 0 in others; nothing else is read, or written.
template <class R>
[[gnu::always_inline]] inline R load_where(std::uint32_t bits, const double* a) {
#if defined(__AVX512F__)
  if constexpr (is_register<R, 8>) return R(_mm512_maskz_loadu_pd(static_cast<__mmask8>(bits), a));
#endif
#if defined(__AVX2__)
  if constexpr (is_register<R, 4>) return R(_mm256_maskload_pd(a, detail::lanes_of(bits)));
#endif
  R values = 0.0;
  for (std::size_t lane = 0; lane < R::size(); ++lane)
    if ((bits >> lane & 1U) != 0) values[lane] = a[lane];
  return values;
}
template <class R>
[[gnu::always_inline]] inline void store_where(std::uint32_t bits, double* a, const R& values) {
#if defined(__AVX512F__)
  if constexpr (is_register<R, 8>)
    return _mm512_mask_storeu_pd(a, static_cast<__mmask8>(bits), static_cast<__m512d>(values));
#endif
#if defined(__AVX2__)
  if constexpr (is_register<R, 4>) return _mm256_maskstore_pd(a, detail::lanes_of(bits), static_cast<__m256d>(values));
#endif
  for (std::size_t lane = 0; lane < R::size(); ++lane)
    if ((bits >> lane & 1U) != 0) a[lane] = values[lane];
}

// greater(a, b) in lane n where bit n of `bits` is set, `other` elsewhere.
template <class R>
[[gnu::always_inline]] inline R greater_where(std::uint32_t bits, const R& a, const R& b, const R& other) {
#if defined(__AVX512F__)
  if constexpr (is_register<R, 8>)
    return R(_mm512_mask_max_pd(static_cast<__m512d>(other), static_cast<__mmask8>(bits), static_cast<__m512d>(a),
                                static_cast<__m512d>(b)));
#endif
#if defined(__AVX2__)
  if constexpr (is_register<R, 4>)
    return R(_mm256_blendv_pd(static_cast<__m256d>(other), static_cast<__m256d>(greater(a, b)),
                              _mm256_castsi256_pd(detail::lanes_of(bits))));
#endif
#if defined(__aarch64__)
  if constexpr (is_register<R, 2>)
    return R(vbslq_f64(vtstq_u64(vdupq_n_u64(bits), uint64x2_t{1, 2}), static_cast<float64x2_t>(greater(a, b)),
                       static_cast<float64x2_t>(other)));
#endif
  R c = greater(a, b);
  for (std::size_t lane = 0; lane < R::size(); ++lane)
    if ((bits >> lane & 1U) == 0) c[lane] = other[lane];
  return c;
}

// Bit n: whether a < b in lane n.
template <class R>
std::uint32_t bits_of_less(const R& a, const R& b) {
#if defined(__AVX512F__)
  if constexpr (is_register<R, 8>)
    return _mm512_cmp_pd_mask(static_cast<__m512d>(a), static_cast<__m512d>(b), _CMP_LT_OQ);
#endif
#if defined(__AVX__)
  if constexpr (is_register<R, 4>)
    return static_cast<std::uint32_t>(
        _mm256_movemask_pd(_mm256_cmp_pd(static_cast<__m256d>(a), static_cast<__m256d>(b), _CMP_LT_OQ)));
#endif
  std::uint32_t all = 0;
  for (std::size_t lane = 0; lane < R::size(); ++lane) all |= (a[lane] < b[lane] ? 1U : 0U) << lane;
  return all;
}

// r and 1/r of r² > 0, to a rounding or two.
template <class R>
struct roots {
  R r, inverse;
};

template <class R>
roots<R> both_roots(const R& r2) {
#if defined(__AVX512F__)
  if constexpr (is_register<R, 8>) {
    // The processor's estimate y of 1/r to 14 bits, and the series of (1 - e)^(-1/2), e = 1 - r² y², to the third
    // power: the next term is below a rounding. The square root's and the division's own instructions take
    // several times as long.
    const auto x = static_cast<__m512d>(r2);
    const __m512d y = _mm512_rsqrt14_pd(x), r = _mm512_mul_pd(x, y);
    const __m512d e = _mm512_fnmadd_pd(r, y, _mm512_set1_pd(1.0));
    const __m512d cubic = _mm512_fmadd_pd(e, _mm512_set1_pd(0.3125), _mm512_set1_pd(0.375));
    const __m512d series = _mm512_fmadd_pd(e, cubic, _mm512_set1_pd(0.5));
    return {R(_mm512_fmadd_pd(_mm512_mul_pd(r, e), series, r)), R(_mm512_fmadd_pd(_mm512_mul_pd(y, e), series, y))};
  }
#endif
  const R r = stdx::sqrt(r2);
  return {r, R(1.0 / r)};
}

}  // namespace tetsuame::foundation
