// What the summary of a run tells, out of the lines of its history: growth, times of fall, velocity and shape of drops,
// uptake of an element.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <run/summary.hpp>
#include <theory/radial_exchange.hpp>
#include <two_fluids/growth.hpp>
#include <two_fluids/measures.hpp>

namespace tetsuame::two_fluids {

using json = nlohmann::ordered_json;
using run::or_null;

// ---- the centroid by time -------------------------------------------------------------------

// s, of the first line where the metal's centroid is as low, by straight lines between.
inline std::optional<double> when_below(const record& r, double y) {
  for (std::size_t k = 1; k < r.time.size(); ++k)
    if (r.centroid[k] <= y && r.centroid[k - 1] > y) {
      const double share = (r.centroid[k - 1] - y) / (r.centroid[k - 1] - r.centroid[k]);
      return r.time[k - 1] + (r.time[k] - r.time[k - 1]) * share;
    }
  return std::nullopt;
}

inline double centroid_at(const record& r, double t) {
  const auto k = static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(std::lower_bound(r.time.begin(), r.time.end(), t) - r.time.begin(), 1,
                                 static_cast<std::ptrdiff_t>(r.time.size()) - 1));
  const double part = (t - r.time[k - 1]) / (r.time[k] - r.time[k - 1]);
  return (1.0 - part) * r.centroid[k - 1] + part * r.centroid[k];
}

// m/s, mean over a fiftieth of the height about y: sound that the start left swings on top of the velocity.
inline std::optional<double> fall_at(const record& r, double y, double height) {
  const double span = 0.02 * height;
  const auto above = when_below(r, y + 0.5 * span), below = when_below(r, y - 0.5 * span);
  return above && below ? std::optional(span / (*below - *above)) : std::nullopt;
}

// m/s, downward, of the metal's centroid over the time of the input's choice.
inline std::optional<double> fall_between(const record& r, const options& o) {
  const double from = o.measure_from.value_or(r.time.front()), until = o.measure_until.value_or(r.time.back());
  if (!(until > from && from >= r.time.front() && until <= r.time.back())) return std::nullopt;
  return (centroid_at(r, from) - centroid_at(r, until)) / (until - from);
}

