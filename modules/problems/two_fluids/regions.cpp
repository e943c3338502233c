#include <two_fluids/groups.hpp>

namespace tetsuame::two_fluids {

regions::abilities regions_of(problem_kind kind, const options& o) {
  const auto names = names_of(kind);
  regions::abilities all{.materials = {names[0], names[1]},
                         .more_materials = true,
                         .temperature = true,
                         .velocity = true,
                         .density = true,
                         .pressure = true};
  for (std::size_t n = 2; n < o.material.size(); ++n) all.materials.push_back(o.material[n].name);
  return all;
}

void resolve_regions(const namelist::schema& schema, problem_kind kind, const options& o, parameters& p) {
  p.regions =
      regions::all(schema, regions_of(kind, o), o.regions, static_cast<int>(o.domain.dimension), o.domain.length, p.dx);
  if (kind == problem_kind::drop && o.material.size() > 2) {
    p.theory_fall.reset();
    p.theory_about = "there are more than two materials: no velocity of fall to compare with";
  }
  p.sources = sources::all(schema, o.sources, o.regions, static_cast<int>(o.domain.dimension), o.domain.length, p.dx);
  if (p.sources.heats() && o.temperature_law == "isothermal")
    schema.fail("sources", "heating", "there is nothing to heat at one temperature: temperature_law");
  if (o.temperature_law == "enthalpy") p.sources.refuse_temperature(schema, "temperature_law = 'enthalpy'");
  if (!p.regions.any()) return;
  const char* group = group_of(kind);
  if (!o.common.start.file.empty())
    schema.fail("initial", "file", "a snapshot says what is where, and so does &region");
  if (o.masses == "equal_mass") schema.fail(group, "masses", "regions are cut from one lattice: 'equal_spacing'");
  if (o.scheme.rows == "balanced") schema.fail(group, "rows", "rows in balance are of one material: 'lattice'");
  if (o.has_bodies()) schema.fail("solids", "shape", "regions take whole rows, for the weight that lies above");
  using regions::what;
  if (p.regions.give(what::density) && p.regions.give(what::pressure))
    schema.fail("region", "density", "one of density and pressure says the other");
  if (kind == problem_kind::rayleigh_taylor) return;
  p.theory_fall.reset();
  p.theory_about = "the start is that of &region: no velocity of fall to compare with";
}

// What is to come to rest starts at rest.
void check_settling(const namelist::schema& schema, problem_kind kind, const options& o, const parameters& p) {
  if (!o.common.start.settles()) return;
  using regions::what;
  for (const what w : {what::velocity_x, what::velocity_y, what::velocity_z})
    if (p.regions.give(w)) schema.fail("initial", "settle", "the start moves: &region gives velocities");
  if (kind == problem_kind::drop) return;
  const bool from_file = !o.common.start.file.empty();
  if (!from_file && o.start == "eigenmode") schema.fail("initial", "settle", "the start moves: start = 'eigenmode'");
  if (!from_file && o.shear != 0.0) schema.fail("initial", "settle", "the start moves: shear");
}

}  // namespace tetsuame::two_fluids
