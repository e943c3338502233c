// What a run of two fluids measures at every line of its history: its flow (energies, speeds, the growing mode, the
// metal's place), a drop's shape, an element, heat.
#pragma once

#include <algorithm>
#include <elements/equilibration.hpp>
#include <liquid/sums.hpp>
#include <optional>
#include <two_fluids/slowing.hpp>
#include <two_fluids/start.hpp>

namespace tetsuame::two_fluids {

// Masses and volumes of everything and of the metal.
struct totals {
  double mass = 0.0, volume = 0.0, metal_mass = 0.0, metal_volume = 0.0;  // kg, m^D (2-D: per m)
};

struct energies {
  double kinetic = 0.0, potential = 0.0, elastic = 0.0, dissipated = 0.0, thermal = 0.0, surface = 0.0;  // J (2-D: J/m)
};

// Of one material.
struct amount {
  double mass = 0.0, centroid = 0.0;  // kg (2-D: kg/m); the height's, of the box's
};

struct measures : totals, energies {
  // Of the last line.
  double time = 0.0, mode = 0.0, centroid = 0.0, fall = 0.0;                   // s, m, m, m/s
  double height = 0.0;                                                         // the centroid's, of the box's
  double lowest_density = 0.0, highest_density = 0.0, lowest_pressure = 0.0;   // 1, of the start's; Pa
  double residual = 0.0, v_rms = 0.0, mass_drift = 0.0;                        // 1, m/s, 1
  double stretch = 0.0, bodies = 0.0, largest_body = 0.0;                      // of a drop; bodies; share of metal
  double drop_volume = 0.0, laplace_pressure = 0.0;                            // m^D; Pa
  double laplace_pressure_or_0 = 0.0;                                          // where all metal is at the contact
  double element = 0.0, in_metal = 0.0, partition = 0.0, equilibration = 0.0;  // kg (2-D: kg/m); of the metal; 0 to 1
  double heat = 0.0;                                                           // J (2-D: J/m), gained
  double work_of_forces = 0.0, heat_of_sources = 0.0;                          // J (2-D: J/m), from outside
  double heat_residual = 0.0, melt_fraction = 0.0, metal_depth = 0.0, metal_below = 0.0;  // 1, 1, m, 1

  std::vector<amount> further;  // of each &material

  // Of the first.
  double energy_start = 0.0, mass_start = 0.0, element_start = 0.0;
  double fraction_start = 0.0;  // of drops: volume of the metal over all
  totals totals_start{};

  // The most and the least so far.
  double residual_max = 0.0, v_rms_max = 0.0, v_rms_max_time = 0.0, mach_max = 0.0, dissipated_most = 0.0;
  double density_min = 1e300, density_max = 0.0, pressure_min = 1e300;
  double density_excess = 0.0;  // of the last line, on this rank
  double element_error = 0.0;

  // Those that the summary looks back on, as a checkpoint has them; the last three of an element.
  struct line {
    const char* name;
    double measures::*now;
    std::vector<double> by_time{};
  };
  std::array<line, 10> lines{{{"time", &measures::time},
                              {"mode", &measures::mode},
                              {"centroid", &measures::centroid},
                              {"fall", &measures::fall},
                              {"stretch", &measures::stretch},
                              {"bodies", &measures::bodies},
                              {"largest_body", &measures::largest_body},
                              {"in_metal", &measures::in_metal},
                              {"partition", &measures::partition},
                              {"equilibration", &measures::equilibration}}};
  const std::vector<double>& by_time(double measures::*now) const {
    return std::ranges::find(lines, now, &line::now)->by_time;
  }
  bool none_yet() const { return lines[0].by_time.empty(); }

