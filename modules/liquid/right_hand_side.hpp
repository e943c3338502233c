// The right-hand side, as a list of stages. A program names its modules:
//
//   volume    how Y and ΔV come about          gradient  the form of the pressure gradient
//   pressure  smoothed or not                  wall      the treatment unless the input says otherwise
//
//   1  halo       the fluid's state beyond the borders
//   2  volume     ρ, ΔV as far as the walls need them
//   3  walls      velocity, temperature, f = ν∇²v + g at the markers; in the same pass over neighbours as f, p of the
//                 fluid that these see, where it is smoothed from Y known beforehand
//   4  volume     Y, p, ΔV = Y/p (the walls' Y on the way), material properties
//   5  walls      pressure of the wall particles
//   6  gradient   one pass: pressure force, continuity, viscosity, conduction
//   7  rates      dT/dt, and what the state carries of the volume
#pragma once

#include <diffusion/conduction.hpp>
#include <diffusion/viscosity.hpp>
#include <foundation/threads.hpp>
#include <gradient/continuity.hpp>
#include <run/lists.hpp>
#include <span>
#include <volume/shape.hpp>

namespace tetsuame::liquid {

// Where dy/dt goes: an array a component of the state.
template <int D>
struct rates {
  std::array<double*, D> dx, dv;
  double* dT;
  double* du;                   // of the internal energy gained: compression, friction, conduction
  double* volume = nullptr;     // dρ/dt or dY/dt; null where nothing is carried
  double* friction = nullptr;   // W/kg; null where nobody asks
  double* conducted = nullptr;  // W, an array for conduction apart from friction; null where nobody asks

  // Sums that stage 7 turns into rates wait where it puts the velocities.
  double* dlnrho() const { return dx[0]; }  // 1/s
  double* heat() const { return dx[1]; }    // W, dissipation, and conduction unless it is asked for apart

  rates() = default;
  // x, v, T, u, and ρ or Y where it is carried.
  explicit rates(std::span<double* const> rate) {
    std::size_t n = 0;
    for (auto& component : dx) component = rate[n++];
    for (auto& component : dv) component = rate[n++];
    dT = rate[n++];
    du = rate[n++];
    volume = n < rate.size() ? rate[n] : nullptr;
  }
};

// The state sets out to the ghosts; it is there after w.end_fluid().
template <volume::carries carried, int D>
void begin_halo(run::state<D>& box) {
  auto& w = box.w;
  auto& s = w.s;
  const foundation::stage timed(w.times, "halo");
  std::array<double*, D + 3> fields;
  std::size_t n = 0;
  for (auto& component : s.v) fields[n++] = component.data();
  fields[n++] = s.T.data();
  if constexpr (carried == volume::carries::density) fields[n++] = s.rho.data();
  if constexpr (carried == volume::carries::weight) fields[n++] = s.Y.data();
  domain::begin_exchange<D>(w.d.ranks, w.d.fluid_halo, std::span<double* const>(fields.data(), n), &s.x);
}

// Stage 6. Forces (N) and the pressure's work (W) stand where their rates will: dv and du. First what walls push,
// then the sums over neighbours, of some rows at a time.
template <int D>
void begin_forces(run::state<D>& box, const rates<D>& out) {
  auto& w = box.w;
  auto& s = w.s;
  const foundation::stage timed(w.times, "gradient");
  foundation::for_all(s.fluid, [&](std::size_t i) {
    for (std::size_t a = 0; a < D; ++a) out.dv[a][i] = 0.0;
    out.du[i] = out.heat()[i] = 0.0;
    if (out.conducted) out.conducted[i] = 0.0;
  });
  std::visit([&](auto t) { t.template push<D>(w, box.walls, out.dv); }, box.treatment);
}

template <class Gradient, int D>
void sum_forces(run::state<D>& box, const rates<D>& out, const pairs::row_range& rows) {
  auto& w = box.w;
  auto& s = w.s;
  const foundation::stage timed(w.times, "gradient");
  const auto v = pairs::pointers<D>(s.v);
  const typename Gradient::template term<D> pressure{v, s.p.data(), s.dV.data(), {out.dv, out.du}};
  const gradient::continuity<D> continuity{v, s.dV.data(), out.dlnrho()};
  if (w.uniform_transport)  // one viscosity, no conduction: a third less to do a pair
    w.sum(rows, pressure, continuity,
          diffusion::uniform_viscosity<D>{v, *w.uniform_transport, s.dV.data(), out.dv, out.heat()});
  else
    w.sum(rows, pressure, continuity, diffusion::viscosity<D>{v, s.eta.data(), s.dV.data(), out.dv, out.heat()},
          diffusion::conduction<D>{s.T.data(), s.k.data(), s.dV.data(), out.conducted ? out.conducted : out.heat()});
}

// Stage 7: the forces become accelerations, Dv/Dt = F/m + g, and
//   ρ c_V DT/Dt = ∇·(k∇T) - α K_T T ∇·v + Φ  [S2], with ∇·v = -D ln ρ/Dt.
template <class Program, int D>
void finish_rates(run::state<D>& box, const rates<D>& out) {
  using volume::carries;
  auto& w = box.w;
  auto& s = w.s;
  const foundation::stage timed(w.times, "rates");
#pragma omp parallel for schedule(static) if (s.fluid > foundation::values_worth_threads)
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const double per_mass = 1.0 / s.m[i], dlnrho = out.dlnrho()[i], friction = out.heat()[i] * per_mass;
    const double heating = out.conducted ? friction + out.conducted[i] * per_mass : friction;
    for (std::size_t a = 0; a < D; ++a) {
      out.dx[a][i] = s.v[a][i];
      out.dv[a][i] = out.dv[a][i] * per_mass + w.g[a];
    }
    const double power = out.du[i] * per_mass;
    if (out.friction) out.friction[i] = friction;
    out.dT[i] = (heating + s.alpha[i] * s.K_T[i] * s.T[i] / s.rho[i] * dlnrho) / s.c_V[i];
    out.du[i] = power + heating;
    if constexpr (Program::volume::carried == carries::density) out.volume[i] = s.rho[i] * dlnrho;
    if constexpr (Program::volume::carried == carries::weight)
      out.volume[i] = Program::volume::rate(s.p[i], s.K_T[i], s.alpha[i], s.dV[i], s.m[i], power, out.dT[i]);
  }
}

