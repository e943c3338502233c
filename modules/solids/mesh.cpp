#include <solids/mesh.hpp>

#include <algorithm>
#include <cmath>
#include <foundation/error.hpp>
#include <solids/triangle_grid.hpp>

#if TETSUAME_CGAL

#include <fmt/format.h>

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/compute_normal.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>

namespace tetsuame::solids {

namespace {

using kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using cgal_point = kernel::Point_3;
using surface_mesh = CGAL::Surface_mesh<cgal_point>;
using primitive = CGAL::AABB_face_graph_triangle_primitive<surface_mesh>;
using box_tree = CGAL::AABB_tree<CGAL::AABB_traits<kernel, primitive>>;
namespace processing = CGAL::Polygon_mesh_processing;
// Distances are good to rounding. Exact predicates would take a thousand times as long where two triangles are as near,
// as they are at every second place of a surface that has a symmetry.
using plain = CGAL::Simple_cartesian<double>;
using plain_triangles = std::vector<plain::Triangle_3>;
using distance_tree =
    CGAL::AABB_tree<CGAL::AABB_traits<plain, CGAL::AABB_triangle_primitive<plain, plain_triangles::const_iterator>>>;

}  // namespace

struct mesh::tree {
  surface_mesh surface;
  box_tree boxes;
  plain_triangles triangles;  // in the order of the faces
  distance_tree distances;
  std::unique_ptr<CGAL::Side_of_triangle_mesh<surface_mesh, kernel>> side;
  triangle_grid grid;

  bool inside(const cgal_point& p) const { return (*side)(p) == CGAL::ON_BOUNDED_SIDE; }
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
        fmt::format("{}: the surface cuts through itself, first in facets {} and {} near ({:.6g}, {:.6g}, {:.6g})",
                    name, of.facet(a.idx()), of.facet(b.idx()), at.x(), at.y(), at.z()));
  }
  tree_->boxes.insert(faces(surface).begin(), faces(surface).end(), surface);
  tree_->boxes.build();
  const auto corner = [&](std::uint32_t n) {
    return plain::Point_3(of.points[n][0], of.points[n][1], of.points[n][2]);
  };
  for (const auto& t : of.corners) tree_->triangles.emplace_back(corner(t[0]), corner(t[1]), corner(t[2]));
  tree_->distances.insert(tree_->triangles.cbegin(), tree_->triangles.cend());
  tree_->distances.build();
  tree_->distances.accelerate_distance_queries();
  tree_->side = std::make_unique<CGAL::Side_of_triangle_mesh<surface_mesh, kernel>>(tree_->boxes);
  tree_->grid = triangle_grid(of, [&](const auto& x) { return tree_->inside({x[0], x[1], x[2]}); });
}

bool mesh::inside(const std::array<double, 3>& x) const {
  const auto known = tree_->grid.at(x);
  return known.distance > 0.0 ? known.inside : tree_->inside({x[0], x[1], x[2]});
}

mesh::place mesh::at(const std::array<double, 3>& x, double reach) const {
  const auto known = tree_->grid.at(x);
  if (known.distance > reach) return {known.inside ? -known.distance : known.distance, {0.0, 0.0, 1.0}};
  const plain::Point_3 p(x[0], x[1], x[2]);
  const auto [on_surface, triangle] = tree_->distances.closest_point_and_primitive(p);
  const auto offset = p - on_surface;
  const double distance = std::sqrt(offset.squared_length());
  const double sign = inside(x) ? -1.0 : 1.0;
  if (distance > 1e-12 * size_) {
    const double per = sign / distance;
    return {sign * distance, {per * offset.x(), per * offset.y(), per * offset.z()}};
  }
  // On the surface: the normal of the triangle there, on an edge with that of its neighbour, at a corner with all
  // around.
  const auto& surface = tree_->surface;
  const surface_mesh::Face_index face(static_cast<surface_mesh::size_type>(triangle - tree_->triangles.cbegin()));
  const cgal_point nearest(on_surface.x(), on_surface.y(), on_surface.z());
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

struct mesh::tree {};
mesh::mesh(const triangles&, const std::string& name) { fail_without(name); }
mesh::place mesh::at(const std::array<double, 3>&, double) const { return {}; }
bool mesh::inside(const std::array<double, 3>&) const { return false; }

#endif

bool reads_triangles() { return TETSUAME_CGAL; }

mesh::~mesh() = default;

}  // namespace tetsuame::solids
