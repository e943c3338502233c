// Sums over pairs of particles: sources one after the other, targets in lanes, so that the sum for a target has the
// same bits in whatever lane it stands.
#pragma once

#include <array>
#include <cstddef>
#include <foundation/lanes.hpp>
#include <foundation/vec.hpp>
#include <gravity/softening.hpp>

namespace tetsuame::gravity {

// Particles in arrays of which lanes may read a register beyond the last one.
template <int D>
struct source_arrays {
  std::array<const double*, D> x;        // m
  const double *mass, *inverse_support;  // kg, 1/m
};

// A register of targets from the particle `first` on, and what they have found: Σ m force · (vector to the source) and
// Σ m potential (softening.hpp).
template <int D>
struct target_register {
  using real = foundation::real;

  foundation::vec<real, D> x, pull;
  real inverse_support, potential;
  std::size_t first;

  void start(const source_arrays<D>& all, std::size_t begin) {
    first = begin;
    for (std::size_t a = 0; a < D; ++a) {
      x[a] = load(all.x[a] + begin);
      pull[a] = 0.0;
    }
    inverse_support = load(all.inverse_support + begin);
    potential = 0.0;
  }

  // Adds the source j. soft: it may be within supports; among: it may be one of the targets, which is left out.
  template <bool soft, bool among>
  [[gnu::always_inline]] void add(const source_arrays<D>& all, std::size_t j) {
    std::array<real, D> d;
    real r2 = 0.0;
    for (std::size_t a = 0; a < D; ++a) {
      d[a] = real(all.x[a][j]) - x[a];
      r2 += d[a] * d[a];
    }
    real m = all.mass[j];
    if constexpr (among) m = foundation::select(numbers() == real(static_cast<double>(j)), real(0.0), m);
    pair_field<real> one;
    if constexpr (soft)
      one = soft_field<D, real>(r2, foundation::lesser(real(all.inverse_support[j]), inverse_support));
    else
      one = point_field<D, real>(r2);
    const real scaled = m * one.force;
    for (std::size_t a = 0; a < D; ++a) pull[a] += scaled * d[a];
    potential += m * one.potential;
  }

 private:
  static real load(const double* from) { return real(from, foundation::stdx::element_aligned); }
  real numbers() const {
    return real([this](auto lane) { return static_cast<double>(first + lane); });
  }
};

// Adds the sources [from, to) to targets in order.
template <bool soft, bool among, int D, std::size_t n>
[[gnu::noinline]] void add_sources(std::array<target_register<D>, n>& targets, const source_arrays<D>& all,
                                   std::size_t from, std::size_t to) {
  auto t = targets;
  for (std::size_t j = from; j < to; ++j)
    for (std::size_t k = 0; k < n; ++k) t[k].template add<soft, among>(all, j);
  targets = t;
}
// Adds groups of sources to targets; span_of(group): {from, to}.
template <bool soft, int D, std::size_t n, class Groups, class Span>
void add_sources(std::array<target_register<D>, n>& targets, const source_arrays<D>& all, const Groups& groups,
                 const Span& span_of) {
  auto t = targets;
  for (const auto group : groups) {
    const auto [from, to] = span_of(group);
    for (std::size_t j = from; j < to; ++j)
      for (std::size_t k = 0; k < n; ++k) t[k].template add<soft, false>(all, j);
  }
  targets = t;
}

}  // namespace tetsuame::gravity
