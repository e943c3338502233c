// Silicate that melts, its viscosity and raised inertia, and an element that it exchanges with metal
// (docs/theory/planet_core_formation.md).
#pragma once

#include <elements/exchange.hpp>
#include <gas/world.hpp>

namespace tetsuame::gas {

// By ρ and u, which holds the latent heat.
template <int D>
void find_melt(world<D>& g, std::size_t i) {
  const auto& s = g.w.s;
  g.melt[i] =
      g.melts_by_law(s.material[i]) ? melting::melt_fraction(g.caloric_of(i), g.o.melting, s.rho[i], s.u[i]) : 0.0;
}

// By temperature and melt fraction, with the inertia that follows.
template <int D>
void find_viscosity(world<D>& g, std::size_t i) {
  auto& s = g.w.s;
  const auto& law = g.o.melting;
  const bool varies = law.viscosity_varies();
  const double eta = varies && g.melts_by_law(s.material[i]) ? melting::viscosity(law, s.T[i], g.melt[i])
                                                             : g.viscosity_of(s.material[i]);
  if (varies) s.eta[i] = eta;
  g.inertia[i] = law.inertia(eta);
}

// The kinetic energy of a raised inertia is heat of friction that comes late: what softens gives it off.
template <int D>
void take_up_inertia(world<D>& g) {
  auto& s = g.w.s;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    double v2 = 0.0;
    for (std::size_t a = 0; a < D; ++a) v2 += s.v[a][i] * s.v[a][i];
    if (g.earlier_inertia[i] > 0.0) s.u[i] += 0.5 * (g.earlier_inertia[i] - g.inertia[i]) * v2;
    g.earlier_inertia[i] = g.inertia[i];
  }
}

// Partition coefficient, ρ times diffusivity, material.
template <int D>
void find_partition(world<D>& g, std::size_t i) {
  const auto& s = g.w.s;
  const auto& o = g.o.element;
  const bool metal = g.is_metal(s.material[i]);
  g.metal[i] = metal ? 1.0 : 0.0;
  g.partition[i] = metal ? elements::partition_coefficient(o, s.p[i], s.T[i]) : 1.0;
  g.mobility[i] = s.rho[i] * o.diffusivity(metal);
}

// What the element gains.
template <int D>
void sum_exchange(world<D>& g, const pairs::row_range& rows) {
  const elements::exchange<D> exchange{g.concentration.data(), g.partition.data(), g.mobility.data(),
                                       g.metal.data(),         g.w.s.dV.data(),    g.gain.data()};
  std::visit(
      [&]<class Kernel>(const Kernel& unit) {
        sum(g, rows, schemes::of_mean_kernel<D, Kernel, elements::exchange<D>>{unit, g.fields(), exchange});
      },
      g.unit);
}

// The mean of a pair is at most twice the diffusivity of either end.
template <int D>
double shortest_exchange(const world<D>& g) {  // s, of this rank
  constexpr double any = std::numeric_limits<double>::infinity();
  const double most = 2.0 * std::max(g.o.element.diffusivity_silicate, g.o.element.diffusivity_metal);
  return foundation::smallest_of(g.w.s.fluid, any, [&](std::size_t i) {
    const double spacing = g.S[i] / g.support_over_dx;
    return spacing * spacing / most;
  });
}

}  // namespace tetsuame::gas