  // Those that a checkpoint has under "measures" and "element", in its order.
  std::array<double*, 22> scalars() {
    return {&energy_start,  &residual,    &residual_max,     &v_rms,         &v_rms_max,       &v_rms_max_time,
            &density_min,   &density_max, &pressure_min,     &mass_start,    &mass_drift,      &heat_residual,
            &melt_fraction, &metal_depth, &metal_below,      &dissipated,    &dissipated_most, &mach_max,
            &surface,       &drop_volume, &laplace_pressure, &fraction_start};
  }
  std::array<double*, 6> of_element() {
    auto& start = totals_start;
    return {&element_start, &element_error, &start.metal_mass, &start.metal_volume, &start.mass, &start.volume};
  }
};

// ---- flow -----------------------------------------------------------------------------------

template <int D>
totals find_totals(const fluids<D>& f) {
  const auto& s = f.world.w.s;
  const auto [mass, volume, metal_mass, metal_volume] =
      liquid::exact_sums<4>(f.world, [&](std::size_t i, const auto& add) {
        const double m = s.m[i], V = m / s.rho[i];
        if (f.is_metal(i))
          add(m, V, m, V);
        else
          add(m, V);
      });
  return {mass, volume, metal_mass, metal_volume};
}

// J/kg, ∫ p̂ dρ/ρ² from the density at the start to this one, at the particle's temperature: four Gauss points in ln ρ.
template <int D>
double elastic_energy(const fluids<D>& f, std::size_t i, double to) {
  const auto& s = f.world.w.s;
  const auto& material = f.world.w.materials[f.material_of(i)];
  constexpr std::array<double, 4> x{-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526};
  constexpr std::array<double, 4> weight{0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                         0.3478548451374538};
  const double half = 0.5 * std::log(to / f.rho_start[i]);
  double sum = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    const double rho = f.rho_start[i] * std::exp(half * (1.0 + x[k]));
    sum += weight[k] * eos::pressure(material, rho, s.T[i]) / rho;
  }
  return half * sum;
}

// J/kg of slowed sound, of which elastic is the physical one: with it the part of the tangent at the column's pressure.
template <int D>
double slowed_energy(const fluids<D>& f, std::size_t i, double elastic) {
  if (!f.slows || f.warms) return elastic;
  const auto& s = f.world.w.s;
  const double p_h = f.p.base->pressure(s.x[1][i]).value, rho_h = density_at_rest(f, i, p_h);
  const double tangent = elastic_energy(f, i, rho_h) + p_h * (1.0 / rho_h - 1.0 / s.rho[i]);
  return f.stiffness * elastic + (1.0 - f.stiffness) * tangent;
}

// J (2-D: J/m), of p_r over the box: what Σ p_r ΔV stands for.
template <int D>
double reference_integral(const fluids<D>& f) {
  double mean = 0.5 * f.reference_floor;
  for (std::size_t a = 0; a < D; ++a) mean *= f.o.domain.length[a];
  return mean;
}

// m² (2-D: m), of the round drop.
template <int D>
double round_surface(double radius) {
  return std::numbers::pi * radius * (D == 3 ? 4.0 * radius : 2.0);
}

// J (2-D: J/m): Δρ g L³/8 of a square box; of a drop, what it loses on the way from lid to floor, and its surface's.
// Where neither weight nor tension does anything, 1 J.
template <int D>
double energy_scale(const fluids<D>& f) {
  const auto& L = f.o.domain.length;
  const double weight = std::abs(f.p.density_difference) * f.o.gravity, a = f.o.radius;
  const double scale =
      f.is_drop() ? f.number_of_drops() * (weight * L[1] * std::numbers::pi * a * a * (D == 3 ? 4.0 / 3.0 * a : 1.0) +
                                           f.o.surface_tension * round_surface<D>(a))
                  : weight * L[0] * L[1] * L[1] * (D == 3 ? L[2] : 1.0) / 8.0;
  return scale > 0.0 ? scale : 1.0;
}

