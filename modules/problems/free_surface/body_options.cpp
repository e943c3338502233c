#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <free_surface/input.hpp>

namespace tetsuame::free_surface {

namespace {

template <int D>
solids::point<D> in_dimensions(const point& x) {
  return solids::point<D>::of([&](std::size_t a) { return x[a]; });
}

template <int D>
solids::lattice<D> lattice_of(const options& o) {
  return {in_dimensions<D>(o.domain.length), o.domain.dx()};
}

// What lies beyond the sides; an open top and periodic sides have nothing there.
template <int D>
solids::body<D> tank_of(const options& o) {
  constexpr double far = 100.0;  // lengths of the box
  solids::point<D> low, high;
  for (std::size_t a = 0; a < D; ++a) {
    const double length = o.domain.length[a];
    low[a] = o.domain.periodic[a] ? -far * length : 0.0;
    high[a] = o.domain.periodic[a] || (a == 1 && o.open_top()) ? far * length : length;
  }
  solids::piece<D> outside{
      .bounds = solids::placed<D>(solids::box<D>(high - low), solids::no_rotation<D>(), 0.5 * (low + high)),
      .outside = true};
  return {"sides of the box", {outside}};
}

// Centres of the cells of a block's lattice.
template <int D>
std::vector<solids::point<D>> places_of(const options& o, const block& b) {
  const double dx = o.domain.dx();
  std::array<std::int64_t, D> number;
  std::int64_t all = 1;
  for (std::size_t a = 0; a < D; ++a) all *= number[a] = std::llround((b.high[a] - b.low[a]) / dx);
  std::vector<solids::point<D>> places;
  for (std::int64_t n = 0; n < all; ++n) {
    std::int64_t rest = n;
    places.push_back(solids::point<D>::of([&](std::size_t a) {
      const double row = static_cast<double>(rest % number[a]);
      rest /= number[a];
      return b.low[a] + (row + 0.5) * dx;
    }));
  }
  return places;
}

template <int D>
void check_gauges_dry(const namelist::schema& schema, const options& o, const std::vector<solids::body<D>>& bodies) {
  const double slight = 1e-6 * o.domain.dx();
  const auto& at = o.gauges.pressure;
  for (std::size_t n = 0; n < at[0].size(); ++n) {
    const auto x = solids::point<D>::of([&](std::size_t a) { return at[a][n]; });
    for (const auto& b : bodies)
      if (b.level(x) < -slight)
        schema.fail("gauges", "pressure_x",
                    fmt::format("gauge {} at {} lies {:.3g} m deep in body '{}'", n + 1, solids::place_text<D>(x),
                                -b.at(x).distance, b.name()));
  }
}

// A depth can be read where some place between the floor and the top of the box is free.
template <int D>
void check_heights_free(const namelist::schema& schema, const options& o, const std::vector<solids::body<D>>& bodies) {
  const auto& at = o.gauges.height;
  const auto covers = [&](const solids::body<D>& body, const solids::point<D>& x) { return body.level(x) < 0.0; };
  for (std::size_t n = 0; n < at[0].size(); ++n) {
    auto x = solids::point<D>::of([&](std::size_t a) { return a == 1 ? 0.0 : at[a][n]; });
    std::string filled_by;
    bool free = false;
    for (std::int64_t row = 0; row < o.domain.particles[1] && !free; ++row) {
      x[1] = (static_cast<double>(row) + 0.5) * o.domain.dx();
      const auto covering = std::ranges::find_if(bodies, [&](const auto& b) { return covers(b, x); });
      free = covering == bodies.end();
      if (!free) filled_by = covering->name();
    }
    if (free) continue;
    x[1] = 0.0;
    schema.fail("gauges", "height_x",
                fmt::format("gauge {} above {}: body '{}' fills the box there from the floor to the top, so that no "
                            "water has a depth",
                            n + 1, solids::place_text<D>(x), filled_by));
  }
}

// Checks of bodies, and the search for places inside of them, go through the whole lattice on every rank.
template <int D>
void check_lattice(const namelist::schema& schema, const options& o) {
  constexpr double most = 1e8;
  double places = 1.0;
  for (std::size_t a = 0; a < D; ++a) places *= static_cast<double>(o.domain.particles[a]);
  if (places > most)
    schema.fail("domain", "particles_x",
                fmt::format("the lattice has {:.3g} places in the box; with bodies at most {:.0e}", places, most));
}

}  // namespace

template <int D>
void resolve_bodies(const namelist::schema& schema, options& o, parameters& p) {
  auto& all = std::get<D - 2>(p.bodies);
  for (auto& file : o.solids.file) complete_path(schema, "solids", "file", file);
  all = solids::make_bodies<D>(schema, o.solids);
  if (all.empty()) {
    if (o.flow.around_bodies) schema.fail("flow", "around_bodies", "there are no bodies: &solids");
    return;
  }
  if (o.flow.start != "rest") schema.fail("flow", "start", "with bodies water starts at rest");
  check_lattice<D>(schema, o);
  const auto box = lattice_of<D>(o);
  schema.placed("solids", "shape", [&] { solids::expect_in_box<D>(all, box); });
  const double support = run::support_over_dx(o.common.kernel) * o.domain.dx();
  auto with_tank = all;
  with_tank.push_back(tank_of<D>(o));
  schema.placed("solids", "shape", [&] { solids::expect_thick<D>(with_tank, box, support); });
  check_gauges_dry<D>(schema, o, all);
  check_heights_free<D>(schema, o, all);
  if (o.flow.around_bodies) return;
  for (const block& b : p.blocks)
    schema.placed("solids", "shape", [&] { solids::expect_dry<D>(all, places_of<D>(o, b)); });
}
template void resolve_bodies<2>(const namelist::schema&, options&, parameters&);
template void resolve_bodies<3>(const namelist::schema&, options&, parameters&);

template <int D>
solids::body<D> solid_of(const options& o, const parameters& p) {
  if (p.bodies_in<D>().empty()) return {};
  auto all = p.bodies_in<D>();
  all.push_back(tank_of<D>(o));
  return solids::joined(all);
}
template solids::body<2> solid_of<2>(const options&, const parameters&);
template solids::body<3> solid_of<3>(const options&, const parameters&);

}  // namespace tetsuame::free_surface
