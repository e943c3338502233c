// What a run of two fluids measures, line after line of its history: its flow (flow_measures.hpp), and by subject a
// drop's shape, an element, heat. Every subject sums by itself: exact sums do not depend on the order.
#pragma once

#include <output/checkpoint.hpp>
#include <output/history.hpp>
#include <two_fluids/flow_measures.hpp>

namespace tetsuame::two_fluids {

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
