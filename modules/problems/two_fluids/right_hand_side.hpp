// One evaluation of two fluids, term after term; the sums are those of terms.hpp:
//   1. ghosts and images: places, velocities
//   2. ΔV and ρ, the pressure of the equation of state; temperature, melt, partition by them
//   3. the pressure in the forces
//   4. sums over neighbours: pressure and friction, continuity, conduction, exchange
//   5. rates of what is integrated
#pragma once

#include <algorithm>
#include <diffusion/conduction.hpp>
#include <two_fluids/slowing.hpp>
#include <two_fluids/supports.hpp>
#include <volume/smoothed.hpp>

namespace tetsuame::two_fluids {

// Where ghosts are, and how they move, sets out to them; it is there after end_motion().
template <int D>
void begin_halo_exchange(fluids<D>& f) {
  auto& w = f.world.w;
  auto& s = w.s;
  const foundation::stage timed(w.times, "halo");
  std::vector<double*> fields;
  for (auto& v : s.v) fields.push_back(v.data());
  if (f.o.conductivity > 0.0 && !f.enthalpy) fields.push_back(s.T.data());
  domain::begin_exchange<D>(w.d.ranks, w.d.fluid_halo, std::span<double* const>(fields), &s.x);
}

// Images as well.
template <int D>
void end_motion(fluids<D>& f) {
  auto& w = f.world.w;
  auto& s = w.s;
  const foundation::stage timed(w.times, "halo");
  w.end_fluid();
  walls::move_images(f.world.walls, s);
  walls::fill_images(f.world.walls, s, walls::velocity<D>{s.v}, walls::even({&s.T}));
}

// The source's ΔV and ρ, and p + ρ g (y_source - y_image).
template <int D>
void mirror(fluids<D>& f, particles::array& p) {
  auto& s = f.world.w.s;
  walls::fill_images(f.world.walls, s, walls::even({&s.dV, &s.rho}),
                     walls::hydrostatic<D>{p.data(), s.rho.data(), f.world.w.g});
}

// ΔV = s/Σ W_ij of these rows, where volumes come from it.
template <int D>
void count(fluids<D>& f, const pairs::row_range& rows) {
  if (f.carried || f.follows) return;
  const foundation::stage timed(f.world.w.times, "volumes");
  f.world.w.sum(rows,
                volume::number_volume<D>{volume::self_value(f.world.w), f.world.w.lattice_sum, f.world.w.s.dV.data()});
}

// ΔV and ρ of the fluid.
template <int D>
void find_own_volumes(fluids<D>& f) {
  auto& w = f.world.w;
  auto& s = w.s;
  if (f.carried) {
    foundation::for_all(s.fluid, [&](std::size_t i) { s.dV[i] = s.m[i] / s.rho[i]; });
    return;
  }
  const foundation::stage timed(w.times, "volumes");
  if (f.follows) {
    volumes_by_count(f);
    return;
  }
  foundation::for_all(s.fluid, [&](std::size_t i) { s.rho[i] = s.m[i] / s.dV[i]; });
}

// ΔV and ρ, and the pressure of the equation of state, of the fluid, set out to its ghosts.
template <int D>
void begin_volumes(fluids<D>& f) {
  auto& w = f.world.w;
  auto& s = w.s;
  find_own_volumes(f);
  {
    const foundation::stage timed(w.times, "equation of state");
    volume::equation_of_state(w, s.fluid);
    slow_sound(f);
  }
  const foundation::stage timed(w.times, "halo");
  // A ghost's ρ is to have the bits of its source's: ρ itself, or what ΔV gives there too.
  if (f.carried)
    w.begin_fluid({s.dV.data(), s.p_eos.data(), s.rho.data()});
  else if (has_factor(f))
    w.begin_fluid({s.dV.data(), s.p_eos.data(), f.follow_factor.data()});
  else
    w.begin_fluid({s.dV.data(), s.p_eos.data()});
}

// Of ghosts and images.
template <int D>
void end_volumes(fluids<D>& f) {
  auto& w = f.world.w;
  auto& s = w.s;
  const foundation::stage timed(w.times, "halo");
  w.end_fluid();
  if (!f.carried)
    foundation::for_all(s.fluid_ghosts,
                        [&](std::size_t k) { s.rho[s.fluid + k] = s.m[s.fluid + k] / s.dV[s.fluid + k]; });
  mirror(f, s.p_eos);
  if (has_factor(f)) walls::fill_images(f.world.walls, s, walls::even({&f.follow_factor}));
}

// Temperature and melt out of the heat content, at the pressure of the equation of state; viscosity and inertia by
// them.
template <int D>
void find_phases(fluids<D>& f) {
  auto& w = f.world.w;
  auto& s = w.s;
  const auto& law = f.o.melting;
  const foundation::stage timed(w.times, "phases");
  foundation::for_all(s.fluid, [&](std::size_t i) {
    const auto here = contents(f, i, s.p_eos[i]).at(f.content[i]);
    s.T[i] = here.temperature;
    f.melt[i] = f.is_metal(i) || !f.melts ? 0.0 : here.melt_fraction;
    f.inertia[i] = 1.0;
    if (f.is_metal(i)) return;
    if (law.viscosity_law != "constant") s.eta[i] = viscosity_by_melt(law, s.T[i], f.melt[i]);
    if (const double x = law.inertia_viscosity; x > 0.0) f.inertia[i] = std::max(1.0, s.eta[i] / x);
  });
  walls::update_ghosts_and_images(w, f.world.walls, walls::even({&s.T, &s.eta}));
}

// Of fluid, ghosts and images: concentration, partition coefficient, ρ times diffusivity, material.
template <int D>
void find_partition(fluids<D>& f) {
  auto& w = f.world.w;
  auto& s = w.s;
  const auto& e = f.o.element;
  foundation::for_all(s.fluid, [&](std::size_t i) {
    const bool metal = f.is_metal(i);
    f.metal[i] = metal ? 1.0 : 0.0;
    f.partition[i] = metal ? partition_coefficient(e, s.p_eos[i], s.T[i]) : 1.0;
    f.mobility[i] = s.rho[i] * (metal ? e.diffusivity_metal : e.diffusivity_silicate);
  });
  walls::update_ghosts_and_images(w, f.world.walls, walls::even({&f.element, &f.metal, &f.partition, &f.mobility}));
}

// The gradient of colour, and the area of contact per volume at each particle.
template <int D>
void find_contact(fluids<D>& f) {
  auto& w = f.world.w;
  auto& s = w.s;
  const auto G = f.colour_slope.data();
  w.sum(w.fluid(), colour_gradient<D>{s.dV.data(), f.metal.data(), G});
  foundation::for_all(s.fluid, [&](std::size_t i) {
    double G2 = 0.0;
    for (std::size_t a = 0; a < D; ++a) G2 += G[a][i] * G[a][i];
    f.area[i] = std::sqrt(G2);
  });
  walls::update_ghosts_and_images(w, f.world.walls, walls::vector(f.colour_slope));
}

// Forces of surface tension.
template <int D>
void find_tension(fluids<D>& f) {
  auto& w = f.world.w;
  auto& s = w.s;
  const foundation::stage timed(w.times, "surface tension");
  find_contact(f);
  foundation::for_all(s.total(), [&](std::size_t i) { f.squared_volume[i] = s.dV[i] * s.dV[i] / w.lattice_sum; });
  w.sum(w.fluid(),
        surface_stress<D>{f.squared_volume.data(), f.colour_slope.read(), f.o.surface_tension, f.tension_force.data()});
}

// p̂ as Σ Y W over Σ ΔV W.
template <int D>
void smooth(fluids<D>& f) {
  auto& w = f.world.w;
  auto& s = w.s;
  const foundation::stage timed(w.times, "smoothing");
  foundation::for_all(s.total(), [&](std::size_t i) { s.Y[i] = s.p_eos[i] * s.dV[i]; });
  volume::smooth(w, true, w.fluid());
  w.exchange_fluid({s.p.data()});
  mirror(f, s.p);
}

// What the forces have of the pressure of particles first to last.
template <int D>
void find_stress(fluids<D>& f, std::size_t first, std::size_t last) {
  auto& s = f.world.w.s;
  foundation::for_all(last - first, [&](std::size_t k) {
    const std::size_t i = first + k;
    if (!f.smoothed) s.p[i] = s.p_eos[i];
    f.stress[i] = (s.p[i] - f.reference_pressure(s.x[1][i])) * element_of_work(f, i);
    if (has_factor(f)) f.stress[i] *= f.follow_factor[i];
  });
}

// What the element gains in these rows.
template <int D>
void exchange_element(fluids<D>& f, const pairs::row_range& rows) {
  const foundation::stage timed(f.world.w.times, "element");
  sum(f, rows,
      element_exchange<D>{f.element.data(), f.partition.data(), f.mobility.data(), f.metal.data(),
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

// Sums over the neighbours of these rows.
template <int D>
void sum_over_neighbours(fluids<D>& f, const pairs::row_range& rows) {
  auto& w = f.world.w;
  auto& s = w.s;
  const auto v = pairs::pointers<D>(s.v);
  {
    const foundation::stage timed(w.times, "forces");
    f.p.symmetric_stress ? sum_forces<D, true>(f, rows) : sum_forces<D, false>(f, rows);
  }
  if (f.carried) {
    const foundation::stage timed(w.times, "continuity");
    sum(f, rows,
        density_rate<D>{v, s.dV.data(), s.p_eos.data(), s.rho.data(), s.c.data(), f.o.gravity,
                        f.o.scheme.delta * f.h * diffusion_of_slowed(f), f.rho_rate.data()});
  }
  if (f.o.conductivity > 0.0) {
    std::fill(f.conducted.begin() + static_cast<std::ptrdiff_t>(rows.first),
              f.conducted.begin() + static_cast<std::ptrdiff_t>(rows.last), 0.0);
    sum(f, rows, diffusion::conduction<D>{s.T.data(), s.k.data(), s.dV.data(), f.conducted.data()});
  }
  if (f.dissolved) exchange_element(f, rows);
}

// Where the rates of each field stand: x, v, u, q, and what some runs have beside.
template <int D>
struct places_of_rates {
  std::size_t x = 0, v = D, u = 2 * D, q = 2 * D + 1, rho, T, c, h;
  explicit places_of_rates(const fluids<D>& f)
      : rho(2 * D + 2),
        T(rho + (f.carried || f.weighed ? 1 : 0)),
        c(T + (f.warms ? 1 : 0)),
        h(c + (f.dissolved ? 1 : 0)) {}
};

// Those of one particle.
template <int D>
void combine(const fluids<D>& f, std::size_t i, const places_of_rates<D>& at, std::span<double* const> rate) {
  const auto& w = f.world.w;
  const auto& s = w.s;
  const double per_m = 1.0 / s.m[i];
  const double compression = has_factor(f) ? f.compression[i] * f.follow_factor[i] : f.compression[i];
  const double heat = f.heat[i] + (f.o.conductivity > 0.0 ? f.conducted[i] : 0.0);
  for (std::size_t a = 0; a < D; ++a) {
    rate[at.x + a][i] = s.v[a][i];
    double force = f.tense ? f.force[a][i] + f.tension_force[a][i] : f.force[a][i];
    if (a == 1) force -= f.reference_slope * s.dV[i];
    if (a == 1 && f.slows) force += f.lift[i];
    rate[at.v + a][i] = (per_m * force + w.g[a]) / f.inertia_of(i);
  }
  walls::push_off(f.world.walls.force, f.world.walls.sides, s, i,
                  [&](std::size_t axis, double a) { rate[at.v + axis][i] += a / f.inertia_of(i); });
  rate[at.u][i] = per_m * s.p[i] * element_of_work(f, i) * compression;
  if (f.slows) rate[at.u][i] -= per_m * f.lift[i] * s.v[1][i];
  rate[at.q][i] = per_m * f.heat[i];
  double dlnrho = compression * s.dV[i] / w.lattice_sum;
  if (f.carried) {
    rate[at.rho][i] = f.rho_rate[i];
    dlnrho = f.rho_rate[i] / s.rho[i];
  }
  if (f.warms) {
    const double gamma = s.alpha[i] * s.K_T[i] / (s.rho[i] * s.c_V[i]);
    rate[at.T][i] = gamma * s.T[i] * dlnrho + per_m * heat / s.c_V[i];
  }
  if (f.dissolved) rate[at.c][i] = per_m * f.gain[i];
  if (f.enthalpy) rate[at.h][i] = per_m * heat;
}

template <int D>
void find_rates(fluids<D>& f, std::span<double* const> rate) {
  auto& w = f.world.w;
  auto& s = w.s;
  const foundation::stage timed(w.times, "rates");
  const places_of_rates<D> at(f);
#pragma omp parallel for schedule(static) if (s.fluid > foundation::rows_worth_threads)
  for (std::size_t i = 0; i < s.fluid; ++i) combine(f, i, at, rate);
}

template <int D>
void evaluate(fluids<D>& f, std::span<double* const> rate) {
  auto& w = f.world.w;
  const std::size_t own = w.s.fluid;
  begin_halo_exchange(f);
  count(f, w.interior());
  end_motion(f);
  count(f, w.at_border());
  begin_volumes(f);
  // Where forces need no more of the ghosts than this, a rank sums them over the rows that have none while it travels.
  const bool ahead = !(f.enthalpy || f.dissolved || f.tense || f.smoothed);
  if (ahead) {
    find_stress(f, 0, own);
    sum_over_neighbours(f, w.interior());
  }
  end_volumes(f);
  if (f.enthalpy) find_phases(f);
  if (f.dissolved) find_partition(f);
  if (f.tense) find_tension(f);
  if (f.smoothed) smooth(f);
  find_stress(f, ahead ? own : 0, w.s.total());
  sum_over_neighbours(f, ahead ? w.at_border() : w.fluid());
  find_rates(f, rate);
}

}  // namespace tetsuame::two_fluids
