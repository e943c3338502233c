// What a run of convection measures, line by line of its history, and what it reports at its end.
#pragma once

#include <convection/measures.hpp>
#include <convection/rates.hpp>
#include <convection/steady.hpp>
#include <output/history.hpp>
#include <run/summary.hpp>

namespace tetsuame::convection {

// Steadiness and averages are over so many turnovers L/v_rms, and at least so much of the diffusion time: within them a
// flow that swings has come to rest or is seen not to. Where the viscous response is relaxed one swing is enough,
// beside which the rest is told: docs/theory/convection.md, "When a flow is steady".
inline constexpr double turnovers = 6.0, of_a_swing = 1.75, least_window = 0.01;
// How much larger the tolerance is of a coarser level, and of the swing that is left.
inline constexpr double coarser_tolerance = 10.0, swing_tolerance = 10.0;
// The same of the standard deviation over six turnovers, which has the noise of the particles in it.
inline constexpr double deviation_tolerance = 25.0;
// A flow is not called steady where heat in and out differ by more of what goes through.
inline constexpr double largest_imbalance = 0.01;

// Of left, right, back and front (walls::side_names) those that heat passes.
template <int D>
std::vector<std::size_t> sides_with_heat(const convection_state<D>& state) {
  std::vector<std::size_t> all;
  for (const auto& wall : state.world.walls.sides)
    if (wall.axis != 1 && (wall.thermal == walls::heat::fixed_temperature || wall.flux != 0.0))
      all.push_back(2 * wall.axis + (wall.inward < 0.0 ? 1 : 0));
  return all;
}

// Nusselt numbers count heat along the axis, or from the hot side to the cold one.
inline double counted_along(const parameters& layer, std::size_t side) {
  return side / 2 == layer.heat_axis ? layer.heat_sign : 1.0;
}

// By friction there is a Nusselt number only where heat goes upwards. Heats of friction, of what rising takes, and work
// of buoyancy and of &sources, whether or not they heat, are of kappa DeltaT c_p/L² (W/kg).
template <int D>
std::vector<std::string> measures_of(const convection_state<D>& state) {
  std::vector<std::string> all{
      "nusselt_volume", "nusselt_top", "nusselt_bottom", "v_rms", "u_max", "v_max", "q1", "q2", "q3", "q4"};
  if (state.layer.heat_axis == 1) all.emplace_back("nusselt_dissipation");
  all.insert(all.end(), {"viscous_heating", "adiabatic_cooling", "buoyancy_work"});
  for (const std::size_t n : sides_with_heat(state)) all.push_back(std::string("nusselt_") + walls::side_names[n]);
  return all;
}
// Places among them.
inline constexpr std::size_t of_nusselt = 0, of_v_rms = 3;
inline bool has_uncertainty(const std::string& name) {
  return name == "v_rms" || (name.starts_with("nusselt_") && name != "nusselt_dissipation");
}

// Of the last line.
struct measured {
  std::vector<std::string> names;
  record samples{names.size()};
  double v_rms = 0.0;  // m/s
  double mach = 0.0, density_drift = 0.0, momentum = 0.0;
  double outside = 0.0;  // the largest share of particles that the viscosity's table did not cover

