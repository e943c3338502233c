#include <fmt/format.h>
#include <gravity/options.hpp>

#include <algorithm>
#include <cmath>
#include <free_surface/input.hpp>
#include <kernels/kernel.hpp>
#include <numbers>

namespace tetsuame::free_surface {

namespace {

using namelist::between, namelist::for_expert;

const regions::abilities of_regions{
    .materials = {"water", "none"}, .velocity = true, .density = true, .pressure = true};

const domain::demands demands{.walls_below_and_above = "water has a floor: along y the box is not periodic"};

void declare_water(namelist::schema& schema, flow_options& o) {
  schema.group("flow", "water with a free surface");
  schema.add("flow", "start", o.start,
             {.choices = {"rest", "standing_wave", "drop"},
              .meaning = "rest: blocks of water with hydrostatic pressure; standing_wave: with the velocity of a small "
                         "wave under a level surface; drop: the ellipse within the block, drawn out along y"});
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string axis = along("", a), only = a == 2 ? " (3-D only)" : "";
    schema.add("flow", "low_" + axis, o.low[a],
               {.unit = "m",
                .minimum = 0.0,
                .meaning = "lower edges along " + axis + " of blocks of water, one a block; not given: 0" + only});
    schema.add("flow", "high_" + axis, o.high[a],
               {.unit = "m",
                .minimum = 0.0,
                .exclusive_minimum = true,
                .meaning = "their upper edges; not given: the box's" + only});
  }
  schema.add("flow", "wavelength", o.wavelength, {.unit = "m", .minimum = 0.0, .meaning = "standing_wave: along x"});
  schema.add("flow", "amplitude", o.amplitude,
             {.unit = "m", .minimum = 0.0, .meaning = "standing_wave: that the surface will reach"});
  schema.add("flow", "strain_rate", o.strain_rate,
             {.unit = "1/s",
              .minimum = 0.0,
              .expert = true,
              .meaning = "drop: its velocity is -strain_rate x, strain_rate y"});
}

void declare_liquid(namelist::schema& schema, flow_options& o) {
  gravity::declare(schema, "flow", "gravity", o.gravity);
  // Squares of pressures, and pressures in single precision, stay far from what a number can hold.
  schema.add("flow", "density", o.density,
             {.unit = "kg/m^3", .minimum = 1e-20, .maximum = 1e20, .meaning = "of the water at zero pressure"});
  schema.add(
      "flow", "scheme", o.scheme,
      {.choices = {"delta", "riemann"},
       .expert = true,
       .meaning = "of the sums over neighbours; delta: pairs have the sum of their pressures, with an artificial "
                  "viscosity and diffusion of the density; riemann: that of a Riemann problem between them"});
  schema.add("flow", "exponent", o.exponent,
             for_expert(between(1, 15, "of the density in the pressure, B ((rho/density)^exponent - 1)")));
  schema.add("flow", "sound_factor", o.sound_factor,
             for_expert(between(1.0, 1000.0, "speed of sound over sqrt(gravity times the height of the water)")));
  schema.add("flow", "sound_speed", o.sound_speed,
             {.unit = "m/s",
              .minimum = 0.0,
              .exclusive_minimum = true,
              .stays_open = true,
              .expert = true,
              .meaning = "of the water at zero pressure, some ten times its largest speed; not given: by "
                         "sound_factor, without gravity by surface_tension, too"});
  schema.add("flow", "viscosity", o.viscosity, {.unit = "Pa s", .minimum = 0.0, .meaning = "of the water"});
  schema.add("flow", "surface_tension", o.surface_tension,
             {.unit = "N/m",
              .minimum = 0.0,
              .expert = true,
              .meaning = "of the free surface; walls are at 90 degrees to it. With it the kernel that is not given is "
                         "'wendland_c2' with h_over_dx = 1.5"});
  schema.add("flow", "alpha", o.alpha, for_expert(between(0.0, 1.0, "scheme = 'delta': of the artificial viscosity")));
  schema.add("flow", "delta", o.delta, for_expert(between(0.0, 1.0, "scheme = 'delta': of the density's diffusion")));
  schema.add("flow", "shifting", o.shifting,
             {.minimum = 0.0,
              .maximum = 10.0,
              .stays_open = true,
              .expert = true,
              .meaning = "how fast particles that move drift to where there are fewer, not across the surface; 0: they "
                         "do not, and water that has lost its concentration keeps its pressure and tension. Not given: "
                         "2, with surface_tension and scheme = 'delta' 0. Once a step: with it every method of &time "
                         "is of first order"});
}

void declare_beach(namelist::schema& schema, flow_options& o) {
  schema.add("flow", "beach_rate", o.beach_rate,
             {.unit = "1/s",
              .minimum = 0.0,
              .expert = true,
              .meaning = "of a beach that absorbs waves: at its end the water slows at this rate"});
  for (const auto& [key, at, meaning] :
       {std::tuple{"beach_from", &o.beach_from, "where along x it begins; its rate rises as the square of the way in"},
        std::tuple{"beach_to", &o.beach_to, "where it has its full rate, at smaller or larger x"}})
    schema.add("flow", key, *at, {.unit = "m", .minimum = 0.0, .stays_open = true, .expert = true, .meaning = meaning});
}

void declare_blocks_around(namelist::schema& schema, flow_options& o) {
  schema.add(
      "flow", "around_bodies", o.around_bodies,
      {.expert = true, .meaning = "blocks of water leave out what bodies of &solids cover; else that is an error"});
}

// ---- blocks of water ------------------------------------------------------------------------

std::size_t number_of_blocks(const namelist::schema& schema, const flow_options& o) {
  std::size_t n = 1;
  for (const auto* lists : {&o.low, &o.high})
    for (const auto& list : *lists) n = std::max(n, list.size());
  for (std::size_t a = 0; a < 3; ++a)
    for (const auto& [name, list] : {std::pair{"low_", &o.low[a]}, std::pair{"high_", &o.high[a]}})
      if (!list->empty() && list->size() != n)
        schema.fail("flow", along(name, a), fmt::format("expected {} numbers, one a block, found {}", n, list->size()));
  return n;
}

// Of the box's lattice, so that an edge lies between particles.
void check_edge(const namelist::schema& schema, const options& o, const std::string& key, std::size_t axis, double at) {
  const double dx = o.domain.dx(), length = o.domain.length[axis], spacings = at / dx;
  if (at > length * (1.0 + 1e-9))
    schema.fail("flow", key, fmt::format("water outside the box: {} m, where the box ends at {} m", at, length));
  if (std::abs(spacings - std::round(spacings)) > 1e-6)
    schema.fail("flow", key,
                fmt::format("expected a whole number of particle spacings, {} m each, found {:.6g}", dx, spacings));
}

bool overlap(const block& a, const block& b, std::size_t axes) {
  for (std::size_t k = 0; k < axes; ++k)
    if (!(std::min(a.high[k], b.high[k]) > std::max(a.low[k], b.low[k]) * (1.0 + 1e-9))) return false;
  return true;
}

std::vector<block> find_blocks(const namelist::schema& schema, const options& o) {
  std::vector<block> all(number_of_blocks(schema, o.flow));
  for (std::size_t n = 0; n < all.size(); ++n) {
    for (std::size_t a = 0; a < o.domain.axes(); ++a) {
      const auto &low = o.flow.low[a], &high = o.flow.high[a];
      all[n].low[a] = low.empty() ? 0.0 : low[n];
      all[n].high[a] = high.empty() ? o.domain.length[a] : high[n];
      check_edge(schema, o, along("low_", a), a, all[n].low[a]);
      check_edge(schema, o, along("high_", a), a, all[n].high[a]);
      if (!(all[n].high[a] > all[n].low[a]))
        schema.fail("flow", along("high_", a),
                    fmt::format("expected more than the lower edge of block {}, {} m, found {} m", n + 1, all[n].low[a],
                                all[n].high[a]));
    }
    for (std::size_t k = 0; k < n; ++k)
      if (overlap(all[k], all[n], o.domain.axes()))
        schema.fail("flow", o.flow.low[0].empty() ? "low_y" : "low_x",
                    fmt::format("blocks {} and {} of water overlap", k + 1, n + 1));
  }
  return all;
}

// ---- what does not go together -----------------------------------------------------------------

void check_wave(const namelist::schema& schema, const options& o, const parameters& p) {
  const auto& f = o.flow;
  const bool wave = f.start == "standing_wave";
  if (!wave && f.wavelength > 0.0) schema.fail("flow", "wavelength", "is of start = 'standing_wave'");
  if (!wave && f.amplitude > 0.0) schema.fail("flow", "amplitude", "is of start = 'standing_wave'");
  if (!wave) return;
  if (!(f.wavelength > 0.0)) schema.fail("flow", "wavelength", "a standing wave needs its length");
  if (!(f.amplitude > 0.0)) schema.fail("flow", "amplitude", "a standing wave needs its amplitude");
  if (f.wavelength < 4.0 * o.domain.dx())
    schema.fail("flow", "wavelength", fmt::format("is below four particle spacings, {} m", 4.0 * o.domain.dx()));
  if (!(f.gravity > 0.0)) schema.fail("flow", "gravity", "a standing wave needs gravity");
  const double number = o.domain.length[0] / f.wavelength * (o.domain.periodic[0] ? 1.0 : 2.0);
  if (std::abs(number - std::round(number)) > 1e-6 || number < 0.5)
    schema.fail("flow", "wavelength",
                fmt::format("expected a whole number of {} in the box's {} m, found {:.6g}",
                            o.domain.periodic[0] ? "waves" : "half waves", o.domain.length[0], number));
  const auto& b = p.blocks.front();
  if (p.blocks.size() != 1 || b.low[0] > 0.0 || b.low[1] > 0.0 || b.high[0] < o.domain.length[0] * (1.0 - 1e-9))
    schema.fail("flow", "start", "a standing wave is of one block of water over the whole floor");
}

void check_drop(const namelist::schema& schema, const options& o, const parameters& p) {
  const auto& f = o.flow;
  if (f.start != "drop") {
    if (f.strain_rate > 0.0) schema.fail("flow", "strain_rate", "is of start = 'drop'");
    return;
  }
  const bool tense = f.surface_tension > 0.0;
  if (o.domain.dimension != 2 && !tense)
    schema.fail("flow", "start", "the drop is one of two dimensions; with surface_tension it may be a ball");
  if (f.gravity > 0.0) schema.fail("flow", "gravity", "expected 0: the drop falls nowhere");
  if (!(f.strain_rate > 0.0) && !tense) schema.fail("flow", "strain_rate", "the drop needs how fast it is drawn out");
  const auto& b = p.blocks.front();
  const auto width = [&](std::size_t a) { return b.high[a] - b.low[a]; };
  for (std::size_t a = 1; a < o.domain.axes(); ++a)
    if (p.blocks.size() != 1 || std::abs(width(0) / width(a) - 1.0) > 1e-9)
      schema.fail("flow", "start",
                  a == 1 ? "the drop begins as a circle, within one block as wide as high"
                         : "the drop begins as a ball, within one block as wide as deep");
}

void check_beach(const namelist::schema& schema, const options& o) {
  const auto& f = o.flow;
  const double length = o.domain.length[0];
  for (const auto& [key, at] : {std::pair{"beach_from", f.beach_from}, std::pair{"beach_to", f.beach_to}}) {
    if (at && !(f.beach_rate > 0.0)) schema.fail("flow", key, "there is no beach: beach_rate is 0");
    if (!at && f.beach_rate > 0.0) schema.fail("flow", key, "must be given: where the beach of beach_rate is");
    if (at && *at > length * (1.0 + 1e-9))
      schema.fail("flow", key, fmt::format("outside the box: {} m, where the box ends at {} m", *at, length));
  }
  if (f.beach_from && std::abs(*f.beach_to - *f.beach_from) < o.domain.dx())
    schema.fail("flow", "beach_to", fmt::format("a beach is at least a particle spacing, {} m, long", o.domain.dx()));
}

// Of what &flow has σ for: σ/(ρΔx) over the square of the slowest sound beside waves of two spacings, of speed √(σk/ρ).
// With Riemann problems densities of the outermost particles follow those within so fast that they give way to noise of
// the curvature, unless sound is faster by far.
double most_tension(const flow_options& f) {
  constexpr double most_with_riemann = 0.02;  // measured (docs/theory/water_surface_tension.md)
  return f.scheme == "riemann" ? most_with_riemann : 1.0 / std::numbers::pi;
}

// m/s: by the water's weight, and how fast it enters (m/s); without gravity by its surface tension, as fast beside a
// drop's swinging, and some way above the slowest that goes with it. What a drop then loses:
// docs/theory/water_surface_tension.md.
double sound_speed_of(const options& o, double height, double entering) {
  const auto& f = o.flow;
  if (f.sound_speed) return *f.sound_speed;
  if (f.gravity > 0.0 || entering > 0.0) return f.sound_factor * std::max(std::sqrt(f.gravity * height), entering);
  const double of_spacing = f.surface_tension / (f.density * o.domain.dx());
  return std::max(f.sound_factor * std::sqrt(2.0 * f.surface_tension / (f.density * height)),
                  (f.scheme == "riemann" ? 1.1 : 2.6) * std::sqrt(of_spacing / most_tension(f)));
}

void find_liquid(const namelist::schema& schema, const options& o, parameters& p) {
  const auto& f = o.flow;
  const double entering = fastest_inflow(o, p);
  if (!f.sound_speed && !(f.gravity > 0.0) && !(f.surface_tension > 0.0) && !(entering > 0.0))
    schema.fail("flow", "sound_speed", "must be given: without gravity and surface tension sound_factor says nothing");
  p.water = {f.density, sound_speed_of(o, p.height, entering), f.exponent};
  p.smoothing_length = o.common.kernel.h_over_dx * o.domain.dx();
  const double D = static_cast<double>(o.domain.dimension), h = p.smoothing_length, c = p.water.sound;
  p.kinematic_viscosity = f.viscosity / f.density;
  if (f.scheme == "delta") {
    p.kinematic_viscosity += f.alpha * h * c / (2.0 * (D + 2.0));
    p.density_diffusivity = f.delta * h * c;
    return;
  }
  for (const auto& [key, value] : {std::pair{"alpha", f.alpha}, std::pair{"delta", f.delta}})
    if (value > 0.0 && schema.changed("flow", key))
      schema.fail("flow", key, "is of scheme = 'delta': Riemann problems dissipate by themselves; leave it out, or 0");
  p.by = scheme::riemann;
}

void check_tension(const namelist::schema& schema, const options& o, const parameters& p) {
  const auto& f = o.flow;
  if (!(f.surface_tension > 0.0)) return;
  const auto is_free = [](const auto& m) { return m.free.has_value(); };
  if (std::ranges::any_of(p.motions_in<2>(), is_free) || std::ranges::any_of(p.motions_in<3>(), is_free))
    schema.fail("flow", "surface_tension", "the pull of the surface on a body that moves freely is not calculated");
  const double most = most_tension(f) * f.density * p.water.sound * p.water.sound * o.domain.dx();
  if (f.surface_tension > most)
    schema.fail("flow", "surface_tension",
                fmt::format("its shortest waves, of two spacings, would be too fast beside sound: at most {:.4g} N/m "
                            "with scheme = '{}' and a speed of sound of {:.4g} m/s",
                            most, f.scheme, p.water.sound));
}

// Where the start is not that of the blocks alone.
void resolve_start(const namelist::schema& schema, const options& o, parameters& p) {
  p.regions = regions::all(schema, of_regions, o.of_regions, static_cast<int>(o.domain.dimension), o.domain.length,
                           o.domain.dx());
  p.sources = sources::all(schema, o.of_sources, o.of_regions, static_cast<int>(o.domain.dimension), o.domain.length,
                           o.domain.dx());
  using regions::what;
  if (p.regions.any() && !o.common.start.file.empty())
    schema.fail("initial", "file", "a snapshot says what is where, and so does &region");
  if (p.regions.give(what::density) && p.regions.give(what::pressure))
    schema.fail("region", "density", "one of density and pressure says the other");
  if (!o.common.start.settles()) return;
  for (const what w : {what::velocity_x, what::velocity_y, what::velocity_z})
    if (p.regions.give(w)) schema.fail("initial", "settle", "the start moves: &region gives velocities");
  if (!o.common.start.file.empty()) return;
  if (o.flow.start != "rest") schema.fail("initial", "settle", "the start moves: start = '" + o.flow.start + "'");
}

void check_top(const namelist::schema& schema, const options& o) {
  if (o.open_top() && !(o.flow.gravity > 0.0))
    schema.fail("walls", "slip_top", "an open top needs gravity: without it no water comes back");
}

}  // namespace

