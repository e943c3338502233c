// What a sum reads of its neighbours, packed: the position and the fields all terms of one
// call ask for stand in one record a particle, so that a neighbour costs a cache line or two
// instead of one for each array. Every lane gets the neighbour's values.
//
// A term says what it reads with tags, and finds it in the pair by them:
//   auto reads() const { return std::tuple{read(of_velocity, v), read(of_volume, dV, D)}; }
//   … ij(of_volume) …
// Terms that read the same field share its place in the record: the tag decides.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <foundation/lanes.hpp>
#include <foundation/threads.hpp>
#include <foundation/vec.hpp>
#include <pairs/cluster.hpp>
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

// A field of N components that a term reads: a number, or a vector (in 1-D too, where N = 1), times a factor, in
// m^lengths. Velocities are less that of the frame which the sum is in.
template <class Tag, std::size_t N, bool Vector>
struct field_read {
  using tag = Tag;
  static constexpr std::size_t components = N;
  static constexpr bool is_vector = Vector, is_velocity = std::is_base_of_v<velocity_tag, Tag>;
  std::array<const double*, N> from;
  int lengths;
  double factor;
};

template <class Tag>
field_read<Tag, 1, false> read(Tag, const double* a, int lengths = 0) {
  return {{a}, lengths, 1.0};
}
template <class Tag, std::size_t N>
field_read<Tag, N, true> read(Tag, const std::array<const double*, N>& a, int lengths = 0, double factor = 1.0) {
  return {a, lengths, factor};
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

// Where each field stands in a record: position first, then the reads in order, the length rounded up to four.
template <int D, class... Reads>
struct layout {
  static constexpr int dimension = D;
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

// The records of the neighbours that a register has room for.
template <class R>
struct neighbours;

template <>
struct neighbours<real> {
  static constexpr std::size_t interleave = 1;
  std::array<const double*, interleave> records;
  [[gnu::always_inline]] real operator[](std::size_t k) const { return records[0][k]; }
};
template <>
struct neighbours<single> {
  static constexpr std::size_t interleave = 2;
  std::array<const float*, interleave> records;
  [[gnu::always_inline]] single operator[](std::size_t k) const {
    return single(foundation::concatenate(records[0] + k, records[1] + k));
  }
};

// How positions, in m, stand in records, and what makes x_i - x_j of them.
template <class R>
struct positions;

template <>
struct positions<real> {
  using number = double;
  using own_type = real;

  explicit positions(const unit<real>&) {}
  static double number_of(double x) { return x; }
  static own_type own(const cluster<real>& i, const double* x) { return i(x); }
  [[gnu::always_inline]] static real difference(const own_type& x_i, const neighbours<real>& j, std::size_t at) {
    return x_i - j.records[0][at];
  }
};

// As whole numbers of 2^-28 units, modulo 2^32: differences of neighbours are exact, whatever the size of the domain
// and on whichever side of its origin, so that x_ij = -x_ji to the bit.
template <>
struct positions<single> {
  using number = float;
  using own_type = stdx::native_simd<std::uint32_t>;
  static_assert(own_type::size() == single::size());
  static constexpr int places = 28;
  static constexpr double whole_numbers = 0x1.8p52;  // near it doubles are

  double per_step;  // 1/m

  explicit positions(const unit<single>& lengths) : per_step(lengths.to(-1) * (1 << places)) {}
  // The lower half of a double's digits, once the number is so large that these are whole.
  std::uint32_t steps(double x) const {
    return static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(x * per_step + whole_numbers));
  }
  float number_of(double x) const { return std::bit_cast<float>(steps(x)); }
  own_type own(const cluster<single>& i, const double* x) const {
    const real whole = foundation::load_where<real>(i.mask, x + i.first) * per_step + whole_numbers;
    const auto digits = std::bit_cast<std::array<std::uint64_t, lanes>>(whole);
    return own_type([&](auto lane) { return static_cast<std::uint32_t>(digits[lane % lanes]); });
  }
  [[gnu::always_inline]] static single difference(const own_type& x_i, const neighbours<single>& j, std::size_t at) {
    const auto x_j = std::bit_cast<own_type>(foundation::concatenate(j.records[0] + at, j.records[1] + at));
    const auto steps = stdx::static_simd_cast<stdx::native_simd<std::int32_t>>(x_i - x_j);
    return single(stdx::static_simd_cast<single::lanes_type>(steps) * (1.0F / (1 << places)));
  }
};

// The particles' positions, and the velocity of the frame that a sum is in (m/s): what its terms see of velocities is
// less by so much, that single precision does not lose their digits.
template <int D>
struct places {
  std::array<const double*, D> x;
  std::array<double, D> frame;

  places(const std::array<const double*, D>& all, const std::array<double, D>& moves = {}) : x(all), frame(moves) {}
};

// Where the fields of records come from.
template <class Layout>
struct sources {
  static constexpr std::size_t D = Layout::dimension;
  std::array<const double*, Layout::used> from;
  std::array<int, Layout::used> lengths{};            // powers of m
  std::array<double, Layout::used> factor{}, less{};  // what is taken off before the factor

  template <class... Reads>
  sources(const places<Layout::dimension>& at, const std::tuple<Reads...>& reads) {
    std::size_t k = 0;
    for (const double* a : at.x) from[k++] = a;
    std::apply([&](const auto&... r) { (append(k, at.frame, r), ...); }, reads);
  }

 private:
  template <class Read>
  void append(std::size_t& k, const std::array<double, D>& frame, const Read& r) {
    // Some components alone are asked for beside wall particles, where there is no frame but theirs.
    if constexpr (Read::is_velocity && Read::components == D) std::copy_n(frame.begin(), D, less.begin() + k);
    for (const double* a : r.from) {
      from[k] = a;
      factor[k] = r.factor;
      lengths[k++] = r.lengths;
    }
  }
};

// Fills the records of the given particles, in ascending order.
template <class R, class Layout, class Particles>
void pack(
    const sources<Layout>& fields, const Particles& chosen, const unit<R>& lengths, const positions<R>& place,
    std::vector<typename positions<R>::number, particles::aligned_allocator<typename positions<R>::number>>& records) {
  using number = typename positions<R>::number;
  const std::size_t n = chosen.size(), room = (n > 0 ? chosen[n - 1] + 1 : 0) * Layout::size;
  if (records.size() < room) records.resize(room);
  std::array<double, Layout::used> scale;
  for (std::size_t c = 0; c < scale.size(); ++c) scale[c] = lengths.to(-fields.lengths[c]) * fields.factor[c];
  number* const out = records.data();
  foundation::for_all(n, [&](std::size_t r) {
    const std::size_t i = chosen[r];
    number* const record = out + i * Layout::size;
    for (std::size_t c = 0; c < Layout::dimension; ++c) record[c] = place.number_of(fields.from[c][i]);
    for (std::size_t c = Layout::dimension; c < Layout::used; ++c)
      record[c] = static_cast<number>((fields.from[c][i] - fields.less[c]) * scale[c]);
  });
}

}  // namespace tetsuame::pairs
