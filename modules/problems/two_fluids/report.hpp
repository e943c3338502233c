// Lines of the history, and what the summary tells out of them: growth, times of fall, velocity and shape of drops,
// uptake of an element.
#pragma once

#include <fmt/format.h>

#include <output/checkpoint.hpp>
#include <output/history.hpp>
#include <run/summary.hpp>
#include <theory/growth_fit.hpp>
#include <theory/radial_exchange.hpp>
#include <two_fluids/measures.hpp>

namespace tetsuame::two_fluids {

using json = nlohmann::ordered_json;
using run::or_null;

// ---- lines of the history -------------------------------------------------------------------

struct measured_column {
  output::history_column column;
  double measures::*value;
};

template <int D>
std::vector<measured_column> columns_of(const fluids<D>& f) {
  using m = measures;
  const std::string J = D == 2 ? "J/m" : "J", kg = D == 2 ? "kg/m" : "kg";
  std::vector<measured_column> all{{{"centroid", "1"}, &m::height},
                                   {{"v_rms", "m/s"}, &m::v_rms},
                                   {{"kinetic", J}, &m::kinetic},
                                   {{"potential", J}, &m::potential},
                                   {{"elastic", J}, &m::elastic},
                                   {{"dissipated", J}, &m::dissipated},
                                   {{"thermal", J}, &m::thermal},
                                   {{"energy_residual", "1"}, &m::residual},
                                   {{"mode_amplitude", "m"}, &m::mode},
                                   {{"fall_velocity", "m/s"}, &m::fall},
                                   {{"density_ratio_min", "1"}, &m::lowest_density},
                                   {{"density_ratio_max", "1"}, &m::highest_density},
                                   {{"pressure_min", "Pa"}, &m::lowest_pressure}};
  const auto add = [&](std::initializer_list<measured_column> some) { all.insert(all.end(), some); };
  if (f.tense) add({{{"surface", J}, &m::surface}});
  if (f.sources.force()) add({{{"work_of_forces", J}, &m::work_of_forces}});
  if (f.sources.heat()) add({{{"heat_of_sources", J}, &m::heat_of_sources}});
  if (f.is_drop() && !f.many()) add({{{"stretch", "1"}, &m::stretch}});
  if (f.is_drop()) add({{{"bodies", "1"}, &m::bodies}, {{"largest_body", "1"}, &m::largest_body}});
  if (f.is_drop() && f.tense) add({{{"laplace_pressure", "Pa"}, &m::laplace_pressure_or_0}});
  if (f.dissolved)
    add({{{"element", kg}, &m::element},
         {{"concentration_metal", "1"}, &m::in_metal},
         {{"partition_coefficient", "1"}, &m::partition},
         {{"equilibration", "1"}, &m::equilibration}});
  if (f.enthalpy)
    add({{{"heat", J}, &m::heat},
         {{"heat_residual", "1"}, &m::heat_residual},
         {{"melt_fraction", "1"}, &m::melt_fraction},
         {{"metal_depth", "m"}, &m::metal_depth},
         {{"metal_below", "1"}, &m::metal_below}});
  return all;
}

// And of each &material.
template <int D>
std::vector<output::history_column> columns_of_materials(const fluids<D>& f) {
  std::vector<output::history_column> all;
  for (std::size_t n = 2; n < f.o.material.size(); ++n) all.push_back({"centroid_" + f.o.material[n].name, "1"});
  return all;
}

// Measures, and keeps what the summary looks back on.
template <int D>
void next_line(measures& m, const fluids<D>& f, double t) {
  m.time = t;
  static_cast<totals&>(m) = find_totals(f);
  follow_energy(m, f);
  follow_motion(m, f);
  follow_metal(m, f);
  follow_materials(m, f);
  if (f.is_drop()) follow_drops(m, f);
  if (f.dissolved) follow_element(m, f);
  if (f.enthalpy) follow_heat(m, f);
  for (auto& line : m.lines) line.by_time.push_back(m.*line.now);
}

// ---- in a checkpoint ------------------------------------------------------------------------

template <int D>
std::size_t lines_kept(const fluids<D>& f) {
  return f.dissolved ? 10 : 7;
}

template <int D>
void save(measures m, const fluids<D>& f, output::checkpoint_globals& g) {
  for (std::size_t k = 0; k < lines_kept(f); ++k) g.blobs[m.lines[k].name] = m.lines[k].by_time;
  if (f.dissolved)
    for (const double* value : m.of_element()) g.blobs["element"].push_back(*value);
  for (const double* value : m.scalars()) g.blobs["measures"].push_back(*value);
  g.blobs["measures"].push_back(f.second_order ? 1.0 : 0.0);
  for (const auto& [mass, centroid] : m.further)
    for (const double value : {mass, centroid}) g.blobs["materials"].push_back(value);
}

template <int D>
measures restored(fluids<D>& f, const output::checkpoint_globals& g) {
  measures m;
  for (std::size_t k = 0; k < lines_kept(f); ++k) {
    m.lines[k].by_time = g.blobs.at(m.lines[k].name);
    if (!m.lines[k].by_time.empty()) m.*m.lines[k].now = m.lines[k].by_time.back();
  }
  std::size_t k = 0;
  if (f.dissolved)
    for (double* value : m.of_element()) *value = g.blobs.at("element")[k++];
  k = 0;
  for (double* value : m.scalars()) *value = g.blobs.at("measures")[k++];
  f.second_order = g.blobs.at("measures")[k] != 0.0;
  if (const auto found = g.blobs.find("materials"); found != g.blobs.end())
    for (k = 0; k + 1 < found->second.size(); k += 2) m.further.push_back({found->second[k], found->second[k + 1]});
  return m;
}

// ---- measures by time -----------------------------------------------------------------------

// s, of the first line where the metal's centroid is as low, by straight lines between.
inline std::optional<double> when_below(const measures& m, double y) {
  const auto &t = m.by_time(&measures::time), &centroid = m.by_time(&measures::centroid);
  for (std::size_t k = 1; k < t.size(); ++k)
    if (centroid[k] <= y && centroid[k - 1] > y) {
      const double share = (centroid[k - 1] - y) / (centroid[k - 1] - centroid[k]);
      return t[k - 1] + (t[k] - t[k - 1]) * share;
    }
  return std::nullopt;
}

// Of a measure by time, constant beyond the record.
inline double value_at(const std::vector<double>& times, const std::vector<double>& values, double t) {
  const auto k = static_cast<std::size_t>(std::lower_bound(times.begin(), times.end(), t) - times.begin());
  if (k == 0 || k == times.size()) return k == 0 ? values.front() : values.back();
  const double share = (t - times[k - 1]) / (times[k] - times[k - 1]);
  return (1.0 - share) * values[k - 1] + share * values[k];
}

// m/s, mean over a fiftieth of the height about y: sound that the start left swings on top of the velocity.
inline std::optional<double> fall_at(const measures& m, double y, double height) {
  const double span = 0.02 * height;
  const auto above = when_below(m, y + 0.5 * span), below = when_below(m, y - 0.5 * span);
  return above && below ? std::optional(span / (*below - *above)) : std::nullopt;
}

// m/s, downward, of the metal's centroid over the time of the input's choice.
inline std::optional<double> fall_between(const measures& m, const options& o) {
  const auto &t = m.by_time(&measures::time), &centroid = m.by_time(&measures::centroid);
  const double from = o.measure_from.value_or(t.front()), until = o.measure_until.value_or(t.back());
  if (!(until > from && from >= t.front() && until <= t.back())) return std::nullopt;
  return (value_at(t, centroid, from) - value_at(t, centroid, until)) / (until - from);
}

// s, between crossings of zero of the stretch, from the first to the last; nothing with fewer than three.
inline std::optional<double> oscillation_period(const measures& m) {
  std::vector<double> crossings;
  const auto &t = m.by_time(&measures::time), &f = m.by_time(&measures::stretch);
  for (std::size_t k = 1; k < f.size(); ++k)
    if ((f[k - 1] > 0.0) != (f[k] > 0.0))
      crossings.push_back(t[k - 1] + (t[k] - t[k - 1]) * f[k - 1] / (f[k - 1] - f[k]));
  if (crossings.size() < 3) return std::nullopt;
  return 2.0 * (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
}

// s, of the part 1 - 1/e.
inline std::optional<double> when_equilibrated(const measures& m, const std::vector<double>& part) {
  const double wanted = 1.0 - std::exp(-1.0);
  const auto& t = m.by_time(&measures::time);
  for (std::size_t k = 1; k < part.size(); ++k)
    if (part[k] >= wanted && part[k - 1] < wanted)
      return t[k - 1] + (t[k] - t[k - 1]) * (wanted - part[k - 1]) / (part[k] - part[k - 1]);
  return std::nullopt;
}

// At the times of the record, the same of a round drop at rest in the middle of as much silicate, with the partition
// coefficient that the drop had: diffusion along the radius alone.
template <int D>
std::vector<double> equilibration_at_rest(const measures& m, const fluids<D>& f) {
  const auto& [mass, volume, metal, metal_volume] = m.totals_start;
  const auto &t = m.by_time(&measures::time), &partition = m.by_time(&measures::partition);
  const double unit = D == 2 ? std::numbers::pi : 4.0 / 3.0 * std::numbers::pi;
  const auto radius_of = [&](double V) { return D == 2 ? std::sqrt(V / unit) : std::cbrt(V / unit); };
  const auto& e = f.o.element;
  const double one = 1.0 / f.number_of_drops();  // with its share of the silicate
  auto part = theory::mean_inside(
      {D, radius_of(one * metal_volume), radius_of(one * volume), metal / metal_volume,
       (mass - metal) / (volume - metal_volume), e.diffusivity_metal, e.diffusivity_silicate, e.concentration_metal,
       e.concentration_silicate, [&](double at) { return value_at(t, partition, at); }},
      t);
  for (std::size_t k = 0; k < part.size(); ++k) part[k] = equilibration(m, f, part[k], partition[k]);
  return part;
}

// ---- the summary, by subject ----------------------------------------------------------------

template <int D>
void tell_growth(json& j, const measures& m, const fluids<D>& f) {
  const auto& p = f.p;
  // Linear: less than 0.03 wavelengths high; the start has gone by a fifth.
  const auto& mode = m.by_time(&measures::mode);
  const double most = p.mode ? 0.03 * 2.0 * std::numbers::pi / p.mode->k / mode.front() : 0.0;
  const auto fit =
      p.mode ? theory::fit_growth(m.by_time(&measures::time), mode, 1.2, std::min(20.0, most)) : std::nullopt;
  j["growth_rate"] = fit ? json(fit->rate) : json(nullptr);
  j["growth_rate_uncertainty"] = fit ? json(fit->uncertainty) : json(nullptr);
  j["growth_rate_theory"] = or_null(p.growth);
  if (f.o.slowing.any()) j["growth_rate_slowed"] = or_null(p.growth_slowed);
  j["growth_rate_incompressible"] = or_null(p.growth_incompressible);
  j["mode_amplitude"] = m.mode;
}

template <int D>
void tell_tension(json& j, const measures& m, const fluids<D>& f, double fall) {
  const auto& o = f.o;
  // m, of a round drop of one drop's volume as particles have it.
  const double radius_now =
      D == 3 ? std::cbrt(0.75 * m.drop_volume / std::numbers::pi) : std::sqrt(m.drop_volume / std::numbers::pi);
  const double radius = o.radius, rho = f.p.base->at(o.measure_at * o.domain.length[1]).density;
  j["laplace_pressure"] = std::isfinite(m.laplace_pressure) ? json(m.laplace_pressure) : json(nullptr);
  j["laplace_pressure_theory"] = (D - 1) * o.surface_tension / radius_now;
  if (!f.many()) {
    j["oscillation_period"] = or_null(oscillation_period(m));
    j["oscillation_period_theory"] = f.p.oscillation_period;
  }
  j["bond_number"] = f.p.bond_number;
  j["weber_number"] = rho * fall * fall * 2.0 * radius / o.surface_tension;
  j["reynolds_number"] = rho * std::abs(fall) * 2.0 * radius / o.material[0].viscosity;
  j["surface_excess"] = m.surface / (o.surface_tension * f.number_of_drops() * round_surface<D>(radius_now));
}

template <int D>
void tell_drops(json& j, const measures& m, const fluids<D>& f) {
  const double L = f.o.domain.length[1];
  const auto fall = f.many() ? fall_between(m, f.o) : fall_at(m, f.o.measure_at * L, L);
  j["fall_velocity"] = or_null(fall);
  j["fall_velocity_theory"] = or_null(f.p.theory_fall);
  if (f.many()) {
    j["fall_velocity_alone"] = or_null(f.p.fall_alone);
    j["fall_velocity_array"] = or_null(f.p.fall_array);
    j["hindered_settling_factor"] = or_null(f.p.hindered);
    j["volume_fraction"] = m.fraction_start;
    j["bodies_start"] = m.by_time(&measures::bodies).front();
  } else {
    j["stretch"] = m.stretch;
  }
  j["bodies"] = m.bodies;
  j["largest_body"] = m.largest_body;
  if (f.tense) tell_tension(j, m, f, fall.value_or(m.fall));
}

template <int D>
void tell_flow(json& j, const measures& m, const fluids<D>& f) {
  const double L = f.o.domain.length[1];
  j["metal_centroid"] = m.centroid / L;
  for (const double fall : {0.1, 0.2, 0.3})
    j["time_of_fall_" + fmt::format("{:.1f}", fall)] =
        or_null(when_below(m, m.by_time(&measures::centroid).front() - fall * L));
  j["viscous_order"] = f.fourth_order() ? 4 : 2;
  j["v_rms"] = m.v_rms;
  j["v_rms_max"] = m.v_rms_max;
  j["v_rms_max_time"] = m.v_rms_max_time;
  j["mach_max"] = m.mach_max;
  j["energy_residual"] = m.residual;
  j["energy_residual_max"] = m.residual_max;
  j["density_ratio_min"] = m.density_min;
  j["density_ratio_max"] = m.density_max;
  j["pressure_min"] = m.pressure_min;
}

template <int D>
void tell_materials(json& j, const measures& m, const fluids<D>& f) {
  for (std::size_t n = 0; n < m.further.size(); ++n) {
    const auto& name = f.o.material[n + 2].name;
    j["mass_" + name] = m.further[n].mass;
    j["centroid_" + name] = m.further[n].centroid;
  }
}

template <int D>
void tell_element(json& j, const measures& m, const fluids<D>& f) {
  j["element_mass_error"] = m.element_error;
  j["concentration_metal"] = m.in_metal;
  j["partition_coefficient"] = m.partition;
  j["equilibration"] = m.equilibration;
  j["equilibration_time"] = or_null(when_equilibrated(m, m.by_time(&measures::equilibration)));
  if (!(f.is_drop() && m.totals_start.metal_mass > 0.0)) return;
  const auto reference = equilibration_at_rest(m, f);
  j["equilibration_reference"] = reference.back();
  j["equilibration_time_reference"] = or_null(when_equilibrated(m, reference));
}

template <int D>
void tell_heat(json& j, const measures& m, const fluids<D>& f) {
  j["melt_fraction"] = m.melt_fraction;
  j["melt_fraction_conducted"] = or_null(f.p.melt_conducted);
  j["heat_residual"] = m.heat_residual;
  j["metal_depth"] = m.metal_depth;
  j["metal_below"] = m.metal_below;
}

template <int D>
void tell(run::summary& r, const measures& m, const fluids<D>& f) {
  auto& j = r.metrics;
  if (f.is_drop())
    tell_drops(j, m, f);
  else
    tell_growth(j, m, f);
  tell_flow(j, m, f);
  tell_materials(j, m, f);
  if (f.dissolved) tell_element(j, m, f);
  if (f.enthalpy) tell_heat(j, m, f);
  f.sources.tell(j);
  const auto& w = f.world.w;
  const auto total = static_cast<double>(f.placed);
  j["particles_lost"] = f.placed - f.ranks().sum(static_cast<std::int64_t>(w.s.fluid));
  j["spurious_shear_modulus"] = f.p.spurious_modulus;
  j["neighbours"] = static_cast<double>(f.ranks().sum(static_cast<std::int64_t>(w.list.pairs))) / total;
  r.conservation = {{"mass", m.mass_drift}, {"momentum", nullptr}, {"energy", m.residual}};
}

}  // namespace tetsuame::two_fluids
