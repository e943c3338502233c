#include <algorithm>
#include <cmath>
#include <limits>
#include <solids/triangle_grid.hpp>

namespace tetsuame::solids {

triangle_grid::triangle_grid(const triangles& of, const std::function<bool(const place&)>& inside) {
  low_.fill(std::numeric_limits<double>::infinity());
  high_.fill(-std::numeric_limits<double>::infinity());
  for (const auto& p : of.points)
    for (std::size_t a = 0; a < 3; ++a) low_[a] = std::min(low_[a], p[a]), high_[a] = std::max(high_[a], p[a]);
  double extent = 0.0;
  for (std::size_t a = 0; a < 3; ++a) extent = std::max(extent, high_[a] - low_[a]);
  const double of_triangles = 2.0 * std::sqrt(static_cast<double>(of.corners.size()));
  const std::int64_t along =
      fewest + static_cast<std::int64_t>(std::min(of_triangles, static_cast<double>(most - fewest)));
  size_ = extent / static_cast<double>(along);
  if (!(size_ > 0.0)) return;
  for (std::size_t a = 0; a < 3; ++a)
    cells_[a] = std::clamp<std::int64_t>(static_cast<std::int64_t>(std::ceil((high_[a] - low_[a]) / size_)), 1, most);
  mark(of);
  measure();
  find_sides(inside);
}

triangle_grid::place triangle_grid::centre_of(std::size_t number) const {
  place x;
  auto rest = static_cast<std::int64_t>(number);
  for (std::size_t a = 0; a < 3; ++a) {
    x[a] = low_[a] + (static_cast<double>(rest % cells_[a]) + 0.5) * size_;
    rest /= cells_[a];
  }
  return x;
}

// Cells that the boxes about triangles touch are 0 apart, to within the rounding of places.
void triangle_grid::mark(const triangles& of) {
  constexpr double rounding = 1e-6;  // of a cell
  apart_.assign(static_cast<std::size_t>(cells_[0] * cells_[1] * cells_[2]),
                std::numeric_limits<std::int32_t>::max() / 2);
  for (const auto& t : of.corners) {
    cell first, last;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto [least, largest] = std::minmax({of.points[t[0]][a], of.points[t[1]][a], of.points[t[2]][a]});
      const auto at = [&](double x, double more) {
        return std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor((x - low_[a]) / size_ + more)), 0,
                                        cells_[a] - 1);
      };
      first[a] = at(least, -rounding);
      last[a] = at(largest, rounding);
    }
    cell c;
    for (c[2] = first[2]; c[2] <= last[2]; ++c[2])
      for (c[1] = first[1]; c[1] <= last[1]; ++c[1])
        for (c[0] = first[0]; c[0] <= last[0]; ++c[0]) apart_[number_of(c)] = 0;
  }
}

// The distance in cells along the axis where it is largest: two sweeps with the neighbours behind and ahead are exact.
void triangle_grid::measure() {
  const auto sweep = [&](int direction) {
    const auto number = static_cast<std::int64_t>(apart_.size());
    for (std::int64_t n = 0; n < number; ++n) {
      const std::int64_t at = direction > 0 ? n : number - 1 - n;
      const cell c{at % cells_[0], at / cells_[0] % cells_[1], at / (cells_[0] * cells_[1])};
      auto& here = apart_[static_cast<std::size_t>(at)];
      for (std::int64_t k = 0; k < 13; ++k) {  // those of the 26 neighbours that come before
        const cell by{k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
        cell other;
        bool there = true;
        for (std::size_t a = 0; a < 3; ++a) {
          other[a] = c[a] + direction * by[a];
          there = there && other[a] >= 0 && other[a] < cells_[a];
        }
        if (there) here = std::min(here, apart_[number_of(other)] + 1);
      }
    }
  };
  sweep(1);
  sweep(-1);
}

// Parts of space that no triangle divides, from cell to cell across faces.
void triangle_grid::find_sides(const std::function<bool(const place&)>& inside) {
  std::vector<bool> seen(apart_.size(), false);
  inside_.assign(apart_.size(), false);
  std::vector<std::size_t> part;
  for (std::size_t seed = 0; seed < apart_.size(); ++seed) {
    if (seen[seed] || apart_[seed] < 2) continue;  // others are not asked for
    const bool side = inside(centre_of(seed));
    part.assign(1, seed);
    seen[seed] = true;
    while (!part.empty()) {
      const auto at = static_cast<std::int64_t>(part.back());
      part.pop_back();
      inside_[static_cast<std::size_t>(at)] = side;
      const cell c{at % cells_[0], at / cells_[0] % cells_[1], at / (cells_[0] * cells_[1])};
      for (std::size_t a = 0; a < 3; ++a)
        for (const int by : {-1, 1}) {
          cell other = c;
          other[a] += by;
          if (other[a] < 0 || other[a] >= cells_[a]) continue;
          const std::size_t n = number_of(other);
          if (seen[n] || apart_[n] == 0) continue;
          seen[n] = true;
          part.push_back(n);
        }
    }
  }
}

triangle_grid::known triangle_grid::at(const place& x) const {
  constexpr double rounding = 1e-6;  // of a cell
  double beyond = 0.0;               // m, outside of all cells
  for (std::size_t a = 0; a < 3; ++a) beyond = std::max({beyond, low_[a] - x[a], x[a] - high_[a]});
  if (beyond > 0.0) return {beyond > rounding * size_ ? beyond : 0.0, false};
  if (apart_.empty()) return {};
  cell c;
  for (std::size_t a = 0; a < 3; ++a)
    c[a] = std::clamp<std::int64_t>(static_cast<std::int64_t>((x[a] - low_[a]) / size_), 0, cells_[a] - 1);
  const std::size_t n = number_of(c);
  const std::int32_t apart = apart_[n];
  if (apart < 2) return {};
  return {(static_cast<double>(apart - 1) - rounding) * size_, inside_[n]};
}

}  // namespace tetsuame::solids
