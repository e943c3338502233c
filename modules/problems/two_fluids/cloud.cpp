#include <algorithm>
#include <boost/pending/disjoint_sets.hpp>
#include <cmath>
#include <random>
#include <two_fluids/cloud.hpp>

namespace tetsuame::two_fluids {

double distance(const domain::options& box, const std::array<double, 3>& a, const std::array<double, 3>& b) {
  double d2 = 0.0;
  for (std::size_t k = 0; k < box.axes(); ++k) {
    double d = a[k] - b[k];
    if (box.periodic[k]) d = std::remainder(d, box.length[k]);
    d2 += d * d;
  }
  return std::sqrt(d2);
}

namespace {

using place = std::array<double, 3>;  // m

// Points of a box by cells at least as wide as `reach` (m), with no more cells than `most` points need.
class points_by_cell {
 public:
  points_by_cell(const domain::options& box, double reach, std::size_t most) : box_(box) {
    const auto axes = box.axes();
    const double enough = 1.0 + std::pow(static_cast<double>(most), 1.0 / static_cast<double>(box.dimension));
    for (std::size_t a = 0; a < axes; ++a)
      cells_[a] = static_cast<std::int64_t>(std::clamp(box.length[a] / reach, 1.0, enough));
    in_cell_.resize(static_cast<std::size_t>(cells_[0] * cells_[1] * cells_[2]));
  }

  void add(const place& x) {
    in_cell_[number_of(cell_of(x))].push_back(points_.size());
    points_.push_back(x);
  }

  const std::vector<place>& all() const { return points_; }

  // visit(number, distance in m) of every point nearer than the reach, and of some that are farther.
  template <class F>
  void for_each_near(const place& x, const F& visit) const {
    const auto home = cell_of(x);
    const std::int64_t deep = box_.dimension == 3 ? 1 : 0;
    for (std::int64_t k = -deep; k <= deep; ++k)
      for (std::int64_t j = -1; j <= 1; ++j)
        for (std::int64_t i = -1; i <= 1; ++i) {
          std::array<std::int64_t, 3> c{home[0] + i, home[1] + j, home[2] + k};
          bool inside = true;
          for (std::size_t a = 0; a < 3; ++a) {
            if (box_.periodic[a]) c[a] = (c[a] + cells_[a]) % cells_[a];
            inside = inside && c[a] >= 0 && c[a] < cells_[a];
          }
          if (!inside) continue;
          for (const std::size_t n : in_cell_[number_of(c)]) visit(n, distance(box_, x, points_[n]));
        }
  }

 private:
  std::array<std::int64_t, 3> cell_of(const place& x) const {
    std::array<std::int64_t, 3> c{};
    for (std::size_t a = 0; a < box_.axes(); ++a) {
      const double part = x[a] / box_.length[a] * static_cast<double>(cells_[a]);
      c[a] = std::clamp(static_cast<std::int64_t>(std::floor(part)), std::int64_t{0}, cells_[a] - 1);
    }
    return c;
  }
  std::size_t number_of(const std::array<std::int64_t, 3>& c) const {
    return static_cast<std::size_t>(c[0] + cells_[0] * (c[1] + cells_[1] * c[2]));
  }

  const domain::options& box_;
  std::array<std::int64_t, 3> cells_{1, 1, 1};
  std::vector<place> points_;
  std::vector<std::vector<std::size_t>> in_cell_;  // numbers of each cell's points
};

}  // namespace

std::optional<std::vector<std::array<double, 3>>> drawn_places(const domain::options& box, double radius, double gap,
                                                               std::int64_t number, std::int64_t seed) {
  std::mt19937_64 random(static_cast<std::uint64_t>(seed));
  const auto axes = box.axes();
  const double least = 2.0 * radius + gap;
  for (std::size_t a = 0; a < axes; ++a)
    if (box.length[a] < (box.periodic[a] ? least : 2.0 * (radius + gap))) return std::nullopt;
  points_by_cell places(box, least, static_cast<std::size_t>(number));
  // Of one drop, and of all: near the densest that can be drawn hardly any draw is a place.
  constexpr std::int64_t most_draws = 20000, most_of_all = 2'000'000;
  std::int64_t of_all = 0;
  for (std::int64_t n = 0; n < number; ++n) {
    std::int64_t draws = 0;
    std::array<double, 3> x{};
    bool free = false;
    while (!free) {
      if (++draws > most_draws || ++of_all > most_of_all) return std::nullopt;
      for (std::size_t a = 0; a < axes; ++a) {
        const double margin = box.periodic[a] ? 0.0 : radius + gap;
        // 53 bits, so that it is the same with every library.
        x[a] = margin + (box.length[a] - 2.0 * margin) * static_cast<double>(random() >> 11) * 0x1p-53;
      }
      free = true;
      places.for_each_near(x, [&](std::size_t, double away) { free = free && away >= least; });
    }
    places.add(x);
  }
  return places.all();
}

std::vector<std::int64_t> connected_sizes(const domain::options& box, std::span<const std::array<double, 3>> points,
                                          double reach) {
  boost::disjoint_sets_with_storage<> sets(points.size());
  points_by_cell before(box, reach, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    before.for_each_near(points[i], [&](std::size_t j, double away) {
      if (away <= reach) sets.union_set(i, j);
    });
    before.add(points[i]);
  }
  std::vector<std::int64_t> size(points.size(), 0), sizes;
  for (std::size_t i = 0; i < points.size(); ++i) ++size[sets.find_set(i)];
  std::copy_if(size.begin(), size.end(), std::back_inserter(sizes), [](std::int64_t n) { return n > 0; });
  std::sort(sizes.rbegin(), sizes.rend());
  return sizes;
}

}  // namespace tetsuame::two_fluids