  // Those that a checkpoint has, by name.
  std::array<std::pair<const char*, double*>, 5> scalars() {
    return {{{"v_rms", &v_rms},
             {"mach", &mach},
             {"density_drift", &density_drift},
             {"momentum", &momentum},
             {"outside", &outside}}};
  }
};

inline std::vector<output::history_column> history_columns(const measured& m) {
  std::vector<output::history_column> all;
  for (const auto& name : m.names) {
    const bool velocity = name == "v_rms" || name == "u_max" || name == "v_max";
    all.push_back({name, velocity ? "kappa/L" : "1"});
  }
  all.push_back({"v_rms_si", "m/s"});
  all.push_back({"mach", "1"});
  all.push_back({"mean_density_drift", "1"});
  return all;
}

// Over the box: heat carried beyond conduction, T v (K m/s), v² (m2/s2), and W/kg of buoyancy, of rising and of
// friction.
template <int D>
std::array<double, 5> means_over_box(const convection_state<D>& state) {
  const auto& s = state.fluid();
  const auto& layer = state.layer;
  std::array<particles::array, 5> all;
  for (auto& f : all) f.resize(s.total() + 1);
  auto &carried = all[0], &v2 = all[1], &work = all[2], &cooling = all[3], &friction = all[4];
  foundation::for_all(s.fluid, [&](std::size_t i) { friction[i] = dissipation(state, i, state.viscosity(i)); });
  walls::update_ghosts_and_images(state.world.w, state.world.walls, walls::even({&friction}));
  foundation::for_all(s.total(), [&](std::size_t i) {
    const double y = s.x[1][i], T = s.T[i], rising = s.v[1][i];
    carried[i] = (layer.heat_axis == 1 ? rising : layer.heat_sign * s.v[layer.heat_axis][i]) *
                 (T - reference_temperature(layer, y));
    v2[i] = 0.0;
    for (std::size_t a = 0; a < D; ++a) v2[i] += s.v[a][i] * s.v[a][i];
    work[i] = buoyancy(layer, y, T, state.p[i]) * rising;
    if (state.sources.force()) {
      std::array<double, 3> x{};
      for (std::size_t a = 0; a < D; ++a) x[a] = s.x[a][i];
      for (std::size_t a = 0; a < D; ++a) work[i] += state.sources.force_at(a, x, s.T[i]) * s.v[a][i];
    }
    cooling[i] = buoyancy_slope(layer, y, T) * rising * T;
  });
  return mean_over_box(state.world, state.at_start.particles, all);
}

// What should stay zero: the mean of p over that of sound, and the momentum over its parts.
template <int D>
void measure_drift(const convection_state<D>& state, measured& m) {
  const auto& s = state.fluid();
  const auto& layer = state.layer;
  const auto& ranks = state.ranks();
  foundation::exact_sum drift, speeds;
  std::array<foundation::exact_sum, D> momentum;
  std::int64_t outside = 0;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    double v2 = 0.0;
    for (std::size_t a = 0; a < D; ++a) {
      v2 += s.v[a][i] * s.v[a][i];
      momentum[a].add(s.v[a][i]);
    }
    speeds.add(std::sqrt(v2));
    const double xi2 = inertia(layer, state.viscosity(i));
    drift.add(state.p[i] / (layer.fluid.rho * xi2 * layer.c_eff * layer.c_eff));
    if (layer.law.table && !layer.law.table->covers(s.T[i], layer.fluid.L - s.x[1][i])) ++outside;
  }
  const auto particles = static_cast<double>(state.world.fluid_total);
  m.density_drift = ranks.exact(drift) / particles;
  m.outside = std::max(m.outside, static_cast<double>(ranks.sum(outside)) / particles);
  const double scale = ranks.exact(speeds);
  m.momentum = 0.0;
  for (std::size_t a = 0; a < D; ++a) m.momentum = std::max(m.momentum, std::abs(ranks.exact(momentum[a])));
  m.momentum = scale > 0.0 ? m.momentum / scale : 0.0;
}

// A line of the history; velocities in kappa/L.
template <int D>
std::vector<double> measure(const convection_state<D>& state, double t, measured& m) {
  const auto& layer = state.layer;
  const auto& f = layer.fluid;
  const double unit = f.kappa / f.L, heat_unit = layer.heat_capacity * unit / f.L * f.dT;
  measure_drift(state, m);
  m.mach = fastest_flow(state) / layer.c_eff;
  const auto [carried, v2, work, cooling, friction] = means_over_box(state);
  m.v_rms = std::sqrt(std::max(v2, 0.0));  // interpolation may overshoot where a few particles hold a roll
  const auto walls = wall_heat(state.world, state.at_start.particles, state.input.domain.length,
                               layer.heat_length / f.dT, layer.conductivity);
  std::vector<double> line{1.0 + carried / (f.kappa / layer.heat_length * f.dT), walls.nusselt[3], walls.nusselt[2],
                           m.v_rms / unit};
  for (std::size_t a = 0; a < 2; ++a) {
    double largest = 0.0;
    for (std::size_t i = 0; i < state.fluid().fluid; ++i) largest = std::max(largest, std::abs(state.fluid().v[a][i]));
    line.push_back(state.ranks().maximum(largest) / unit);
  }
  line.insert(line.end(), walls.corners.begin(), walls.corners.end());
  // Where the flow is steady viscosity takes what buoyancy gives, <2 nu e:e> = alpha g <v_y T'>.
  if (layer.heat_axis == 1) line.push_back(1.0 + friction / (f.alpha * f.g * unit * f.dT));
  for (const double heat : {friction, cooling, work}) line.push_back(heat / heat_unit);
  for (const std::size_t n : sides_with_heat(state)) line.push_back(counted_along(layer, n) * walls.nusselt[n]);
  m.samples.add(t, line);
  line.insert(line.end(), {m.v_rms, m.mach, m.density_drift});
  return line;
}

template <int D>
double turnover(const convection_state<D>& state, const measured& m) {  // s
  const auto& f = state.layer.fluid;
  return f.L / (m.v_rms > 0.0 ? m.v_rms : f.kappa / f.L);
}

template <int D>
double window(const convection_state<D>& state, const measured& m, bool of_swing) {  // s, of averages
  const auto& f = state.layer.fluid;
  return std::max((of_swing ? of_a_swing : turnovers) * turnover(state, m), least_window * f.L * f.L / f.kappa);
}

