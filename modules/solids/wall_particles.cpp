#include <fmt/format.h>

#include <cmath>
#include <foundation/error.hpp>
#include <solids/extents.hpp>
#include <solids/fit.hpp>
#include <solids/wall_particles.hpp>

namespace tetsuame::solids {

namespace {

using foundation::fail_input;

// f(number, place) for every place of the lattice in the box.
template <int D, class F>
void for_each_place(const lattice<D>& box, F&& f) {
  std::array<std::int64_t, D> cells;
  std::int64_t places = 1;
  for (std::size_t k = 0; k < D; ++k) {
    cells[k] = std::llround(box.length[k] / box.spacing);
    places *= cells[k];
  }
  for (std::int64_t n = 0; n < places; ++n) {
    std::int64_t rest = n;
    point<D> x;
    for (std::size_t k = 0; k < D; ++k) {
      x[k] = (static_cast<double>(rest % cells[k]) + 0.5) * box.spacing;
      rest /= cells[k];
    }
    f(n, x);
  }
}

// Whose surface a place lies on, or is the nearest to.
template <int D>
std::size_t nearest_surface(const std::vector<body<D>>& bodies, const point<D>& x) {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (const double away = std::abs(bodies[b].level(x)); away < least) {
      least = away;
      nearest = b;
    }
  return nearest;
}

// m, from a place of the surface along a direction, to where what is there ends, fluid (sign +1) or solid (−1); at most
// `reach`. As far as the level says that nothing ends, step by step [J. C. Hart, Visual Comput. 12, 527 (1996)].
template <int D>
double way(const body<D>& all, const point<D>& from, const point<D>& along, double sign, double reach) {
  const double least = 1e-3 * reach;
  double t = least;
  while (t < reach) {
    const double free = sign * all.level(from + t * along);
    if (free < 0.0) return t;
    t += std::max(free, least);
  }
  return reach;
}

}  // namespace

template <int D>
std::optional<marked<D>> mark(const body<D>& all, const point<D>& x, double depth) {
  if (!all.solid(x)) return {};
  const auto surface = all.at(x, depth);
  if (!surface.found) return {};
  const double below = -surface.distance;
  marked<D> m{surface.nearest + below * surface.normal, surface.normal, surface.nearest, below, below};
  if (!all.solid(m.marker)) return m;
  // At the corner itself the way along ∇φ may begin in the other wall.
  const bool free = !all.solid(surface.nearest + (1e-3 * below) * surface.normal);
  const auto along = free ? surface.normal : all.into_fluid(surface.nearest);
  m.height = 0.5 * way(all, surface.nearest, along, 1.0, below);
  m.marker = surface.nearest + m.height * along;
  return m;
}

template <int D>
wall_particles<D> fill_with_wall_particles(const std::vector<body<D>>& bodies, const lattice<D>& box, double depth,
                                           const part_of_space<D>& markers, bool fitted) {
  wall_particles<D> w;
  const auto all = joined(bodies);
  fit<D> fit_to(all, box.spacing);
  // A marker is no higher above the surface than its particle is below; to fit, that moves by less than a spacing.
  const double reach = 2.1 * depth + (fitted ? box.spacing : 0.0);
  const auto may_be_wanted = [&](const point<D>& x) {
    bool near = true;
    for (std::size_t a = 0; a < D; ++a) {
      const auto holds = [&](double at) { return at >= markers.lower[a] - reach && at < markers.upper[a] + reach; };
      near = near && (holds(x[a]) || (box.periodic[a] && (holds(x[a] - box.length[a]) || holds(x[a] + box.length[a]))));
    }
    return near;
  };
  for_each_place(box, [&](std::int64_t n, const point<D>& on_lattice) {
    if (!may_be_wanted(on_lattice)) return;
    const auto x = fitted ? fit_to.place(on_lattice, depth) : on_lattice;
    const auto m = mark(all, x, depth);
    if (!m) return;
    const auto shift = shift_into<D>(m->marker, box.length, box.periodic);
    if (!markers.holds(m->marker + shift)) return;
    if (m->height < m->depth) ++w.shortened;
    w.x.push_back(x + shift);
    w.marker.push_back(m->marker + shift);
    w.normal.push_back(m->normal);
    w.depth.push_back(m->depth);
    w.height.push_back(m->height);
    w.body.push_back(static_cast<std::uint32_t>(nearest_surface(bodies, m->nearest)));
    w.place.push_back(n);
  });
  return w;
}

namespace {

// As many as make one of a body and its images.
template <int D>
std::size_t pieces_without_images(const body<D>& of) {
  const auto& all = of.pieces();
  std::size_t n = 1;
  while (n < all.size() && all[n].how != operation::begin) ++n;
  return n;
}

}  // namespace

template <int D>
void expect_in_box(const std::vector<body<D>>& bodies, const lattice<D>& box) {
  std::vector<std::vector<bool>> seen;
  for (const auto& b : bodies) seen.emplace_back(pieces_without_images(b), false);
  std::vector<bool> body_seen(bodies.size(), false);
  bool fluid = false;
  for_each_place(box, [&](std::int64_t, const point<D>& x) {
    bool solid = false;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const bool here = bodies[b].solid(x);
      body_seen[b] = body_seen[b] || here;
      solid = solid || here;
      for (std::size_t p = 0; p < bodies[b].pieces().size(); ++p)
        if (const std::size_t k = p % seen[b].size(); !seen[b][k])
          seen[b][k] = solids::solid<D>(bodies[b].pieces()[p], x);
    }
    fluid = fluid || !solid;
  });
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    for (std::size_t p = 0; p < seen[b].size(); ++p)
      if (!seen[b][p])
        fail_input(
            fmt::format("piece {} of body '{}' lies outside the box, or is smaller than the spacing of the particles{}",
                        p + 1, bodies[b].name(), extents_text<D>({bodies[b]}, box.length)));
    if (!body_seen[b]) fail_input(fmt::format("body '{}' has no solid in the box", bodies[b].name()));
  }
  if (!bodies.empty() && !fluid) fail_input("solids fill the whole box" + extents_text(bodies, box.length));
}

