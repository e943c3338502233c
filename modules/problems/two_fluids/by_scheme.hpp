// One evaluation of two fluids by the scheme of a program: volumes, pressure, walls, forces are the scheme's; melt and
// dissolved elements as in right_hand_side.hpp.
#pragma once

#include <liquid/scheme.hpp>
#include <two_fluids/right_hand_side.hpp>

namespace tetsuame::two_fluids {

// Where the scheme puts its rates; those that nobody integrates, where nothing reads them.
template <int D>
liquid::rates<D> rates_of_scheme(fluids<D>& f, const places_of_rates<D>& at, std::span<double* const> rate) {
  liquid::rates<D> out;
  for (std::size_t a = 0; a < D; ++a) {
    out.dx[a] = rate[at.x + a];
    out.dv[a] = rate[at.v + a];
  }
  out.du = rate[at.u];
  out.friction = rate[at.q];
  if (f.o.conductivity > 0.0) out.conducted = f.conducted.data();
  if (f.carried || f.weighed) out.volume = rate[at.rho];
  out.dT = f.warms ? rate[at.T] : f.heat.data();
  return out;
}

// u is of compression alone; the heat of friction and conduction stands apart.
template <int D>
void part_heat(fluids<D>& f, const places_of_rates<D>& at, std::span<double* const> rate) {
  const auto& s = f.world.w.s;
  foundation::for_all(s.fluid, [&](std::size_t i) {
    const double conducted = f.o.conductivity > 0.0 ? f.conducted[i] / s.m[i] : 0.0;
    const double heating = rate[at.q][i] + conducted;
    rate[at.u][i] -= heating;
    if (f.enthalpy) rate[at.h][i] = heating;
    if (!f.enthalpy || f.inertia[i] == 1.0) return;
    for (std::size_t a = 0; a < D; ++a) rate[at.v + a][i] /= f.inertia[i];
  });
}

// Nothing dissolved in what stands behind walls takes part.
template <int D>
void exchange_element(fluids<D>& f, const places_of_rates<D>& at, std::span<double* const> rate) {
  auto& s = f.world.w.s;
  find_partition(f);
  if (!f.world.mirrors())
    for (std::size_t i = s.first_wall(); i < s.total(); ++i) {
      f.mobility[i] = f.element()[i] = f.metal[i] = 0.0;
      f.partition[i] = 1.0;
    }
  exchange_element(f, f.world.w.fluid());
  foundation::for_all(s.fluid, [&](std::size_t i) { rate[at.c][i] = f.gain[i] / s.m[i]; });
}

template <int D>
void evaluate(fluids<D>& f, liquid::scheme<D>& scheme, std::span<double* const> rate) {
  auto& w = f.world.w;
  const places_of_rates<D> at(f);
  if (f.enthalpy) {
    scheme.recall_density(f.world);
    volume::equation_of_state(w, w.s.fluid);
    find_phases(f);
  }
  scheme.evaluate(f.world, rates_of_scheme(f, at, rate));
  part_heat(f, at, rate);
  if (f.dissolved) exchange_element(f, at, rate);
  w.agree();
}

}  // namespace tetsuame::two_fluids
