#include <two_fluids/groups.hpp>

namespace tetsuame::two_fluids {

namespace {

// What is not calculated beside bodies, each in a sentence at its key.
void refuse_with_bodies(const namelist::schema& schema, problem_kind kind, const options& o) {
  const char* group = group_of(kind);
  if (o.by_program)
    schema.fail("solids", "shape",
                "bodies have the pressures of program " + std::string(group) + ", not those of this scheme: run that");
  if (o.open_lid()) schema.fail("walls", "slip_top", "with bodies the box is closed: 'no_slip' or 'free_slip'");
  if (o.masses == "equal_mass")
    schema.fail(group, "masses", "wall particles of bodies stand on one lattice: 'equal_spacing'");
  if (o.scheme.supports == "volume")
    schema.fail(group, "supports", "wall particles of bodies have the one support: 'fixed'");
  if (o.surface_tension > 0.0)
    schema.fail(group, "surface_tension", "the angle of the materials' contact to a body is not calculated");
  if (kind == problem_kind::drop && o.drops > 1)
    schema.fail(group, "drops", "several drops start in a box without bodies: the weight above them is of whole rows");
  if (!o.common.start.file.empty()) schema.fail("initial", "file", "a box with bodies starts from its lattice");
}

}  // namespace

void resolve_bodies(const namelist::schema& schema, problem_kind kind, const options& o, parameters& p) {
  if (!o.has_bodies()) return;
  refuse_with_bodies(schema, kind, o);
  if (o.domain.dimension == 3)
    std::get<1>(p.bodies) = rigid::bodies_at_rest<3>(schema, o.solids, rigid::box_of<3>(o.domain, o.common, o.walls));
  else
    std::get<0>(p.bodies) = rigid::bodies_at_rest<2>(schema, o.solids, rigid::box_of<2>(o.domain, o.common, o.walls));
  if (kind == problem_kind::rayleigh_taylor) return;
  p.theory_fall.reset();
  p.theory_about = "bodies stand in the box: no velocity of fall to compare with";
}

}  // namespace tetsuame::two_fluids
