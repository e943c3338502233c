#include <fmt/format.h>

#include <algorithm>
#include <rigid/box.hpp>
#include <solids/extents.hpp>

namespace tetsuame::rigid {

template <int D>
box<D> box_of(const domain::options& of, const run::common_options& common, const walls::options& sides) {
  const double dx = of.dx();
  box<D> all{{solids::point<D>::of([&](std::size_t a) { return of.length[a]; }), dx}};
  std::copy_n(of.periodic.begin(), D, all.lattice.periodic.begin());
  all.open_top = sides.sides[3].slip == "free_surface";
  all.support = run::support_over_dx(common.kernel) * dx;
  all.skin = common.kernel.skin * dx;
  all.gauges = common.gauges;
  return all;
}

template <int D>
solids::period<D> period_of(const box<D>& of) {
  return {of.lattice.length, of.lattice.periodic, of.support + of.skin, 1e-3 * of.lattice.spacing};
}

template <int D>
solids::body<D> tank_of(const box<D>& of) {
  constexpr double far = 100.0;  // lengths of the box
  solids::point<D> low, high;
  for (std::size_t a = 0; a < D; ++a) {
    const double length = of.lattice.length[a];
    low[a] = of.lattice.periodic[a] ? -far * length : 0.0;
    high[a] = of.lattice.periodic[a] || of.is_open(a) ? far * length : length;
  }
  solids::piece<D> outside{
      .bounds = solids::placed<D>(solids::box<D>(high - low), solids::no_rotation<D>(), 0.5 * (low + high)),
      .outside = true};
  return {"sides of the box", {outside}};
}

template <int D>
solids::body<D> solid_of(const box<D>& of, std::vector<solids::body<D>> bodies) {
  bodies.push_back(tank_of(of));
  return solids::joined(bodies);
}

template <int D>
void expect_countable(const namelist::schema& schema, const box<D>& of) {
  double places = 1.0;
  for (std::size_t a = 0; a < D; ++a) places *= std::round(of.lattice.length[a] / of.lattice.spacing);
  if (places > most_places)
    schema.fail(
        "domain", "particles_x",
        fmt::format("the lattice has {:.3g} places in the box; with bodies at most {:.0e}", places, most_places));
}

template <int D>
solids::body<D> with_images(const namelist::schema& schema, const char* group, const char* key,
                            const solids::body<D>& of, const solids::period<D>& period, double most) {
  if (const auto fault = solids::fault_across<D>(of, period, most); !fault.empty()) schema.fail(group, key, fault);
  return solids::repeated<D>(of, period);
}

template <int D>
void expect_sound(const namelist::schema& schema, const std::vector<solids::body<D>>& bodies, const box<D>& of) {
  schema.placed("solids", "shape", [&] { solids::expect_in_box<D>(bodies, of.lattice); });
  auto with_tank = bodies;
  with_tank.push_back(tank_of(of));
  schema.placed("solids", "shape", [&] { solids::expect_thick<D>(with_tank, of.lattice, of.support); });
  gauges::refuse_points(schema, of.gauges, [&](const std::array<double, 3>& place) -> std::string {
    solids::point<D> x;
    std::copy_n(place.begin(), D, x.c.begin());
    for (const auto& body : bodies)
      if (body.level(x) < -1e-9 * of.lattice.spacing) return fmt::format("is inside of body '{}'", body.name());
    return "";
  });
}

template <int D>
std::vector<solids::body<D>> bodies_at_rest(const namelist::schema& schema, const solids::options& o,
                                            const box<D>& of) {
  auto all = solids::make_bodies<D>(schema, o);
  if (all.empty()) return all;
  schema.placed("solids", "shape", [&] { solids::expect_sizes<D>(all, of.lattice.length); });
  expect_countable(schema, of);
  for (auto& b : all) b = with_images(schema, "solids", "shape", b, period_of(of), longest_at_rest);
  expect_sound(schema, all, of);
  return all;
}

#define TETSUAME_BOX_OF_BODIES(D)                                                                                    \
  template box<D> box_of<D>(const domain::options&, const run::common_options&, const walls::options&);              \
  template solids::period<D> period_of<D>(const box<D>&);                                                            \
  template solids::body<D> tank_of<D>(const box<D>&);                                                                \
  template solids::body<D> solid_of<D>(const box<D>&, std::vector<solids::body<D>>);                                 \
  template void expect_countable<D>(const namelist::schema&, const box<D>&);                                         \
  template solids::body<D> with_images<D>(const namelist::schema&, const char*, const char*, const solids::body<D>&, \
                                          const solids::period<D>&, double);                                         \
  template void expect_sound<D>(const namelist::schema&, const std::vector<solids::body<D>>&, const box<D>&);        \
  template std::vector<solids::body<D>> bodies_at_rest<D>(const namelist::schema&, const solids::options&,           \
                                                          const box<D>&)
TETSUAME_BOX_OF_BODIES(2);
TETSUAME_BOX_OF_BODIES(3);
#undef TETSUAME_BOX_OF_BODIES

}  // namespace tetsuame::rigid
