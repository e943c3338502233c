// Shapes by the surfaces that bound them: the solid is what lies behind all of these. About the origin, with the last
// axis (y in two dimensions, z in three) upwards; in two dimensions a shape of revolution is its section through the
// axis.
#pragma once

#include <solids/surface.hpp>
#include <vector>

namespace tetsuame::solids {

template <int D>
using faces = std::vector<surface<D>>;

// All below the origin.
template <int D>
faces<D> plane();
// m: its lengths; the origin is its centre.
template <int D>
faces<D> box(const point<D>& length);
// A disc in two dimensions.
template <int D>
faces<D> sphere(double radius);
// Upright; the origin is its centre.
template <int D>
faces<D> cylinder(double radius, double height);
// Upright; the origin is the centre of its base.
template <int D>
faces<D> cone(double radius, double height);
// The lower half of a hollow sphere: a hollow of this radius about the origin, in a wall of this thickness.
template <int D>
faces<D> bowl(double radius, double thickness);
// Three dimensions only.
faces<3> triangulated(std::shared_ptr<const mesh> triangles);

// Turned about the origin, and then moved.
template <int D>
faces<D> placed(faces<D> all, const rotation<D>& R, const point<D>& shift);

// Degrees about x, then y, then z; in two dimensions the last alone.
template <int D>
rotation<D> turned_by(const std::array<double, 3>& degrees);

}  // namespace tetsuame::solids
