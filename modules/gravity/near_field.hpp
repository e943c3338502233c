// Sums over pairs of particles: sources one after the other, targets in lanes, so that the sum for a target has the
// same bits in whatever lane it stands. R: foundation::real, or single for twice as many targets at a time.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <foundation/lanes.hpp>
#include <foundation/vec.hpp>
#include <gravity/softening.hpp>
#include <type_traits>
#include <vector>

namespace tetsuame::gravity {

template <class R>
using scalar_of = std::conditional_t<std::is_same_v<R, foundation::single>, float, double>;

// Sources, of which the first ones are the targets. Lanes may read `room` values beyond the last one.
template <int D, class R>
struct source_list {
  using scalar = scalar_of<R>;
  static constexpr std::size_t room = 16;

  std::array<std::vector<scalar>, D> x;       // from any point near the targets
  std::vector<scalar> mass, inverse_support;  // (softening.hpp)
  std::size_t size = 0;
  std::vector<std::uint32_t> soft, others;  // places in the list, of sum_pairs()

  void reserve(std::size_t n) {
    if (mass.size() >= n + room) return;
    for (auto& one : x) one.resize(2 * (n + room), scalar{});
    for (auto* one : {&mass, &inverse_support}) one->resize(2 * (n + room), scalar{});
  }
};

// Σ m force · (vector to the source) and Σ m potential (softening.hpp) of n targets, n a multiple of a register.
template <int D, std::size_t n>
struct near_sums {
  std::array<std::array<double, n>, D> pull{};
  std::array<double, n> potential{};
};

namespace detail {

template <class R>
[[gnu::always_inline]] inline R load(const scalar_of<R>* from) {
  if constexpr (std::is_same_v<R, foundation::single>)
    return R(typename R::lanes_type(from, foundation::stdx::element_aligned));
  else
    return R(from, foundation::stdx::element_aligned);
}
template <class R>
[[gnu::always_inline]] inline R broadcast(scalar_of<R> value) {
  if constexpr (std::is_same_v<R, foundation::single>)
    return R(typename R::lanes_type(value));
  else
    return R(value);
}
template <class R>
[[gnu::always_inline]] inline void store(const R& values, scalar_of<R>* to) {
  if constexpr (std::is_same_v<R, foundation::single>)
    values.all().copy_to(to, foundation::stdx::element_aligned);
  else
    values.copy_to(to, foundation::stdx::element_aligned);
}
// 0, 1, 2, … from `first` on.
template <class R>
R numbers(std::size_t first) {
  std::array<scalar_of<R>, R::size()> all;
  for (std::size_t lane = 0; lane < all.size(); ++lane) all[lane] = static_cast<scalar_of<R>>(first + lane);
  return load<R>(all.data());
}

template <int D, class R>
struct target_register {
  foundation::vec<R, D> x, pull;
  R inverse_support, potential, number;

  target_register(const source_list<D, R>& all, std::size_t first)
      : x(foundation::vec<R, D>::of([&](std::size_t a) { return load<R>(&all.x[a][first]); })),
        pull(foundation::zero<R, D>()),
        inverse_support(load<R>(&all.inverse_support[first])),
        potential(0.0),
        number(numbers<R>(first)) {}