// s, between crossings of zero of the stretch, from the first to the last; nothing with fewer than three.
inline std::optional<double> oscillation_period(const record& r) {
  std::vector<double> crossings;
  const auto& f = r.stretch;
  for (std::size_t k = 1; k < f.size(); ++k)
    if ((f[k - 1] > 0.0) != (f[k] > 0.0))
      crossings.push_back(r.time[k - 1] + (r.time[k] - r.time[k - 1]) * f[k - 1] / (f[k - 1] - f[k]));
  if (crossings.size() < 3) return std::nullopt;
  return 2.0 * (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
}

// ---- element --------------------------------------------------------------------------------

// s, of the part 1 - 1/e.
inline std::optional<double> when_equilibrated(const record& r, const std::vector<double>& part) {
  const double wanted = 1.0 - std::exp(-1.0);
  for (std::size_t k = 1; k < part.size(); ++k)
    if (part[k] >= wanted && part[k - 1] < wanted)
      return r.time[k - 1] + (r.time[k] - r.time[k - 1]) * (wanted - part[k - 1]) / (part[k] - part[k - 1]);
  return std::nullopt;
}

// The mean partition coefficient by time, constant beyond the record.
inline double partition_at(const record& r, double t) {
  const auto k = static_cast<std::size_t>(std::lower_bound(r.time.begin(), r.time.end(), t) - r.time.begin());
  if (k == 0 || k == r.time.size()) return k == 0 ? r.partition.front() : r.partition.back();
  const double share = (t - r.time[k - 1]) / (r.time[k] - r.time[k - 1]);
  return (1.0 - share) * r.partition[k - 1] + share * r.partition[k];
}

// At the times of the record, the same of a round drop at rest in the middle of as much silicate, with the partition
// coefficient that the drop had: diffusion along the radius alone.
template <int D>
std::vector<double> equilibration_at_rest(const measures& m, const fluids<D>& f) {
  const auto& [metal, metal_volume, mass, volume] = m.metal_start;
  const double unit = D == 2 ? std::numbers::pi : 4.0 / 3.0 * std::numbers::pi;
  const auto radius_of = [&](double V) { return D == 2 ? std::sqrt(V / unit) : std::cbrt(V / unit); };
  const auto& e = f.o.element;
  const double one = 1.0 / f.number_of_drops();  // with its share of the silicate
  auto part = theory::mean_inside(
      {D, radius_of(one * metal_volume), radius_of(one * volume), metal / metal_volume,
       (mass - metal) / (volume - metal_volume), e.diffusivity_metal, e.diffusivity_silicate, e.concentration_metal,
       e.concentration_silicate, [&](double t) { return partition_at(m.lines, t); }},
      m.lines.time);
  for (std::size_t k = 0; k < part.size(); ++k) part[k] = equilibration(m, f, part[k], m.lines.partition[k]);
  return part;
}

// ---- the summary, by subject ----------------------------------------------------------------

template <int D>
void tell_growth(json& j, const measures& m, const fluids<D>& f) {
  const auto& p = f.p;
  // Linear: less than 0.03 wavelengths high; the start has gone by a fifth.
  const double most = p.mode ? 0.03 * 2.0 * std::numbers::pi / p.mode->k / m.lines.mode.front() : 0.0;
  const auto fit = p.mode ? fit_growth(m.lines.time, m.lines.mode, 1.2, std::min(20.0, most)) : std::nullopt;
  j["growth_rate"] = fit ? json(fit->rate) : json(nullptr);
  j["growth_rate_uncertainty"] = fit ? json(fit->uncertainty) : json(nullptr);
  j["growth_rate_theory"] = or_null(p.growth);
  j["growth_rate_incompressible"] = or_null(p.growth_incompressible);
  j["mode_amplitude"] = m.lines.mode.back();
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
    j["oscillation_period"] = or_null(oscillation_period(m.lines));
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
  const auto fall = f.many() ? fall_between(m.lines, f.o) : fall_at(m.lines, f.o.measure_at * L, L);
  j["fall_velocity"] = or_null(fall);
  j["fall_velocity_theory"] = or_null(f.p.theory_fall);
  if (f.many()) {
    j["fall_velocity_alone"] = or_null(f.p.fall_alone);
    j["fall_velocity_array"] = or_null(f.p.fall_array);
    j["hindered_settling_factor"] = or_null(f.p.hindered);
    j["volume_fraction"] = *m.fraction_start;
    j["bodies_start"] = m.lines.bodies.front();
  } else {
    j["stretch"] = m.lines.stretch.back();
  }
  j["bodies"] = m.lines.bodies.back();
  j["largest_body"] = m.lines.largest_body.back();
  if (f.tense) tell_tension(j, m, f, fall.value_or(m.lines.fall.back()));
}

template <int D>
void tell_flow(json& j, const measures& m, const fluids<D>& f) {
  const double L = f.o.domain.length[1];
  j["metal_centroid"] = m.lines.centroid.back() / L;
  for (const double fall : {0.1, 0.2, 0.3})
    j["time_of_fall_" + fmt::format("{:.1f}", fall)] =
        or_null(when_below(m.lines, m.lines.centroid.front() - fall * L));
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
void tell_element(json& j, const measures& m, const fluids<D>& f) {
  j["element_mass_error"] = m.element_error;
  j["concentration_metal"] = m.lines.in_metal.back();
  j["partition_coefficient"] = m.lines.partition.back();
  j["equilibration"] = m.lines.equilibration.back();
  j["equilibration_time"] = or_null(when_equilibrated(m.lines, m.lines.equilibration));
  if (!(f.is_drop() && m.metal_start[0] > 0.0)) return;
  const auto reference = equilibration_at_rest(m, f);
  j["equilibration_reference"] = reference.back();
  j["equilibration_time_reference"] = or_null(when_equilibrated(m.lines, reference));
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
  if (f.dissolved) tell_element(j, m, f);
  if (f.enthalpy) tell_heat(j, m, f);
  const auto& w = f.world.w;
  const auto total = static_cast<double>(f.world.fluid_total);
  j["particles_lost"] = f.world.fluid_total - f.ranks().sum(static_cast<std::int64_t>(w.s.fluid));
  j["spurious_shear_modulus"] = f.p.spurious_modulus;
  j["neighbours"] = static_cast<double>(f.ranks().sum(static_cast<std::int64_t>(w.list.pairs))) / total;
  r.conservation = {{"mass", m.mass_drift}, {"momentum", nullptr}, {"energy", m.residual}};
}

}  // namespace tetsuame::two_fluids
