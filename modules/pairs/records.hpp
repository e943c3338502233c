// What a sum reads of its neighbours, packed: the position and the fields all terms of one
// call ask for stand in one record a particle, so that a neighbour costs a cache line or two
// instead of one for each array. Every lane gets the neighbour's values; the records of a cluster's members are turned
// into lanes.
//
// A term says what it reads with tags, and finds it in the pair by them:
//   auto reads() const { return std::tuple{read(of_velocity, v), read(of_volume, dV)}; }
//   … ij(of_volume) …
// Terms that read the same field share its place in the record: the tag decides.
#pragma once

#include <array>
#include <cells/neighbour_list.hpp>
#include <cstddef>
#include <cstdint>
#include <foundation/lanes.hpp>
#include <foundation/threads.hpp>
#include <foundation/vec.hpp>
#include <particles/particles.hpp>
#include <tuple>
#include <type_traits>
#include <utility>

namespace tetsuame::pairs {

namespace stdx = std::experimental;
using foundation::lanes, foundation::real, foundation::vec;

struct velocity_tag {};
struct volume_tag {};
struct pressure_tag {};
struct weight_tag {};
struct viscosity_tag {};
struct temperature_tag {};
struct conductivity_tag {};
inline constexpr velocity_tag of_velocity;
inline constexpr volume_tag of_volume;
inline constexpr pressure_tag of_pressure;
inline constexpr weight_tag of_weight;
inline constexpr viscosity_tag of_viscosity;
inline constexpr temperature_tag of_temperature;
inline constexpr conductivity_tag of_conductivity;

// A field of N components that a term reads: a number, or a vector (in 1-D too, where N = 1).
template <class Tag, std::size_t N, bool Vector>
struct field_read {
  using tag = Tag;
  static constexpr std::size_t components = N;
  static constexpr bool is_vector = Vector;
  std::array<const double*, N> from;
};

template <class Tag>
field_read<Tag, 1, false> read(Tag, const double* a) {
  return {{a}};
}
template <class Tag, std::size_t N>
field_read<Tag, N, true> read(Tag, const std::array<const double*, N>& a) {
  return {a};
}

// The reads of a term, none if it does not say.
template <class Term>
auto reads_of(const Term& term) {
  if constexpr (requires { term.reads(); })
    return term.reads();
  else
    return std::tuple<>{};
}

namespace detail {

template <class Tag, class... Reads>
constexpr bool has_tag = (std::is_same_v<Tag, typename Reads::tag> || ...);

// Each tag once, in the order of its first appearance.
template <class... Kept>
auto unique_reads(std::tuple<Kept...> kept) {
  return kept;
}
template <class... Kept, class Next, class... Rest>
auto unique_reads(std::tuple<Kept...> kept, Next next, Rest... rest) {
  if constexpr (has_tag<typename Next::tag, Kept...>)
    return unique_reads(kept, rest...);
  else
    return unique_reads(std::tuple_cat(kept, std::tuple{next}), rest...);
}

}  // namespace detail

// Where each field stands in a record of doubles: position first, then the reads in order,
// the length rounded up to whole registers of four.
template <int D, class... Reads>
struct layout {
  static constexpr std::size_t used = D + (std::size_t{0} + ... + Reads::components);
  static constexpr std::size_t size = (used + 3) / 4 * 4;

