// What is measured of the flow of two fluids: energies, speeds, the growing mode, the metal's place; and the lines of
// the history that the summary looks back on.
#pragma once

#include <optional>
#include <two_fluids/start.hpp>

namespace tetsuame::two_fluids {

// J/kg, ∫ p dρ/ρ² from the density at the start, at the particle's temperature: four Gauss points in ln ρ.
template <int D>
double elastic_energy(const fluids<D>& f, std::size_t i) {
  const auto& s = f.world.w.s;
  const auto& material = f.world.w.materials[static_cast<std::size_t>(s.material[i])];
  constexpr std::array<double, 4> x{-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526};
  constexpr std::array<double, 4> weight{0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                         0.3478548451374538};
  const double half = 0.5 * std::log(s.rho[i] / f.rho_start()[i]);
  double sum = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    const double rho = f.rho_start()[i] * std::exp(half * (1.0 + x[k]));
    sum += weight[k] * eos::pressure(material, rho, s.T[i]) / rho;
  }
  return half * sum;
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

// A measure over time: lines of history that the summary looks back on.
struct record {
  std::vector<double> time, mode, centroid, fall;          // s; m; m; m/s
  std::vector<double> stretch;                             // of a drop: 1
  std::vector<double> bodies, largest_body;                // of metal (find_bodies); share of it
  std::vector<double> in_metal, partition, equilibration;  // of an element: means over the metal; 0 to 1

  // As a checkpoint has them; the last three of an element.
  std::array<std::pair<const char*, std::vector<double>*>, 10> by_name() {
    return {{{"time", &time},
             {"mode", &mode},
             {"centroid", &centroid},
             {"fall", &fall},
             {"stretch", &stretch},
             {"bodies", &bodies},
             {"largest_body", &largest_body},
             {"in_metal", &in_metal},
             {"partition", &partition},
             {"equilibration", &equilibration}}};
  }
};

struct measures {
  record lines;
  std::optional<double> energy_start;
  double residual = 0.0, residual_max = 0.0, v_rms = 0.0, v_rms_max = 0.0, v_rms_max_time = 0.0;
  double density_min = 1e300, density_max = 0.0, pressure_min = 1e300;
  double mass_start = 0.0, mass_drift = 0.0;
  double heat_residual = 0.0, melt_fraction = 0.0, metal_depth = 0.0, metal_below = 0.0;
  double dissipated_now = 0.0, dissipated_most = 0.0;  // J, at lines of the history
  double mach_max = 0.0;
  double surface = 0.0, drop_volume = 0.0, laplace_pressure = 0.0;  // J (2-D: J/m); m^D; Pa
  std::optional<double> fraction_start;                             // of drops: volume of the metal over all
  std::optional<double> element_start;                              // kg (2-D: kg/m)
  std::array<double, 4> metal_start{};                              // mass and volume of the metal, of all
  double element_error = 0.0;

  // Those that a checkpoint has under "measures", in its order.
  std::array<double*, 20> scalars() {
    return {&residual,        &residual_max,  &v_rms,        &v_rms_max,   &v_rms_max_time,
            &density_min,     &density_max,   &pressure_min, &mass_start,  &mass_drift,
            &heat_residual,   &melt_fraction, &metal_depth,  &metal_below, &dissipated_now,
            &dissipated_most, &mach_max,      &surface,      &drop_volume, &laplace_pressure};
  }
};

using sum_of = foundation::exact_sum;

// Volumes and masses of the metal and of everything.
struct totals {
  double mass, volume, metal_mass, metal_volume;  // kg, m^D (2-D: per m)
};

template <int D>
totals find_totals(const fluids<D>& f) {
  const auto& s = f.world.w.s;
  sum_of mass, volume, metal_mass, metal_volume;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const double V = s.m[i] / s.rho[i];
    mass.add(s.m[i]);
    volume.add(V);
    if (!f.is_metal(i)) continue;
    metal_mass.add(s.m[i]);
    metal_volume.add(V);
  }
  const auto& r = f.ranks();
  return {r.exact(mass), r.exact(volume), r.exact(metal_mass), r.exact(metal_volume)};
}

struct energies {
  double kinetic, potential, elastic, dissipated, thermal, surface;  // J (2-D: J/m)
};

