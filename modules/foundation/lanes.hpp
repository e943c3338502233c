// Several numbers in one register, one a lane: what loops over neighbours need beside arithmetic. `real` holds doubles;
// `single` twice as many numbers of half the length, and stands wherever `real` does: doubles become single by
// themselves.
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

class single {
 public:
  using lanes_type = stdx::native_simd<float>;
  using mask_type = lanes_type::mask_type;
  static constexpr std::size_t size() { return lanes_type::size(); }

  single() = default;
  [[gnu::always_inline]] single(double all) : v_(static_cast<float>(all)) {}
  [[gnu::always_inline]] explicit single(const lanes_type& v) : v_(v) {}
  [[gnu::always_inline]] const lanes_type& all() const { return v_; }
  [[gnu::always_inline]] float operator[](std::size_t lane) const { return v_[lane]; }

  [[gnu::always_inline]] friend single operator+(const single& a, const single& b) { return single(a.v_ + b.v_); }
  [[gnu::always_inline]] friend single operator-(const single& a, const single& b) { return single(a.v_ - b.v_); }
  [[gnu::always_inline]] friend single operator*(const single& a, const single& b) { return single(a.v_ * b.v_); }
  [[gnu::always_inline]] friend single operator/(const single& a, const single& b) { return single(a.v_ / b.v_); }
  [[gnu::always_inline]] single operator-() const { return single(-v_); }
  [[gnu::always_inline]] single& operator+=(const single& b) { return *this = *this + b; }
  [[gnu::always_inline]] single& operator-=(const single& b) { return *this = *this - b; }
  [[gnu::always_inline]] single& operator*=(const single& b) { return *this = *this * b; }
  [[gnu::always_inline]] friend single sqrt(const single& a) { return single(stdx::sqrt(a.v_)); }
  [[gnu::always_inline]] friend single abs(const single& a) { return single(stdx::abs(a.v_)); }
  [[gnu::always_inline]] friend single copysign(const single& a, const single& sign) {
    return single(stdx::copysign(a.v_, sign.v_));
  }
  [[gnu::always_inline]] friend mask_type operator==(const single& a, const single& b) { return a.v_ == b.v_; }
  [[gnu::always_inline]] friend mask_type operator!=(const single& a, const single& b) { return a.v_ != b.v_; }
  [[gnu::always_inline]] friend mask_type operator<(const single& a, const single& b) { return a.v_ < b.v_; }

 private:
  lanes_type v_;
};

// A single number as it is, rounded. Of a b + c d the compiler fuses one of the products with the sum, which is then
// another one for who has c d + a b: the other end of a pair. Rounded both, the sum is the same. Doubles are passed on
// as they are, fused or not.
inline double rounded(double a) { return a; }
[[gnu::always_inline]] inline real rounded(const real& a) { return a; }
[[gnu::always_inline]] inline single rounded(const single& a) {
  // No instruction, but what the compiler does not look into: __builtin_assoc_barrier takes registers apart. Elsewhere
  // nothing is fused.
#if defined(__AVX512F__)
  auto v = static_cast<__m512>(a.all());
  asm("" : "+v"(v));
  return single(single::lanes_type(v));
#elif defined(__AVX__)
  auto v = static_cast<__m256>(a.all());
  asm("" : "+x"(v));
  return single(single::lanes_type(v));
#elif defined(__aarch64__)
  auto v = static_cast<float32x4_t>(a.all());
  asm("" : "+w"(v));
  return single(single::lanes_type(v));
#else
  return a;
#endif
}

// Lanes of the mask from a, others from b.
template <class T, class Abi>
[[gnu::always_inline]] inline stdx::simd<T, Abi> select(const stdx::simd_mask<T, Abi>& mask,
                                                        const std::type_identity_t<stdx::simd<T, Abi>>& a,
                                                        const std::type_identity_t<stdx::simd<T, Abi>>& b) {
  stdx::simd<T, Abi> c = b;
  where(mask, c) = a;
  return c;
}
[[gnu::always_inline]] inline single select(const single::mask_type& mask, const single& a, const single& b) {
  single::lanes_type c = b.all();
  where(mask, c) = a.all();
  return single(c);
}

// Bit n: lane n of the mask.
template <class T, class Abi>
std::uint32_t bits_of(const stdx::simd_mask<T, Abi>& mask) {
  std::uint32_t bits = 0;
  for (std::size_t lane = 0; lane < mask.size(); ++lane) bits |= (mask[lane] ? 1U : 0U) << lane;
  return bits;
}

