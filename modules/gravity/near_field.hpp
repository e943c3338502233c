// Sums over pairs of particles: sources one after the other, targets in lanes, so that the sum for a target has the
// same bits in whatever lane it stands.
#pragma once

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

// Registers of targets that start at the particle `first`, and what they have found: Σ m force · (vector to the source)
// and Σ m potential (softening.hpp).
template <int D, std::size_t registers>
struct target_registers {
  using real = foundation::real;
  static constexpr std::size_t width = registers * foundation::lanes;

  std::array<foundation::vec<real, D>, registers> x, pull;
  std::array<real, registers> inverse_support, potential;
  std::size_t first;

  target_registers(const source_arrays<D>& all, std::size_t begin) : first(begin) {
    for (std::size_t t = 0; t < registers; ++t) {
      const std::size_t k = begin + t * foundation::lanes;
      x[t] = foundation::vec<real, D>::of([&](std::size_t a) { return load(all.x[a] + k); });
      inverse_support[t] = load(all.inverse_support + k);
      pull[t] = foundation::zero<real, D>();
      potential[t] = 0.0;
    }
  }

  // Adds the sources [from, to), which are all other particles than the targets, unless `among` says that targets may
  // be among them. soft: within supports.
  template <bool soft, bool among = false>
  [[gnu::always_inline]] void add(const source_arrays<D>& all, std::size_t from, std::size_t to) {
    for (std::size_t j = from; j < to; ++j) {
      const auto source = foundation::vec<real, D>::of([&](std::size_t a) { return all.x[a][j]; });
      const real mass = all.mass[j], h = all.inverse_support[j];
      foundation::for_each_of<registers>([&](std::size_t t) {
        const auto d = source - x[t];
        const real r2 = dot(d, d);
        pair_field<real> one;
        if constexpr (soft)
          one = soft_field<D, real>(r2, foundation::lesser(h, inverse_support[t]));
        else
          one = point_field<D, real>(r2);
        real m = mass;
        if constexpr (among) m = foundation::select(target_numbers(t) == real(static_cast<double>(j)), real(0.0), mass);
        pull[t] += (m * one.force) * d;
        potential[t] += m * one.potential;
      });
    }
  }

 private:
  static real load(const double* from) { return real(from, foundation::stdx::element_aligned); }
  real target_numbers(std::size_t t) const {
    return real([&](auto lane) { return static_cast<double>(first + t * foundation::lanes + lane); });
  }
};

}  // namespace tetsuame::gravity
