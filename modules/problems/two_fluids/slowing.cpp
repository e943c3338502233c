#include <fmt/format.h>

#include <cmath>
#include <two_fluids/groups.hpp>

namespace tetsuame::two_fluids {

void declare(namelist::schema& schema, problem_kind kind, slowing_options& o) {
  const char* group = group_of(kind);
  schema.add(group, "zeta", o.zeta,
             for_expert(between(1.0, 1e6,
                                "sound is slowed by it: what the pressure departs from that of the column at rest by "
                                "is divided by its square (plan relaxation recommends one)")));
  schema.add(group, "xi", o.xi, for_expert(between(1.0, 1e12, "inertia is multiplied by its square")));
  for (const std::size_t n : {1, 0})
    schema.add(group, std::string("xi_") + names_of(kind)[n], o.xi_of[n],
               for_expert(between(1.0, 1e12, "of this material; not given: xi")));
}

void check_slowing(const namelist::schema& schema, problem_kind kind, const options& o) {
  if (!(o.slowing.zeta > 1.0)) return;
  const char* group = group_of(kind);
  if (o.integrates_weight)
    schema.fail(group, "zeta", "the equation of Y holds for pressures of the equation of state: run another program");
  if (o.material.size() > 2)
    schema.fail(group, "zeta",
                "slowed sound is that about a column of the two materials of the problem: with &material, 1");
  if (kind == problem_kind::drop && o.drops > 1)
    schema.fail(group, "zeta", "the column at rest has one material: slowed sound is for one drop");
  if (kind == problem_kind::rayleigh_taylor && o.scheme.rows == "balanced")
    schema.fail(group, "zeta", "rows = 'balanced' is derived for sound as it is: choose 'lattice'");
}

volume::options liquid_options(const options& o) {
  volume::options all = o.liquid;
  all.consistency.rate /= o.slowing.of_sound();
  return all;
}

// What linear theory says of the growth of such a run, where there is a wave: beside the physical one.
void tell_slowing(const options& o, parameters& p) {
  if (!o.slowing.any() || !p.growth || !p.growth_slowed) return;
  const double error = *p.growth_slowed / *p.growth - 1.0;
  p.lines.push_back(
      fmt::format("{}: with zeta = {:.4g}, xi = {:.4g} (lower), {:.4g} (upper) the growth rate is off by "
                  "{:+.2g} %",
                  std::abs(error) > 0.01 ? "warning" : "slowed", o.slowing.zeta, o.slowing.xi_n(0), o.slowing.xi_n(1),
                  100.0 * error));
}

}  // namespace tetsuame::two_fluids
