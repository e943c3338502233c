// How bodies of the input move: their courses, their images across periodic sides, and where in the box they ever come.
#pragma once

#include <optional>
#include <rigid/box.hpp>
#include <solids/motion.hpp>

namespace tetsuame::rigid {

// Of a body its images across periodic sides. Which of them a place belongs to, the middle between two of them says.
template <int D>
struct images_of_body {
  bool any = false;
  solids::point<D> middle = foundation::zero<double, D>();  // m, of the body's bounds at rest
  solids::point<D> apart = foundation::zero<double, D>();   // m; 0: along this axis there are none
  std::array<bool, D> through{};                            // axes along which it runs through the sides without
};

// Of a body of the input: as prescribed, or free.
template <int D>
struct motion_of_body {
  images_of_body<D> images;
  solids::prescribed<D> course;
  std::optional<solids::free_body<D>> free;
  bool moves() const { return course.moves() || free.has_value(); }
};

// Where, while a body is at rest, what of it stands that ever comes into the box: all of a free one, of one that runs
// through periodic sides a piece as long as the box. Infinite where it has no end and is free.
template <int D>
solids::bounds<D> ever_in_box(const box<D>& in, const solids::body<D>& of, const motion_of_body<D>& how);

}  // namespace tetsuame::rigid
