// A closed surface of triangles, as an STL file holds it: read, checked, and its signed distance.
//
// Reading, self-intersections and distances are CGAL's, which a program may be built without: then every call that
// needs it is an error that says so. The distance is that to the nearest triangle, from a tree of boxes about
// triangles, and its sign that of a ray through all of them, by exact predicates [CGAL, Polygon Mesh Processing; 3D
// Fast Intersection and Distance Computation].
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tetsuame::solids {

// Whether this build has CGAL.
bool reads_triangles();

struct triangles {
  std::vector<std::array<double, 3>> points;          // m, each once
  std::vector<std::array<std::uint32_t, 3>> corners;  // of each triangle, counterclockwise seen from outside
};

// An STL file's content, ASCII or binary; corners that are equal are one point. The normals in it are not read: the
// order of corners says where outside is. `name` is what messages call it. All errors are of status bad_input.
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
  place at(const std::array<double, 3>& x) const;
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