  template <class Tag>
  static constexpr std::size_t place() {
    std::size_t at = D;
    bool found = false;
    ((found = found || std::is_same_v<Tag, typename Reads::tag>, at += found ? 0 : Reads::components), ...);
    return at;
  }
  template <class Tag>
  static constexpr std::size_t components() {
    return (std::size_t{0} + ... + (std::is_same_v<Tag, typename Reads::tag> ? Reads::components : 0));
  }
  template <class Tag>
  static constexpr bool is_vector() {
    return ((std::is_same_v<Tag, typename Reads::tag> && Reads::is_vector) || ...);
  }
};

template <int D, class... Reads>
layout<D, Reads...> layout_of(const std::tuple<Reads...>&) {
  return {};
}

// Fills the records of the given particles, in ascending order; there is room for a cluster behind the last.
template <int D, class... Reads, class Particles>
void pack(const std::array<const double*, D>& x, const std::tuple<Reads...>& reads, const Particles& chosen,
          const cells::neighbour_list& list) {
  using form = layout<D, Reads...>;
  std::array<const double*, form::size> source{};
  std::size_t k = 0;
  for (const double* a : x) source[k++] = a;
  std::apply(
      [&](const auto&... r) {
        ((std::copy(r.from.begin(), r.from.end(), source.begin() + k), k += r.from.size()), ...);
      },
      reads);
  for (; k < form::size; ++k) source[k] = x[0];  // fills up the last register; never looked at
  const std::size_t n = chosen.size(), room = (n > 0 ? chosen[n - 1] + lanes : 0) * form::size;
  if (list.records.size() < room) list.records.resize(room);
  double* out = list.records.data();
#pragma omp parallel for schedule(static) if (n > foundation::values_worth_threads)
  for (std::size_t r = 0; r < n; ++r) {
    const std::size_t i = chosen[r];
    for (std::size_t c = 0; c < form::size; ++c) out[i * form::size + c] = source[c][i];
  }
}

namespace detail {

#if defined(__AVX__)
struct real_4 {
  __m256d v;
};

// Four records' registers of four components each, turned: rows of one component.
inline std::array<real_4, 4> turn(const double* r0, const double* r1, const double* r2, const double* r3) {
  const __m256d a = _mm256_load_pd(r0), b = _mm256_load_pd(r1), c = _mm256_load_pd(r2), d = _mm256_load_pd(r3);
  const __m256d ab_low = _mm256_unpacklo_pd(a, b), ab_high = _mm256_unpackhi_pd(a, b);
  const __m256d cd_low = _mm256_unpacklo_pd(c, d), cd_high = _mm256_unpackhi_pd(c, d);
  return {{{_mm256_permute2f128_pd(ab_low, cd_low, 0x20)},
           {_mm256_permute2f128_pd(ab_high, cd_high, 0x20)},
           {_mm256_permute2f128_pd(ab_low, cd_low, 0x31)},
           {_mm256_permute2f128_pd(ab_high, cd_high, 0x31)}}};
}
#endif

#if defined(__AVX512F__)
struct real_8 {
  __m512d v;
};

// The same of eight records. Two records loaded into one register need no shuffle for it; which two: so that
// the lanes end in order.
inline std::array<real_8, 4> turn(const std::array<const double*, 8>& r) {
  const auto two = [](const double* low, const double* high) {
    return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_load_pd(low)), _mm256_load_pd(high), 1);
  };
  const __m512d a = two(r[0], r[2]), b = two(r[1], r[3]), c = two(r[4], r[6]), d = two(r[5], r[7]);
  const __m512d ab_low = _mm512_unpacklo_pd(a, b), ab_high = _mm512_unpackhi_pd(a, b);
  const __m512d cd_low = _mm512_unpacklo_pd(c, d), cd_high = _mm512_unpackhi_pd(c, d);
  return {{{_mm512_shuffle_f64x2(ab_low, cd_low, 0x88)},
           {_mm512_shuffle_f64x2(ab_high, cd_high, 0x88)},
           {_mm512_shuffle_f64x2(ab_low, cd_low, 0xdd)},
           {_mm512_shuffle_f64x2(ab_high, cd_high, 0xdd)}}};
}
#endif

// values[c] = component c of `lanes` records, the first one at records + place[0], and so on.
template <class R, std::size_t Size>
inline void load(const double* records, const std::uint32_t* place, std::array<R, Size>& values) {
  const auto record = [&](std::size_t lane) { return records + place[lane]; };
#if defined(__AVX__)
  if constexpr (R::size() == 4) {
    for (std::size_t c = 0; c < Size; c += 4) {
      const auto t = turn(record(0) + c, record(1) + c, record(2) + c, record(3) + c);
      for (std::size_t k = 0; k < 4; ++k) values[c + k] = R(t[k].v);
    }
    return;
  }
#endif
#if defined(__AVX512F__)
  if constexpr (R::size() == 8) {
    for (std::size_t c = 0; c < Size; c += 4) {
      const auto t = turn({record(0) + c, record(1) + c, record(2) + c, record(3) + c, record(4) + c, record(5) + c,
                           record(6) + c, record(7) + c});
      for (std::size_t k = 0; k < 4; ++k) values[c + k] = R(t[k].v);
    }
    return;
  }
#endif
  for (std::size_t c = 0; c < Size; ++c) values[c] = R([&](auto lane) { return record(lane)[c]; });
}

// Of records that follow each other.
template <class R, std::size_t Size>
inline void load_own(const double* records, std::array<R, Size>& values) {
  std::array<std::uint32_t, R::size()> place;
  for (std::size_t lane = 0; lane < place.size(); ++lane) place[lane] = static_cast<std::uint32_t>(lane * Size);
  load(records, place.data(), values);
}

}  // namespace detail

}  // namespace tetsuame::pairs
