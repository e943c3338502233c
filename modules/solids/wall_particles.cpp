#include <fmt/format.h>

#include <cmath>
#include <foundation/error.hpp>
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

template <int D>
std::size_t nearest_body(const std::vector<body<D>>& bodies, const point<D>& x) {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (const double l = bodies[b].level(x); l < least) {
      least = l;
      nearest = b;
    }
  return nearest;
}

// m, from a place of the surface along a direction, to where what is there ends, fluid (sign +1) or solid (−1); at most
// `reach`. As far as the level says that nothing ends, step by step [J. C. Hart, Visual Comput. 12, 527 (1996)].
template <int D>
double way(const std::vector<body<D>>& bodies, const point<D>& from, const point<D>& along, double sign, double reach) {
  const double least = 1e-3 * reach;
  double t = least;
  while (t < reach) {
    const double free = sign * level(bodies, from + t * along);
    if (free < 0.0) return t;
    t += std::max(free, least);
  }
  return reach;
}

}  // namespace

template <int D>
double level(const std::vector<body<D>>& bodies, const point<D>& x) {
  double all = std::numeric_limits<double>::infinity();
  for (const auto& b : bodies) all = std::min(all, b.level(x));
  return all;
}

template <int D>
wall_particles<D> fill_with_wall_particles(const std::vector<body<D>>& bodies, const lattice<D>& box, double depth,
                                           const std::function<bool(const point<D>&)>& keep) {
  wall_particles<D> all;
  for_each_place(box, [&](std::int64_t n, const point<D>& x) {
    const auto b = nearest_body(bodies, x);
    if (bodies.empty() || !bodies[b].solid(x)) return;
    const auto surface = bodies[b].at(x, depth);
    if (!surface.found) return;
    const double below = -surface.distance;
    // Where the surface lies in another body, there is no fluid.
    if (level(bodies, surface.nearest + (1e-3 * box.spacing) * surface.normal) < 0.0) return;
    double height = below;
    if (level(bodies, surface.nearest + below * surface.normal) < 0.0) {
      height = 0.5 * way(bodies, surface.nearest, surface.normal, 1.0, below);
      ++all.shortened;
    }
    const auto marker = surface.nearest + height * surface.normal;
    if (keep && !keep(marker)) return;
    all.x.push_back(x);
    all.marker.push_back(marker);
    all.normal.push_back(surface.normal);
    all.depth.push_back(below);
    all.height.push_back(height);
    all.body.push_back(static_cast<std::uint32_t>(b));
    all.place.push_back(n);
  });
  return all;
}

template <int D>
void expect_in_box(const std::vector<body<D>>& bodies, const lattice<D>& box) {
  std::vector<std::vector<bool>> seen;
  for (const auto& b : bodies) seen.emplace_back(b.pieces().size(), false);
  std::vector<bool> body_seen(bodies.size(), false);
  bool fluid = false;
  for_each_place(box, [&](std::int64_t, const point<D>& x) {
    bool solid = false;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const bool here = bodies[b].solid(x);
      body_seen[b] = body_seen[b] || here;
      solid = solid || here;
      for (std::size_t p = 0; p < bodies[b].pieces().size(); ++p)
        if (!seen[b][p]) seen[b][p] = level<D>(bodies[b].pieces()[p], x) < 0.0;
    }
    fluid = fluid || !solid;
  });
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    for (std::size_t p = 0; p < seen[b].size(); ++p)
      if (!seen[b][p])
        fail_input(
            fmt::format("piece {} of body '{}' lies outside the box, or is smaller than the spacing of the particles",
                        p + 1, bodies[b].name()));
    if (!body_seen[b]) fail_input(fmt::format("body '{}' has no solid in the box", bodies[b].name()));
  }
  if (!bodies.empty() && !fluid) fail_input("solids fill the whole box");
}

template <int D>
void expect_thick(const std::vector<body<D>>& bodies, const lattice<D>& box, double reach) {
  constexpr double opposite = -0.866;  // cosine of 150°
  for_each_place(box, [&](std::int64_t, const point<D>& x) {
    for (const auto& b : bodies) {
      const auto s = b.at(x, box.spacing);
      if (!s.found) continue;
      // A face that another body covers is no surface of the solids.
      if (level(bodies, s.nearest + (1e-3 * reach) * s.normal) < 0.0) continue;
      for (const double sign : {1.0, -1.0}) {
        const auto along = sign * s.normal;
        const double length = way(bodies, s.nearest, along, sign, reach);
        if (length >= reach) continue;
        const auto end = s.nearest + length * along;
        const auto& other = bodies[nearest_body(bodies, end)];
        const auto facing = other.at(end, 2.0 * reach);
        if (!facing.found || foundation::dot(facing.normal, s.normal) > opposite) continue;
        if (sign > 0.0)
          fail_input(fmt::format(
              "the gap between body '{}' and body '{}' at {} is {:.3g} m wide; the kernel reaches {:.3g} m: "
              "use more particles, or close the gap",
              b.name(), other.name(), place_text<D>(s.nearest), length, reach));
        fail_input(
            fmt::format("body '{}' is {:.3g} m thick at {}; the kernel reaches {:.3g} m: use more particles, or a "
                        "thicker wall",
                        b.name(), length, place_text<D>(s.nearest), reach));
      }
    }
  });
}

template <int D>
void expect_dry(const std::vector<body<D>>& bodies, const std::vector<point<D>>& particles) {
  std::size_t wet = 0, first = 0;
  for (std::size_t i = 0; i < particles.size(); ++i)
    if (level(bodies, particles[i]) < 0.0 && wet++ == 0) first = i;
  if (wet == 0) return;
  const auto& x = particles[first];
  const auto& b = bodies[nearest_body(bodies, x)];
  fail_input(fmt::format("{} particles of the fluid start inside a wall, the first at {}, {:.3g} m deep in body '{}'",
                         wet, place_text<D>(x), -b.at(x).distance, b.name()));
}

#define TETSUAME_INSTANTIATE(D)                                                                                  \
  template double level<D>(const std::vector<body<D>>&, const point<D>&);                                        \
  template wall_particles<D> fill_with_wall_particles<D>(const std::vector<body<D>>&, const lattice<D>&, double, \
                                                         const std::function<bool(const point<D>&)>&);           \
  template void expect_in_box<D>(const std::vector<body<D>>&, const lattice<D>&);                                \
  template void expect_thick<D>(const std::vector<body<D>>&, const lattice<D>&, double);                         \
  template void expect_dry<D>(const std::vector<body<D>>&, const std::vector<point<D>>&);
TETSUAME_INSTANTIATE(2)
TETSUAME_INSTANTIATE(3)
#undef TETSUAME_INSTANTIATE

}  // namespace tetsuame::solids