template <int D>
void expect_thick(const std::vector<body<D>>& bodies, const lattice<D>& box, double reach) {
  constexpr double opposite = -0.866;  // cosine of 150°
  constexpr double rounding = 1.0e-6;  // of lengths in STL files, which have single precision
  const auto all = joined(bodies);
  const auto name = [&](const point<D>& x) { return "body '" + bodies[nearest_surface(bodies, x)].name() + "'"; };
  for_each_place(box, [&](std::int64_t, const point<D>& x) {
    const auto s = all.at(x, box.spacing);
    if (!s.found) return;
    for (const double sign : {1.0, -1.0}) {
      const auto along = sign * s.normal;
      const double length = way(all, s.nearest, along, sign, reach);
      if (length >= reach * (1.0 - rounding)) continue;
      const auto end = s.nearest + length * along;
      const auto facing = all.at(end, 2.0 * reach);
      if (!facing.found || foundation::dot(facing.normal, s.normal) > opposite) continue;
      const auto at = place_text<D>(s.nearest);
      if (sign > 0.0)
        fail_input(
            fmt::format("the gap between {} and {} at {} is {:.3g} m wide; the kernel reaches {:.3g} m: use more "
                        "particles, or close the gap",
                        name(s.nearest), name(facing.nearest), at, length, reach));
      fail_input(
          fmt::format("{} is {:.3g} m thick at {}; the kernel reaches {:.3g} m: use more particles, or a thicker wall",
                      name(s.nearest), length, at, reach));
    }
  });
}

template <int D>
void expect_dry(const std::vector<body<D>>& bodies, const std::vector<point<D>>& particles) {
  const auto all = joined(bodies);
  std::size_t wet = 0, first = 0;
  for (std::size_t i = 0; i < particles.size(); ++i)
    if (all.solid(particles[i]) && wet++ == 0) first = i;
  if (wet == 0) return;
  const auto surface = all.at(particles[first]);
  fail_input(fmt::format("{} particles of the fluid start inside a wall, the first at {}, {:.3g} m deep in body '{}'",
                         wet, place_text<D>(particles[first]), -surface.distance,
                         bodies[nearest_surface(bodies, surface.nearest)].name()));
}

template std::optional<marked<2>> mark<2>(const body<2>&, const point<2>&, double);
template wall_particles<2> fill_with_wall_particles<2>(const std::vector<body<2>>&, const lattice<2>&, double,
                                                       const part_of_space<2>&, bool);
template void expect_in_box<2>(const std::vector<body<2>>&, const lattice<2>&);
template void expect_thick<2>(const std::vector<body<2>>&, const lattice<2>&, double);
template void expect_dry<2>(const std::vector<body<2>>&, const std::vector<point<2>>&);
template std::optional<marked<3>> mark<3>(const body<3>&, const point<3>&, double);
template wall_particles<3> fill_with_wall_particles<3>(const std::vector<body<3>>&, const lattice<3>&, double,
                                                       const part_of_space<3>&, bool);
template void expect_in_box<3>(const std::vector<body<3>>&, const lattice<3>&);
template void expect_thick<3>(const std::vector<body<3>>&, const lattice<3>&, double);
template void expect_dry<3>(const std::vector<body<3>>&, const std::vector<point<3>>&);

}  // namespace tetsuame::solids