bool block::holds(const point& x) const {
  for (std::size_t a = 0; a < 3; ++a)
    if (high[a] > low[a] && !(x[a] >= low[a] && x[a] < high[a])) return false;
  return true;
}

void declare(namelist::schema& schema, options& o) {
  // On which still water stays, and waves lose the least (docs/theory/still_water.md).
  o.common.kernel.name = "quintic";
  o.common.kernel.h_over_dx = 1.25;
  o.common.kernel.skin = 0.5;
  o.walls.slip = "free_slip";
  domain::declare(schema, demands, o.domain);
  declare_water(schema, o.flow);
  declare_liquid(schema, o.flow);
  declare_blocks_around(schema, o.flow);
  declare_beach(schema, o.flow);
  declare_gauges(schema, o.gauges);
  declare_openings(schema, o);
  walls::declare(schema, {.moving = false, .heat = false, .free_surface = true, .bodies = true}, o.walls);
  solids::declare(schema, o.solids, o.motions);
  regions::declare(schema, of_regions, o.of_regions);
  sources::declare(schema, {.heating = false, .temperature = false}, o.of_sources);
  run::declare(schema, o.common,
               {.single_pairs = true,
                .kernels = kernels::names_of(std::type_identity<kernels_of_water<2>>{}),
                .diffuses = false,
                .starts_from_file = true,
                .settles = true,
                .reads = "places and velocities, and densities and masses where it has them,"});
}