template <int D>
energies find_energies(const fluids<D>& f) {
  const auto& s = f.world.w.s;
  const auto [kinetic, potential, elastic, dissipated, thermal, surface] =
      liquid::exact_sums<6>(f.world, [&](std::size_t i, const auto& add) {
        const double V = s.m[i] / s.rho[i];
        add(0.5 * s.m[i] * f.inertia_of(i) * f.speed2(i), s.m[i] * f.o.gravity * s.x[1][i],
            s.m[i] * (f.warms ? s.u[i] : slowed_energy(f, i, elastic_energy(f, i, s.rho[i]))) +
                f.reference_pressure(s.x[1][i]) * V,
            s.m[i] * f.dissipated[i], s.m[i] * s.c_V[i] * (s.T[i] - f.T_start[i]),
            f.tense ? f.o.surface_tension * V * f.tension.area[i] : 0.0);
        const auto& force = f.world.walls.force;
        add(0.0, s.m[i] * walls::boundary_potential(force, f.world.walls.sides, s, i));
        if (!f.has_bodies) return;
        const double depth = rigid::depth_of(f.bodies, i).depth;
        add(0.0, 0.5 * s.m[i] * force.stiffness * depth * depth);
      });
  return {kinetic, potential, elastic - reference_integral(f), dissipated, thermal, surface};
}

// What the energy is off by, and the mass, since the first line.
template <int D>
void follow_energy(measures& m, const fluids<D>& f) {
  static_cast<energies&>(m) = find_energies(f);
  m.work_of_forces = f.sources.work_of_forces();
  m.heat_of_sources = f.sources.heat_supplied();
  const double energy = m.kinetic + m.potential + m.elastic + m.dissipated + m.surface - m.work_of_forces;
  if (m.none_yet()) {
    m.energy_start = energy;
    m.mass_start = m.mass;
  }
  m.mass_drift = m.mass / m.mass_start - 1.0;
  m.residual = (energy - m.energy_start) / energy_scale(f);
  m.residual_max = std::max(m.residual_max, std::abs(m.residual));
}

// Root mean square of the speed, and the extremes of density and pressure.
template <int D>
void follow_motion(measures& m, const fluids<D>& f) {
  const auto& s = f.world.w.s;
  double fastest2 = 0.0, low = std::numeric_limits<double>::infinity(), high = 0.0, p_low = low;
  m.density_excess = 0.0;
  const auto [squares] = liquid::exact_sums<1>(f.world, [&](std::size_t i, const auto& add) {
    const double v2 = f.speed2(i), ratio = s.rho[i] / f.rho_start[i];
    const double slow2 = f.xi2[f.material_of(i)] / f.stiffness;  // (ζξ)², of the input
    add(s.m[i] / s.rho[i] * v2);
    fastest2 = std::max(fastest2, slow2 * (v2 / (s.c[i] * s.c[i])));
    const auto& [least, most] = f.density_range[f.material_of(i)];
    m.density_excess = std::max({m.density_excess, s.rho[i] / most, least / s.rho[i]});
    low = std::min(low, ratio);
    high = std::max(high, ratio);
    p_low = std::min(p_low, s.p_eos[i]);
  });
  const auto& r = f.ranks();
  m.v_rms = std::sqrt(squares / m.volume);
  if (m.v_rms > m.v_rms_max) {
    m.v_rms_max = m.v_rms;
    m.v_rms_max_time = m.time;
  }
  m.lowest_density = r.minimum(low);
  m.highest_density = r.maximum(high);
  m.lowest_pressure = r.minimum(p_low);
  m.density_min = std::min(m.density_min, m.lowest_density);
  m.density_max = std::max(m.density_max, m.highest_density);
  m.pressure_min = std::min(m.pressure_min, m.lowest_pressure);
  m.mach_max = std::max(m.mach_max, std::sqrt(r.maximum(fastest2)));
}

