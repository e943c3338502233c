// A body of any shape, made of pieces that are united with, taken from, or intersected with those before them; and its
// exact signed distance.
//
// The level set of such a body is made of its pieces' by minima and maxima: union min(a, b), difference max(a, −b),
// intersection max(a, b), and a piece is the intersection of what lies behind its faces [A. Ricci, Comput. J. 16, 157
// (1973)]. Its sign is right everywhere, but its value is only a lower bound of the distance: inside of a union, and
// outside of an intersection, the nearest point by it may be no point of the surface at all (the seam of two boxes that
// touch). So the nearest point is looked for where it can be (derived here): it is
//
//   on a face        x − φ_i ∇φ_i
//   on an edge       of two faces: the point nearest to x with φ_i = φ_j = 0
//   at a corner      of three (in two dimensions of two): φ_i = φ_j = φ_k = 0
//
// Of these candidates those count that lie on the body's surface: where the level about them, a little way along and
// against the normals, has both signs. No point of face i is nearer to x than |φ_i|: faces are taken in the order of
// that, until the best candidate is nearer, which most often is the first.
#pragma once

#include <cstdint>
#include <limits>
#include <solids/shape.hpp>

namespace tetsuame::solids {

enum class operation : std::uint8_t {
  unite,
  subtract,
  intersect,
  begin,  // what follows is a whole by itself, united with all before it
};

template <int D>
struct piece {
  operation how = operation::unite;  // with the pieces before it
  faces<D> bounds;
  bool outside = false;  // the solid is what lies outside of it
};

// The point of a surface that is nearest to a place.
template <int D>
struct foot {
  double distance;   // m, signed: positive in the fluid
  point<D> normal;   // ∇φ, of length one
  point<D> nearest;  // m
  bool found;        // else there is none within reach, and the distance is a bound of the same sign
};

template <int D>
class body {
 public:
  body() = default;
  body(std::string name, std::vector<piece<D>> pieces);

  const std::string& name() const { return name_; }
  const std::vector<piece<D>>& pieces() const { return pieces_; }
  double size() const { return size_; }  // m, the largest coordinate or radius of its surfaces

  // m; of the right sign, and nowhere farther from zero than the distance.
  double level(const point<D>& x) const;
  // Whether the level is below zero.
  bool solid(const point<D>& x) const;
  // reach: m, beyond which no surface is looked for.
  foot<D> at(const point<D>& x, double reach = std::numeric_limits<double>::infinity()) const;

  // From a place of the surface, the mean direction in which the fluid is: at a corner that of its middle. Of length
  // one, or zero where there is none.
  point<D> into_fluid(const point<D>& p) const;

 private:
  struct search;
  template <class Distance>
  double combine(Distance&& of_face) const;

  std::string name_;
  std::vector<piece<D>> pieces_;
  faces<D> all_;          // of all pieces, one after the other
  double size_ = 0.0;     // m
  double small_ = 1e-12;  // m: what counts as nothing beside the body's size
};

// All of them as one body at rest, whose surface is where the fluid is: not that between bodies that touch.
template <int D>
body<D> joined(const std::vector<body<D>>& bodies);

// Of a piece alone.
template <int D>
bool solid(const piece<D>& of, const point<D>& x);

}  // namespace tetsuame::solids
