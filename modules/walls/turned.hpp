// Records as they stand in memory, fours of numbers a particle, and as lanes take them: a register a number.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <foundation/lanes.hpp>

namespace tetsuame::walls::detail {

using foundation::lanes, foundation::real, foundation::single;

// The records of the particles at these places, one a lane.
inline std::array<real, 4> turned(const double* first, const std::uint32_t* place) {
  const auto of = [&](std::size_t lane) { return first + std::size_t{place[lane]} * 4; };
#if defined(__AVX512F__)
  // Two particles loaded into one register need no shuffle for it; which two: so that the lanes end in order.
  const auto two = [&](std::size_t low, std::size_t high) {
    return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_load_pd(of(low))), _mm256_load_pd(of(high)), 1);
  };
  const __m512d a = two(0, 2), b = two(1, 3), c = two(4, 6), d = two(5, 7);
  const __m512d ab_low = _mm512_unpacklo_pd(a, b), ab_high = _mm512_unpackhi_pd(a, b);
  const __m512d cd_low = _mm512_unpacklo_pd(c, d), cd_high = _mm512_unpackhi_pd(c, d);
  return {real(_mm512_shuffle_f64x2(ab_low, cd_low, 0x88)), real(_mm512_shuffle_f64x2(ab_high, cd_high, 0x88)),
          real(_mm512_shuffle_f64x2(ab_low, cd_low, 0xdd)), real(_mm512_shuffle_f64x2(ab_high, cd_high, 0xdd))};
#elif defined(__AVX__)
  const __m256d a = _mm256_load_pd(of(0)), b = _mm256_load_pd(of(1)), c = _mm256_load_pd(of(2)),
                d = _mm256_load_pd(of(3));
  const __m256d ab_low = _mm256_unpacklo_pd(a, b), ab_high = _mm256_unpackhi_pd(a, b);
  const __m256d cd_low = _mm256_unpacklo_pd(c, d), cd_high = _mm256_unpackhi_pd(c, d);
  return {real(_mm256_permute2f128_pd(ab_low, cd_low, 0x20)), real(_mm256_permute2f128_pd(ab_high, cd_high, 0x20)),
          real(_mm256_permute2f128_pd(ab_low, cd_low, 0x31)), real(_mm256_permute2f128_pd(ab_high, cd_high, 0x31))};
#else
  std::array<real, 4> values;
  for (std::size_t c = 0; c < values.size(); ++c) values[c] = real([&](auto lane) { return of(lane)[c]; });
  return values;
#endif
}

// The same of single numbers, twice as many.
inline std::array<single, 4> turned(const float* first, const std::uint32_t* place) {
  const auto of = [&](std::size_t lane) { return first + std::size_t{place[lane]} * 4; };
#if defined(__AVX512F__)
  // Particles n, n + 4, n + 8 and n + 12, in whose 128 bits each the four registers are turned.
  const auto four = [&](std::size_t n) {
    __m512 all = _mm512_castps128_ps512(_mm_load_ps(of(n)));
    all = _mm512_insertf32x4(all, _mm_load_ps(of(n + 4)), 1);
    all = _mm512_insertf32x4(all, _mm_load_ps(of(n + 8)), 2);
    return _mm512_insertf32x4(all, _mm_load_ps(of(n + 12)), 3);
  };
  const __m512 a = four(0), b = four(1), c = four(2), d = four(3);
  const __m512d ab_low = _mm512_castps_pd(_mm512_unpacklo_ps(a, b)),
                ab_high = _mm512_castps_pd(_mm512_unpackhi_ps(a, b)),
                cd_low = _mm512_castps_pd(_mm512_unpacklo_ps(c, d)),
                cd_high = _mm512_castps_pd(_mm512_unpackhi_ps(c, d));
  const auto all = [](const __m512d& v) { return single(single::lanes_type(_mm512_castpd_ps(v))); };
  return {all(_mm512_unpacklo_pd(ab_low, cd_low)), all(_mm512_unpackhi_pd(ab_low, cd_low)),
          all(_mm512_unpacklo_pd(ab_high, cd_high)), all(_mm512_unpackhi_pd(ab_high, cd_high))};
#elif defined(__AVX__)
  const auto two = [&](std::size_t n) { return _mm256_set_m128(_mm_load_ps(of(n + 4)), _mm_load_ps(of(n))); };
  const __m256 a = two(0), b = two(1), c = two(2), d = two(3);
  const __m256d ab_low = _mm256_castps_pd(_mm256_unpacklo_ps(a, b)),
                ab_high = _mm256_castps_pd(_mm256_unpackhi_ps(a, b)),
                cd_low = _mm256_castps_pd(_mm256_unpacklo_ps(c, d)),
                cd_high = _mm256_castps_pd(_mm256_unpackhi_ps(c, d));
  const auto all = [](const __m256d& v) { return single(single::lanes_type(_mm256_castpd_ps(v))); };
  return {all(_mm256_unpacklo_pd(ab_low, cd_low)), all(_mm256_unpackhi_pd(ab_low, cd_low)),
          all(_mm256_unpacklo_pd(ab_high, cd_high)), all(_mm256_unpackhi_pd(ab_high, cd_high))};
#else
  std::array<single, 4> values;
  for (std::size_t c = 0; c < values.size(); ++c)
    values[c] = single(single::lanes_type([&](auto lane) { return of(lane)[c]; }));
  return values;
#endif
}

}  // namespace tetsuame::walls::detail
