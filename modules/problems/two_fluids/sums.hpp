// The sums over neighbours of two fluids, of some rows.
#pragma once

#include <algorithm>
#include <diffusion/conduction.hpp>
#include <elements/exchange.hpp>
#include <two_fluids/supports.hpp>
#include <volume/smoothed.hpp>

namespace tetsuame::two_fluids {

// ΔV = s/Σ W_ij.
template <int D>
void sum_volumes(fluids<D>& f, const pairs::row_range& rows) {
  f.world.w.sum(rows,
                volume::number_volume<D>{volume::self_value(f.world.w), f.world.w.lattice_sum, f.world.w.s.dV.data()});
}

// What the element gains.
template <int D>
void exchange_element(fluids<D>& f, const pairs::row_range& rows) {
  sum(f, rows,
      elements::exchange<D>{f.element.data(), f.partition.data(), f.mobility.data(), f.metal.data(),
                            f.world.w.s.dV.data(), f.gain.data()});
}

// Pressure and viscosity, of the stress that the run chose.
template <int D, bool symmetric>
void sum_forces(fluids<D>& f, const pairs::row_range& rows) {
  auto& s = f.world.w.s;
  forces<D, symmetric> all{
      pairs::pointers<D>(s.v), f.stress.data(),      s.dV.data(),  s.eta.data(), f.viscous.a0, f.viscous.a1,
      f.force.data(),          f.compression.data(), f.heat.data()};
  sum(f, rows, all);
}

// The density's diffusion is δ h times the speed of sound, c/(ζξ), and its sum has 1/c of pressures that are softer by
// ζ².
template <int D>
double diffusion_of_slowed(const fluids<D>& f) {
  return f.o.slowing.zeta / std::min(f.o.slowing.xi_n(0), f.o.slowing.xi_n(1));
}
template <int D>
void sum_density_rate(fluids<D>& f, const pairs::row_range& rows) {
  auto& s = f.world.w.s;
  sum(f, rows,
      density_rate<D>{pairs::pointers<D>(s.v), s.dV.data(), s.p_eos.data(), s.rho.data(), s.c.data(), f.o.gravity,
                      f.o.scheme.delta * f.h * diffusion_of_slowed(f), f.rho_rate.data()});
}
template <int D>
void conduct(fluids<D>& f, const pairs::row_range& rows) {
  auto& s = f.world.w.s;
  std::fill(f.conducted.begin() + static_cast<std::ptrdiff_t>(rows.first),
            f.conducted.begin() + static_cast<std::ptrdiff_t>(rows.last), 0.0);
  sum(f, rows, diffusion::conduction<D>{s.T.data(), s.k.data(), s.dV.data(), f.conducted.data()});
}

}  // namespace tetsuame::two_fluids