parameters resolve(const namelist::schema& schema, options& o) {
  // Drops under tension grow on the kernel of still water (docs/studies/2026-11-27_surface_tension_with_an_energy.md).
  if (o.flow.surface_tension > 0.0 && !schema.given("kernel", "name")) {
    o.common.kernel.name = "wendland_c2";
    if (!schema.given("kernel", "h_over_dx")) o.common.kernel.h_over_dx = 1.5;
  }
  run::resolve(schema, o.common);
  domain::resolve(schema, demands, o.domain);
  std::vector<std::string> shown{"Volume", "FreeSurface"};
  if (!o.inflow.side.empty() || !o.outflow.side.empty()) shown.emplace_back("Zone");
  run::check_output(schema, o.common, o.domain, shown);
  const double dx = o.domain.dx(), support = run::support_over_dx(o.common.kernel) * dx;
  domain::check_widths(schema, o.domain, support + o.common.kernel.skin * dx, support);
  if (!o.common.time.has_end()) schema.fail("time", "t_end", "must be given, or else steps and dt");
  parameters p;
  p.blocks = find_blocks(schema, o);
  double lowest = o.domain.length[1], highest = 0.0;
  for (const auto& b : p.blocks) {
    lowest = std::min(lowest, b.low[1]);
    highest = std::max(highest, b.high[1]);
  }
  find_openings(schema, o, p);
  for (const auto& e : p.openings) {
    if (!e.enters) continue;
    lowest = std::min(lowest, e.low[1]);
    highest = std::max(highest, e.high[1]);
  }
  p.height = highest - lowest;
  find_liquid(schema, o, p);
  check_wave(schema, o, p);
  check_drop(schema, o, p);
  check_top(schema, o);
  check_beach(schema, o);
  resolve_gauges(schema, o, p);
  if (o.domain.dimension == 3)
    resolve_bodies<3>(schema, o, p);
  else
    resolve_bodies<2>(schema, o, p);
  check_openings(schema, o, p);
  check_tension(schema, o, p);
  // What drifts takes its momentum along, and makes surface whose energy nobody counts: a drop that turned lost 5 % of
  // its angular momentum in half a turn, without drift it gains 0.2 % (docs/theory/water_surface_tension.md).
  const bool still = o.flow.surface_tension > 0.0 && p.by == scheme::delta;
  p.shifting = o.flow.shifting.value_or(still ? 0.0 : 2.0);
  resolve_start(schema, o, p);
  return p;
}

}  // namespace tetsuame::free_surface