// What guards a division by what may vanish; R holds its inverse too.
template <class R>
inline constexpr double tiny = std::is_same_v<R, single> ? 1e-30 : 1e-200;

// Whether R is a register of n doubles, or of n single numbers, for which there are the processor's own instructions.
template <class R, std::size_t n>
inline constexpr bool is_register = std::is_same_v<R, real>&& R::size() == n;
template <class R, std::size_t n>
inline constexpr bool is_single = std::is_same_v<R, single>&& R::size() == n;

#if defined(__AVX2__)
namespace detail {
// All bits of lane n where bit n is set: of four doubles, of eight single numbers.
inline __m256i lanes_of(std::uint32_t bits) {
  const __m256i lane = _mm256_setr_epi64x(1, 2, 4, 8), all = _mm256_set1_epi64x(static_cast<long long>(bits));
  return _mm256_cmpeq_epi64(_mm256_and_si256(all, lane), lane);
}
inline __m256i single_lanes_of(std::uint32_t bits) {
  const __m256i lane = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128), all = _mm256_set1_epi32(static_cast<int>(bits));
  return _mm256_cmpeq_epi32(_mm256_and_si256(all, lane), lane);
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
inline double lesser(double a, double b) { return a < b ? a : b; }
template <class R>
[[gnu::always_inline]] inline R greater(const R& a, const R& b) {
#if defined(__AVX512F__)
  if constexpr (is_single<R, 16>)
    return R(typename R::lanes_type(_mm512_max_ps(static_cast<__m512>(a.all()), static_cast<__m512>(b.all()))));
  if constexpr (is_register<R, 8>) return R(_mm512_max_pd(static_cast<__m512d>(a), static_cast<__m512d>(b)));
#endif
#if defined(__AVX__)
  if constexpr (is_register<R, 4>) return R(_mm256_max_pd(static_cast<__m256d>(a), static_cast<__m256d>(b)));
  if constexpr (is_single<R, 8>)
    return R(typename R::lanes_type(_mm256_max_ps(static_cast<__m256>(a.all()), static_cast<__m256>(b.all()))));
#endif
  return select(b < a, a, b);
}
template <class R>
[[gnu::always_inline]] inline R lesser(const R& a, const R& b) {
#if defined(__AVX512F__)
  if constexpr (is_register<R, 8>) return R(_mm512_min_pd(static_cast<__m512d>(a), static_cast<__m512d>(b)));
#endif
#if defined(__AVX__)
  if constexpr (is_register<R, 4>) return R(_mm256_min_pd(static_cast<__m256d>(a), static_cast<__m256d>(b)));
#endif
  return select(a < b, a, b);
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

// A `single` holds the same particles twice, beside two neighbours: its lower half those with the one, its upper half
// those with the other. Doubles as single numbers, in both halves:
[[gnu::always_inline]] inline single duplicate_halves(const real& a) {
#if defined(__AVX512F__)
  if constexpr (is_single<single, 16>) {
    const __m512 low = _mm512_castps256_ps512(_mm512_cvtpd_ps(static_cast<__m512d>(a)));
    return single(single::lanes_type(_mm512_shuffle_f32x4(low, low, 0x44)));
  }
#elif defined(__AVX__)
  if constexpr (is_single<single, 8>) {
    const __m128 low = _mm256_cvtpd_ps(static_cast<__m256d>(a));
    return single(single::lanes_type(_mm256_set_m128(low, low)));
  }
#endif
  return single(single::lanes_type([&](auto lane) { return static_cast<float>(a[lane % lanes]); }));
}
[[gnu::always_inline]] inline real lower_half(const single& a) {
#if defined(__AVX512F__)
  if constexpr (is_single<single, 16>)
    return real(_mm512_cvtps_pd(_mm512_castps512_ps256(static_cast<__m512>(a.all()))));
#elif defined(__AVX__)
  if constexpr (is_single<single, 8>)
    return real(_mm256_cvtps_pd(_mm256_castps256_ps128(static_cast<__m256>(a.all()))));
#endif
  return real([&](auto lane) { return static_cast<double>(a[lane]); });
}
[[gnu::always_inline]] inline single halves_exchanged(const single& a) {
#if defined(__AVX512F__)
  if constexpr (is_single<single, 16>) {
    const auto all = static_cast<__m512>(a.all());
    return single(single::lanes_type(_mm512_shuffle_f32x4(all, all, 0x4e)));
  }
#elif defined(__AVX__)
  if constexpr (is_single<single, 8>) {
    const auto all = static_cast<__m256>(a.all());
    return single(single::lanes_type(_mm256_permute2f128_ps(all, all, 1)));
  }
#endif
  return single(single::lanes_type([&](auto lane) { return a[(lane + lanes) % single::size()]; }));
}
// The sum of all lanes, in doubles.
inline double sum(const single& a) { return sum(real(lower_half(a) + lower_half(halves_exchanged(a)))); }
// *low in all lanes of the lower half, *high in those of the upper: loads, and no shuffle.
[[gnu::always_inline]] inline single::lanes_type concatenate(const float* low, const float* high) {
#if defined(__AVX512F__)
  if constexpr (single::size() == 16)
    return single::lanes_type(_mm512_mask_blend_ps(0xff00, _mm512_set1_ps(*low), _mm512_set1_ps(*high)));
#elif defined(__AVX__)
  if constexpr (single::size() == 8)
    return single::lanes_type(_mm256_blend_ps(_mm256_set1_ps(*low), _mm256_set1_ps(*high), 0xf0));
#elif defined(__aarch64__)
  if constexpr (single::size() == 4) return single::lanes_type(vcombine_f32(vld1_dup_f32(low), vld1_dup_f32(high)));
#endif
  return single::lanes_type([&](auto lane) { return lane < lanes ? *low : *high; });
}

// greater(a, b) in lane n where bit n of `bits` is set, `other` elsewhere.
template <class R>
[[gnu::always_inline]] inline R greater_where(std::uint32_t bits, const R& a, const R& b, const R& other) {
#if defined(__AVX512F__)
  if constexpr (is_single<R, 16>)
    return R(typename R::lanes_type(_mm512_mask_max_ps(static_cast<__m512>(other.all()), static_cast<__mmask16>(bits),
                                                       static_cast<__m512>(a.all()), static_cast<__m512>(b.all()))));
  if constexpr (is_register<R, 8>)
    return R(_mm512_mask_max_pd(static_cast<__m512d>(other), static_cast<__mmask8>(bits), static_cast<__m512d>(a),
                                static_cast<__m512d>(b)));
#endif
#if defined(__AVX2__)
  if constexpr (is_register<R, 4>)
    return R(_mm256_blendv_pd(static_cast<__m256d>(other), static_cast<__m256d>(greater(a, b)),
                              _mm256_castsi256_pd(detail::lanes_of(bits))));
  if constexpr (is_single<R, 8>)
    return R(typename R::lanes_type(_mm256_blendv_ps(static_cast<__m256>(other.all()),
                                                     static_cast<__m256>(greater(a, b).all()),
                                                     _mm256_castsi256_ps(detail::single_lanes_of(bits)))));
#endif
#if defined(__aarch64__)
  if constexpr (is_register<R, 2>)
    return R(vbslq_f64(vtstq_u64(vdupq_n_u64(bits), uint64x2_t{1, 2}), static_cast<float64x2_t>(greater(a, b)),
                       static_cast<float64x2_t>(other)));
#endif
  typename R::mask_type mask;
  for (std::size_t lane = 0; lane < R::size(); ++lane) mask[lane] = (bits >> lane & 1U) != 0;
  return select(mask, greater(a, b), other);
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
  if constexpr (is_single<R, 16>) {
    // The next term of the series is below a rounding here.
    const auto x = static_cast<__m512>(r2.all());
    const __m512 y = _mm512_rsqrt14_ps(x), e = _mm512_fnmadd_ps(_mm512_mul_ps(x, y), y, _mm512_set1_ps(1.0F));
    const __m512 inverse = _mm512_fmadd_ps(_mm512_mul_ps(y, e), _mm512_set1_ps(0.5F), y);
    return {R(typename R::lanes_type(_mm512_mul_ps(x, inverse))), R(typename R::lanes_type(inverse))};
  }
#endif
  if constexpr (std::is_same_v<R, single>) {
    const R r(stdx::sqrt(r2.all()));
    return {r, R(1.0 / r)};
  } else {
    const R r = stdx::sqrt(r2);
    return {r, R(1.0 / r)};
  }
}

}  // namespace tetsuame::foundation