// Of nusselt_volume and v_rms: whether they no longer change, over six turnovers; and whether they are known sooner,
// beside a swing, where the viscous response is relaxed.
template <int D>
bool decided(const convection_state<D>& state, const measured& m, double tolerance, bool beside_a_swing) {
  const double span = window(state, m, beside_a_swing);
  if (!m.samples.full(span) || m.samples.last_time() < state.layer.ramp + span) return false;
  return std::ranges::all_of(std::array{of_nusselt, of_v_rms}, [&](std::size_t k) {
    if (!beside_a_swing) {
      const auto mean = m.samples.over(k, span);
      return m.samples.settled(k, span, tolerance) &&
             mean.swing <= deviation_tolerance * tolerance * std::abs(mean.mean);
    }
    const auto a = m.samples.beside_a_swing(k, span, turnover(state, m));
    const double most = tolerance * std::abs(a.mean);
    return a.uncertainty && *a.uncertainty <= most && a.swing <= swing_tolerance * most;
  });
}
template <int D>
bool known_beside_a_swing(const convection_state<D>& state, const measured& m, double tolerance) {
  return state.layer.relaxed && decided(state, m, tolerance, true);
}
template <int D>
bool settled(const convection_state<D>& state, const measured& m, double tolerance) {
  return known_beside_a_swing(state, m, tolerance) || decided(state, m, tolerance, false);
}

// Heat that comes in through walls or from inside less what leaves, over that which goes through; of means, all over
// the area of a wall of conduction. None where &sources heats.
template <int D>
std::optional<double> heat_imbalance(const convection_state<D>& state, const nlohmann::ordered_json& means) {
  if (state.sources.heat()) return {};
  const auto& layer = state.layer;
  const auto& f = layer.fluid;
  const auto& c = state.input.convection;
  const auto& length = state.input.domain.length;
  const double l = layer.heat_length, per_L = l / f.L;
  double left = layer.heating * l * l / (f.kappa * f.dT), through = 0.0;
  if (c.viscous_heating) left += per_L * per_L * means["viscous_heating"].template get<double>();
  if (c.adiabatic_heating) left -= per_L * per_L * means["adiabatic_cooling"].template get<double>();
  auto sides = sides_with_heat(state);
  sides.insert(sides.end(), {2, 3});
  for (const std::size_t n : sides) {
    const double area = l / length[n / 2];  // over that of a wall which heat is conducted from
    const double passes = area * means[std::string("nusselt_") + walls::side_names[n]].template get<double>();
    left += (n % 2 == 0 ? passes : -passes) * counted_along(layer, n);
    through += 0.5 * std::abs(passes);
  }
  return through != 0.0 ? left / through : 0.0;
}

template <int D>
void report(const convection_state<D>& state, const measured& m, bool steady, run::summary& r) {
  auto& j = r.metrics;
  const auto& layer = state.layer;
  const auto& f = layer.fluid;
  const bool beside = steady && known_beside_a_swing(state, m, state.input.convection.steady_tolerance);
  const double span = window(state, m, beside);
  for (std::size_t k = 0; k < m.names.size(); ++k) {
    const auto a = beside ? m.samples.beside_a_swing(k, span, turnover(state, m)) : m.samples.over(k, span);
    j[m.names[k]] = a.mean;
    if (has_uncertainty(m.names[k])) j[m.names[k] + "_uncertainty"] = run::or_null(a.uncertainty);
  }
  const auto imbalance = heat_imbalance(state, j);
  const bool balanced = !imbalance || std::abs(*imbalance) <= largest_imbalance;
  if (steady && !balanced)
    r.warnings.push_back(fmt::format(
        "what is measured no longer changes, but heat in and out differ by {:.2g} %: not called steady. More particles "
        "resolve what is thin at the walls",
        100.0 * *imbalance));
  j["averaged_over"] = span;
  j["steady"] = steady && balanced;
  j["levels_left"] = state.at_start.level;
  j["mach"] = m.mach;
  j["mean_density_drift"] = m.density_drift;
  j["rayleigh"] = relaxation::rayleigh(f);
  j["prandtl"] = relaxation::prandtl(f);
  j["dissipation_number"] = layer.dissipation_number;
  j["reynolds_effective"] = m.v_rms * f.L / layer.nu_eff;
  j["prandtl_effective"] = layer.nu_eff / f.kappa;
  j["viscous_response"] = layer.relaxed ? "relaxed" : "instant";
  j["zeta"] = layer.slowing.zeta;
  j["xi"] = layer.slowing.xi;
  j["sound_speed_effective"] = layer.c_eff;
  j["target"] = layer.steady ? "steady" : "transient";
  if (layer.law.table) j["outside_viscosity_table"] = m.outside;
  // Where the flow is steady, friction takes the work of buoyancy.
  const double friction = j["viscous_heating"], work = j["buoyancy_work"];
  j["work_imbalance"] = friction > 0.0 ? (work - friction) / friction : 0.0;
  j["heat_imbalance"] = imbalance ? nlohmann::ordered_json(*imbalance) : nlohmann::ordered_json(nullptr);
  r.conservation = {{"mass", m.density_drift}, {"momentum", m.momentum}, {"energy", imbalance.value_or(0.0)}};
}

}  // namespace tetsuame::convection