// One evaluation of dy/dt at the state in the particle arrays: x, v, T, and ρ or Y where it is carried. A fault that no
// agreement has thrown yet, on every rank alike, stands in the workspace.
template <class Program, int D>
void evaluate(run::state<D>& box, typename Program::volume& how, const volume::smoothing_options& smoothing,
              const rates<D>& out) {
  auto& w = box.w;
  const volume::wall_context<D> around{box.treatment, box.walls, smoothing};

  using volume_module = typename Program::volume;
  using pressure = typename Program::pressure;
  const auto in_stage = [&](const char* name, const auto& f) {
    const foundation::stage timed(w.times, name);
    f();
  };
  const auto arrive = [&] {
    w.end_fluid();
    std::visit([&](auto t) { t.places(w, box.walls); }, box.treatment);
  };
  const auto wall_pressures = [&] { std::visit([&](auto t) { t.pressures(w, box.walls); }, box.treatment); };

  begin_halo<volume_module::carried>(box);
  if constexpr (volume::works_ahead<volume_module>) {
    // Twice a rank sums over the rows that need no ghosts while these travel. Ranks agree on a fault once, at the end:
    // until then numbers may be not finite.
    in_stage("volume", [&] { how.ahead(w); });
    in_stage("pressure", [&] { pressure::sum_apart(w, around, true); });
    in_stage("halo", arrive);
    in_stage("volume", [&] { how.with_ghosts(w); });
    in_stage("walls", [&] { pressure::with_kinematics(w, around); });
    ++w.first_fault.stage;
    in_stage("pressure", [&] {
      around.weights(w);
      pressure::sum_apart(w, around, false);
      pressure::add_walls(w, around);
      pressure::begin(w);
    });
    begin_forces(box, out);
    sum_forces<typename Program::gradient>(box, out, w.interior());
    in_stage("pressure", [&] { pressure::end(w); });
    in_stage("walls", wall_pressures);
    sum_forces<typename Program::gradient>(box, out, w.at_border());
  } else {
    in_stage("halo", arrive);
    in_stage("volume", [&] { how.before_walls(w, around); });
    w.agree();
    in_stage("walls", [&] { std::visit([&](auto t) { t.kinematics(w, box.walls); }, box.treatment); });
    in_stage("pressure", [&] { how.template determine<pressure>(w, around); });
    w.agree();
    in_stage("walls", wall_pressures);
    begin_forces(box, out);
    sum_forces<typename Program::gradient>(box, out, w.fluid());
  }
  finish_rates<Program>(box, out);
}

}  // namespace tetsuame::liquid
