// What a run of two fluids measures, line after line of its history: its flow (energies, speeds, the growing mode, the
// metal's place), and by subject a drop's shape, an element, heat. Every subject sums by itself: exact sums do not
// depend on the order.
#pragma once

#include <optional>
#include <output/checkpoint.hpp>
#include <output/history.hpp>
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
  const auto sizes = connected_sizes(box_of(f.o.domain), points, 1.9 * f.world.w.dx);
  const auto metal = static_cast<double>(points.size());
  m.lines.bodies.push_back(static_cast<double>(std::count_if(sizes.begin(), sizes.end(), [&](std::int64_t n) {
    return static_cast<double>(n) * 10.0 * f.number_of_drops() >= metal;
  })));
  m.lines.largest_body.push_back(static_cast<double>(sizes.front()) / metal);
}

// (a - b)/(a + b), a and b the second moments of the drop along y and along x.
template <int D>
double stretch_of_drop(const fluids<D>& f, double y_drop) {
  const auto& s = f.world.w.s;
  sum_of along, across;
  for (std::size_t i = 0; i < s.fluid; ++i)
    if (f.is_metal(i)) {
      double x = s.x[0][i] - *f.o.centre[0];
      if (f.o.domain.periodic[0]) x = std::remainder(x, f.o.domain.length[0]);
      across.add(s.m[i] * x * x);
      along.add(s.m[i] * (s.x[1][i] - y_drop) * (s.x[1][i] - y_drop));
    }
  const double a = f.ranks().exact(along), b = f.ranks().exact(across);
  return (a - b) / (a + b);
}

// Pa, of the metal over the silicate, each above the column at rest, out of reach of the other material.
template <int D>
double pressure_inside(const fluids<D>& f) {
  const auto& s = f.world.w.s;
  sum_of inside, inside_p, outside, outside_p;
  for (std::size_t i = 0; i < s.fluid; ++i)
    if (f.area[i] == 0.0) {
      const double V = s.m[i] / s.rho[i], excess = V * (s.p_eos[i] - f.p.base->at(s.x[1][i]).pressure);
      (f.is_metal(i) ? inside : outside).add(V);
      (f.is_metal(i) ? inside_p : outside_p).add(excess);
    }
  const auto& r = f.ranks();
  return r.exact(inside_p) / r.exact(inside) - r.exact(outside_p) / r.exact(outside);
}

template <int D>
void follow_drops(measures& m, const fluids<D>& f, const totals& all, std::vector<double>& values) {
  if (!f.many()) {
    m.lines.stretch.push_back(stretch_of_drop(f, m.lines.centroid.back()));
    values.push_back(m.lines.stretch.back());
  }
  find_bodies(m, f);
  values.push_back(m.lines.bodies.back());
  values.push_back(m.lines.largest_body.back());
  m.drop_volume = all.metal_volume / f.number_of_drops();
  if (!m.fraction_start) m.fraction_start = all.metal_volume / all.volume;
  if (!f.tense) return;
  m.laplace_pressure = pressure_inside(f);
  // 0 where no particle of a drop is out of reach of the contact: a table has numbers only.
  values.push_back(std::isfinite(m.laplace_pressure) ? m.laplace_pressure : 0.0);
}

// Of what the metal would take up, P being what it is, from its start to equilibrium with all silicate: the part
// taken; 1 where it has nothing to take up.
template <int D>
double equilibration(const measures& m, const fluids<D>& f, double c, double P) {
  const auto& [metal, metal_volume, mass, volume] = m.metal_start;
  const double there = *m.element_start / (metal + (mass - metal) / P);
  const double start = f.o.element.concentration_metal;
  if (std::abs(there - start) <= 1e-12 * std::max(there, start)) return 1.0;
  return (c - start) / (there - start);
}

template <int D>
void follow_element(measures& m, const fluids<D>& f, const totals& all, std::vector<double>& values) {
  const auto& s = f.world.w.s;
  sum_of amount, in_metal, partition;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    amount.add(s.m[i] * f.element()[i]);
    if (!f.is_metal(i)) continue;
    in_metal.add(s.m[i] * f.element()[i]);
    partition.add(s.m[i] * f.partition[i]);
  }
  const auto& r = f.ranks();
  const double there = r.exact(amount), c = r.exact(in_metal) / all.metal_mass, P = r.exact(partition) / all.metal_mass;
  if (!m.element_start) {
    m.element_start = there;
    m.metal_start = {all.metal_mass, all.metal_volume, all.mass, all.volume};
  }
  m.element_error = std::max(m.element_error, std::abs(there / *m.element_start - 1.0));
  m.lines.in_metal.push_back(c);
  m.lines.partition.push_back(P);
  m.lines.equilibration.push_back(equilibration(m, f, c, P));
  for (const double v : {there, c, P, m.lines.equilibration.back()}) values.push_back(v);
}

// What the temperature and the melt that the run shows hold, not what was integrated; and where the metal is.
template <int D>
void follow_heat(measures& m, const fluids<D>& f, const totals& all, std::vector<double>& values) {
  const auto& s = f.world.w.s;
  sum_of content_gain, exchanged, melt, lower_mass, metal_below;
  double metal_low = f.o.domain.length[1];
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const double gain = s.m[i] * (s.c_V[i] * s.T[i] + f.latent(i) * f.melt[i] - f.content_start()[i]);
    content_gain.add(gain);
    exchanged.add(std::abs(gain));
    if (f.is_metal(i)) {
      metal_low = std::min(metal_low, s.x[1][i]);
      metal_below.add(s.x[1][i] < f.p.interface ? s.m[i] : 0.0);
    } else {
      lower_mass.add(s.m[i]);
      melt.add(s.m[i] * f.melt[i]);
    }
  }
  const auto& r = f.ranks();
  const double gain = r.exact(content_gain), moved = r.exact(exchanged);
  m.heat_residual = moved > 0.0 ? (gain - m.dissipated_now) / moved : 0.0;
  m.melt_fraction = r.exact(melt) / r.exact(lower_mass);
  m.metal_depth = f.p.interface - r.minimum(metal_low);
  m.metal_below = r.exact(metal_below) / all.metal_mass;
  for (const double v : {gain, m.heat_residual, m.melt_fraction, m.metal_depth, m.metal_below}) values.push_back(v);
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
