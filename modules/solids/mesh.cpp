#include <solids/mesh.hpp>

#include <algorithm>
#include <cmath>
#include <foundation/error.hpp>

#if TETSUAME_CGAL

#include <fmt/format.h>

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/STL.h>
#include <CGAL/Polygon_mesh_processing/compute_normal.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>
#include <sstream>

namespace tetsuame::solids {

namespace {

using kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using cgal_point = kernel::Point_3;
using surface_mesh = CGAL::Surface_mesh<cgal_point>;
using primitive = CGAL::AABB_face_graph_triangle_primitive<surface_mesh>;
using box_tree = CGAL::AABB_tree<CGAL::AABB_traits<kernel, primitive>>;
namespace processing = CGAL::Polygon_mesh_processing;

}  // namespace

triangles read_stl(const std::string& bytes, const std::string& name) {
  std::istringstream in(bytes);
  std::vector<cgal_point> points;
  std::vector<std::array<std::uint32_t, 3>> corners;
  if (!CGAL::IO::read_STL(in, points, corners) || corners.empty())
    foundation::fail_input(name + ": no STL file, or a damaged one (broken off, or other than triangles in it)");
  triangles all;
  for (const auto& p : points) all.points.push_back({p.x(), p.y(), p.z()});
  all.corners = std::move(corners);
  return all;
}

struct mesh::tree {
  surface_mesh surface;
  box_tree boxes;
  std::unique_ptr<CGAL::Side_of_triangle_mesh<surface_mesh, kernel>> side;
};

mesh::mesh(const triangles& of, const std::string& name) : tree_(std::make_unique<tree>()) {
  std::vector<cgal_point> points;
  low_ = high_ = of.points.at(0);
  for (const auto& p : of.points) {
    points.emplace_back(p[0], p[1], p[2]);
    for (std::size_t k = 0; k < 3; ++k) {
      low_[k] = std::min(low_[k], p[k]);
      high_[k] = std::max(high_[k], p[k]);
    }
    for (const double x : p) size_ = std::max(size_, std::abs(x));
  }
  auto& surface = tree_->surface;
  if (!processing::is_polygon_soup_a_polygon_mesh(of.corners))
    foundation::fail_input(name + ": parts of the surface touch in a single point");
  processing::polygon_soup_to_polygon_mesh(points, of.corners, surface);
  std::vector<std::pair<surface_mesh::Face_index, surface_mesh::Face_index>> cuts;
  processing::self_intersections(surface, std::back_inserter(cuts));
  if (!cuts.empty()) {
    const auto [a, b] = *std::min_element(cuts.begin(), cuts.end());
    const auto at = surface.point(target(halfedge(a, surface), surface));
    foundation::fail_input(
        fmt::format("{}: the surface cuts through itself, first in triangles {} and {} near ({:.6g}, {:.6g}, {:.6g})",
                    name, a.idx() + 1, b.idx() + 1, at.x(), at.y(), at.z()));
  }
  tree_->boxes.insert(faces(surface).begin(), faces(surface).end(), surface);
  tree_->boxes.build();
  tree_->boxes.accelerate_distance_queries();
  tree_->side = std::make_unique<CGAL::Side_of_triangle_mesh<surface_mesh, kernel>>(tree_->boxes);
}

mesh::place mesh::at(const std::array<double, 3>& x) const {
  const cgal_point p(x[0], x[1], x[2]);
  const auto [nearest, face] = tree_->boxes.closest_point_and_primitive(p);
  const auto offset = p - nearest;
  const double distance = std::sqrt(offset.squared_length());
  const double sign = (*tree_->side)(p) == CGAL::ON_BOUNDED_SIDE ? -1.0 : 1.0;
  if (distance > 1e-12 * size_) {
    const double per = sign / distance;
    return {sign * distance, {per * offset.x(), per * offset.y(), per * offset.z()}};
  }
  // On the surface: the normal of the triangle there, on an edge with that of its neighbour, at a corner with all
  // around.
  const auto& surface = tree_->surface;
  const double here = 1e-20 * size_ * size_;
  auto n = processing::compute_face_normal(face, surface);
  for (const auto h : CGAL::halfedges_around_face(halfedge(face, surface), surface)) {
    const auto &from = surface.point(source(h, surface)), &to = surface.point(target(h, surface));
    if (CGAL::squared_distance(nearest, to) < here) {
      for (const auto around : CGAL::faces_around_target(h, surface))
        n += processing::compute_face_normal(around, surface);
    } else if (CGAL::squared_distance(nearest, kernel::Segment_3(from, to)) < here) {
      n += processing::compute_face_normal(surface.face(opposite(h, surface)), surface);
    }
  }
  const double per = 1.0 / std::sqrt(n.squared_length());
  return {sign * distance, {per * n.x(), per * n.y(), per * n.z()}};
}

#else

namespace tetsuame::solids {

namespace {
[[noreturn]] void fail_without(const std::string& name) {
  foundation::fail_input(name +
                         ": this program is built without CGAL (libcgal-dev), which reads surfaces of triangles");
}
}  // namespace

triangles read_stl(const std::string&, const std::string& name) { fail_without(name); }

struct mesh::tree {};
mesh::mesh(const triangles&, const std::string& name) { fail_without(name); }
mesh::place mesh::at(const std::array<double, 3>&) const { return {}; }

#endif

bool reads_triangles() { return TETSUAME_CGAL; }

mesh::~mesh() = default;

}  // namespace tetsuame::solids
