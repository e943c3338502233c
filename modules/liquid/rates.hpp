// What the sums for liquids leave, and the rates that follow from them:
//   Dv/Dt = F/m + g + K,   ρ c_V DT/Dt = ∇·(k∇T) - α K_T T ∇·v + Φ + ρ J  [S2], with ∇·v = -D ln ρ/Dt
#pragma once

#include <diffusion/conduction.hpp>
#include <diffusion/viscosity.hpp>
#include <foundation/threads.hpp>
#include <gradient/continuity.hpp>
#include <run/lists.hpp>
#include <span>
#include <volume/shape.hpp>

namespace tetsuame::liquid {

// Where dy/dt goes: an array a component of the state. Until the rates are found forces (N) stand in dv, the power of
// pressure (W) in du.
template <int D>
struct rates {
  std::array<double*, D> dx, dv;
  double* dT;
  double* du;                   // of the internal energy gained: compression, friction, conduction, sources
  double* volume = nullptr;     // dρ/dt or dY/dt; null where nothing is carried
  double* friction = nullptr;   // W/kg; null where nobody asks
  double* conducted = nullptr;  // W, an array for conduction apart from friction; null where nobody asks
  double* heat = nullptr;       // W, dissipation, and conduction unless it is asked for apart
  double* dlnrho = nullptr;     // 1/s
};

// Of x, v, T, u, and ρ or Y where it is carried, in this order. dT: where T's rate goes, if T is not among them.
template <int D>
rates<D> rates_in_order(std::span<double* const> rate, double* dT = nullptr) {
  rates<D> all;
  std::size_t n = 0;
  for (auto& component : all.dx) component = rate[n++];
  for (auto& component : all.dv) component = rate[n++];
  all.dT = dT != nullptr ? dT : rate[n++];
  all.du = rate[n++];
  all.volume = n < rate.size() ? rate[n] : nullptr;
  return all;
}

// Forces and heat from nothing, and what walls push.
template <int D>
void begin_forces(run::state<D>& box, const rates<D>& out) {
  auto& w = box.w;
  foundation::for_all(w.s.fluid, [&](std::size_t i) {
    for (std::size_t a = 0; a < D; ++a) out.dv[a][i] = 0.0;
    out.du[i] = out.heat[i] = 0.0;
    if (out.conducted) out.conducted[i] = 0.0;
  });
  std::visit([&](auto t) { t.template push<D>(w, box.walls, out.dv); }, box.treatment);
}

// The continuity whose work a gradient does, where it names one; else that of the notes.
template <class Gradient, int D>
struct continuity_of {
  using type = gradient::continuity<D>;
};
template <class Gradient, int D>
requires requires { typename Gradient::template energy_conserving_continuity<D>; }
struct continuity_of<Gradient, D> {
  using type = typename Gradient::template energy_conserving_continuity<D>;
};

// The sums over the neighbours of these rows: pressure, continuity, viscosity, conduction. symmetric: the viscous
// stress with the transpose of the gradient.
template <class Gradient, int D, class Continuity = gradient::continuity<D>>
void sum_forces(run::state<D>& box, const rates<D>& out, const pairs::row_range& rows, bool symmetric) {
  auto& w = box.w;
  auto& s = w.s;
  const auto v = pairs::pointers<D>(s.v);
  const typename Gradient::template term<D> pressure{v, s.p.data(), s.dV.data(), {out.dv, out.du}};
  Continuity continuity;
  continuity.v = v, continuity.dV = s.dV.data(), continuity.dlnrho = out.dlnrho;
  const diffusion::conduction<D> conduction{s.T.data(), s.k.data(), s.dV.data(),
                                            out.conducted ? out.conducted : out.heat};
  if (symmetric)
    w.sum(rows, pressure, continuity, diffusion::symmetric_viscosity<D>{v, s.eta.data(), s.dV.data(), out.dv, out.heat},
          conduction);
  else if (w.uniform_transport)  // one viscosity, no conduction: a third less to do a pair
    w.sum(rows, pressure, continuity,
          diffusion::uniform_viscosity<D>{v, *w.uniform_transport, s.dV.data(), out.dv, out.heat});
  else
    w.sum(rows, pressure, continuity, diffusion::viscosity<D>{v, s.eta.data(), s.dV.data(), out.dv, out.heat},
          conduction);
}

// The rates of particle i. tied: the volume is (volume/consistency.hpp), and Y has the rate that follows from ρ's.
template <class Volume, int D>
void finish_rates(const pairs::workspace<D>& w, const rates<D>& out, std::size_t i, bool tied = false) {
  using volume::carries;
  const auto& s = w.s;
  const double per_mass = 1.0 / s.m[i], dlnrho = out.dlnrho[i], friction = out.heat[i] * per_mass;
  double heating = out.conducted ? friction + out.conducted[i] * per_mass : friction;
  if (w.heating != nullptr) heating += (*w.heating)[i];
  for (std::size_t a = 0; a < D; ++a) {
    const double gravity = w.gravity(a, i);
    out.dx[a][i] = s.v[a][i];
    out.dv[a][i] = out.dv[a][i] * per_mass + gravity;
  }
  const double power = out.du[i] * per_mass;
  if (out.friction) out.friction[i] = friction;
  out.dT[i] = (heating + s.alpha[i] * s.K_T[i] * s.T[i] / s.rho[i] * dlnrho) / s.c_V[i];
  out.du[i] = power + heating;
  if constexpr (Volume::carried != carries::nothing)
    if (tied) {
      out.volume[i] = Volume::tied_rate(s, i, dlnrho, out.dT[i]);
      return;
    }
  if constexpr (Volume::carried == carries::density) out.volume[i] = s.rho[i] * dlnrho;
  if constexpr (Volume::carried == carries::weight)
    out.volume[i] = Volume::rate(s.p[i], s.K_T[i], s.alpha[i], s.dV[i], s.m[i], power, out.dT[i]);
}

}  // namespace tetsuame::liquid
