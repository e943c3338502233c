// The particles of the planet, and what is measured of them against its profile.
#include <cmath>
#include <foundation/exact_sum.hpp>
#include <functional>
#include <gas/setup_parts.hpp>
#include <memory>
#include <planet/fragments.hpp>
#include <planet/options.hpp>
#include <planet/shells.hpp>
#include <planet/sums.hpp>

namespace tetsuame::planet {

namespace {

using gas::point, gas::view;

double mean_square_speed(const view& w) {  // m²/s², by mass
  return mean_by_mass(w, all, [&](std::size_t i) {
    const point v = w.velocity(i);
    return v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
  });
}

// Mean of |value/profile - 1| by mass, beyond two smoothing lengths of interfaces and within: of density and pressure.
struct errors {
  std::optional<double> density, pressure, density_at_interfaces;  // none: no particle is there
};

errors errors_of(const view& w, const profile& planet, double h_over_dx, const point& centre) {
  foundation::exact_sum mass, density, pressure, near_mass, near;
  for (std::size_t i = 0; i < w.n; ++i) {
    const double r = gas::distance(w.place(i), centre), h = h_over_dx * planet.form().root(w.volume[i]);
    double apart = std::abs(r - planet.radius());
    for (std::size_t n = 0; n + 1 < planet.layers().size(); ++n)
      apart = std::min(apart, std::abs(r - planet.layers()[n].outer().r));
    const level here = planet.at(r, planet.layer_at(r));
    const double of_density = w.m[i] * std::abs(w.rho[i] / here.rho - 1.0);
    if (apart < 2.0 * h || r > planet.radius()) {
      near_mass.add(w.m[i]);
      near.add(of_density);
      continue;
    }
    mass.add(w.m[i]);
    density.add(of_density);
    pressure.add(w.m[i] * std::abs(w.p[i] / here.p - 1.0));
  }
  const double M = w.ranks.exact(mass), N = w.ranks.exact(near_mass);
  const auto mean = [&](const foundation::exact_sum& sum, double by) {
    const double all = w.ranks.exact(sum);
    return by > 0.0 ? std::optional(all / by) : std::nullopt;
  };
  return {mean(density, M), mean(pressure, M), mean(near, N)};
}

// Mean by mass of (x_a - centre_a)², m².
point spread_of(const view& w) {
  const point centre = centre_of(w, all).place;
  point square{};
  for (std::size_t a = 0; a < 3 && w.x[a] != nullptr; ++a)
    square[a] = mean_by_mass(w, all, [&](std::size_t i) { return (w.x[a][i] - centre[a]) * (w.x[a][i] - centre[a]); });
  return square;
}

// Mean distance from the planet's centre of mass, by mass, m.
double mean_radius(const view& w, std::int32_t material) {
  const point centre = centre_of(w, all).place;
  return mean_by_mass(w, of_material(w, material), [&](std::size_t i) { return gas::distance(w.place(i), centre); });
}

void displace(const growing_mode& mode, const point& centre, gas::placed& p) {
  const auto by = mode.displacement(p.x[0] - centre[0], p.x[1] - centre[1]);
  for (std::size_t a = 0; a < 2; ++a) {
    p.x[a] += by[a];
    p.now.v[a] += mode.growth_rate() * by[a];
  }
}

std::vector<std::size_t> layers_by_material(const options& o) {
  std::vector<std::size_t> all;
  for (std::size_t n = 0; n < o.names.size(); ++n) all.push_back(o.layer_of(static_cast<std::int32_t>(n)));
  return all;
}

// Of the history, and of its end in summary.json.
struct metal_column {
  const char *name, *unit;
  double metal_of_impactor::*value;
};
constexpr std::array metal_columns{metal_column{"impactor_metal_pieces", "1", &metal_of_impactor::pieces},
                                   metal_column{"impactor_metal_largest", "1", &metal_of_impactor::largest},
                                   metal_column{"impactor_metal_merged", "1", &metal_of_impactor::merged},
                                   metal_column{"impactor_metal_mixed", "1", &metal_of_impactor::mixed},
                                   metal_column{"impactor_metal_distance", "m", &metal_of_impactor::distance}};

constexpr const char* mode_trace = "mode_amplitude";

void tell_growth(const growing_mode& mode, const gas::samples& lines, std::size_t column, gas::numbers& told) {
  std::vector<double> time, amplitude;
  for (const auto& line : lines) time.push_back(line[0]), amplitude.push_back(line[column]);
  const auto fit = mode.fit(time, amplitude);
  told.emplace_back("growth_rate", fit ? std::optional(fit->rate) : std::nullopt);
  told.emplace_back("growth_rate_uncertainty", fit ? std::optional(fit->uncertainty) : std::nullopt);
  told.emplace_back("growth_rate_theory", mode.growth_rate());
}

}  // namespace

gas::setup start_of(const options& o) {
  const auto planet = std::make_shared<const profile>(*o.structure);
  const double R = planet->radius(), M = planet->mass();
  const bool is_sphere = planet->form().is_sphere();
  const point centre{R, R, is_sphere ? R : 0.0};
  gas::setup t;
  const double spin = o.spin_period ? 2.0 * pi / *o.spin_period : 0.0;
  t.turns = {spin, o.expansion, centre};
  std::optional<changed_by_regions> regions;
  if (o.regions.any()) regions.emplace(o);
  for (const auto& p : on_shells(*planet, o.names, o.particles)) {
    const point x{centre[0] + p.x[0], centre[1] + p.x[1], centre[2] + p.x[2]};
    const level here = planet->at(gas::distance(x, centre), p.layer);
    gas::state now{here.rho, here.p, {}, o.material_of(p.layer), here.T};
    for (std::size_t a = 0; a < 3 && !o.gas.common.start.settles(); ++a) now.v[a] = t.turns.velocity(a, x);
    t.particles.push_back({x, p.mass, now});
    if (regions) regions->apply(p.x, t.particles.back());
    if (o.mode) displace(*o.mode, centre, t.particles.back());
  }
  if (regions) regions->expect_used();
  const std::int32_t core = o.material_of(0);
  const bool layered = planet->layers().size() > 1;
  const double escape = planet->form().fall(M, R);  // m/s
  t.scales = {M * escape, M * R * escape};
  t.traces = {{"v_rms", "m/s", [](const view& w) { return std::sqrt(mean_square_speed(w)); }},
              {"radius_rms", "m", [](const view& w) {
                 const auto square = spread_of(w);
                 return std::sqrt(square[0] + square[1] + square[2]);
               }}};
  if (layered)
    for (std::size_t n = 0; n < o.names.size(); ++n)
      t.traces.push_back({"radius_" + o.names[n], "m",
                          [material = o.material_of(n)](const view& w) { return mean_radius(w, material); }});
  if (o.mode)
    t.traces.push_back({mode_trace, "m", [mode = *o.mode, layer_of = layers_by_material(o)](const view& w) {
                          return mode.measure(w, centre_of(w, all).place, layer_of);
                        }});
  const std::size_t amplitude = t.traces.size();  // its place in a line, after the time
  const double h_over_dx = o.gas.common.kernel.h_over_dx;
  t.known = {{"planet_radius", R}, {"central_pressure", planet->centre().p}, {"central_density", planet->centre().rho}};
  t.measures = [=, mode = o.mode](const view& w, const gas::samples& lines) {
    const errors e = errors_of(w, *planet, h_over_dx, centre_of(w, all).place);
    gas::numbers told{
        {"profile_density_error", e.density},
        {"profile_pressure_error", e.pressure},
        {"profile_density_error_at_interfaces", e.density_at_interfaces},
        {is_sphere ? "v_rms_over_v_escape" : "v_rms_over_v_fall", std::sqrt(mean_square_speed(w)) / escape}};
    if (layered) told.emplace_back("core_mass", mass_of(w, of_material(w, core)));
    if (mode) tell_growth(*mode, lines, amplitude, told);
    if (spin != 0.0 && is_sphere) {
      const auto square = spread_of(w);
      told.emplace_back("axis_ratio", std::sqrt(2.0 * square[2] / (square[0] + square[1])));
    }
    return told;
  };
  follow_melt_and_element(o, t);
  return t;
}

gas::setup impact_start(const options& o) {
  const auto bodies = std::make_shared<const options::bodies>(*o.impact_of);
  const auto& [target, impactor, start] = *bodies;
  point centre{};
  for (std::size_t a = 0; a < 3; ++a) centre[a] = 0.5 * o.gas.domain.length[a];
  gas::setup t;
  t.particles = meet(target, impactor, start, centre);
  const double M = target.mass + impactor.mass, R = target.radius + impactor.radius;
  t.scales = {M * start.escape_velocity, target.mass * impactor.mass / M * R * start.contact_speed};
  t.known = {{"mutual_escape_velocity", start.escape_velocity},
             {"contact_speed", start.contact_speed},
             {"target_radius", target.radius},
             {"impactor_radius", impactor.radius}};
  const auto of_target = static_cast<std::int64_t>(target.particles.size());
  t.traces = {{"separation", "m", [of_target](const view& w) {
                 const auto is_target = [&](std::size_t i) { return w.id[i] < of_target; };
                 return gas::distance(centre_of(w, is_target).place, centre_of(w, std::not_fn(is_target)).place);
               }}};
  const std::int32_t metal = o.material_of(0);
  const auto found = std::make_shared<metal_of_impactor>();  // of a line: its first column has it looked for
  for (const metal_column& c : metal_columns)
    t.traces.push_back({c.name, c.unit, [=](const view& w) {
                          if (c.value == metal_columns.front().value)
                            *found = find_metal_of_impactor(w, of_target, metal);
                          return (*found).*c.value;
                        }});
  t.measures = [bodies, metal, of_target](const view& w, const gas::samples&) {
    const remnants left = find_remnants(w, bodies->target, metal);
    gas::numbers told{{"planet_radius", left.planet_radius}};
    const auto add = [&](const std::string& name, const remnants::part& part) {
      told.emplace_back(name + "_mass", part.mass);
      told.emplace_back(name + "_metal_mass", part.metal);
      told.emplace_back(name + "_impactor_mass", part.of_impactor);
      told.emplace_back(name + "_angular_momentum", part.angular_momentum);
    };
    add("planet", left.planet);
    add("disk", left.disk);
    add("escaping", left.escaping);
    const auto pieces = find_metal_of_impactor(w, of_target, metal);
    for (const metal_column& c : metal_columns) told.emplace_back(c.name, pieces.*c.value);
    return told;
  };
  follow_melt_and_element(o, t);
  return t;
}

}  // namespace tetsuame::planet
