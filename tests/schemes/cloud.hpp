// Particles without order: no box and no lists of a run, every particle lists all others.
#pragma once

#include <kernels/kernel.hpp>
#include <particles/storage.hpp>
#include <random>
#include <schemes/density_based.hpp>
#include <schemes/gradients.hpp>
#include <schemes/reproducing.hpp>

namespace tetsuame {

inline constexpr double adiabatic = 1.4;
using array = particles::array;

template <int D>
struct cloud : particles::particles<D>, schemes::arrays<D> {
  std::size_t n;
  cells::neighbour_list list;

  explicit cloud(std::size_t count_) : schemes::arrays<D>(*this, {true, true, true, true}), n(count_) {
    particles::allocate(*this, n, 0, 0, 0);
    std::fill(this->gamma.begin(), this->gamma.end(), adiabatic);
    see_all(1);
  }
  // Each sees all others, in so many sequences.
  void see_all(std::size_t interleave) {
    list.interleave = interleave;
    cells::make_rows(list, (n + pairs::lanes - 1) / pairs::lanes, [&](std::size_t r, auto& made) {
      cells::row_of_clusters row;
      for (std::size_t j = 0; j < n; ++j)
        row.add(j % interleave, static_cast<std::uint32_t>(j),
                ((1U << pairs::lanes) - 1U) & ~(j / pairs::lanes == r ? 1U << j % pairs::lanes : 0U));
      row.write(interleave, made);
      return n * n;
    });
  }

  schemes::fields<D> fields() { return {*this, *this}; }

  void sum(const auto& term) {
    pairs::sum_over<D>(pairs::row_range{0, n, 0, n}, list, pairs::pointers<D>(this->x), schemes::distances_only{1e-9},
                       term);
  }
  void sum_single(const auto& term) {
    pairs::sum_in<D>(pairs::unit<pairs::single>(1.0), pairs::row_range{0, n, 0, n}, list, pairs::pointers<D>(this->x),
                     schemes::distances_only{1e-9}, term);
  }
  template <class Kernel>
  void find_densities(const Kernel& unit) {
    sum(schemes::density<D, Kernel>{unit, fields()});
  }
  template <class Kernel>
  void find_gradients(const Kernel& unit) {
    sum(schemes::gradients<D, Kernel>{unit, fields(), this->p});
  }
  template <class Kernel>
  void find_corrections(const Kernel& unit) {
    sum(schemes::reproducing<D, Kernel>{unit, fields()});
  }
};

// `count` particles without order in a box of edge 1, with jumps of mass, energy and support by factors.
template <int D>
cloud<D> disorder(std::uint32_t seed, std::size_t count = 60) {
  cloud<D> g(count);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (std::size_t i = 0; i < g.n; ++i) {
    for (std::size_t a = 0; a < D; ++a) {
      g.x[a][i] = uniform(random);
      g.v[a][i] = 2.0 * uniform(random) - 1.0;
    }
    g.m[i] = uniform(random) < 0.5 ? 1.0 : 0.1 + uniform(random);
    g.u[i] = 0.2 + 5.0 * uniform(random);
    g.S[i] = 0.2 + 0.4 * uniform(random);
  }
  return g;
}

enum class weigh { mass, energy };

// Densities, state, gradients as in a run (gas/flow.hpp).
template <int D, class Kernel>
void prepare(cloud<D>& g, const Kernel& unit, weigh by, bool own_pressure, bool number) {
  for (std::size_t i = 0; i < g.n; ++i) g.weight[i] = by == weigh::energy ? g.m[i] * g.u[i] : g.m[i];
  g.find_densities(unit);
  for (std::size_t i = 0; i < g.n; ++i) {
    g.rho[i] = by == weigh::energy ? g.y[i] / g.u[i] : g.y[i];
    g.p[i] = (adiabatic - 1.0) * g.rho[i] * g.u[i];
    g.c[i] = std::sqrt(adiabatic * g.p[i] / g.rho[i]);
    g.slope[i] = (number ? 1.0 : g.f[i]) * (own_pressure ? g.p[i] : 1.0) / (g.y[i] * g.y[i]);
    g.correction[i] = number ? g.z[i] : 0.0;
    g.per_S[i] = 1.0 / g.S[i];
    g.dissipation[i] = own_pressure ? 1.0 : 0.1 + 0.9 * static_cast<double>(i % 7) / 6.0;
    g.dV[i] = 1.0 / g.number[i];
  }
  g.find_gradients(unit);
}

// As a run of the schemes of Σ m W with other gradients: V = m/ρ, C and g.
template <int D, class Kernel>
void prepare_density_based(cloud<D>& g, const Kernel& unit, bool supports_vary = true) {
  prepare(g, unit, weigh::mass, true, false);
  for (std::size_t i = 0; i < g.n; ++i) g.dV[i] = g.m[i] / g.rho[i];
  g.sum(schemes::integral<D, Kernel>{unit, g.fields()});
  g.sum(schemes::geometric_factor<D, Kernel>{unit, g.fields(), supports_vary});
}

// f(term, name) of each of these schemes.
template <int D, class Kernel>
void for_each_density_based(cloud<D>& g, const Kernel& unit, double conductivity, const auto& f) {
  const auto all = g.fields();
  f(schemes::density_based<D, Kernel, false, false>{{unit, all}, conductivity}, "ssph");
  f(schemes::density_based<D, Kernel, false, true>{{unit, all}, conductivity}, "ssph by an integral");
  f(schemes::density_based<D, Kernel, true, false>{{unit, all}, conductivity}, "gdf");
  f(schemes::density_based<D, Kernel, true, true>{{unit, all}, conductivity}, "gdf by an integral");
}

}  // namespace tetsuame