// m, the displacement's projection on the mode.
template <int D>
double mode_amplitude(const fluids<D>& f) {
  if (!f.p.mode) return 0.0;
  const auto& s = f.world.w.s;
  const auto [shape, shape2] = liquid::exact_sums<2>(f.world, [&](std::size_t i, const auto& add) {
    std::array<double, D> lattice;
    for (std::size_t a = 0; a < D; ++a) lattice[a] = s.x_start[a][i];
    const auto u = mode_at(f, lattice);
    for (std::size_t a = 0; a < D; ++a) add(s.m[i] * u[a] * (s.x[a][i] - lattice[a]), s.m[i] * u[a] * u[a]);
  });
  return shape / shape2;
}

// The metal's centroid and its mean velocity downward.
template <int D>
void follow_metal(measures& m, const fluids<D>& f) {
  const auto& s = f.world.w.s;
  const auto [y, v] = liquid::exact_sums<2>(f.world, [&](std::size_t i, const auto& add) {
    if (f.is_metal(i)) add(s.m[i] * s.x[1][i], -(s.m[i] / s.rho[i]) * s.v[1][i]);
  });
  m.mode = mode_amplitude(f);
  m.centroid = y / m.metal_mass;
  m.height = m.centroid / f.o.domain.length[1];
  m.fall = v / m.metal_volume;
}

template <int D>
void follow_materials(measures& m, const fluids<D>& f) {
  const auto& s = f.world.w.s;
  m.further.clear();
  for (std::size_t n = 2; n < f.o.material.size(); ++n) {
    const auto [mass, y] = liquid::exact_sums<2>(f.world, [&](std::size_t i, const auto& add) {
      if (f.material_of(i) == n) add(s.m[i], s.m[i] * s.x[1][i]);
    });
    m.further.push_back({mass, y / mass / f.o.domain.length[1]});
  }
}

// ---- drops ----------------------------------------------------------------------------------

// How many bodies the metal is in: sets of its particles that steps of up to 1.9 spacings hold together. Sheared
// particles lie in rows up to so far apart, and one undisturbed row of the other liquid, 2 spacings, still parts two
// drops. Less than a tenth of a drop is a fragment, and not counted. On every rank all metal at once.
template <int D>
void find_bodies(measures& m, const fluids<D>& f) {
  const auto& s = f.world.w.s;
  std::vector<double> mine;
  for (std::size_t i = 0; i < s.fluid; ++i)
    if (f.is_metal(i))
      for (std::size_t a = 0; a < D; ++a) mine.push_back(s.x[a][i]);
  const auto local = static_cast<double>(mine.size());
  mine.resize(static_cast<std::size_t>(f.ranks().maximum(local)), std::numeric_limits<double>::quiet_NaN());
  const auto all = f.ranks().every(std::span<const double>(mine));
  std::vector<std::array<double, 3>> points;
  for (std::size_t k = 0; k + D <= all.size(); k += D) {
    std::array<double, 3> x{};
    std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(k), D, x.begin());
    if (!std::isnan(x[0])) points.push_back(x);
  }
  const auto sizes = connected_sizes(f.o.domain, points, 1.9 * f.world.w.dx);
  const auto metal = static_cast<double>(points.size());
  m.bodies = static_cast<double>(std::ranges::count_if(
      sizes, [&](std::int64_t n) { return static_cast<double>(n) * 10.0 * f.number_of_drops() >= metal; }));
  m.largest_body = static_cast<double>(sizes.front()) / metal;
}

// (a - b)/(a + b), a and b the second moments of the drop along y and along x.
template <int D>
double stretch_of_drop(const fluids<D>& f, double y_drop) {
  const auto& s = f.world.w.s;
  const auto [a, b] = liquid::exact_sums<2>(f.world, [&](std::size_t i, const auto& add) {
    if (!f.is_metal(i)) return;
    double x = s.x[0][i] - *f.o.centre[0];
    if (f.o.domain.periodic[0]) x = std::remainder(x, f.o.domain.length[0]);
    add(s.m[i] * (s.x[1][i] - y_drop) * (s.x[1][i] - y_drop), s.m[i] * x * x);
  });
  return (a - b) / (a + b);
}

