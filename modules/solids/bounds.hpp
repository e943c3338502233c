// How far bodies reach along the axes, and bodies in a box with periodic sides, where each stands again and again.
#pragma once

#include <solids/body.hpp>

namespace tetsuame::solids {

// A box along the axes; infinite where there is no end.
template <int D>
struct bounds {
  point<D> low, high;  // m

  bool empty() const;
  bool ends(std::size_t axis) const { return std::isfinite(low[axis]) && std::isfinite(high[axis]); }
  double length(std::size_t axis) const { return high[axis] - low[axis]; }
  bounds within(const bounds& other) const;  // what both hold
  void widen(const point<D>& x);             // to hold x too
  static bounds none();
  static bounds all();
};

// That hold a body: tightly if it is made of united boxes, spheres and upright cylinders, else perhaps with some room.
template <int D>
bounds<D> bounds_of(const body<D>& of);

// The box [0, length), and along which axes its sides are periodic.
template <int D>
struct period {
  point<D> length;              // m
  std::array<bool, D> along{};  // axes
  double reach = 0.0;           // m, how far beyond a side bodies are looked at
  double slight = 0.0;          // m, what counts as nothing
  bool any() const;
};

// Whether a body goes on across the periodic sides of an axis without an image of it: because it stays away from them,
// or all of its faces that come to them run along the axis.
template <int D>
bool goes_on(const body<D>& of, const period<D>& box, std::size_t axis);
// Whether it does the latter, or is a bar along the axis, at least as long as the box: then it never ends.
template <int D>
bool runs_through(const body<D>& of, const period<D>& box, std::size_t axis);
// Of a body that runs through, so much of it along the axis as is in a box: where it has an end, from there on.
template <int D>
void keep_one_period(bounds<D>& where, const body<D>& of, const period<D>& box, std::size_t axis);

// Why a body cannot stand in such a box; nothing: it can. most: of what needs images and does not run through, at most
// so many lengths of the box; a body of triangles ends before its image begins.
template <int D>
std::string fault_across(const body<D>& of, const period<D>& box, double most);

// With all of its images that come within reach of the box, as one body. It has no fault_across().
template <int D>
body<D> repeated(const body<D>& of, const period<D>& box);

}  // namespace tetsuame::solids
