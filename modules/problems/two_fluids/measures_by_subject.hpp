// The measures of two fluids that belong to a subject: a drop's shape, an element, heat; and what all measures are kept
// in. Every subject sums by itself: exact sums do not depend on the order.
#pragma once

#include <optional>
#include <output/checkpoint.hpp>
#include <output/history.hpp>
#include <two_fluids/start.hpp>

namespace tetsuame::two_fluids {

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
}  // namespace tetsuame::two_fluids
