// What a run of two fluids measures, line after line of its history: its flow (energies, speeds, the growing mode, the
// metal's place), and by subject (measures_by_subject.hpp) a drop's shape, an element, heat.
#pragma once

#include <two_fluids/measures_by_subject.hpp>

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

// ---- lines of the history -------------------------------------------------------------------

template <int D>
std::vector<output::history_column> columns_of(const fluids<D>& f) {
  const std::string J = D == 2 ? "J/m" : "J", kg = D == 2 ? "kg/m" : "kg";
  std::vector<output::history_column> all{{"centroid", "1"},
                                          {"v_rms", "m/s"},
                                          {"kinetic", J},
                                          {"potential", J},
                                          {"elastic", J},
                                          {"dissipated", J},
                                          {"thermal", J},
                                          {"energy_residual", "1"},
                                          {"mode_amplitude", "m"},
                                          {"fall_velocity", "m/s"},
                                          {"density_ratio_min", "1"},
                                          {"density_ratio_max", "1"},
                                          {"pressure_min", "Pa"}};
  const auto add = [&](std::initializer_list<output::history_column> some) { all.insert(all.end(), some); };
  if (f.tense) add({{"surface", J}});
  if (f.is_drop() && !f.many()) add({{"stretch", "1"}});
  if (f.is_drop()) add({{"bodies", "1"}, {"largest_body", "1"}});
  if (f.is_drop() && f.tense) add({{"laplace_pressure", "Pa"}});
  if (f.dissolved)
    add({{"element", kg}, {"concentration_metal", "1"}, {"partition_coefficient", "1"}, {"equilibration", "1"}});
  if (f.enthalpy)
    add({{"heat", J}, {"heat_residual", "1"}, {"melt_fraction", "1"}, {"metal_depth", "m"}, {"metal_below", "1"}});
  return all;
}

// Values of columns_of().
template <int D>
std::vector<double> next_line(measures& m, const fluids<D>& f, double t) {
  const auto all = find_totals(f);
  const auto e = find_energies(f);
  follow(m, f, e, all.mass);
  const auto now = find_motion(m, f, t, all.volume);
  follow_metal(m, f, t, all);
  std::vector<double> values{m.lines.centroid.back() / f.o.domain.length[1],
                             m.v_rms,
                             e.kinetic,
                             e.potential,
                             e.elastic,
                             e.dissipated,
                             e.thermal,
                             m.residual,
                             m.lines.mode.back(),
                             m.lines.fall.back(),
                             now.density_min,
                             now.density_max,
                             now.pressure_min};
  if (f.tense) values.push_back(e.surface);
  if (f.is_drop()) follow_drops(m, f, all, values);
  if (f.dissolved) follow_element(m, f, all, values);
  if (f.enthalpy) follow_heat(m, f, all, values);
  return values;
}

// ---- in a checkpoint ------------------------------------------------------------------------

template <int D>
void save(const measures& measured, const fluids<D>& f, output::checkpoint_globals& g) {
  auto m = measured;
  const auto lines = m.lines.by_name();
  for (std::size_t k = 0; k < (f.dissolved ? 10 : 7); ++k) g.blobs[lines[k].first] = *lines[k].second;
  if (f.dissolved) {
    const auto& start = m.metal_start;
    g.blobs["element"] = {m.element_start.value_or(0.0), m.element_error, start[0], start[1], start[2], start[3]};
  }
  auto& all = g.blobs["measures"];
  all = {m.energy_start.value_or(0.0)};
  for (const double* v : m.scalars()) all.push_back(*v);
  all.push_back(m.fraction_start.value_or(0.0));
  all.push_back(f.second_order ? 1.0 : 0.0);
}

template <int D>
measures restored(fluids<D>& f, const output::checkpoint_globals& g) {
  measures m;
  const auto lines = m.lines.by_name();
  for (std::size_t k = 0; k < (f.dissolved ? 10 : 7); ++k) *lines[k].second = g.blobs.at(lines[k].first);
  if (f.dissolved) {
    const auto& e = g.blobs.at("element");
    m.element_start = e[0];
    m.element_error = e[1];
    m.metal_start = {e[2], e[3], e[4], e[5]};
  }
  const auto& all = g.blobs.at("measures");
  m.energy_start = all[0];
  std::size_t k = 1;
  for (double* v : m.scalars()) *v = all[k++];
  if (f.is_drop()) m.fraction_start = all[k];
  f.second_order = all[k + 1] != 0.0;
  return m;
}

}  // namespace tetsuame::two_fluids
