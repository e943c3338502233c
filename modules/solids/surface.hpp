// A smooth surface with its signed distance: positive in the fluid, negative in the solid, as that of a plane side of
// the box. Every shape is bounded by some of these (shape.hpp), and its edges and corners lie where they meet
// (body.hpp).
//
//   plane      φ = (x − p)·a
//   sphere     φ = |x − p| − r
//   cylinder   φ = q − r             of any length; q: distance from the axis
//   cone       φ = q cos α − s sin α of one nappe, opening along the axis: s is the way along it from the apex p;
//   nearer
//                                    to the apex than to any other point of the surface, φ = |x − p|
//   mesh       triangles (mesh.hpp)
//
// The gradient of each is the unit normal that points into the fluid. The point of the surface that is nearest to x is
// x − φ ∇φ.
#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <solids/mesh.hpp>
#include <solids/vectors.hpp>

namespace tetsuame::solids {

template <int D>
struct at_surface {
  double distance;  // m, signed
  point<D> normal;  // ∇φ
};

template <int D>
struct surface {
  enum class form { plane, sphere, cylinder, cone, mesh };
  form what = form::plane;
  point<D> place = foundation::zero<double, D>();      // m: a point of a plane or an axis, a centre, an apex, an origin
  point<D> axis = unit<D>(D - 1);                      // of a plane: its normal
  double radius = 0.0;                                 // m; of a cone: of its base, for its size alone
  double cosine = 1.0, sine = 0.0;                     // of a cone's half angle α
  bool turned = false;                                 // the fluid is on the other side
  std::shared_ptr<const solids::mesh> triangles = {};  // turned by `orientation` about their origin, which is `place`
  rotation<D> orientation = no_rotation<D>();          // of a mesh

  // reach: m, beyond which a bound of the distance with the right sign will do, with any normal.
  at_surface<D> at(const point<D>& x, double reach = std::numeric_limits<double>::infinity()) const {
    auto a = of_form(x, reach);
    if (!turned) return a;
    return {-a.distance, -1.0 * a.normal};
  }

  // Of the distance's sign alone; what surfaces without triangles have is the distance.
  double side(const point<D>& x) const {
    if constexpr (D == 3)
      if (what == form::mesh) return triangles->inside(turn_back<D>(orientation, x - place).c) == turned ? 1.0 : -1.0;
    return at(x).distance;
  }

 private:
  // A unit vector along a, or one square to the axis where a is zero, on the axis or at a centre.
  point<D> direction(const point<D>& a, double length) const {
    if (length > 0.0) return (1.0 / length) * a;
    std::size_t least = 0;
    for (std::size_t k = 1; k < D; ++k)
      if (std::abs(axis[k]) < std::abs(axis[least])) least = k;
    auto square = unit<D>(least) - axis[least] * axis;
    return (1.0 / norm<D>(square)) * square;
  }

  at_surface<D> of_form(const point<D>& x, [[maybe_unused]] double reach) const {
    if constexpr (D == 3)
      if (what == form::mesh) {
        const auto a = triangles->at(turn_back<D>(orientation, x - place).c, reach);
        return {a.distance, turn<D>(orientation, point<D>{a.normal})};
      }
    const auto r = x - place;
    const double s = foundation::dot(r, axis);
    if (what == form::plane) return {s, axis};
    if (what == form::sphere) {
      const double length = norm<D>(r);
      return {length - radius, direction(r, length)};
    }
    const auto across = r - s * axis;
    const double q = norm<D>(across);
    const auto outward = direction(across, q);
    if (what == form::cylinder) return {q - radius, outward};
    const double apex = norm<D>(r);
    if (apex < 1e-9 * radius) return {apex, -1.0 * axis};  // at the apex itself, the mean of all normals
    if (s * cosine + q * sine < 0.0 && apex > 0.0) return {apex, (1.0 / apex) * r};
    return {q * cosine - s * sine, cosine * outward - sine * axis};
  }
};

}  // namespace tetsuame::solids
