#include <fmt/format.h>

#include <cmath>
#include <kernels/lattice.hpp>
#include <numbers>
#include <overturn/options.hpp>
#include <theory/drop.hpp>
#include <theory/free_slip_box.hpp>
#include <theory/sphere_uptake.hpp>
#include <theory/stefan.hpp>
#include <theory/stokes_box.hpp>

namespace tetsuame::overturn {

namespace {

using namelist::key_info;

constexpr std::array<const char*, 3> axis_names{"x", "y", "z"};
constexpr std::array<double, 2> default_density{3000.0, 7000.0};  // kg/m3, of lower or outside, upper or drop
const char* group_of(problem_kind kind) { return kind == problem_kind::drop ? "drop" : "rti"; }
std::array<const char*, 2> names_of(problem_kind kind) {
  if (kind == problem_kind::drop) return {"outside", "drop"};
  return {"lower", "upper"};
}

key_info positive(std::string unit, std::string meaning) {
  return {.unit = std::move(unit), .minimum = 0.0, .exclusive_minimum = true, .meaning = std::move(meaning)};
}

void declare(namelist::schema& schema, domain_options& o) {
  schema.group("domain", "the box and the start lattice");
  schema.add("domain", "dimension", o.dimension, {.minimum = 2, .maximum = 3, .meaning = "of space; y is up"});
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string axis = axis_names[a], only = a == 2 ? " (3-D only)" : "";
    schema.add("domain", "length_" + axis, o.length[a], positive("m", "edge of the box along " + axis + only));
    schema.add("domain", "particles_" + axis, o.particles[a],
               {.minimum = 4, .maximum = 1e6, .meaning = "particles along " + axis + only});
    if (a != 1)
      schema.add("domain", "periodic_" + axis, o.periodic[a],
                 {.meaning = "the two sides across " + axis + " are one, or else walls" + only});
  }
  schema.add("domain", "ranks_x", o.ranks_x,
             {.minimum = 0,
              .maximum = 1e6,
              .meaning = "MPI ranks side by side along x, a divisor of their number; 0: as the box's shape suggests"});
}

void declare(namelist::schema& schema, const char* group, const std::string& which, material_options& o) {
  std::vector<std::string> choices;
  for (const auto& name : eos::names()) choices.emplace_back(name);
  schema.add(group, "eos_" + which, o.eos,
             {.choices = choices, .meaning = "equation of state; others than linear have parameters of their own"});
  schema.add(group, "density_" + which, o.density, positive("kg/m^3", "linear equation of state: at zero pressure"));
  schema.add(group, "bulk_modulus_" + which, o.bulk_modulus,
             positive("Pa", "linear equation of state; not given: bulk_modulus"));
  schema.add(group, "heat_capacity_" + which, o.heat_capacity,
             positive("J/(kg K)", "c_V; not given: the equation of state's"));
  schema.add(group, "viscosity_" + which, o.viscosity, positive("Pa s", "dynamic"));
}

void declare(namelist::schema& schema, const char* group, scheme_options& o) {
  schema.add(group, "volume", o.volume,
             {.choices = {"number_density", "our_method"},
              .meaning = "of a particle: from the number density, or m/rho with rho by continuity (our method)"});
  schema.add(
      group, "pressure", o.pressure,
      {.choices = {"non_smoothed", "smoothed"}, .meaning = "straight from the equation of state, or the sum of Y W"});
  schema.add(group, "gradient", o.gradient,
             {.choices = {"pattern_1", "pattern_2"}, .meaning = "form of the pressure gradient"});
  schema.add(group, "volume_element", o.volume_element,
             {.choices = {"own", "from_weight"},
              .meaning = "in the forces, with a smoothed pressure: as volume says (p dV^2), or Y/p (Y^2/p)"});
  schema.add(
      group, "reference_pressure", o.reference_pressure,
      {.choices = {"auto", "none", "lightest"},
       .meaning = "a pressure p_r(y) that the forces between particles leave out and that lifts their volumes "
                  "instead: none, or that of a column of the lighter fluid (auto: lightest with the number density "
                  "in a closed box)"});
  schema.add(group, "normalise", o.normalise, {.meaning = "smoothing is divided by the sum of dV W"});
  schema.add(group, "delta", o.delta,
             {.minimum = 0.0,
              .maximum = 1.0,
              .meaning = "our_method: diffusion of the dynamic pressure in the density (0: none, as in the notes)"});
  schema.add(group, "viscous_order", o.viscous_order,
             {.minimum = 0,
              .maximum = 4,
              .meaning = "of the viscous sum on the lattice: 2, the notes' sum; 4, which does not smooth, until the "
                         "energy dissipated falls: then 2; 0: 4 where the stress is the Laplacian, else 2"});
  schema.add(group, "stress", o.stress,
             {.choices = {"auto", "laplacian", "symmetric"},
              .meaning = "viscous: div(eta grad v), or with its transpose, which unequal viscosities need (auto)"});
}

void declare(namelist::schema& schema, melting_options& o) {
  schema.group("melting", "of the lower (outer) material, where temperature_law is 'enthalpy'");
  schema.add("melting", "curve", o.curve,
             {.choices = {"none", "mantle", "constant"},
              .meaning = "solidus and liquidus: it never melts, fits for the mantle by pressure, or two temperatures"});
  schema.add("melting", "composition", o.composition,
             {.choices = {"peridotitic", "chondritic"}, .meaning = "curve 'mantle': of the liquidus above 20 GPa"});
  schema.add("melting", "solidus", o.solidus, positive("K", "curve 'constant'"));
  schema.add("melting", "liquidus", o.liquidus, positive("K", "curve 'constant'"));
  schema.add("melting", "latent_heat", o.latent_heat, {.unit = "J/kg", .minimum = 0.0, .meaning = "of fusion"});
  schema.add("melting", "viscosity_law", o.viscosity_law,
             {.choices = {"constant", "blended", "suspension"},
              .meaning = "the material's one viscosity; or by temperature and melt fraction, smooth or with the "
                         "crystals' sudden lock at 0.4"});
  schema.add("melting", "viscosity_min", o.viscosity_min, positive("Pa s", "the law's viscosity is not below this"));
  schema.add("melting", "viscosity_max", o.viscosity_max, positive("Pa s", "nor above this"));
  schema.add("melting", "inertia_viscosity", o.inertia_viscosity,
             {.unit = "Pa s",
              .minimum = 0.0,
              .meaning = "what is more viscous gets its inertia raised by the ratio, so that steps need not follow it "
                         "(0: inertia as it is)"});
}

void declare(namelist::schema& schema, element_options& o) {
  schema.group("element", "dissolved in metal and silicate, exchanged at their contact");
  schema.add("element", "name", o.name,
             {.choices = {"none", "constant", "nickel", "cobalt"},
              .meaning = "whose partition coefficient: none, a constant one, or by pressure and temperature (Rubie et "
                         "al. 2015)"});
  schema.add("element", "partition_coefficient", o.partition_coefficient,
             positive("1", "'constant': metal over silicate at equilibrium"));
  schema.add("element", "iron_ratio", o.iron_ratio,
             positive("1", "nickel, cobalt: mole fraction of Fe in the metal over that of FeO in the silicate"));
  schema.add("element", "diffusivity_silicate", o.diffusivity_silicate, positive("m^2/s", "of the element"));
  schema.add("element", "diffusivity_metal", o.diffusivity_metal, positive("m^2/s", "of the element"));
  schema.add("element", "concentration_silicate", o.concentration_silicate,
             {.minimum = 0.0, .meaning = "at the start, amount per mass, in a unit of choice"});
  schema.add("element", "concentration_metal", o.concentration_metal,
             {.minimum = 0.0, .meaning = "at the start, in the same unit"});
}

eos::any make(const options& o, std::size_t n) {
  const auto& given = o.material[n];
  eos::material_options m;
  m.name = given.eos;
  if (given.eos == "linear") {
    m.reference_pressure = 0.0;
    m.reference_density = given.density;
    m.reference_temperature = o.temperature;
    m.bulk_modulus = given.bulk_modulus.value_or(o.bulk_modulus);
    m.thermal_expansivity = 0.0;
  }
  m.heat_capacity = given.heat_capacity;
  return eos::make(m);
}

theory::boundary boundary_of(const std::string& name) {
  return name == "no_slip"     ? theory::boundary::no_slip
         : name == "free_slip" ? theory::boundary::free_slip
                               : theory::boundary::free_surface;
}

theory::two_layers layers(const options& o, const parameters& p, bool compressible) {
  theory::two_layers t;
  const auto fill = [&](theory::layer& l, std::size_t n, double thickness, const barotropic& b) {
    l.thickness = thickness;
    l.viscosity = o.material[n].viscosity;
    l.bulk_viscosity = (p.stress_b == 0.0 ? -1.0 : 5.0) / 3.0 * l.viscosity;
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
  t.floor = boundary_of(o.walls.floor);
  t.lid = boundary_of(o.walls.lid);
  return t;
}

void check_domain(const namelist::schema& schema, options& o, parameters& p) {
  const auto& d = o.domain;
  p.dx = d.length[1] / static_cast<double>(d.particles[1]);
  for (std::size_t a = 0; a < static_cast<std::size_t>(d.dimension); ++a)
    if (const double spacing = d.length[a] / static_cast<double>(d.particles[a]);
        std::abs(spacing - p.dx) > 1e-9 * p.dx)
      schema.fail(
          "domain", std::string("particles_") + axis_names[a],
          fmt::format("the particle spacing must be the same along all axes: here {} m, along y {} m", spacing, p.dx));
}

void choose_scheme(const namelist::schema& schema, const char* group, options& o, parameters& p) {
  auto& s = o.scheme;
  if (s.pressure == "non_smoothed" && s.volume_element == "from_weight")
    schema.fail(group, "volume_element", "Y/p is the particle's own volume where the pressure is not smoothed");
  if (s.volume == "number_density" && schema.given(group, "delta") && s.delta > 0.0)
    schema.fail(group, "delta", "belongs to volume = 'our_method': the number density has no rate to add to");
  if (s.volume == "number_density") s.delta = 0.0;
  if (o.walls.lid == "free_surface" && s.volume == "number_density")
    schema.fail(group, "volume",
                "at a free surface the number density takes missing neighbours for tension: choose 'our_method'");
  if (o.surface_tension > 0.0 &&
      !(s.volume == "number_density" && s.gradient == "pattern_1" && s.pressure == "non_smoothed"))
    schema.fail(group, "surface_tension",
                "is derived for volume = 'number_density', gradient = 'pattern_1' and pressure = 'non_smoothed'");
  const bool open = o.walls.lid == "free_surface";
  if (open && s.reference_pressure == "lightest")
    schema.fail(group, "reference_pressure", "a free surface feels the whole pressure: choose 'none'");
  const bool whole = open || s.volume != "number_density" || o.temperature_law == "enthalpy" || o.surface_tension > 0.0;
  if (s.reference_pressure == "auto") s.reference_pressure = whole ? "none" : "lightest";
  if (s.viscous_order == 1 || s.viscous_order == 3) schema.fail(group, "viscous_order", "is 2 or 4, or 0 for either");
  if (s.viscous_order == 4 && o.melting.viscosity_law != "constant")
    schema.fail(group, "viscous_order",
                "4 has far neighbours of the other sign: between two stiff ones with something soft around they make "
                "motion instead of friction; choose 2");
  const bool equal = o.melting.viscosity_law == "constant" && o.material[0].viscosity == o.material[1].viscosity &&
                     o.walls.lid != "free_surface";
  if (s.stress == "auto") s.stress = equal ? "laplacian" : "symmetric";
  if (s.viscous_order == 0) s.viscous_order = s.stress == "laplacian" && o.melting.viscosity_law == "constant" ? 4 : 2;
  p.stress_a = s.stress == "laplacian" ? 1.0 : 0.0;
  p.stress_b = s.stress == "laplacian" ? 0.0 : static_cast<double>(o.domain.dimension + 2);
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
  fits(0, p.k_x, "wavelength");
  if (p.k_z > 0.0) fits(2, p.k_z, "wavelength_z");
  const bool walls = !d.periodic[0] || (d.dimension == 3 && !d.periodic[2]);
  if (o.temperature_law == "enthalpy") {
    p.theory_about = "materials that melt, or lie in three layers, have no growth rate";
    if (o.start != "coloured") schema.fail("rti", "start", p.theory_about + "; start must be 'coloured'");
    return;
  }
  if (walls && o.walls.sides == "no_slip") {
    p.theory_about = "no-slip sides: there are no separate waves, and no theory to compare with";
    if (o.start != "coloured") schema.fail("rti", "start", p.theory_about + "; start must be 'coloured'");
    return;
  }
  const double k = std::hypot(p.k_x, p.k_z);
  p.mode = theory::eigenmode(layers(o, p, true), k);
  p.growth = p.mode->growth_rate;
  p.growth_incompressible = theory::growth_rate(layers(o, p, false), k);
}

// A lattice under pressure resists shear, as no fluid does (kernels/lattice.hpp).
void find_elasticity(const options& o, parameters& p) {
  const auto& k = o.march.kernel;
  const double h = k.h_over_dx * p.dx;
  const auto mu = o.domain.dimension == 3 ? kernels::spurious_shear_moduli<3>(kernels::make<3>(k.name, h), p.dx)
                                          : kernels::spurious_shear_moduli<2>(kernels::make<2>(k.name, h), p.dx);
  p.spurious_modulus = mu.largest();
  if (p.spurious_modulus > 5e-4)
    p.lines.push_back(fmt::format(
        "warning: a lattice with kernel '{}' at h = {:.4g} dx has the shear modulus {:.2g} p along its rows and {:.2g} "
        "p "
        "along its diagonals; slow flow will be stiff, or the lattice break up: 'wendland_c6' stays below 5e-4",
        k.name, k.h_over_dx, mu.simple, mu.pure));
}

// Keys that mean nothing here; with their defaults, as a resolved input has them, they may stand.
using unused_key = std::pair<const char*, bool>;  // name, and whether its value is the default
void refuse(const namelist::schema& schema, const char* group, std::initializer_list<unused_key> keys,
            const std::string& why) {
  for (const auto& [key, is_default] : keys)
    if (schema.given(group, key) && !is_default) schema.fail(group, key, why);
}

void check_element(const namelist::schema& schema, const element_options& o) {
  const element_options d;
  if (o.name == "none")
    refuse(schema, "element",
           {{"diffusivity_silicate", o.diffusivity_silicate == d.diffusivity_silicate},
            {"diffusivity_metal", o.diffusivity_metal == d.diffusivity_metal},
            {"concentration_silicate", o.concentration_silicate == d.concentration_silicate},
            {"concentration_metal", o.concentration_metal == d.concentration_metal}},
           "there is no element: name is 'none'");
  else if (!(o.concentration_silicate + o.concentration_metal > 0.0))
    schema.fail("element", "concentration_silicate", "there is nothing of the element in either material");
  if (o.name != "constant")
    refuse(schema, "element", {{"partition_coefficient", o.partition_coefficient == d.partition_coefficient}},
           "belongs to name = 'constant'");
  if (o.name == "none" || o.name == "constant")
    refuse(schema, "element", {{"iron_ratio", o.iron_ratio == d.iron_ratio}}, "belongs to a named element");
}

// Temperatures at the start of the enthalpy law, and what else belongs to it alone.
void find_heat(const namelist::schema& schema, problem_kind kind, options& o, parameters& p) {
  const char* group = group_of(kind);
  const auto names = names_of(kind);
  auto& m = o.melting;
  const bool enthalpy = o.temperature_law == "enthalpy";
  for (const std::size_t n : {0, 1}) {
    const std::string key = std::string("temperature_") + names[n];
    if (!enthalpy && o.start_heat[n]) schema.fail(group, key, "belongs to temperature_law = 'enthalpy'");
    if (enthalpy && o.material[n].eos != "linear")
      schema.fail(group, std::string("eos_") + names[n],
                  "with temperature_law = 'enthalpy' pressure must not depend on temperature: 'linear' only");
    p.temperature[n] = o.start_heat[n].value_or(o.temperature);
  }
  p.cover_temperature = o.cover_temperature.value_or(o.temperature);
  if (!enthalpy && (o.pond_top || o.cover_temperature))
    schema.fail(group, o.pond_top ? "pond_top" : "cover_temperature", "belongs to temperature_law = 'enthalpy'");
  if (o.cover_temperature && !o.pond_top)
    schema.fail(group, "cover_temperature", "nothing covers the pond: no pond_top");
  const melting_options d;
  const unused_key solidus{"solidus", m.solidus == d.solidus}, liquidus{"liquidus", m.liquidus == d.liquidus},
      least{"viscosity_min", m.viscosity_min == d.viscosity_min},
      most{"viscosity_max", m.viscosity_max == d.viscosity_max};
  if (m.curve == "none") {
    refuse(schema, "melting",
           {solidus,
            liquidus,
            least,
            most,
            {"latent_heat", m.latent_heat == d.latent_heat || m.latent_heat == 0.0},
            {"viscosity_law", m.viscosity_law == d.viscosity_law || m.viscosity_law == "constant"},
            {"inertia_viscosity", m.inertia_viscosity == d.inertia_viscosity},
            {"composition", m.composition == d.composition}},
           "nothing melts: curve is 'none'");
    m.viscosity_law = "constant";
    m.latent_heat = 0.0;
    return;
  }
  if (!enthalpy) schema.fail("melting", "curve", std::string("&") + group + " temperature_law must be 'enthalpy'");
  if (m.curve == "constant" && !(m.liquidus > m.solidus))
    schema.fail("melting", "liquidus", "must be above the solidus");
  if (m.curve == "mantle") refuse(schema, "melting", {solidus, liquidus}, "curve 'mantle' has one of its own");
  if (m.viscosity_max < m.viscosity_min) schema.fail("melting", "viscosity_max", "is below viscosity_min");
  if (m.viscosity_law == "constant") refuse(schema, "melting", {least, most}, "viscosity_law is 'constant'");
}

// Heat conducted across a flat contact at rest: two half spaces, as long as the heat has not reached floor and lid.
void find_melt(const options& o, parameters& p) {
  if (!(o.conductivity > 0.0 && o.march.time.t_end)) return;
  const auto [T_s, T_l] = melting_range(o.melting, p.base->at(p.interface).pressure);
  if (!(p.temperature[1] > p.temperature[0] && p.temperature[0] <= T_s)) return;
  const auto side = [&](std::size_t n) {
    const double y = p.interface * (n == 0 ? 1.0 - 1e-12 : 1.0);
    const auto e = eos::evaluate((*p.material)[n], p.base->at(y).density, o.temperature);
    return theory::half_space{p.base->at(y).density, e.c_V, o.conductivity, p.temperature[n]};
  };
  const auto s = theory::solve({side(1), side(0), T_s, T_l, o.melting.latent_heat});
  p.melt_conducted = s.melt_thickness(*o.march.time.t_end) / p.interface;
}

// Along the contact the stress of surface tension is up to (1 - 1/d) sigma |G|, |G| = 0.4/dx (surface_tension.hpp): a
// pressure below that leaves the particles there under tension, in which no lattice is stable.
void warn_of_tension(const options& o, parameters& p, double y) {
  const double pressure = p.base->at(std::min(y, o.domain.length[1])).pressure,
               least = 0.4 * (1.0 - 1.0 / static_cast<double>(o.domain.dimension)) * o.surface_tension / p.dx;
  if (o.surface_tension > 0.0 && pressure < 2.0 * least)
    p.lines.push_back(fmt::format(
        "warning: surface tension puts the contact under a tension of up to {:.3g} Pa, and the pressure there "
        "is {:.3g} Pa: particles will clump, and make energy; raise p_top",
        least, pressure));
}

// What a drop with surface tension is held against.
void find_tension(const options& o, parameters& p, double outside, double top_of_drops) {
  if (!(o.surface_tension > 0.0)) return;
  const int dimension = static_cast<int>(o.domain.dimension);
  p.oscillation_period =
      2.0 * std::numbers::pi /
      theory::oscillation_frequency(2, dimension, o.surface_tension, o.radius, outside + p.density_difference, outside);
  warn_of_tension(o, p, top_of_drops);
  p.bond_number = std::abs(p.density_difference) * o.gravity * o.radius * o.radius / o.surface_tension;
  p.lines.push_back(fmt::format(
      "Bond number {:.4g}; largest stable radius {:.4g} m (Rayleigh-Taylor waves on the front)", p.bond_number,
      p.density_difference == 0.0 ? std::numeric_limits<double>::infinity()
                                  : theory::largest_radius(o.surface_tension, p.density_difference, o.gravity)));
}

// Of one drop with its centre there: creeping flow about it.
std::optional<double> find_fall_of_one(const options& o, const parameters& p, const std::array<double, 3>& at,
                                       std::string& about) {
  const auto& d = o.domain;
  const double eta = o.material[0].viscosity, eta_drop = o.material[1].viscosity;
  const auto& w = o.walls;
  if (d.dimension == 2) {
    const auto sides = [](const std::string& slip) {
      return slip == "no_slip" ? theory::sides::no_slip : theory::sides::free_slip;
    };
    if (w.floor != w.lid) {
      about = "no theory for a floor unlike the lid";
      return std::nullopt;
    }
    const theory::drop_in_box box{d.length[0],   d.length[1],
                                  o.radius,      at[0],
                                  at[1],         eta,
                                  eta_drop,      p.density_difference,
                                  o.gravity,     d.periodic[0] ? theory::sides::periodic : sides(w.sides),
                                  sides(w.floor)};
    const int cells = static_cast<int>(std::ceil(6.0 * d.length[0] / o.radius));
    about = "creeping flow about the round drop in this box (finite differences)";
    return theory::fall_velocity_extrapolated(box, cells);
  }
  if (w.floor == "free_slip" && w.lid == "free_slip" && (w.sides == "free_slip" || (d.periodic[0] && d.periodic[2]))) {
    about = "creeping flow about the round drop in this box (Fourier series)";
    return theory::fall_velocity(
        {3, d.length, d.periodic, o.radius, at, eta, eta_drop, p.density_difference, o.gravity});
  }
  about = "in three dimensions there is a theory for free-slip walls only";
  return std::nullopt;
}

// Of several drops: where they lie, and what their fall is held against.
void find_cloud(const namelist::schema& schema, options& o, parameters& p) {
  const auto& d = o.domain;
  const bool deep = d.dimension == 3;
  const auto box = box_of(d);
  for (const char* key : {"x", "y", "z"})
    if (schema.given("drop", key)) schema.fail("drop", key, "is of one drop");
  if (schema.given("drop", "measure_at") && o.measure_at != 0.5)  // which a resolved input has
    schema.fail("drop", "measure_at", "is of one drop");
  if (o.shape != "round" || o.elongation != 1.0)
    schema.fail("drop", o.shape != "round" ? "shape" : "elongation", "several drops are round at the start");
  o.measure_at = 0.5;
  if (!o.places[0].empty()) {
    if (o.least_gap) schema.fail("drop", "least_gap", "is of drops that are drawn, and places are given");
    if (o.seed != 1) schema.fail("drop", "seed", "is of drops that are drawn, and places are given");
    for (std::size_t n = 0; n < o.places[0].size(); ++n) {
      const std::array<double, 3> at{o.places[0][n], o.places[1][n], deep ? o.places[2][n] : 0.0};
      for (std::size_t a = 0; a < (deep ? 3U : 2U); ++a)
        if (!box.periodic[a] && (at[a] < o.radius || at[a] > d.length[a] - o.radius))
          schema.fail("drop", std::string("places_") + axis_names[a], "the drops must lie inside the box");
      for (const auto& other : p.places)
        if (distance(box, at, other) < 2.0 * o.radius) schema.fail("drop", "places_x", "two drops overlap");
      p.places.push_back(at);
    }
  } else {
    if (!o.least_gap) o.least_gap = 2.0 * p.dx;
    const auto drawn = drawn_places(box, o.radius, *o.least_gap, o.drops, o.seed);
    if (!drawn)
      schema.fail("drop", "drops",
                  fmt::format("{} drops of radius {:.6g} m do not fit into the box at random, {:.6g} m from each other "
                              "and from the walls",
                              o.drops, o.radius, *o.least_gap));
    p.places = *drawn;
  }
  const auto number = static_cast<double>(p.places.size());
  const double size = std::numbers::pi * o.radius * o.radius * (deep ? 4.0 / 3.0 * o.radius : 1.0),
               fraction = number * size / (d.length[0] * d.length[1] * (deep ? d.length[2] : 1.0));
  const double eta = o.material[0].viscosity, eta_drop = o.material[1].viscosity;
  const double y = 0.5 * d.length[1], weight = p.density_difference * o.gravity;
  std::string about;
  p.fall_alone = find_fall_of_one(o, p, {0.5 * d.length[0], y, 0.5 * d.length[2]}, about);
  const theory::drop one{o.radius, p.density_difference, o.gravity, eta, eta_drop};
  if (fraction <= 0.1)
    p.fall_array = deep ? theory::hadamard_rybczynski(one) * theory::cubic_array_factor(fraction, eta_drop / eta)
                        : weight * o.radius * o.radius / eta * theory::square_array_velocity(fraction, eta_drop / eta);
  const double reynolds =
      2.0 * o.radius * p.base->at(y).density *
      std::abs(p.fall_alone.value_or(deep ? theory::hadamard_rybczynski(one) : p.fall_array.value_or(0.0))) / eta;
  if (fraction <= 0.6) p.hindered = theory::hindered_settling_factor(fraction, reynolds);
  const auto& w = o.walls;
  const bool free_sides = d.periodic[0] && (!deep || d.periodic[2]);
  if (w.floor == "free_slip" && w.lid == "free_slip" && (w.sides == "free_slip" || free_sides) && eta == eta_drop) {
    p.theory_fall = theory::mean_fall_velocity({static_cast<int>(d.dimension),
                                                d.length,
                                                d.periodic,
                                                o.radius,
                                                {},
                                                eta,
                                                eta_drop,
                                                p.density_difference,
                                                o.gravity},
                                               p.places);
    p.theory_about = "creeping flow about the round drops as they lie at the start (Fourier series)";
  } else {
    p.theory_about = "for several drops there is a theory for free-slip walls and equal viscosities only";
  }
  p.lines.push_back(fmt::format("{} drops, volume fraction {:.4g}", p.places.size(), fraction));
}

// Difference of density and terminal velocity at the height where it is measured.
void find_fall(const namelist::schema& schema, options& o, parameters& p) {
  const auto& d = o.domain;
  const bool deep = d.dimension == 3;
  const double height = d.length[1];
  const auto& given = o.places;
  for (std::size_t a = 0; a < 3; ++a)
    if (given[a].size() != (a < 2 || deep ? given[0].size() : 0))
      schema.fail("drop", std::string("places_") + axis_names[a],
                  "as many numbers as drops along each axis, and none along z in two dimensions");
  if (!given[0].empty()) {
    const auto number = static_cast<std::int64_t>(given[0].size());
    if (schema.given("drop", "drops") && o.drops != number) schema.fail("drop", "drops", "is not the number of places");
    if (number < 2) schema.fail("drop", "places_x", "one drop's place is x, y, z");
    o.drops = number;
  }
  const bool many = o.drops > 1;
  const double y = (many ? 0.5 : o.measure_at) * height;
  const barotropic inside{&(*p.material)[1], o.p_top, o.temperature, o.temperature_law == "adiabatic"};
  const place here = p.base->at(y);
  p.density_difference = at_pressure(inside, here.pressure).density - here.density;
  if (many) {
    find_cloud(schema, o, p);
    for (auto [key, value] : {std::pair{"measure_from", o.measure_from}, {"measure_until", o.measure_until}})
      if (value && o.march.time.t_end && *value > *o.march.time.t_end)
        schema.fail("drop", key, "is after the end of the run");
    if (o.measure_from && o.measure_until && !(*o.measure_until > *o.measure_from))
      schema.fail("drop", "measure_until", "must be after measure_from");
    double highest = 0.0;
    for (const auto& at : p.places) highest = std::max(highest, at[1]);
    find_tension(o, p, here.density, highest + o.radius);
    return;
  }
  if (o.seed != 1) schema.fail("drop", "seed", "is of several drops");
  for (const auto& [key, value] :
       {std::pair{"least_gap", &o.least_gap}, {"measure_from", &o.measure_from}, {"measure_until", &o.measure_until}})
    if (*value) schema.fail("drop", key, "is of several drops");
  const std::array<double, 3> middle{0.5 * d.length[0], 0.75 * height, 0.5 * d.length[2]};
  for (std::size_t a = 0; a < 3; ++a)
    if (!o.centre[a]) o.centre[a] = middle[a];
  for (std::size_t a = 0; a < (deep ? 3U : 2U); ++a)
    if (*o.centre[a] < o.radius || *o.centre[a] > d.length[a] - o.radius)
      schema.fail("drop", axis_names[a], "the drop must lie inside the box");
  if (!(y > o.radius && y < *o.centre[1] - 0.02 * height))
    schema.fail(
        "drop", "measure_at",
        "must be lower than the drop starts, by a fiftieth of the height at least, and the drop above the floor");
  p.places = {{*o.centre[0], *o.centre[1], *o.centre[2]}};
  find_tension(o, p, here.density, *o.centre[1] + o.radius);
  p.theory_fall = find_fall_of_one(o, p, {*o.centre[0], y, *o.centre[2]}, p.theory_about);
}

}  // namespace

box_of_drops box_of(const domain_options& d) {
  return {static_cast<int>(d.dimension), d.length, {d.periodic[0], false, d.dimension == 3 && d.periodic[2]}};
}

std::array<double, 2> melting_range(const melting_options& o, double p) {
  if (o.curve == "constant") return {o.solidus, o.liquidus};
  const double above = std::max(p, 0.0);  // the fits' range; sound may take the top below
  return {melting::solidus(above), melting::liquidus(o.composition == "chondritic" ? melting::composition::chondritic
                                                                                   : melting::composition::peridotitic,
                                                     above)};
}

double partition_coefficient(const element_options& o, double p, double T) {
  if (o.name == "constant") return o.partition_coefficient;
  return theory::partition_coefficient(o.name == "nickel" ? theory::nickel : theory::cobalt, p, T, o.iron_ratio);
}

double viscosity_by_melt(const melting_options& o, double T, double melt_fraction) {
  // The laws' liquid has a pole at 1000 K, far below every solidus: there all is solid.
  const double eta = T < 1100.0                     ? melting::solid_viscosity(T)
                     : o.viscosity_law == "blended" ? melting::blended_viscosity(T, melt_fraction)
                                                    : melting::suspension_viscosity(T, melt_fraction);
  return std::clamp(eta, o.viscosity_min, o.viscosity_max);
}

void declare(namelist::schema& schema, problem_kind kind, options& o) {
  const char* group = group_of(kind);
  const auto names = names_of(kind);
  o.march.kernel.name = "wendland_c6";
  o.march.kernel.skin = 0.4;
  o.march.output.history_interval = 10;
  o.march.time.t_end = 3000.0;
  for (const std::size_t n : {0, 1}) o.material[n].density = default_density[n];
  declare(schema, o.domain);
  schema.group(group, kind == problem_kind::drop ? "a drop that sinks in a box" : "a dense layer over a light one");
  for (const std::size_t n : {1, 0}) declare(schema, group, names[n], o.material[n]);
  schema.add(group, "bulk_modulus", o.bulk_modulus, positive("Pa", "K of p = K (rho/rho0 - 1), of both"));
  schema.add(group, "gravity", o.gravity, positive("m/s^2", "towards -y"));
  schema.add(group, "p_top", o.p_top, {.unit = "Pa", .meaning = "pressure at the top of the start column"});
  schema.add(group, "temperature", o.temperature, positive("K", "at the top of the start column"));
  schema.add(
      group, "temperature_law", o.temperature_law,
      {.choices = {"isothermal", "adiabatic", "enthalpy"},
       .meaning = "one temperature for ever; adiabats at the start and temperature by compression, friction, "
                  "conduction; or heat content by friction and conduction, and melting (linear equations of state)"});
  schema.add(group, "conductivity", o.conductivity,
             {.unit = "W/(m K)", .minimum = 0.0, .meaning = "thermal, not of the isothermal law"});
  schema.add(group, "surface_tension", o.surface_tension,
             {.unit = "N/m", .minimum = 0.0, .meaning = "between the two materials; walls are neutral (90 degrees)"});
  for (const std::size_t n : {1, 0})
    schema.add(group, std::string("temperature_") + names[n], o.start_heat[n],
               positive("K", "at the start, enthalpy law; not given: temperature"));
  if (kind == problem_kind::drop) {
    schema.add(group, "radius", o.radius, positive("m", "of the drop"));
    for (std::size_t a = 0; a < 3; ++a)
      schema.add(
          group, axis_names[a], o.centre[a],
          {.unit = "m", .minimum = 0.0, .meaning = "its centre; not given: the middle, y at 0.75 of the height"});
    schema.add(group, "measure_at", o.measure_at,
               {.minimum = 0.0, .maximum = 1.0, .meaning = "height over the box's where the velocity is measured"});
    schema.add(group, "shape", o.shape,
               {.choices = {"round", "square"}, .meaning = "at the start; square (a cube): of the round one's volume"});
    schema.add(group, "elongation", o.elongation,
               positive("1", "at the start, extent along y over that across, at the same volume"));
    schema.add(group, "drops", o.drops,
               {.minimum = 1,
                .maximum = 1e5,
                .meaning = "how many; several lie where they are drawn, all over the box, or at places_x …"});
    schema.add(group, "seed", o.seed, {.minimum = 0, .meaning = "of the places drawn"});
    schema.add(group, "least_gap", o.least_gap,
               {.unit = "m",
                .minimum = 0.0,
                .meaning = "several drops: between the surfaces of two drawn, and to walls; not given: two spacings"});
    for (std::size_t a = 0; a < 3; ++a)
      schema.add(group, std::string("places_") + axis_names[a], o.places[a],
                 {.unit = "m", .minimum = 0.0, .meaning = "several drops: their centres, in the place of drawn ones"});
    for (auto [key, value, meaning] : {std::tuple{"measure_from", &o.measure_from, "not given: the start"},
                                       {"measure_until", &o.measure_until, "not given: the end"}})
      schema.add(group, key, *value,
                 {.unit = "s",
                  .minimum = 0.0,
                  .meaning = std::string("several drops: of the time over which their fall is measured; ") + meaning});
  } else {
    schema.add(
        group, "interface", o.interface,
        {.unit = "m",
         .minimum = 0.0,
         .exclusive_minimum = true,
         .meaning = "its height; rows whose centres are not above it are of the lower layer; not given: the middle"});
    schema.add(group, "wavelength", o.wavelength, positive("m", "along x; not given: the box's width"));
    schema.add(group, "wavelength_z", o.wavelength_z,
               {.unit = "m", .minimum = 0.0, .meaning = "along z; 0: none (3-D only)"});
    schema.add(group, "amplitude", o.amplitude,
               {.unit = "m", .minimum = 0.0, .meaning = "of the interface at the start"});
    schema.add(group, "start", o.start,
               {.choices = {"eigenmode", "displaced", "coloured"},
                .meaning = "displaced by the growing mode, with its velocity or at rest; or a lattice whose materials "
                           "part at the wave"});
  }
  if (kind == problem_kind::rayleigh_taylor) {
    schema.add(group, "pond_top", o.pond_top,
               positive("m", "enthalpy law: the upper material lies below this height, the lower one once more above"));
    schema.add(group, "cover_temperature", o.cover_temperature,
               positive("K", "of what lies above pond_top; not given: temperature"));
  }
  declare(schema, group, o.scheme);
  declare(schema, o.melting);
  declare(schema, o.element);
  schema.group("walls", "sides of the box that are not periodic");
  schema.add("walls", "floor", o.walls.floor,
             {.choices = {"no_slip", "free_slip"}, .meaning = "velocity at the floor"});
  schema.add("walls", "lid", o.walls.lid,
             {.choices = {"no_slip", "free_slip", "free_surface"}, .meaning = "velocity at the lid, or none there"});
  schema.add("walls", "sides", o.walls.sides,
             {.choices = {"no_slip", "free_slip"}, .meaning = "velocity at the sides"});
  schema.add(
      "walls", "pressure", o.walls.pressure,
      {.choices = {"hydrostatic", "mirrored"}, .meaning = "behind floor and lid: continued with rho g, or as inside"});
  march::declare(schema, o.march, true);
}

parameters resolve(const namelist::schema& schema, problem_kind kind, options& o) {
  const char* group = group_of(kind);
  march::resolve(o.march);
  parameters p{};
  p.material = std::make_unique<std::array<eos::any, 2>>();
  check_domain(schema, o, p);
  find_heat(schema, kind, o, p);
  choose_scheme(schema, group, o, p);
  check_element(schema, o.element);
  find_elasticity(o, p);
  if (o.conductivity > 0.0 && o.temperature_law == "isothermal")
    schema.fail(group, "conductivity", "there is nothing to conduct at one temperature");
  const double height = o.domain.length[1];
  for (const std::size_t n : {0, 1}) {
    const auto& m = o.material[n];
    const std::string which = names_of(kind)[n];
    if (m.eos != "linear") {
      const std::string density = "density_" + which, modulus = "bulk_modulus_" + which;
      refuse(schema, group, {{density.c_str(), m.density == default_density[n]}, {modulus.c_str(), !m.bulk_modulus}},
             "is of the linear equation of state; '" + m.eos + "' has its own");
    }
    (*p.material)[n] = make(o, n);
  }
  const bool adiabatic = o.temperature_law == "adiabatic";
  if (kind == problem_kind::rayleigh_taylor) {
    if (!o.interface) o.interface = 0.5 * height;
    const double rows = std::floor(*o.interface / p.dx + 0.5 + 1e-9);  // with their centres not above it
    p.interface = rows * p.dx;
    if (!(rows >= 1.0 && rows < static_cast<double>(o.domain.particles[1])))
      schema.fail(group, "interface", "leaves no row of particles on one side");
  } else {
    p.interface = height;
  }
  p.pond_top = height;
  if (o.pond_top) {
    p.pond_top = std::floor(*o.pond_top / p.dx + 0.5 + 1e-9) * p.dx;
    if (!(p.pond_top > p.interface && p.pond_top < height))
      schema.fail(group, "pond_top", "must leave rows of particles to the pond and to what covers it");
  }
  const std::size_t top = kind == problem_kind::drop ? 0 : 1;
  const auto at_rest = [&](std::size_t n) { return barotropic{&(*p.material)[n], o.p_top, o.temperature, adiabatic}; };
  if (o.pond_top)
    p.base = std::make_unique<column>(at_rest(0), at_rest(1), at_rest(0), p.interface, p.pond_top, height, o.gravity);
  else
    p.base = std::make_unique<column>(at_rest(0), at_rest(top), p.interface, height, o.gravity);
  if (kind == problem_kind::rayleigh_taylor) {
    p.density_difference = p.base->at(p.interface).density - p.base->at(p.interface * (1.0 - 1e-12)).density;
    find_waves(schema, o, p);
    warn_of_tension(o, p, p.interface);
    if (o.melting.curve != "none" && !o.pond_top) find_melt(o, p);
  } else {
    find_fall(schema, o, p);
  }
  return p;
}

std::string theory_text(problem_kind kind, const options& o, const parameters& p) {
  if (kind == problem_kind::drop)
    return p.theory_fall
               ? fmt::format("{}\ndrop less surroundings {:.6g} kg/m3 at y = {:.6g} m\nfall velocity {:.9g} m/s\n",
                             p.theory_about, p.density_difference, o.measure_at * o.domain.length[1], *p.theory_fall)
               : p.theory_about + "\n";
  if (p.melt_conducted)
    return fmt::format("{}\nmelt fraction {:.6g} of the lower material at t = {:.6g} s, by conduction at rest\n",
                       p.theory_about, *p.melt_conducted, *o.march.time.t_end);
  if (!p.growth) return p.theory_about + "\n";
  return fmt::format(
      "interface {:.9g} m above the floor, density above less below {:.6g} kg/m3 there\n"
      "wave number {:.9g} 1/m, {} floor, {} lid\n"
      "growth rate {:.9g} 1/s (as run: compressible, {} stress)\n"
      "growth rate {:.9g} 1/s (incompressible)\n",
      p.interface, p.density_difference, std::hypot(p.k_x, p.k_z), o.walls.floor, o.walls.lid, *p.growth,
      o.scheme.stress, *p.growth_incompressible);
}

}  // namespace tetsuame::overturn