template <int D>
energies find_energies(const fluids<D>& f) {
  const auto& s = f.world.w.s;
  sum_of kinetic, potential, elastic, heat, thermal, surface;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const double V = s.m[i] / s.rho[i];
    kinetic.add(0.5 * s.m[i] * f.inertia_of(i) * f.speed2(i));
    potential.add(s.m[i] * f.o.gravity * s.x[1][i]);
    potential.add(s.m[i] * walls::boundary_potential(f.world.walls.force, f.world.walls.sides, s, i));
    elastic.add(s.m[i] * (f.warms ? s.u[i] : elastic_energy(f, i)) + f.reference_pressure(s.x[1][i]) * V);
    heat.add(s.m[i] * f.dissipated()[i]);
    thermal.add(s.m[i] * s.c_V[i] * (s.T[i] - f.T_start()[i]));
    if (f.tense) surface.add(f.o.surface_tension * V * f.area[i]);
  }
  const auto& r = f.ranks();
  return {r.exact(kinetic), r.exact(potential), r.exact(elastic) - reference_integral(f),
          r.exact(heat),    r.exact(thermal),   f.tense ? r.exact(surface) : 0.0};
}

// What the energy is off by, and the mass, since the first line.
template <int D>
void follow(measures& m, const fluids<D>& f, const energies& e, double mass) {
  const double energy = e.kinetic + e.potential + e.elastic + e.dissipated + e.surface;
  if (!m.energy_start) {
    m.energy_start = energy;
    m.mass_start = mass;
  }
  m.surface = e.surface;
  m.dissipated_now = e.dissipated;
  m.mass_drift = mass / m.mass_start - 1.0;
  m.residual = (energy - *m.energy_start) / energy_scale(f);
  m.residual_max = std::max(m.residual_max, std::abs(m.residual));
}

struct extremes {
  double density_min, density_max, pressure_min;  // 1, of the start's; Pa
};

// Root mean square of the speed, and the extremes of density and pressure.
template <int D>
extremes find_motion(measures& m, const fluids<D>& f, double t, double volume) {
  const auto& s = f.world.w.s;
  sum_of squares;
  double fastest2 = 0.0, low = std::numeric_limits<double>::infinity(), high = 0.0, p_low = low;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const double v2 = f.speed2(i), ratio = s.rho[i] / f.rho_start()[i];
    squares.add(s.m[i] / s.rho[i] * v2);
    fastest2 = std::max(fastest2, v2 / (s.c[i] * s.c[i]));
    low = std::min(low, ratio);
    high = std::max(high, ratio);
    p_low = std::min(p_low, s.p_eos[i]);
  }
  const auto& r = f.ranks();
  m.v_rms = std::sqrt(r.exact(squares) / volume);
  if (m.v_rms > m.v_rms_max) {
    m.v_rms_max = m.v_rms;
    m.v_rms_max_time = t;
  }
  const extremes now{r.minimum(low), r.maximum(high), r.minimum(p_low)};
  m.density_min = std::min(m.density_min, now.density_min);
  m.density_max = std::max(m.density_max, now.density_max);
  m.pressure_min = std::min(m.pressure_min, now.pressure_min);
  m.mach_max = std::max(m.mach_max, std::sqrt(r.maximum(fastest2)));
  return now;
}

// m, the displacement's projection on the mode.
template <int D>
double mode_amplitude(const fluids<D>& f) {
  if (!f.p.mode) return 0.0;
  const auto& s = f.world.w.s;
  sum_of shape, shape2;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    std::array<double, D> lattice;
    for (std::size_t a = 0; a < D; ++a) lattice[a] = s.x_start[a][i];
    const auto m = mode_at(f, lattice);
    for (std::size_t a = 0; a < D; ++a) {
      shape.add(s.m[i] * m[a] * (s.x[a][i] - lattice[a]));
      shape2.add(s.m[i] * m[a] * m[a]);
    }
  }
  return f.ranks().exact(shape) / f.ranks().exact(shape2);
}

// The metal's centroid (m) and its mean velocity downward (m/s).
template <int D>
void follow_metal(measures& m, const fluids<D>& f, double t, const totals& all) {
  const auto& s = f.world.w.s;
  sum_of y, v;
  for (std::size_t i = 0; i < s.fluid; ++i)
    if (f.is_metal(i)) {
      y.add(s.m[i] * s.x[1][i]);
      v.add(-(s.m[i] / s.rho[i]) * s.v[1][i]);
    }
  m.lines.time.push_back(t);
  m.lines.mode.push_back(mode_amplitude(f));
  m.lines.centroid.push_back(f.ranks().exact(y) / all.metal_mass);
  m.lines.fall.push_back(f.ranks().exact(v) / all.metal_volume);
}

}  // namespace tetsuame::two_fluids
