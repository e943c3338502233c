// A closed surface of triangles, as an STL file holds it: read, checked, and its signed distance.
//
// Self-intersections and distances are CGAL's, which a program may be built without: then every call that
// needs it is an error that says so. The distance is that to the nearest triangle, from a tree of boxes about
// triangles, and its sign that of a ray through all of them, by exact predicates [CGAL, Polygon Mesh Processing; 3D
// Fast Intersection and Distance Computation].
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace tetsuame::solids {

// Whether this build has CGAL.
bool reads_triangles();

struct triangles {
  std::vector<std::array<double, 3>> points;          // m, each once
  std::vector<std::array<std::uint32_t, 3>> corners;  // of each triangle, counterclockwise seen from outside
  std::vector<std::uint32_t> facets = {};             // which of the file each is, from 1; empty: their order

  std::size_t facet(std::size_t triangle) const { return facets.empty() ? triangle + 1 : facets[triangle]; }
};

// Corners that are nearer to each other than this part of the surface's extent are one point.
inline constexpr double weld_tolerance = 1e-6;

// An STL file's content, ASCII (keywords in any case, several solids) or binary. A facet two of whose corners are one
// point is left out: its neighbours meet there. The normals in it are not read: the order of corners says where outside
// is. `name` is what messages call it. All errors are of status bad_input, with line or facet.
triangles read_stl(const std::string& bytes, const std::string& name);

// Fails unless every edge joins two triangles that agree on which side is outside, no triangle is without an area, and
// the volume inside is positive: the message names the place.
void expect_closed(const triangles& of, const std::string& name);

class mesh {
 public:
  // Of what expect_closed has accepted. Fails where the surface cuts through itself.
  mesh(const triangles& of, const std::string& name);
  ~mesh();
  mesh(const mesh&) = delete;
  mesh& operator=(const mesh&) = delete;

  struct place {
    double distance;               // m, negative inside
    std::array<double, 3> normal;  // its gradient
  };
  // reach: m, beyond which a bound of the distance with the right sign will do, with any normal.
  place at(const std::array<double, 3>& x, double reach = std::numeric_limits<double>::infinity()) const;
  bool inside(const std::array<double, 3>& x) const;
  double size() const { return size_; }  // m, the largest coordinate
  // m, of the smallest box along the axes that holds it.
  const std::array<double, 3>& low() const { return low_; }
  const std::array<double, 3>& high() const { return high_; }

 private:
  struct tree;
  std::unique_ptr<tree> tree_;
  double size_ = 0.0;
  std::array<double, 3> low_{}, high_{};
};

}  // namespace tetsuame::solids