  // Adds the source j. soft: it may be within supports; among: it may be one of the targets, which is left out.
  template <bool soft, bool among>
  [[gnu::always_inline]] void add(const source_list<D, R>& all, std::size_t j) {
    std::array<R, D> d;
    R r2 = 0.0;
    for (std::size_t a = 0; a < D; ++a) {
      d[a] = broadcast<R>(all.x[a][j]) - x[a];
      r2 += d[a] * d[a];
    }
    R m = broadcast<R>(all.mass[j]);
    if constexpr (among) m = foundation::select(number == R(static_cast<double>(j)), R(0.0), m);
    pair_field<R> one;
    if constexpr (soft)
      one = soft_field<D, R>(r2, foundation::lesser(broadcast<R>(all.inverse_support[j]), inverse_support));
    else
      one = point_field<D, R>(r2);
    const R scaled = m * one.force;
    for (std::size_t a = 0; a < D; ++a) pull[a] += scaled * d[a];
    potential += m * one.potential;
  }
};

template <class R>
void add_to(double* sums, const R& more) {
  for (std::size_t lane = 0; lane < R::size(); ++lane) sums[lane] += static_cast<double>(more[lane]);
}

// The sources source(0), …, source(n - 1) act on the targets [first, first + R::size()).
template <bool soft, bool among, int D, class R, std::size_t n, class Source>
[[gnu::noinline]] void add_sources(const source_list<D, R>& all, std::size_t count, const Source& source,
                                   std::size_t first, near_sums<D, n>& sums) {
  // Sums of single numbers are short, so that their roundings stay those of a few terms.
  constexpr std::size_t chunk = 256;
  for (std::size_t from = 0; from < count; from += chunk) {
    target_register<D, R> t(all, first);
    const std::size_t end = std::min(count, from + chunk);
    for (std::size_t k = from; k < end; ++k) t.template add<soft, among>(all, source(k));
    for (std::size_t a = 0; a < D; ++a) add_to(&sums.pull[a][first], t.pull[a]);
    add_to(&sums.potential[first], t.potential);
  }
}

// Divides the sources [from, to): those that may be within the support of a pair with one of the first `targets`, and
// those that are surely not. The same in lanes of any number.
template <int D, class R>
void sort_by_support(source_list<D, R>& all, std::size_t targets, std::size_t from, std::size_t to) {
  using scalar = scalar_of<R>;
  std::array<scalar, D> low, high;
  for (std::size_t a = 0; a < D; ++a) {
    const auto [least, most] =
        std::minmax_element(all.x[a].begin(), all.x[a].begin() + static_cast<std::ptrdiff_t>(targets));
    low[a] = *least;
    high[a] = *most;
  }
  const scalar least_inverse = *std::min_element(all.inverse_support.begin(),
                                                 all.inverse_support.begin() + static_cast<std::ptrdiff_t>(targets));
  auto &soft = all.soft, &others = all.others;
  soft.resize(to - from + R::size());
  others.resize(to - from + R::size());
  std::size_t near = 0, beyond = 0;
  for (std::size_t j = from; j < to; j += R::size()) {
    R gap2 = 0.0;
    for (std::size_t a = 0; a < D; ++a) {
      const R x = load<R>(&all.x[a][j]), below = broadcast<R>(low[a]) - x, above = x - broadcast<R>(high[a]);
      const R gap = foundation::greater(foundation::greater(below, above), R(0.0));
      gap2 += gap * gap;
    }
    const R h = foundation::lesser(load<R>(&all.inverse_support[j]), broadcast<R>(least_inverse));
    std::array<scalar, R::size()> gaps;  // squared, over the support
    store(R(gap2 * h * h), gaps.data());
    for (std::size_t lane = 0; lane < std::min(R::size(), to - j); ++lane) {
      // With some room for roundings: of a pair beyond its support both sums are the same.
      const std::size_t is_near = gaps[lane] < scalar{1.0001F} ? 1 : 0;
      soft[near] = others[beyond] = static_cast<std::uint32_t>(j + lane);
      near += is_near;
      beyond += 1 - is_near;
    }
  }
  soft.resize(near);
  others.resize(beyond);
}

}  // namespace detail

// Of `targets` first ones of the list; beyond `soft_end` sources are out of supports.
template <int D, class R, std::size_t n>
near_sums<D, n> sum_pairs(source_list<D, R>& all, std::size_t targets, std::size_t soft_end) {
  static_assert(n % R::size() == 0 && R::size() <= source_list<D, R>::room);
  detail::sort_by_support(all, targets, targets, soft_end);
  near_sums<D, n> sums;
  const auto from = [](std::size_t begin) { return [begin](std::size_t k) { return begin + k; }; };
  const auto of = [](const std::vector<std::uint32_t>& some) { return [&some](std::size_t k) { return some[k]; }; };
  for (std::size_t first = 0; first < targets; first += R::size()) {
    detail::add_sources<true, true>(all, targets, from(0), first, sums);
    detail::add_sources<true, false>(all, all.soft.size(), of(all.soft), first, sums);
    detail::add_sources<false, false>(all, all.others.size(), of(all.others), first, sums);
    detail::add_sources<false, false>(all, all.size - soft_end, from(soft_end), first, sums);
  }
  return sums;
}

}  // namespace tetsuame::gravity
