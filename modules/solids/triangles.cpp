// Whether triangles bound a solid.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <foundation/error.hpp>
#include <optional>
#include <solids/mesh.hpp>
#include <solids/vectors.hpp>
#include <span>

namespace tetsuame::solids {

namespace {

using foundation::fail_input;

point<3> corner(const triangles& of, std::size_t triangle, std::size_t k) {
  return {of.points[of.corners[triangle][k]]};
}

point<3> middle(const triangles& of, std::size_t t) {
  return (1.0 / 3.0) * (corner(of, t, 0) + corner(of, t, 1) + corner(of, t, 2));
}

point<3> cross(const point<3>& a, const point<3>& b) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}

void expect_areas(const triangles& of, const std::string& name) {
  for (std::size_t t = 0; t < of.corners.size(); ++t) {
    const auto a = corner(of, t, 1) - corner(of, t, 0), b = corner(of, t, 2) - corner(of, t, 0);
    const double longest = std::max({norm<3>(a), norm<3>(b), norm<3>(b - a)});
    // As high as the rounding of its corners in single precision, of which binary files are.
    if (norm<3>(cross(a, b)) > 1e-7 * longest * longest) continue;
    fail_input(fmt::format("{}: facet {} has no area, at {}", name, of.facet(t), place_text<3>(corner(of, t, 0))));
  }
}

using edge = std::pair<std::uint32_t, std::uint32_t>;

struct side {
  edge of;
  std::size_t triangle;
  bool forward;  // it runs from the point of the lower number to the other
};

std::string edge_text(const triangles& of, const edge& e) {
  return fmt::format("from {} to {}", place_text<3>({of.points[e.first]}), place_text<3>({of.points[e.second]}));
}

// Those of an edge follow one another, in the order of their triangles.
std::vector<side> sides_by_edge(const triangles& of) {
  std::vector<side> all;
  all.reserve(3 * of.corners.size());
  for (std::size_t t = 0; t < of.corners.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = of.corners[t][k], b = of.corners[t][(k + 1) % 3];
      all.push_back({std::minmax(a, b), t, a < b});
    }
  std::ranges::stable_sort(all, {}, &side::of);
  return all;
}

// f(sides) of each edge.
template <class F>
void for_each_edge(const std::vector<side>& all, F&& f) {
  for (std::size_t first = 0, last = 0; first < all.size(); first = last) {
    while (last < all.size() && all[last].of == all[first].of) ++last;
    f(std::span(all).subspan(first, last - first));
  }
}

void expect_two_at_each(const triangles& of, const std::vector<side>& all, const std::string& name) {
  std::size_t open = 0;
  std::optional<edge> first;
  for_each_edge(all, [&](std::span<const side> sides) {
    const edge& e = sides.front().of;
    if (sides.size() > 2)
      fail_input(
          fmt::format("{}: {} triangles meet at the edge {}; expected two", name, sides.size(), edge_text(of, e)));
    if (sides.size() == 2) return;
    ++open;
    if (!first) first = e;
  });
  if (open > 0)
    fail_input(fmt::format("{}: the surface has a hole: {} of its edges belong to one triangle alone, the first {}",
                           name, open, edge_text(of, *first)));
}

// Neighbours agree where the edge between them runs one way in the one and the other way in the other. Of each
// connected part, those in the minority are the flipped ones.
void expect_one_orientation(const triangles& of, const std::vector<side>& all, const std::string& name) {
  std::vector<std::vector<std::pair<std::size_t, bool>>> neighbours(of.corners.size());
  for_each_edge(all, [&](std::span<const side> sides) {
    const bool agree = sides[0].forward != sides[1].forward;
    neighbours[sides[0].triangle].emplace_back(sides[1].triangle, agree);
    neighbours[sides[1].triangle].emplace_back(sides[0].triangle, agree);
  });
  std::vector<int> turn(of.corners.size(), 0);  // 1: as the first of its part, -1: the other way
  std::size_t flipped = 0, first = of.corners.size();
  for (std::size_t seed = 0; seed < of.corners.size(); ++seed) {
    if (turn[seed] != 0) continue;
    std::vector<std::size_t> part{seed};
    turn[seed] = 1;
    std::size_t others = 0;
    for (std::size_t k = 0; k < part.size(); ++k)
      for (const auto& [t, agree] : neighbours[part[k]]) {
        const int wanted = agree ? turn[part[k]] : -turn[part[k]];
        if (turn[t] == -wanted)
          fail_input(fmt::format("{}: the surface has one side only, as a Möbius strip: at facet {}, {}", name,
                                 of.facet(t), place_text<3>(middle(of, t))));
        if (turn[t] != 0) continue;
        turn[t] = wanted;
        others += wanted < 0;
        part.push_back(t);
      }
    const int minority = 2 * others > part.size() ? 1 : -1;
    for (const std::size_t t : part) {
      if (turn[t] != minority) continue;
      ++flipped;
      first = std::min(first, t);
    }
  }
  if (flipped > 0)
    fail_input(
        fmt::format("{}: normals of {} triangles point the other way than those of their neighbours, the first of "
                    "facet {}, about {}",
                    name, flipped, of.facet(first), place_text<3>(middle(of, first))));
}

}  // namespace

void expect_closed(const triangles& of, const std::string& name) {
  if (of.corners.empty()) fail_input(name + ": holds no triangles");
  constexpr double farthest = 1e12;  // beyond which volumes might overflow
  for (const auto& p : of.points)
    for (const double x : p)
      if (!(std::abs(x) <= farthest))
        fail_input(fmt::format("{}: a corner is at {} (expected: at most 1e12)", name, x));
  expect_areas(of, name);
  const auto all = sides_by_edge(of);
  expect_two_at_each(of, all, name);
  expect_one_orientation(of, all, name);
  double volume = 0.0;
  const auto origin = corner(of, 0, 0);
  for (std::size_t t = 0; t < of.corners.size(); ++t)
    volume +=
        foundation::dot(corner(of, t, 0) - origin, cross(corner(of, t, 1) - origin, corner(of, t, 2) - origin)) / 6.0;
  if (!(volume > 0.0))
    fail_input(fmt::format("{}: normals point inwards (the volume inside comes to {:.3g} m3): turn all triangles", name,
                           volume));
}

}  // namespace tetsuame::solids
