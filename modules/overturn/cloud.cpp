#include <algorithm>
#include <cmath>
#include <numeric>
#include <overturn/cloud.hpp>
#include <random>

namespace tetsuame::overturn {

double distance(const box_of_drops& box, const std::array<double, 3>& a, const std::array<double, 3>& b) {
  double d2 = 0.0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(box.dimension); ++k) {
    double d = a[k] - b[k];
    if (box.periodic[k]) d = std::remainder(d, box.length[k]);
    d2 += d * d;
  }
  return std::sqrt(d2);
}

std::optional<std::vector<std::array<double, 3>>> drawn_places(const box_of_drops& box, double radius, double gap,
                                                               std::int64_t number, std::int64_t seed) {
  std::mt19937_64 random(static_cast<std::uint64_t>(seed));
  const auto axes = static_cast<std::size_t>(box.dimension);
  for (std::size_t a = 0; a < axes; ++a)
    if (box.length[a] < (box.periodic[a] ? 2.0 * radius + gap : 2.0 * (radius + gap))) return std::nullopt;
  std::vector<std::array<double, 3>> places;
  for (std::int64_t n = 0; n < number; ++n) {
    int draws = 0;
    std::array<double, 3> x{};
    do {
      if (++draws > 20000) return std::nullopt;
      for (std::size_t a = 0; a < axes; ++a) {
        const double margin = box.periodic[a] ? 0.0 : radius + gap;
        // 53 bits, so that it is the same with every library.
        x[a] = margin + (box.length[a] - 2.0 * margin) * static_cast<double>(random() >> 11) * 0x1p-53;
      }
    } while (std::any_of(places.begin(), places.end(),
                         [&](const auto& other) { return distance(box, x, other) < 2.0 * radius + gap; }));
    places.push_back(x);
  }
  return places;
}

std::vector<std::int64_t> connected_sizes(const box_of_drops& box, std::span<const std::array<double, 3>> points,
                                          double reach) {
  // Points by cells at least as wide as the reach; the root of a tree stands for a set.
  std::array<std::int64_t, 3> cells{1, 1, 1};
  const auto axes = static_cast<std::size_t>(box.dimension);
  for (std::size_t a = 0; a < axes; ++a)
    cells[a] = std::max<std::int64_t>(1, static_cast<std::int64_t>(box.length[a] / reach));
  const auto cell_of = [&](const std::array<double, 3>& x) {
    std::array<std::int64_t, 3> c{};
    for (std::size_t a = 0; a < axes; ++a) {
      const double part = x[a] / box.length[a] * static_cast<double>(cells[a]);
      c[a] = std::clamp(static_cast<std::int64_t>(std::floor(part)), std::int64_t{0}, cells[a] - 1);
    }
    return c;
  };
  const auto number_of = [&](const std::array<std::int64_t, 3>& c) {
    return static_cast<std::size_t>(c[0] + cells[0] * (c[1] + cells[1] * c[2]));
  };
  constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::vector<std::size_t> first(static_cast<std::size_t>(cells[0] * cells[1] * cells[2]), none),
      next(points.size(), none), parent(points.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  const std::int64_t deep = box.dimension == 3 ? 1 : 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto home = cell_of(points[i]);
    for (std::int64_t z = -deep; z <= deep; ++z)
      for (std::int64_t y = -1; y <= 1; ++y)
        for (std::int64_t x = -1; x <= 1; ++x) {
          std::array<std::int64_t, 3> c{home[0] + x, home[1] + y, home[2] + z};
          bool inside = true;
          for (std::size_t a = 0; a < 3; ++a) {
            if (box.periodic[a]) c[a] = (c[a] + cells[a]) % cells[a];
            inside = inside && c[a] >= 0 && c[a] < cells[a];
          }
          if (!inside) continue;
          for (std::size_t j = first[number_of(c)]; j != none; j = next[j])
            if (distance(box, points[i], points[j]) <= reach) parent[root(i)] = root(j);
        }
    const std::size_t c = number_of(home);
    next[i] = first[c];
    first[c] = i;
  }
  std::vector<std::int64_t> size(points.size(), 0), sizes;
  for (std::size_t i = 0; i < points.size(); ++i) ++size[root(i)];
  std::copy_if(size.begin(), size.end(), std::back_inserter(sizes), [](std::int64_t n) { return n > 0; });
  std::sort(sizes.rbegin(), sizes.rend());
  return sizes;
}

}  // namespace tetsuame::overturn
