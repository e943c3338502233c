#include <fmt/format.h>

#include <cmath>
#include <foundation/error.hpp>
#include <numbers>
#include <two_fluids/groups.hpp>

namespace tetsuame::two_fluids {

void declare_waves(namelist::schema& schema, const char* group, options& o) {
  schema.add(
      group, "interface", o.interface,
      positive("m", "its height; rows whose centres are not above it are of the lower layer; not given: the middle"));
  schema.add(group, "wavelength", o.wavelength, positive("m", "along x; not given: the box's width"));
  schema.add(group, "wavelength_z", o.wavelength_z, for_expert(not_negative("m", "along z; 0: none (3-D only)")));
  schema.add(group, "amplitude", o.amplitude, not_negative("m", "of the interface at the start"));
  schema.add(group, "start", o.start,
             {.choices = {"eigenmode", "displaced", "coloured"},
              .meaning = "displaced by the growing mode, with its velocity or at rest; or a lattice whose materials "
                         "part at the wave"});
  schema.add(group, "masses", o.masses,
             {.choices = {"equal_spacing", "equal_mass"},
              .meaning = "of the particles of both layers: on one lattice; or, of a coloured start that is flat, the "
                         "denser layer on a finer lattice, to a whole number of rows and columns"});
  schema.add(group, "shear", o.shear,
             for_expert({.unit = "m/s",
                         .meaning = "of a coloured start: velocity along x of the upper layer less that of the lower, "
                                    "half of it each"}));
  if (!o.by_program)
    schema.add(
        group, "rows", o.scheme.rows,
        {.choices = {"lattice", "balanced"},
         .expert = true,
         .meaning = "of the start: evenly spaced; or, with our_method, moved a little and with pressures such that "
                    "the sums over neighbours hold their weight"});
  schema.add(group, "pond_top", o.pond_top,
             for_expert(positive(
                 "m", "enthalpy law: the upper material lies below this height, the lower one once more above")));
  schema.add(group, "cover_temperature", o.cover_temperature,
             for_expert(positive("K", "of what lies above pond_top; not given: temperature")));
}

namespace {

// The growth rate and the mode of the run: with its slowed sound and inertia.
void find_growth(const options& o, parameters& p, double k) {
  p.mode = theory::eigenmode(layers(o, p, true), k);
  p.growth = p.mode->growth_rate;
  p.growth_incompressible = theory::growth_rate(layers(o, p, false), k);
  if (!o.slowing.any()) return;
  p.mode = theory::eigenmode(slowed_layers(o, p, o.slowing), k);
  p.growth_slowed = p.mode->growth_rate;
}

theory::boundary boundary_of(const std::string& name) {
  return name == "no_slip"     ? theory::boundary::no_slip
         : name == "free_slip" ? theory::boundary::free_slip
                               : theory::boundary::free_surface;
}

}  // namespace

theory::two_layers layers(const options& o, const parameters& p, bool compressible) {
  theory::two_layers t;
  const auto fill = [&](theory::layer& l, std::size_t n, double thickness, const barotropic& b) {
    l.thickness = thickness;
    l.viscosity = o.material[n].viscosity;
    l.bulk_viscosity = (p.symmetric_stress ? 5.0 : -1.0) / 3.0 * l.viscosity;
    if (compressible)
      l.material = curve(b);
    else
      l.material = theory::linear_barotrope(o.material[n].eos == "linear"
                                                ? o.material[n].density
                                                : p.base->at(p.interface * (n == 0 ? 1.0 - 1e-12 : 1.0)).density,
                                            std::numeric_limits<double>::infinity());
  };
  fill(t.lower, 0, p.interface, p.base->lower());
  fill(t.upper, 1, o.domain.length[1] - p.interface, p.base->upper());
  t.gravity = o.gravity;
  t.surface_tension = o.surface_tension;
  t.top_pressure = o.p_top;
  const auto w = slips_of(o);
  t.floor = boundary_of(w.floor);
  t.lid = boundary_of(w.lid);
  return t;
}

theory::two_layers slowed_layers(const options& o, const parameters& p, const slowing_options& slowed) {
  auto flow = layers(o, p, true);
  flow.softness = slowed.zeta * slowed.zeta;
  flow.lower.inertia = slowed.xi_n(0) * slowed.xi_n(0);
  flow.upper.inertia = slowed.xi_n(1) * slowed.xi_n(1);
  return flow;
}

// The lighter layer has the box's lattice. The denser one has, of equal masses, so many more columns and rows.
void find_lattices(const namelist::schema& schema, const options& o, parameters& p) {
  const auto& d = o.domain;
  const bool equal = o.masses == "equal_mass";
  if (equal && (o.start != "coloured" || o.amplitude != 0.0))
    schema.fail("rti", "masses", "'equal_mass' is of a flat contact: start = 'coloured' with amplitude = 0");
  if (equal && o.temperature_law == "enthalpy")
    schema.fail("rti", "masses", "'equal_mass' is not for temperature_law 'enthalpy'");
  if (o.shear != 0.0 && (o.start != "coloured" || !d.periodic[0]))
    schema.fail("rti", "shear", "needs start = 'coloured', and sides across x that are one: periodic_x = .true.");
  const double ratio =
      1.0 + p.density_difference / p.base->at(p.interface * (1.0 - 1e-12)).density;  // upper over lower
  for (const std::size_t n : {0, 1}) {
    auto& layer = p.layers[n];
    const double denser = equal ? std::max(1.0, n == 1 ? ratio : 1.0 / ratio) : 1.0;
    const double finer = std::pow(denser, 1.0 / static_cast<double>(d.dimension));
    layer.low = n == 0 ? 0.0 : p.interface;
    layer.volume = 1.0;
    for (std::size_t a = 0; a < d.axes(); ++a) {
      const double length = a != 1 ? d.length[a] : n == 0 ? p.interface : d.length[1] - p.interface;
      layer.number[a] = std::llround(length / p.dx * finer);
      layer.spacing[a] = length / static_cast<double>(layer.number[a]);
      layer.volume *= layer.spacing[a];
    }
  }
}

void find_waves(const namelist::schema& schema, options& o, parameters& p) {
  const auto& d = o.domain;
  if (!o.wavelength) o.wavelength = d.length[0];
  p.k_x = 2.0 * std::numbers::pi / *o.wavelength;
  if (o.wavelength_z > 0.0) {
    if (d.dimension == 2) schema.fail("rti", "wavelength_z", "two dimensions have no z");
    p.k_z = 2.0 * std::numbers::pi / o.wavelength_z;
  }
  const auto fits = [&](std::size_t a, double k, const char* key) {
    const double halves = k * d.length[a] / std::numbers::pi, least = d.periodic[a] ? 2.0 : 1.0;
    if (std::abs(halves / least - std::round(halves / least)) > 1e-6)
      schema.fail("rti", key,
                  fmt::format("the box holds {:.6g} waves along {}: it must hold a whole number of {}", 0.5 * halves,
                              axis_names[a], d.periodic[a] ? "waves" : "half waves"));
  };
  // Two spacings: what a lattice can hold.
  const auto is_resolved = [&](double wavelength, const char* key) {
    if (wavelength < 2.0 * p.dx * (1.0 - 1e-9))
      schema.fail("rti", key, fmt::format("expected at least two particle spacings, {:.6g} m", 2.0 * p.dx));
  };
  is_resolved(*o.wavelength, "wavelength");
  if (p.k_z > 0.0) is_resolved(o.wavelength_z, "wavelength_z");
  fits(0, p.k_x, "wavelength");
  if (p.k_z > 0.0) fits(2, p.k_z, "wavelength_z");
  const double thinner = std::min(p.interface, d.length[1] - p.interface);
  if (o.start != "coloured" && !(o.amplitude < thinner))
    schema.fail("rti", "amplitude",
                fmt::format("is {:.6g} m, more than the thinner layer is high, {:.6g} m", o.amplitude, thinner));
  if (o.temperature_law == "enthalpy")
    p.theory_about = "materials that melt, or lie in three layers, have no growth rate";
  else if (o.material.size() > 2)
    p.theory_about = "there are more than two materials: no growth rate to compare with";
  else if (o.regions.any())
    p.theory_about = "the start is that of &region: no growth rate to compare with";
  else if (o.has_bodies())
    p.theory_about = "bodies stand in the box: there is no growth rate to compare with";
  else if (const auto sides = slips_of(o).sides; !sides.empty() && sides != "free_slip")
    p.theory_about = "no-slip sides: there are no separate waves, and no theory to compare with";
  if (!p.theory_about.empty()) {
    if (o.start != "coloured") schema.fail("rti", "start", p.theory_about + "; start must be 'coloured'");
    return;
  }
  const double k = std::hypot(p.k_x, p.k_z);
  try {
    find_growth(o, p, k);
  } catch (const foundation::error& e) {
    p.mode.reset();
    p.growth.reset();
    p.theory_about = fmt::format("no growth rate to compare with: {}", e.what());
    if (o.start != "coloured")
      schema.fail("rti", "start",
                  fmt::format("'{}' needs the growing mode of linear theory. {}; 'coloured' starts without a mode",
                              o.start, e.what()));
  }
}

}  // namespace tetsuame::two_fluids
