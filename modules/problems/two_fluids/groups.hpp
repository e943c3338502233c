// Parts of the input by subject, which options.cpp declares and resolves together: each group has its keys and its
// rules in one place. Not for other modules.
#pragma once

#include <namelist/refuse.hpp>
#include <two_fluids/options.hpp>

namespace tetsuame::two_fluids {

inline const char* group_of(problem_kind kind) { return kind == problem_kind::drop ? "drop" : "rti"; }
inline std::array<const char*, 2> names_of(problem_kind kind) {
  if (kind == problem_kind::drop) return {"outside", "drop"};
  return {"lower", "upper"};
}

using namelist::between, namelist::for_expert, namelist::positive, namelist::refuse, namelist::up_to;

inline namelist::key_info not_negative(std::string unit, std::string meaning) {
  return {.unit = std::move(unit), .minimum = 0.0, .meaning = std::move(meaning)};
}

inline constexpr std::array<const char*, 3> axis_names{"x", "y", "z"};

// Of floor, lid and those sides that are walls, whose slip is empty where there are none.
struct slips {
  std::string floor, lid, sides;
  bool all_free() const { return floor == "free_slip" && lid == floor && (sides == floor || sides.empty()); }
};
slips slips_of(const options& o);

// scheme.cpp: materials and formulation
std::string own_key(const eos::parameter& key, const std::string& which);  // of a parameter of one material
void declare(namelist::schema& schema, const char* group, const std::string& which, material_options& o);
void declare(namelist::schema& schema, const char* group, scheme_options& o);
eos::any make(const options& o, std::size_t n);
void choose_scheme(const namelist::schema& schema, const char* group, options& o, parameters& p);
void find_elasticity(const options& o, parameters& p);

// materials.cpp: those of &material
void declare(namelist::schema& schema, more_materials& m);
void read_materials(const namelist::schema& schema, problem_kind kind, options& o);
void make_more_materials(const namelist::schema& schema, const options& o, parameters& p);
std::vector<melting::options> melting_by_material(const options& o);
void expect_places(const namelist::schema& schema, const options& o, const parameters& p);

// heat.cpp: heat content, melting
void find_heat(const namelist::schema& schema, problem_kind kind, options& o, parameters& p);
void find_melt(const options& o, parameters& p);

// slowing.cpp: slowed sound and inertia
void declare(namelist::schema& schema, problem_kind kind, slowing_options& o);
void check_slowing(const namelist::schema& schema, problem_kind kind, const options& o);
void tell_slowing(const options& o, parameters& p);

// waves.cpp: layers one over the other
void declare_waves(namelist::schema& schema, const char* group, options& o);
void find_lattices(const namelist::schema& schema, const options& o, parameters& p);
void find_waves(const namelist::schema& schema, options& o, parameters& p);

// bodies.cpp
void resolve_bodies(const namelist::schema& schema, problem_kind kind, const options& o, parameters& p);

// regions.cpp
regions::abilities regions_of(problem_kind kind, const options& o);
void resolve_regions(const namelist::schema& schema, problem_kind kind, const options& o, parameters& p);
void check_settling(const namelist::schema& schema, problem_kind kind, const options& o, const parameters& p);

// drops.cpp
void declare_drops(namelist::schema& schema, const char* group, options& o);
void warn_of_tension(const options& o, parameters& p, double y);
void find_fall(const namelist::schema& schema, options& o, parameters& p);

}  // namespace tetsuame::two_fluids
