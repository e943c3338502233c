#include <planet/fragments.hpp>

#include <algorithm>
#include <bit>
#include <cells/grid.hpp>
#include <cmath>
#include <gas/setup_parts.hpp>
#include <numeric>
#include <planet/sums.hpp>
#include <vector>

namespace tetsuame::planet {

namespace {

// Particles of all ranks, by ID.
struct collected {
  struct one {
    std::int64_t id;
    gas::point x;          // m
    double mass, spacing;  // kg, m
  };
  std::vector<one> all;

  template <class Which>
  collected(const gas::view& w, const Which& which) {
    constexpr std::size_t row = 6;
    std::vector<double> mine;
    for (std::size_t i = 0; i < w.n; ++i) {
      if (!which(i)) continue;
      const gas::point x = w.place(i);
      mine.insert(mine.end(), {static_cast<double>(w.id[i]), x[0], x[1], x[2], w.m[i], std::cbrt(w.m[i] / w.rho[i])});
    }
    const auto most = static_cast<std::size_t>(w.ranks.maximum(static_cast<double>(mine.size())));
    mine.resize(most, -1.0);  // no ID
    const auto every = w.ranks.every(std::span<const double>(mine));
    for (std::size_t at = 0; at + row <= every.size(); at += row) {
      const double* r = every.data() + at;
      if (r[0] >= 0.0) all.push_back({static_cast<std::int64_t>(r[0]), {r[1], r[2], r[3]}, r[4], r[5]});
    }
    std::ranges::sort(all, {}, &one::id);
    double mean = 0.0;
    for (const auto& p : all) mean += p.spacing / static_cast<double>(all.size());
    for (auto& p : all) p.spacing = std::min(p.spacing, 2.0 * mean);
  }
};

constexpr double friends = 1.5;  // spacings

cells::grid<3> grid_of(const std::vector<gas::point>& places, double edge) {
  std::array<particles::array, 3> x;
  std::vector<std::int64_t> id(places.size());
  std::iota(id.begin(), id.end(), 0);
  for (std::size_t a = 0; a < 3; ++a)
    for (const gas::point& at : places) x[a].push_back(at[a]);
  return cells::make_grid<3>(x, id, places.size(), edge);
}

// f(n) of the places nearer to x than `reach` (m), a rounding more or less.
template <class F>
void for_each_place(const cells::grid<3>& g, const gas::point& x, double reach, F&& f) {
  const std::array<double, 3> at{x[0], x[1], x[2]};
  cells::for_each_near<3>(g, at, at, reach, [&](std::uint32_t k, std::uint64_t near) {
    for (; near != 0; near &= near - 1) f(g.members[k + static_cast<std::uint32_t>(std::countr_zero(near))]);
  });
}

// Sets that grow together.
class pieces {
 public:
  explicit pieces(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
  std::size_t of(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t i, std::size_t j) { parent_[of(std::max(of(i), of(j)))] = std::min(of(i), of(j)); }

 private:
  std::vector<std::size_t> parent_;
};

using metal_particles = std::vector<collected::one>;

// Of friends of friends.
pieces pieces_of(const metal_particles& m, const cells::grid<3>& grid, double widest) {
  pieces all(m.size());
  for (std::size_t i = 0; i < m.size(); ++i)
    for_each_place(grid, m[i].x, widest, [&](std::size_t j) {
      if (gas::distance(m[i].x, m[j].x) < friends * 0.5 * (m[i].spacing + m[j].spacing)) all.join(i, j);
    });
  return all;
}

// How many places of the grid are that near to each particle of metal; 0 for those below this ID.
std::vector<double> number_near(const metal_particles& m, std::int64_t first_id, const cells::grid<3>& grid,
                                const std::vector<gas::point>& places) {
  std::vector<double> found(m.size(), 0.0);
  for (std::size_t i = 0; i < m.size(); ++i)
    if (const double reach = friends * m[i].spacing; m[i].id >= first_id)
      for_each_place(grid, m[i].x, reach, [&](std::size_t j) {
        if (gas::distance(m[i].x, places[j]) < reach) found[i] += 1.0;
      });
  return found;
}

}  // namespace

metal_of_impactor find_metal_of_impactor(const gas::view& w, std::int64_t first_of_impactor, std::int32_t metal) {
  const collected all_metal(w, of_material(w, metal));
  const auto& m = all_metal.all;
  metal_of_impactor found;
  if (m.empty()) return found;
  double widest = 0.0;
  std::vector<gas::point> places, rocks;
  for (const auto& p : m) {
    places.push_back(p.x);
    widest = std::max(widest, friends * p.spacing);
  }
  for (std::size_t i = 0; i < w.n; ++i)
    if (w.material[i] != metal) rocks.push_back(w.place(i));
  const auto grid = grid_of(places, widest);
  pieces sets = pieces_of(m, grid, widest);
  const auto metal_near = number_near(m, first_of_impactor, grid, places);
  auto rock_near = number_near(m, first_of_impactor, grid_of(rocks, widest), rocks);
  w.ranks.sum(rock_near);  // whole numbers

  const auto is_of_impactor = [&](std::size_t i) { return m[i].id >= first_of_impactor; };
  std::vector<double> of_impactor(m.size(), 0.0), of_target(m.size(), 0.0);  // kg, of each piece
  double whole = 0.0, target_metal = 0.0;
  gas::point centre{};
  for (std::size_t i = 0; i < m.size(); ++i) {
    (is_of_impactor(i) ? of_impactor : of_target)[sets.of(i)] += m[i].mass;
    (is_of_impactor(i) ? whole : target_metal) += m[i].mass;
    if (!is_of_impactor(i))
      for (std::size_t a = 0; a < 3; ++a) centre[a] += m[i].mass * m[i].x[a];
  }
  if (whole == 0.0) return found;
  for (double& c : centre) c /= target_metal;
  for (std::size_t i = 0; i < m.size(); ++i) {
    const bool merged = of_target[sets.of(i)] >= of_impactor[sets.of(i)];
    if (sets.of(i) == i && !merged) {
      found.pieces += 1.0;
      found.largest = std::max(found.largest, of_impactor[i] / whole);
    }
    if (!is_of_impactor(i)) continue;
    const double share = m[i].mass / whole;
    if (merged) found.merged += share;
    if (rock_near[i] >= metal_near[i]) found.mixed += share;
    if (target_metal > 0.0) found.distance += share * gas::distance(m[i].x, centre);
  }
  return found;
}

}  // namespace tetsuame::planet
