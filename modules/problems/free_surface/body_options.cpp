#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <free_surface/input.hpp>
#include <solids/extents.hpp>

namespace tetsuame::free_surface {

template <int D>
rigid::box<D> box_of(const options& o) {
  return rigid::box_of<D>(o.domain, o.common, o.walls);
}
template rigid::box<2> box_of<2>(const options&);
template rigid::box<3> box_of<3>(const options&);

namespace {

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

// Mass and inertia of the whole body, in the box or not; where it has no end, or runs through periodic sides, of what
// is in the box.
template <int D>
solids::free_body<D> mass_of(const options& o, const solids::body<D>& of, double density) {
  const auto period = rigid::period_of(box_of<D>(o));
  auto where = solids::bounds_of<D>(of);
  for (std::size_t a = 0; a < D; ++a) {
    if (solids::runs_through<D>(of, period, a)) {
      solids::keep_one_period<D>(where, of, period, a);
    } else if (!where.ends(a)) {
      where.low[a] = std::max(where.low[a], 0.0);
      where.high[a] = std::min(where.high[a], o.domain.length[a]);
    }
  }
  return solids::filled<D>(of, density, where, o.domain.dx() / (D == 2 ? 8.0 : 2.0));
}

template <int D>
solids::free_body<D> free_body_of(const options& o, const solids::body<D>& of, const solids::free_options& how) {
  auto b = mass_of<D>(o, of, how.density > 0.0 ? how.density : 1.0);
  if (how.mass > 0.0) {
    for (auto& row : b.inertia) row = (how.mass / b.mass) * row;
    b.mass = how.mass;
  }
  // The spin of a very light body follows the errors of the sums; that of the water that it drags along is not known.
  constexpr double least = 0.01;  // of the liquid's density, as which its spin counts
  const double density = how.density > 0.0 ? how.density : how.mass / mass_of<D>(o, of, 1.0).mass;
  if (const double heavier = least * o.flow.density / density; heavier > 1.0)
    for (auto& row : b.inertia) row = heavier * row;
  for (std::size_t k = 0; k < b.inertia.size(); ++k) {
    const double radius = how.gyration[D == 2 ? 2 : k];  // all of them are given, or none
    if (!(radius > 0.0)) continue;
    b.inertia[k] = foundation::zero < double, D == 2 ? 1 : 3 > ();
    b.inertia[k][k] = b.mass * radius * radius;
  }
  if constexpr (D == 2)
    b.restrained = how.in_plane;
  else
    b.restrained = how.in_space;
  if (how.hinge) b.hinge(solids::point<D>::of([&](std::size_t a) { return (*how.hinge)[a]; }));
  return b;
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

// Half a spacing beyond the sides of the box that are closed, on the lattice.
template <int D>
bool reaches_a_side(const options& o, const solids::body<D>& of) {
  const double dx = o.domain.dx();
  for (std::size_t side = 0; side < 2 * D; ++side) {
    const std::size_t axis = side / 2;
    if (o.domain.periodic[axis] || (side == 3 && o.open_top())) continue;
    block b{};
    for (std::size_t a = 0; a < D; ++a) b.high[a] = o.domain.length[a];
    b.low[axis] = side % 2 == 0 ? -dx : o.domain.length[axis];
    b.high[axis] = b.low[axis] + dx;
    if (std::ranges::any_of(places_of<D>(o, b), [&](const auto& x) { return of.solid(x); })) return true;
  }
  return false;
}

template <int D>
std::vector<motion_of_body<D>> motions_of(const namelist::schema& schema, options& o,
                                          const std::vector<solids::body<D>>& bodies) {
  const auto courses = solids::make_motions<D>(schema, o.motions, bodies);
  std::vector<std::string> names;
  for (const auto& b : bodies) names.push_back(b.name());
  const auto free = solids::make_free(schema, o.motions, D, names);
  std::vector<motion_of_body<D>> all(bodies.size());
  for (std::size_t b = 0; b < all.size(); ++b) {
    all[b].course = courses[b];
    if (free[b])
      all[b].free = schema.placed("motions", "body", [&] { return free_body_of<D>(o, bodies[b], *free[b]); });
  }
  return all;
}

// Of a body that moves, as it begins: wall particles stand wherever it comes into the box.
template <int D>
void check_moving(const namelist::schema& schema, const options& o, const solids::body<D>& of,
                  const motion_of_body<D>& how) {
  const auto where = rigid::ever_in_box<D>(box_of<D>(o), of, how);
  double places = 1.0;
  for (std::size_t a = 0; a < D; ++a) {
    if (!where.ends(a))
      schema.fail("motions", "body",
                  fmt::format("body '{}' has no end: one that moves {} takes one", of.name(),
                              how.free ? "freely" : "so, where the box is periodic,"));
    places *= std::max(0.0, where.length(a)) / o.domain.dx();
  }
  if (places > rigid::most_places)
    schema.fail("motions", "body",
                fmt::format("the lattice has {:.3g} places where body '{}' may come into the box; at most {:.0e}: give "
                            "it a smaller size, or a shorter way",
                            places, of.name(), rigid::most_places));
}

// Of a body at rest that begins here.
template <int D>
images_of_body<D> images_of(const solids::body<D>& at_rest, const solids::body<D>& begun,
                            const solids::period<D>& period) {
  images_of_body<D> images;
  const auto where = solids::bounds_of<D>(at_rest);
  for (std::size_t a = 0; a < D; ++a) {
    images.middle[a] = where.ends(a) ? 0.5 * (where.low[a] + where.high[a]) : 0.5 * period.length[a];
    images.through[a] = solids::runs_through<D>(begun, period, a);
    if (!period.along[a] || images.through[a]) continue;
    images.apart[a] = period.length[a];
    images.any = true;
  }
  return images;
}

// With their images across periodic sides, as they stand when the run begins; and what does not move for good.
template <int D>
std::vector<solids::body<D>> begin_with_images(const namelist::schema& schema, const options& o,
                                               std::vector<solids::body<D>>& all,
                                               std::vector<motion_of_body<D>>& motions) {
  const auto period = rigid::period_of(box_of<D>(o));
  std::vector<solids::body<D>> begun;
  for (std::size_t b = 0; b < all.size(); ++b) {
    const bool moves = motions[b].moves();
    const auto here = motions[b].course.moves() ? solids::placed<D>(all[b], motions[b].course.at(0.0)) : all[b];
    begun.push_back(rigid::with_images<D>(schema, moves ? "motions" : "solids", moves ? "body" : "shape", here, period,
                                          moves ? 1.0 : rigid::longest_at_rest));
    motions[b].images = images_of<D>(all[b], here, period);
    if (!moves) all[b] = begun.back();
  }
  return begun;
}

template <int D>
std::size_t body_named(const namelist::schema& schema, const std::string& key,
                       const std::vector<solids::body<D>>& bodies, const std::string& name) {
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (bodies[b].name() == name) return b;
  schema.fail("gauges", key, "&solids has no body '" + name + "'");
}

// Gauges that read bodies.
template <int D>
void resolve_body_gauges(const namelist::schema& schema, const options& o, parameters& p,
                         const std::vector<solids::body<D>>& bodies) {
  const auto& g = o.gauges;
  bool points = false;
  for (std::size_t a = 0; a < 3; ++a) points = points || !g.moment[a].empty();
  for (std::size_t a = 0; a < 3; ++a)
    if (const std::size_t expected = points && a < D ? g.force.size() : 0; g.moment[a].size() != expected)
      schema.fail("gauges", along("moment_", a),
                  fmt::format("expected {} numbers, one a force, found {}", expected, g.moment[a].size()));
  for (std::size_t n = 0; n < g.force.size(); ++n) {
    force_gauge to{body_named(schema, "force", bodies, g.force[n]), {}, {}};
    if (points) {
      to.about = point{};
      for (std::size_t a = 0; a < D; ++a) (*to.about)[a] = g.moment[a][n];
    }
    const auto centre = schema.placed("gauges", "force", [&] { return mass_of<D>(o, bodies[to.body], 1.0).now.pivot; });
    for (std::size_t a = 0; a < D; ++a) to.centre[a] = centre[a];
    p.force.push_back(to);
  }
  for (const auto& name : g.motion) p.motion.push_back(body_named(schema, "motion", bodies, name));
}

}  // namespace

template <int D>
void resolve_bodies(const namelist::schema& schema, options& o, parameters& p) {
  auto& all = std::get<D - 2>(p.bodies);
  all = solids::make_bodies<D>(schema, o.solids);
  schema.placed("solids", "shape", [&] { solids::expect_sizes<D>(all, box_of<D>(o).lattice.length); });
  auto& motions = std::get<D - 2>(p.motions);
  motions = motions_of<D>(schema, o, all);
  if (all.empty()) {
    resolve_body_gauges<D>(schema, o, p, all);
    if (o.flow.around_bodies) schema.fail("flow", "around_bodies", "there are no bodies: &solids");
    return;
  }
  if (o.flow.start != "rest") schema.fail("flow", "start", "with bodies water starts at rest");
  const auto box = box_of<D>(o);
  rigid::expect_countable(schema, box);
  resolve_body_gauges<D>(schema, o, p, all);
  const auto begun = begin_with_images<D>(schema, o, all, motions);
  for (std::size_t b = 0; b < all.size(); ++b)
    if (motions[b].free && reaches_a_side<D>(o, begun[b]))
      schema.fail("motions", "body", "body '" + all[b].name() + "' begins in a side of the box; a free one may not");
  rigid::expect_sound(schema, begun, box);
  for (std::size_t b = 0; b < all.size(); ++b)
    if (motions[b].moves()) check_moving<D>(schema, o, all[b], motions[b]);
  check_gauges_dry<D>(schema, o, begun);
  check_heights_free<D>(schema, o, begun);
  if (o.flow.around_bodies) return;
  for (const block& b : p.blocks)
    schema.placed("solids", "shape", [&] { solids::expect_dry<D>(begun, places_of<D>(o, b)); });
}
template void resolve_bodies<2>(const namelist::schema&, options&, parameters&);
template void resolve_bodies<3>(const namelist::schema&, options&, parameters&);

}  // namespace tetsuame::free_surface
