// Cells about a surface of triangles, by which most places are known to be inside or outside, and far from it, without
// a search among the triangles.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <solids/mesh.hpp>
#include <vector>

namespace tetsuame::solids {

class triangle_grid {
 public:
  using place = std::array<double, 3>;  // m

  triangle_grid() = default;
  // inside(x): by the triangles; it is asked once for each part of space without triangles in it.
  triangle_grid(const triangles& of, const std::function<bool(const place&)>& inside);

  // What is known of a place: how far it is from the surface at least (m), and on which side, where that is above 0.
  struct known {
    double distance = 0.0;
    bool inside = false;
  };
  known at(const place& x) const;

 private:
  // Cells along the longest axis: as fine as the triangles of a surface of equal ones, and never finer than 96.
  static constexpr std::int64_t fewest = 16, most = 96;
  using cell = std::array<std::int64_t, 3>;

  std::size_t number_of(const cell& c) const {
    return static_cast<std::size_t>((c[2] * cells_[1] + c[1]) * cells_[0] + c[0]);
  }
  place centre_of(std::size_t number) const;
  void mark(const triangles& of);
  void measure();
  void find_sides(const std::function<bool(const place&)>& inside);

  place low_{}, high_{};
  double size_ = 0.0;                // m, of a cell
  cell cells_{};                     // along each axis; 0: there are none
  std::vector<std::int32_t> apart_;  // cells to the next one with a triangle, along the axis where it is farthest
  std::vector<bool> inside_;         // of cells without triangles
};

}  // namespace tetsuame::solids
