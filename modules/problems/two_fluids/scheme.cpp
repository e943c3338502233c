#include <fmt/format.h>
#include <fmt/ranges.h>

#include <eos/keys.hpp>
#include <kernels/lattice.hpp>
#include <two_fluids/groups.hpp>

namespace tetsuame::two_fluids {

std::string own_key(const eos::parameter& key, const std::string& which) { return std::string(key.key) + "_" + which; }

namespace {

// Those of the equation of state that the material has no other key for.
bool has_other_key(const eos::parameter& key) { return key.key == "bulk_modulus" || key.key == "heat_capacity"; }

}  // namespace

void declare(namelist::schema& schema, const char* group, const std::string& which, material_options& o) {
  std::vector<std::string> choices;
  for (const auto& name : eos::names()) choices.emplace_back(name);
  schema.add(group, "eos_" + which, o.eos,
             {.choices = choices, .meaning = "equation of state; others than linear have parameters of their own"});
  schema.add(group, "table_" + which, o.table, for_expert(eos::key_of_table()));
  schema.add(group, "tillotson_" + which, o.parameters.tillotson,
             for_expert({.meaning = "of eos = 'tillotson': iron, granite or basalt, whose parameters others replace; "
                                    "not given: iron"}));
  for (const eos::parameter& key : eos::parameters)
    if (!has_other_key(key))
      schema.add(group, own_key(key, which), o.parameters.*key.member, for_expert(eos::key_of(key)));
  schema.add(group, "density_" + which, o.density, positive("kg/m^3", "linear equation of state: at zero pressure"));
  schema.add(group, "bulk_modulus_" + which, o.bulk_modulus,
             for_expert(positive("Pa",
                                 "on the reference curve; not given: bulk_modulus of linear, else the equation of "
                                 "state's")));
  schema.add(group, "heat_capacity_" + which, o.heat_capacity,
             for_expert(positive("J/(kg K)", "c_V; not given: the equation of state's")));
  schema.add(group, "conductivity_" + which, o.conductivity,
             for_expert(not_negative("W/(m K)", "thermal; not given: conductivity")));
  schema.add(group, "viscosity_" + which, o.viscosity, positive("Pa s", "dynamic"));
}

void declare(namelist::schema& schema, const char* group, scheme_options& o) {
  schema.add(group, "volume", o.volume,
             {.choices = {"number_density", "our_method"},
              .meaning = "of a particle: from the number density, or m/rho with rho by continuity (our method)"});
  schema.add(
      group, "pressure", o.pressure,
      {.choices = {"non_smoothed", "smoothed"}, .meaning = "straight from the equation of state, or the sum of Y W"});
  schema.add(
      group, "reference_pressure", o.reference_pressure,
      {.choices = {"auto", "none", "lightest"},
       .expert = true,
       .meaning = "a pressure p_r(y) that the forces between particles leave out and that lifts their volumes "
                  "instead: none, or that of a column of the lighter fluid (auto: lightest with the number density "
                  "in a closed box)"});
  schema.add(group, "supports", o.supports,
             {.choices = {"fixed", "volume"},
              .expert = true,
              .meaning = "of the kernels: one for all, or in proportion to the edge of each particle's volume, with "
                         "pairs in double precision"});
  schema.add(group, "delta", o.delta,
             for_expert(between(
                 0.0, 1.0, "our_method: diffusion of the dynamic pressure in the density (0: none, as in the notes)")));
  schema.add(group, "viscous_order", o.viscous_order,
             for_expert(between(0, 4,
                                "of the viscous sum on the lattice: 2, the notes' sum; 4, which does not smooth, until "
                                "the energy dissipated falls: then 2; 0: 4 where viscosities are equal, else 2")));
}

eos::any make(const options& o, std::size_t n) {
  const auto& given = o.material[n];
  eos::material_options m = given.parameters;
  m.name = given.eos;
  m.bulk_modulus = given.bulk_modulus;
  if (given.eos == "linear") {
    m.reference_pressure = 0.0;
    m.reference_density = given.density;
    m.reference_temperature = o.temperature;
    m.bulk_modulus = given.bulk_modulus.value_or(o.bulk_modulus);
    m.thermal_expansivity = 0.0;
  }
  m.heat_capacity = given.heat_capacity;
  m.table = given.table;
  return eos::make(m);
}

// Pairs in single precision, where they are the default alone, leave to double what has no other, and surface tension,
// of which too much changes: docs/studies/2026-11-24_single_precision.md
void choose_precision(const namelist::schema& schema, options& o) {
  if (!schema.given("kernel", "precision") && (o.scheme.supports == "volume" || o.surface_tension > 0.0))
    o.common.kernel.precision = "double";
}

// What the sums with supports of their own are derived for.
void check_supports(const namelist::schema& schema, const char* group, const options& o) {
  const auto& s = o.scheme;
  if (s.pressure != "non_smoothed") schema.fail(group, "supports", "'volume' is derived for pressure = 'non_smoothed'");
  if (o.common.kernel.single_pairs())
    schema.fail("kernel", "precision", "'single' is for one support for all: supports = 'fixed'");
  if (o.surface_tension > 0.0) schema.fail(group, "supports", "surface tension has one support for all: 'fixed'");
}

// A program's scheme has the notes' viscous sum, one kernel for all and the whole pressure.
void choose_by_program(const namelist::schema& schema, const char* group, options& o, parameters& p) {
  if (o.surface_tension > 0.0 && !(o.by_number && o.walls.treatment == "mirror"))
    schema.fail(group, "surface_tension",
                "is derived for volumes of the number density, pressures of the equation of state and walls that are "
                "mirror images: run disph_n, or program " +
                    std::string(group));
  if (o.temperature_law == "enthalpy" && !o.remembers_density)
    schema.fail(
        group, "temperature_law",
        "'enthalpy' needs the density before the volumes are known, which this program's scheme does not carry: "
        "run one that does (disph_c), or program " +
            std::string(group));
  o.scheme = {.volume = "our_method", .reference_pressure = "none", .delta = 0.0, .viscous_order = 2};
  volume::resolve(schema, o.liquid, o.viscosities_differ());
  p.symmetric_stress = o.liquid.stress == "symmetric";
  if (o.liquid.consistency.ties() && !o.integrates_volume)
    p.lines.emplace_back(
        "note: &volume consistency: this program finds its volumes anew in every evaluation; there is "
        "nothing to tie");
  if (schema.passed().empty()) return;
  p.lines.push_back(
      fmt::format("note: passed over, as this program has a scheme of its own: {}", fmt::join(schema.passed(), ", ")));
}

void choose_scheme(const namelist::schema& schema, const char* group, options& o, parameters& p) {
  auto& s = o.scheme;
  if (o.by_program) {
    choose_by_program(schema, group, o, p);
    return;
  }
  if (s.volume == "number_density" && schema.given(group, "delta") && s.delta > 0.0)
    schema.fail(group, "delta", "belongs to volume = 'our_method': the number density has no rate to add to");
  if (s.volume == "number_density") s.delta = 0.0;
  if (o.open_lid() && s.volume == "number_density")
    schema.fail(group, "volume",
                "at a free surface the number density takes missing neighbours for tension: choose 'our_method'");
  if (o.surface_tension > 0.0 && !(s.volume == "number_density" && s.pressure == "non_smoothed"))
    schema.fail(group, "surface_tension", "is derived for volume = 'number_density' and pressure = 'non_smoothed'");
  const bool open = o.open_lid();
  if (open && s.reference_pressure == "lightest")
    schema.fail(group, "reference_pressure", "a free surface feels the whole pressure: choose 'none'");
  const bool whole = open || s.volume != "number_density" || o.temperature_law == "enthalpy" || o.surface_tension > 0.0;
  if (s.reference_pressure == "auto") s.reference_pressure = whole ? "none" : "lightest";
  choose_precision(schema, o);
  if (s.supports == "volume") check_supports(schema, group, o);
  if (s.rows == "balanced" &&
      !(s.volume == "our_method" && s.pressure == "non_smoothed" && s.reference_pressure == "none"))
    schema.fail(group, "rows",
                "'balanced' is derived for volume = 'our_method', pressure = 'non_smoothed' and no reference pressure");
  if (s.rows == "balanced" && o.start == "coloured")
    schema.fail(group, "rows", "'balanced' is of rows of one material each: start is 'coloured'");
  if (s.viscous_order == 1 || s.viscous_order == 3) schema.fail(group, "viscous_order", "is 2 or 4, or 0 for either");
  if (s.viscous_order == 4 && o.melting.viscosity_law != "constant")
    schema.fail(group, "viscous_order",
                "4 has far neighbours of the other sign: between two stiff ones with something soft around they make "
                "motion instead of friction; choose 2");
  // Where viscosities differ, or nothing holds the surface, only the symmetric stress is right.
  p.symmetric_stress = open || o.viscosities_differ();
  if (s.viscous_order == 0) s.viscous_order = p.symmetric_stress ? 2 : 4;
}

// A lattice under pressure resists shear, as no fluid does (kernels/lattice.hpp).
void find_elasticity(const options& o, parameters& p) {
  const auto& k = o.common.kernel;
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

}  // namespace tetsuame::two_fluids
