#include <fmt/format.h>
#include <gravity/options.hpp>

#include <cmath>
#include <eos/keys.hpp>
#include <gas/setup_parts.hpp>
#include <numbers>
#include <run/amounts.hpp>

namespace tetsuame::gas {

namespace {

using namelist::between, namelist::for_expert, namelist::positive, namelist::up_to;

const regions::abilities of_regions{.materials = {"left", "right"},
                                    .temperature = true,
                                    .velocity = true,
                                    .density = true,
                                    .pressure = true,
                                    .energy = true};

const domain::demands demands{.least_dimension = 1, .least_particles = 8, .follows_x = true, .jitters = false};

void declare_case(namelist::schema& schema, shock_options& s) {
  schema.add(
      "shock", "test", s.test,
      {.choices = {"riemann", "square", "sedov", "kelvin_helmholtz", "rayleigh_taylor", "gresho", "noh", "blasts",
                   "impact", "viscous_shock", "collapse"},
       .meaning =
           "what is at the start; left and right are inside and outside of a square or band, core and mantle of "
           "bodies that meet, behind a shock and ahead of it. collapse: a cold cloud of mass and radius 1 under its "
           "own gravity, in units with G = 1, of gamma alone. square: pairs are in double precision unless "
           "&kernel precision is given"});
  schema.add(
      "shock", "scheme", s.scheme,
      {.choices = {"ssph", "disph", "gsph", "gdisph", "remix", "gdf"},
       .meaning =
           "standard, density-independent; Godunov's forms of the two; kernels that reproduce linear fields; "
           "forces with geometric densities. Supports that follow the density are found once a step, which makes "
           "every method of &time of first order"});
  schema.add("shock", "masses", s.masses,
             {.choices = {"equal_mass", "equal_spacing"},
              .meaning = "of the particles where the density jumps; smooth layers have equal spacing"});
}

void declare_weights(namelist::schema& schema, shock_options& s) {
  schema.add("shock", "weight", s.weight,
             {.choices = {"energy", "volume", "power"},
              .meaning = "disph, gdisph, what is smoothed: m u; or the volume at the start, for any equation of state, "
                         "with densities as given at the start; or p^exponent times the volume, for an ideal gas in "
                         "one dimension with "
                         "strong shocks"});
  schema.add("shock", "exponent", s.exponent,
             for_expert(between(0.01, 1.0, "weight = 'power': of the pressure; 1: the weight is that of 'energy'")));
  schema.add(
      "shock", "support_terms", s.support_terms,
      {.choices = {"weight", "number", "none", "fading"},
       .expert = true,
       .meaning =
           "disph, gdisph, the forces' terms of a support that varies: as if it followed the weight's "
           "density [S4], or the number density, as it does [Hopkins 2013]; ssph and gdf have the first for "
           "both. none: no such terms, in any of the four, as in gsph. fading (gdisph): as 'number' where pressures "
           "are equal and as 'none' where they jump, with one volume of the pair"});
  schema.add("shock", "fading", s.fading,
             for_expert(between(0.0, 1e6,
                                "support_terms = 'fading': the terms are gone where the pressures of a pair differ by "
                                "this part of their sum, inverted")));
  schema.add(
      "shock", "density", s.density,
      {.choices = {"weight", "mass"},
       .expert = true,
       .meaning =
           "disph, gdisph, in output and errors: m q/U, sharp at contacts, or the sum of m W, for gas so cold that "
           "the pressure at a particle is its neighbours'"});
}

void declare_states(namelist::schema& schema, shock_options& s) {
  struct end {
    std::string name, where;
    side_options& of;
  };
  const std::array<end, 2> ends{{{"l", " on the left", s.l}, {"r", " on the right", s.r}}};
  for (const auto& [name, where, of] : ends) {
    schema.add("shock", "rho_" + name, of.rho, positive("kg/m^3", "density" + where));
    schema.add("shock", "u_" + name, of.u, {.unit = "m/s", .meaning = "velocity along x" + where});
    schema.add("shock", "p_" + name, of.p, positive("Pa", "pressure" + where));
  }
  const auto above_one = [](std::string meaning) {
    return namelist::key_info{.minimum = 1.0, .exclusive_minimum = true, .meaning = std::move(meaning)};
  };
  schema.add("shock", "gamma", s.gamma, above_one("adiabatic exponent of the gas"));
  for (const auto& [name, where, of] : ends) {
    schema.add("shock", "gamma_" + name, of.gamma, above_one("riemann, square: of the gas" + where + "; empty: gamma"));
    schema.add("shock", "p_infinity_" + name, of.p_infinity,
               {.unit = "Pa",
                .minimum = 0.0,
                .meaning = "riemann, square: of the stiffened gas" + where + "; 0: an ideal gas"});
  }
  std::vector<std::string> equations{""};
  for (const auto known : eos::names()) equations.emplace_back(known);
  for (const auto& [name, where, of] : ends) {
    schema.add("shock", "eos_" + name, of.eos,
               {.choices = equations,
                .meaning = "riemann, square, kelvin_helmholtz, rayleigh_taylor, impact: equation of state" + where +
                           ", with its own parameters; '': the gas of gamma and p_infinity"});
    schema.add("shock", "tillotson_" + name, of.tillotson,
               {.choices = {"", "iron", "granite", "basalt"},
                .expert = true,
                .meaning = "of the equation of state 'tillotson'" + where + ": its material; '': iron"});
    schema.add("shock", "table_" + name, of.table, for_expert(eos::key_of_table(where)));
    schema.add("shock", "temperature_" + name, of.temperature,
               positive("K", "with an equation of state:" + where + "; the density follows from it and p"));
  }
}

void declare_test(namelist::schema& schema, shock_options& s) {
  schema.add("shock", "window", s.window,
             for_expert(up_to(1.0, "errors are measured in this part of the box along x, about its middle")));
  schema.add(
      "shock", "middle", s.middle,
      for_expert(between(0.05, 0.95, "riemann, viscous_shock: where the two sides meet, in parts of the box along x")));
  schema.add("shock", "coarser", s.coarser,
             between(0, 10,
                     "first so many runs of the same with 1/2, 1/4, ... of the particles along an axis; summary.json "
                     "then has the errors of all and their order of convergence"));
  schema.add("shock", "energy", s.energy, positive("J", "sedov: of the explosion"));
  schema.add("shock", "blast_radius", s.blast_radius,
             for_expert(between(1.0, 100.0, "sedov: within so many spacings the energy starts")));
  schema.add("shock", "corner", s.corner,
             {.expert = true,
              .meaning = "sedov: the centre is in the corner at the origin, of which the box sees one quadrant or "
                         "octant; the energy is that of the whole explosion"});
  schema.add("shock", "layer", s.layer, positive("m", "kelvin_helmholtz, rayleigh_taylor: width of the layers"));
  schema.add("shock", "perturbation", s.perturbation,
             {.unit = "m/s", .meaning = "kelvin_helmholtz, rayleigh_taylor: velocity along y, a sine along x"});
  schema.add("shock", "waves", s.waves, between(1, 1000, "kelvin_helmholtz, rayleigh_taylor: of that sine"));
  schema.add("shock", "tension", s.tension,
             {.expert = true,
              .meaning = "equations of state: pressures below zero are as they say; F: they are zero, as in a material "
                         "that parts, and sound is not below a tenth of that at the start"});
  schema.add("shock", "radius", s.radius, for_expert(positive("m", "impact: of each of the two bodies")));
  schema.add("shock", "core", s.core,
             for_expert(up_to(1.0, "impact: radius of the cores, of the left material, over that")));
  gravity::declare(schema, "shock", "gravity", s.gravity, true, "rayleigh_taylor: ");
}

void declare_dissipation(namelist::schema& schema, shock_options& s) {
  schema.add("shock", "solver", s.solver,
             {.choices = {"exact", "hllc"}, .meaning = "of the Riemann problem (gsph, gdisph)"});
  schema.add("shock", "reconstruction", s.reconstruction,
             {.choices = {"first", "second"}, .meaning = "order of the states at the interface (gsph, gdisph)"});
  schema.add("shock", "limiter", s.limiter,
             {.choices = {"minmod", "monotonised"}, .expert = true, .meaning = "of the second order's slopes"});
  schema.add("shock", "star_pressure", s.star_pressure,
             {.choices = {"full", "balsara"},
              .expert = true,
              .meaning = "gdisph: the Riemann problem's throughout, or in the part that Balsara's factor gives, and "
                         "the particles' own in the rest"});
  schema.add("shock", "alpha", s.alpha,
             between(0.0, 10.0, "of the artificial viscosity (ssph, disph); time-dependent: the largest"));
  schema.add("shock", "time_dependent_alpha", s.switch_of_alpha,
             {.meaning = "alpha rises where gas is compressed and decays to alpha_min"});
  schema.add("shock", "alpha_min", s.alpha_min, for_expert(between(0.0, 10.0, "smallest alpha")));
  schema.add("shock", "balsara", s.balsara, {.meaning = "less viscosity where gas is sheared and not compressed"});
  schema.add("shock", "conductivity", s.conductivity,
             for_expert(between(0.0, 10.0,
                                "ssph, gdf: alpha_u of an artificial conductivity that acts where pressures differ "
                                "[Price 2008]; 0: none")));
  schema.add(
      "shock", "gradients", s.gradients,
      {.choices = {"kernel", "integral"},
       .expert = true,
       .meaning = "ssph, gdf: the kernel's, or by an integral, exact for linear fields [Garcia-Senz et al. 2012]"});
}

}  // namespace

void declare(namelist::schema& schema, options& o) {
  o.common.time.method = "adaptive";
  o.common.time.rtol = 0.02;
  o.common.kernel.name = "quintic";
  o.common.kernel.skin = 0.5;
  // What it changes is a tenth of any answer's error at most: docs/studies/2026-11-24_single_precision.md
  o.common.kernel.precision = "single";
  domain::declare(schema, demands, o.domain);
  schema.group("shock", "gas with contacts and shocks");
  declare_case(schema, o.shock);
  declare_weights(schema, o.shock);
  declare_states(schema, o.shock);
  declare_test(schema, o.shock);
  declare_dissipation(schema, o.shock);
  gravity::declare_softening(schema, "shock", o.softening, "collapse: ");
  declare_largest_support(schema, "shock", o.largest_support);
  declare_transport(schema, o.shock);
  regions::declare(schema, of_regions, o.of_regions);
  sources::declare(schema, {.temperature = false}, o.of_sources);
  run::declare(schema, o.common,
               {.single_pairs = true,
                .keeping = {"kdk"},
                .kernels = {"quintic", "wendland_c4"},
                .diffuses = false,
                .starts_from_file = true,
                .reads = "places, velocities, densities, masses, and internal energies or pressures"});
}

eos::any eos_of(const side_options& side) {
  eos::material_options m = side.parameters;
  m.name = side.eos;
  m.tillotson = side.tillotson;
  m.table = side.table;
  return eos::make(m);
}

// As setups.cpp lays them.
double expected_particles(const options& o) {
  const double lattice = o.domain.lattice_particles();
  if (o.shock.test == "impact") {
    const double radius = o.shock.radius / o.domain.dx();  // in spacings
    return std::min(lattice, 2.0 * run::particles_within(radius, o.domain.dimension));
  }
  if (o.shock.test == "collapse") return lattice * std::numbers::pi / 6.0;
  if (o.shock.masses == "equal_mass" && o.any_eos()) {
    const double denser = o.shock.l.rho / o.shock.r.rho;
    if (o.shock.test == "kelvin_helmholtz") return 0.5 * lattice * (1.0 + denser);
    if (o.shock.test == "rayleigh_taylor") return 0.5 * lattice * (1.0 + 1.0 / denser);
  }
  if (o.shock.test != "square" || o.shock.masses != "equal_mass") return lattice;
  const double inside = std::pow(0.5, static_cast<double>(o.domain.dimension));
  return lattice * (1.0 - inside + inside * o.shock.l.rho / o.shock.r.rho);
}

namespace {

// Of a run at this or a coarser resolution.
void check_kernel_fits(const namelist::schema& schema, const options& o, const domain::options& d) {
  const double dx = d.dx(), support = run::support_over_dx(o.common.kernel) * dx;
  domain::check_widths(schema, d, support + o.common.kernel.skin * dx, support);
}

void resolve_box(const namelist::schema& schema, options& o) {
  auto& d = o.domain;
  domain::resolve(schema, demands, d);
  for (std::size_t a = d.axes(); a < 3; ++a) d.length[a] = 0.0, d.particles[a] = 0;
  domain::check_number(schema, d, std::max(d.lattice_particles(), expected_particles(o)));
  check_kernel_fits(schema, o, d);
}

// Of one side: with an equation of state the density follows.
void resolve_material(const namelist::schema& schema, const std::string& test, const std::string& end,
                      side_options& side) {
  const auto fail = [&](const char* key, const std::string& why) { schema.fail("shock", key + end, why); };
  if (!side.tillotson.empty() && side.eos != "tillotson") fail("tillotson_", "needs eos_" + end + " = 'tillotson'");
  if (!side.table.empty() && side.eos != "table") fail("table_", "needs eos_" + end + " = 'table'");
  if (side.temperature && side.eos.empty()) fail("temperature_", "a temperature needs an equation of state");
  if (side.eos.empty()) return;
  const std::array<std::string_view, 5> tests{"riemann", "square", "kelvin_helmholtz", "rayleigh_taylor", "impact"};
  if (std::find(tests.begin(), tests.end(), test) == tests.end())
    fail("eos_", "the test '" + test + "' is of an ideal gas");
  if (!side.temperature) fail("eos_", "an equation of state needs temperature_" + end);
  if (side.gamma) fail("gamma_", "is of a gas, and there is an equation of state");
  if (side.p_infinity != 0.0) fail("p_infinity_", "is of a gas, and there is an equation of state");
  const double follows =
      schema.placed("shock", "eos_" + end, [&] { return eos::density(eos_of(side), side.p, *side.temperature); });
  if (schema.given("shock", "rho_" + end) && std::abs(side.rho / follows - 1.0) > 1e-9)
    fail("rho_",
         fmt::format("of '{}' at this pressure and temperature the density is {:.10g} kg/m^3", side.eos, follows));
  side.rho = follows;
}

void resolve_materials(const namelist::schema& schema, options& o) {
  auto& s = o.shock;
  const bool waves = s.test == "kelvin_helmholtz" || s.test == "rayleigh_taylor";
  if (waves && !o.any_eos()) {
    if (schema.given("shock", "masses") && s.masses == "equal_mass")
      schema.fail("shock", "masses", "the layers of this test are smooth: expected 'equal_spacing'");
    s.masses = "equal_spacing";
  }
  if (o.any_eos() && (s.test == "impact" || waves)) {
    if (!schema.given("shock", "p_r")) s.r.p = s.l.p;
    if (s.r.p != s.l.p) schema.fail("shock", "p_r", "where the materials touch both have the pressure p_l");
  }
  resolve_material(schema, s.test, "l", s.l);
  resolve_material(schema, s.test, "r", s.r);
  if (s.l.eos.empty() != s.r.eos.empty())
    schema.fail("shock", s.l.eos.empty() ? "eos_l" : "eos_r", "both sides have an equation of state, or neither");
  if (o.any_eos()) {
    if (o.weighs_energy() || o.weighs_power())
      schema.fail("shock", "weight", "an equation of state needs weight = 'volume' in '" + s.scheme + "'");
    return;
  }
  bool one_gas = true;
  for (side_options* side : {&s.l, &s.r}) {
    if (!side->gamma) side->gamma = s.gamma;
    one_gas = one_gas && side->p_infinity == 0.0 && *side->gamma == s.gamma;
  }
  if (one_gas) return;
  if (s.test != "riemann" && s.test != "square")
    schema.fail("shock", "gamma_l", "the test '" + s.test + "' is of an ideal gas with one gamma");
  if (o.weighs_energy() || o.weighs_power())
    schema.fail("shock", "weight", "two gases, or a stiffened gas, need weight = 'volume' in '" + s.scheme + "'");
}

void check_form(const namelist::schema& schema, const options& o) {
  const auto& s = o.shock;
  if (o.common.time.method == "kdk" && o.weighs_power())
    schema.fail("time", "method", "'kdk' has no state of which the weights of weight = 'power' could follow");
  if (o.integral() && !o.density_based())
    schema.fail("shock", "gradients", "'integral' is of the schemes 'ssph' and 'gdf'");
  if (!o.conducts()) return;
  if (!o.density_based())
    schema.fail(
        "shock", "conductivity",
        "is of the schemes 'ssph' and 'gdf': the others have no step of p at a contact, or diffusion of their own");
  const bool one_gas = s.l.p_infinity == 0.0 && s.r.p_infinity == 0.0 && s.l.gamma == s.r.gamma;
  if (o.any_eos() || !one_gas)
    schema.fail("shock", "conductivity",
                "evens out u, whose zero differs from material to material: one ideal gas alone");
}

void check_test(const namelist::schema& schema, const options& o) {
  const auto& s = o.shock;
  const auto& test = s.test;
  if (test == "rayleigh_taylor" ? s.gravity <= 0.0 : s.gravity != 0.0)
    schema.fail("shock", "gravity", "gravity is for the test 'rayleigh_taylor', which needs it");
  if (test == "rayleigh_taylor" && o.domain.periodic[1])
    schema.fail("domain", "periodic_y", "the test 'rayleigh_taylor' has walls below and above");
  if (s.weight == "power" && !o.density_independent())
    schema.fail("shock", "weight", "'power' is of the schemes 'disph' and 'gdisph'");
  if (s.weight != "power" && s.exponent != shock_options{}.exponent)
    schema.fail("shock", "exponent", "belongs to weight = 'power'");
  if (s.middle != 0.5 && test != "riemann" && test != "viscous_shock")
    schema.fail("shock", "middle", "is of the tests 'riemann' and 'viscous_shock'");
  if (o.terms_fade() && s.scheme != "gdisph")
    schema.fail("shock", "support_terms", "'fading' is of the scheme 'gdisph'");
  if (test == "impact") {
    if (!o.any_eos()) schema.fail("shock", "eos_l", "the test 'impact' is of materials with equations of state");
    if (s.radius < 2.0 * o.domain.dx()) schema.fail("shock", "radius", "a body has a radius of two spacings at least");
    for (std::size_t a = 0; a < o.domain.axes(); ++a)
      if (o.domain.length[a] < (a == 0 ? 4.0 : 2.0) * s.radius)
        schema.fail("shock", "radius", "the box does not hold the two bodies side by side");
  }
  if (s.corner)
    for (std::size_t a = 0; a < o.domain.axes(); ++a)
      if (test != "sedov" || o.domain.periodic[a])
        schema.fail("shock", "corner", "the centre is in a corner only in the test 'sedov' and between walls");
  if (o.domain.dimension == 1 &&
      (test == "square" || test == "kelvin_helmholtz" || test == "rayleigh_taylor" || test == "gresho"))
    schema.fail("domain", "dimension", "the test '" + test + "' has two dimensions at least");
}

// Sums over pairs have products of up to three densities and pressures, which must lie among the numbers of single
// precision, 1e-38 to 3e38. In these ranges Sod's tube comes out as in double precision to five digits with every
// scheme; the first goes wrong beyond 1e-13 and 1e17.
bool fits_single(const options& o) {
  const auto& s = o.shock;
  if (o.any_eos()) return true;  // of liquids and rock
  const auto [thin, dense] = std::minmax(s.l.rho, s.r.rho);
  double most = std::max({s.l.p, s.r.p, s.l.rho * s.l.u * s.l.u, s.r.rho * s.r.u * s.r.u});  // Pa
  if (s.test == "sedov")
    most = std::max(most, s.energy / std::pow(s.blast_radius * o.domain.dx(), static_cast<double>(o.domain.dimension)));
  return thin >= 1e-9 && dense <= 1e9 && most >= 1e-12 && most <= 1e15;
}

}  // namespace

void declare_largest_support(namelist::schema& schema, const std::string& group, double& largest) {
  schema.add(group, "largest_support", largest,
             namelist::for_expert({.minimum = 0.0,
                                   .maximum = 1e6,
                                   .meaning = "of a particle's kernel, over the largest one at the start: beyond it a "
                                              "lone particle has fewer neighbours; 0: any"}));
}

void choose_cfl(run::time_options& o) {
  if (!o.cfl) o.cfl = o.method == "euler" ? 0.1 : o.method == "kdk" ? 0.25 : 0.4;
}

void choose_precision(const namelist::schema& schema, options& o) {
  auto& kernel = o.common.kernel;
  if (!kernel.single_pairs()) return;
  const bool exact = o.godunov() && o.shock.solver == "exact";
  if (!schema.given("kernel", "precision")) {
    if (o.evolves_density() || exact || o.shock.test == "square" || !fits_single(o) || o.element.any())
      kernel.precision = "double";
    return;
  }
  if (!fits_single(o))
    schema.fail("kernel", "precision",
                "expected 'double': 'single' holds densities from 1e-9 to 1e9 kg/m^D with pressures from 1e-12 to 1e15 "
                "Pa");
  if (o.evolves_density()) schema.fail("kernel", "precision", "the scheme 'remix' computes pairs in double precision");
  if (o.element.any())
    schema.fail("kernel", "precision",
                "expected 'double': the exchange of an element is summed in it, so that none is lost");
  if (exact) schema.fail("kernel", "precision", "solver = 'exact' iterates in double precision: 'single' needs 'hllc'");
}

namespace {

void resolve_regions(const namelist::schema& schema, options& o) {
  o.regions = regions::all(schema, of_regions, o.of_regions, static_cast<int>(o.domain.dimension), o.domain.length,
                           o.domain.dx());
  o.sources = sources::all(schema, o.of_sources, o.of_regions, static_cast<int>(o.domain.dimension), o.domain.length,
                           o.domain.dx());
  using regions::what;
  const auto& r = o.regions;
  if (r.any() && !o.common.start.file.empty())
    schema.fail("initial", "file", "a snapshot says what is where, and so does &region");
  if (!o.common.start.file.empty() && o.shock.coarser > 0)
    schema.fail("shock", "coarser", "a snapshot has particles of one resolution");
  if (r.any() && o.shock.test == "collapse")
    schema.fail("shock", "test", "the start of 'collapse' is given, and so leaves nothing to &region");
  if (r.any() && o.shock.coarser > 0)
    schema.fail("shock", "coarser", "the start is that of &region: there is no exact solution");
  if (r.give(what::energy) && r.give(what::pressure))
    schema.fail("region", "energy", "one of energy and pressure says the other");
  if (!o.any_eos() && r.give(what::temperature))
    schema.fail("region", "temperature", "needs equations of state, eos_l and eos_r: a gas has its pressure or energy");
  if (o.any_eos() && r.give(what::density) && r.give(what::pressure))
    schema.fail("region", "density",
                "with equations of state the density follows from pressure and temperature, or is "
                "given without a pressure");
}

void check_coarser(const namelist::schema& schema, const options& o) {
  const std::int64_t k = o.shock.coarser;
  if (k == 0) return;
  if (o.shock.molecular.any() && o.shock.test != "viscous_shock")
    schema.fail("shock", "coarser", "with friction or conduction of the gas there is no exact solution");
  for (const char* test : {"square", "kelvin_helmholtz", "rayleigh_taylor", "blasts", "collapse"})
    if (o.shock.test == test)
      schema.fail("shock", "coarser",
                  fmt::format("the test '{}' has no exact solution to measure errors against", test));
  for (std::size_t a = 0; a < o.domain.axes(); ++a)
    if (const auto n = o.domain.particles[a], least = n >> k; (least << k) != n || least < 8)
      schema.fail("shock", "coarser",
                  fmt::format("{} particles along an axis cannot be halved {} times to 8 or more", n, k));
  auto coarsest = o.domain;
  for (auto& n : coarsest.particles) n >>= k;
  check_kernel_fits(schema, o, coarsest);
}

// At the corners of each block, where pressure or density is least.
void check_start(const options& o, const setup& t) {
  if (o.any_eos()) return;
  for (const block& b : t.blocks)
    for (std::size_t corner = 0; corner < (std::size_t{1} << o.domain.axes()); ++corner) {
      point x{};
      for (std::size_t a = 0; a < o.domain.axes(); ++a) {
        const double half = 0.5 * (b.high[a] - b.low[a]) / static_cast<double>(b.n[a]);
        x[a] = (corner >> a & 1U) != 0 ? b.high[a] - half : b.low[a] + half;
      }
      if (b.holds && !b.holds(x)) continue;
      const state now = t.start(x);
      const side_options& side = now.material == t.material_l ? o.shock.l : o.shock.r;
      if (!(now.rho > 0.0 && now.p + side.p_infinity > 0.0))
        foundation::fail_input(fmt::format(
            "the gas would start with p = {:.6g} Pa and rho = {:.6g} kg/m^3 at ({:.6g}, {:.6g}) m, where both must be "
            "above 0: {}",
            now.p, now.rho, x[0], x[1],
            o.shock.gravity > 0.0 ? "p_l is too small for the weight above the middle, or gravity too strong"
                                  : "check the pressures and densities of &shock"));
    }
}

}  // namespace

void resolve(const namelist::schema& schema, options& o) {
  choose_cfl(o.common.time);
  run::resolve(schema, o.common);
  resolve_materials(schema, o);
  resolve_box(schema, o);
  check_form(schema, o);
  check_test(schema, o);
  resolve_collapse(schema, o);
  check_transport(schema, o);
  choose_precision(schema, o);
  resolve_regions(schema, o);
  check_coarser(schema, o);
  if (!o.common.time.has_end()) schema.fail("time", "t_end", "must be given, or else steps and dt");
  const auto test = schema.placed("shock", "test", [&] { return make_setup(o); });
  schema.placed("shock", "test", [&] { check_start(o, test); });
  std::vector<std::string> fields{"InternalEnergy"};
  if (o.self_gravity) fields.emplace_back("GravitationalPotential");
  if (o.has_alpha()) fields.emplace_back("ArtificialViscosity");
  if (test.exact) fields.insert(fields.end(), {"DensityReference", "PressureReference", "VelocitiesReference"});
  run::check_output(schema, o.common, o.domain, fields);
}

}  // namespace tetsuame::gas