// Pa, of the metal over the silicate, each above the column at rest, out of reach of the other material.
template <int D>
double pressure_inside(const fluids<D>& f) {
  const auto& s = f.world.w.s;
  const auto [inside, inside_p, outside, outside_p] =
      liquid::exact_sums<4>(f.world, [&](std::size_t i, const auto& add) {
        if (f.tension.area[i] != 0.0) return;
        const double V = s.m[i] / s.rho[i], excess = V * (s.p_eos[i] - f.p.base->at(s.x[1][i]).pressure);
        if (f.is_metal(i))
          add(V, excess);
        else
          add(0.0, 0.0, V, excess);
      });
  return inside_p / inside - outside_p / outside;
}

template <int D>
void follow_drops(measures& m, const fluids<D>& f) {
  if (!f.many()) m.stretch = stretch_of_drop(f, m.centroid);
  find_bodies(m, f);
  m.drop_volume = m.metal_volume / f.number_of_drops();
  if (m.none_yet()) m.fraction_start = m.metal_volume / m.volume;
  if (!f.tense) return;
  m.laplace_pressure = pressure_inside(f);
  m.laplace_pressure_or_0 = std::isfinite(m.laplace_pressure) ? m.laplace_pressure : 0.0;
}

// ---- an element, heat -----------------------------------------------------------------------

template <int D>
double equilibration(const measures& m, const fluids<D>& f, double c, double P) {
  const auto& all = m.totals_start;
  return elements::equilibration({m.element_start, all.metal_mass, all.mass - all.metal_mass},
                                 f.o.element.concentration_metal, c, P);
}

template <int D>
void follow_element(measures& m, const fluids<D>& f) {
  const auto& s = f.world.w.s;
  const auto [amount, in_metal, partition] = liquid::exact_sums<3>(f.world, [&](std::size_t i, const auto& add) {
    const double here = s.m[i] * f.element[i];
    if (f.is_metal(i))
      add(here, here, s.m[i] * f.partition[i]);
    else
      add(here);
  });
  if (m.none_yet()) {
    m.element_start = amount;
    m.totals_start = m;
  }
  m.element = amount;
  m.in_metal = in_metal / m.metal_mass;
  m.partition = partition / m.metal_mass;
  m.element_error = std::max(m.element_error, std::abs(amount / m.element_start - 1.0));
  m.equilibration = equilibration(m, f, m.in_metal, m.partition);
}

// What the temperature and the melt that the run shows hold, not what was integrated; and where the metal is.
template <int D>
void follow_heat(measures& m, const fluids<D>& f) {
  const auto& s = f.world.w.s;
  double metal_low = f.o.domain.length[1];
  const auto [gain, moved, melt, lower_mass, metal_below] =
      liquid::exact_sums<5>(f.world, [&](std::size_t i, const auto& add) {
        const double gained = s.m[i] * (s.c_V[i] * s.T[i] + f.latent(i) * f.melt[i] - f.content_start[i]);
        if (f.is_metal(i)) {
          metal_low = std::min(metal_low, s.x[1][i]);
          add(gained, std::abs(gained), 0.0, 0.0, s.x[1][i] < f.p.interface ? s.m[i] : 0.0);
        } else {
          add(gained, std::abs(gained), s.m[i] * f.melt[i], f.o.material[f.material_of(i)].melts ? s.m[i] : 0.0);
        }
      });
  m.heat = gain;
  m.heat_residual = moved > 0.0 ? (gain - m.dissipated - m.heat_of_sources) / moved : 0.0;
  m.melt_fraction = melt / lower_mass;
  m.metal_depth = f.p.interface - f.ranks().minimum(metal_low);
  m.metal_below = metal_below / m.metal_mass;
}

}  // namespace tetsuame::two_fluids
