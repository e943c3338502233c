#include <algorithm>
#include <cmath>
#include <free_surface/united.hpp>
#include <limits>
#include <numeric>
#include <optional>

namespace tetsuame::free_surface {

namespace {

bool overlap_along(const block& a, const block& b, std::size_t axis, double least) {
  return std::min(a.high[axis], b.high[axis]) - std::max(a.low[axis], b.low[axis]) > least;
}

// The root of the set that i belongs to.
std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

}  // namespace

bool touch_sideways(const options& o, const parameters& p) {
  const double slight = 1e-6 * o.domain.dx();
  const auto touch = [&](const block& a, const block& b, std::size_t axis) {
    const double length = o.domain.length[axis];
    const bool across = o.domain.periodic[axis] && a.low[axis] < slight && b.high[axis] > length - slight;
    if (!across && std::abs(a.low[axis] - b.high[axis]) > slight) return false;
    for (std::size_t k = 0; k < o.domain.axes(); ++k)
      if (k != axis && !overlap_along(a, b, k, slight)) return false;
    return true;
  };
  for (const block& a : p.blocks)
    for (const block& b : p.blocks)
      for (std::size_t axis = 0; axis < o.domain.axes(); axis += 2)
        if (&a != &b && touch(a, b, axis)) return true;
  return false;
}

united_surface::united_surface(const options& o, const parameters& p, const is_there& is_water,
                               const is_there& is_solid)
    : axes_(o.domain.axes()), periodic_(o.domain.periodic), dx_(o.domain.dx()), number_{1, 1, 1} {
  for (std::size_t a = 0; a < axes_; ++a) number_[a] = static_cast<std::size_t>(std::llround(o.domain.length[a] / dx_));
  number_cells([&](const point& x) {
    return std::ranges::any_of(p.blocks, [&](const block& b) { return b.holds(x); }) && is_water(x);
  });
  find_faces(is_solid);
  if (!find_level_waters()) solve();
}

point united_surface::middle(const std::array<std::size_t, 3>& cell) const {
  point x{};
  for (std::size_t a = 0; a < axes_; ++a) x[a] = (static_cast<double>(cell[a]) + 0.5) * dx_;
  return x;
}

void united_surface::number_cells(const is_there& is_water) {
  cell_.assign(number_[0] * number_[1] * number_[2], none);
  std::uint32_t cells = 0;
  for (std::size_t z = 0; z < number_[2]; ++z)
    for (std::size_t y = 0; y < number_[1]; ++y)
      for (std::size_t x = 0; x < number_[0]; ++x)
        if (is_water(middle({x, y, z}))) cell_[place_of({x, y, z})] = cells++;
  Y_.assign(cells, 0.0);
}

// Between cells with water; and to the air above, half a spacing away.
void united_surface::find_faces(const is_there& is_solid) {
  const auto visit = [&](const std::array<std::size_t, 3>& cell, std::size_t axis) {
    const auto mine = cell_[place_of(cell)];
    if (mine == none) return;
    auto next = cell;
    const bool last = ++next[axis] == number_[axis];
    if (last) next[axis] = 0;
    point at = middle(cell);
    at[axis] += 0.5 * dx_;
    const auto other = last && !periodic_[axis] ? none : cell_[place_of(next)];
    if (is_solid(at)) return;
    if (other != none) {
      faces_.push_back({mine, other});
    } else if (axis == 1) {
      const double level = at[1];
      at[1] += 0.5 * dx_;
      if (last || !is_solid(at)) openings_.push_back({mine, level});
    }
  };
  for (std::size_t z = 0; z < number_[2]; ++z)
    for (std::size_t y = 0; y < number_[1]; ++y)
      for (std::size_t x = 0; x < number_[0]; ++x)
        for (std::size_t a = 0; a < axes_; ++a) visit({x, y, z}, a);
}

// Waters that hang together: Y where all of one's surface is level, and of one without a surface the height of its
// highest cell. Whether that is all of them; elsewhere Y begins at the highest surface.
bool united_surface::find_level_waters() {
  std::vector<std::uint32_t> parent(Y_.size());
  std::iota(parent.begin(), parent.end(), 0U);
  for (const face& f : faces_) parent[root_of(parent, f.first)] = root_of(parent, f.second);
  constexpr double unknown = std::numeric_limits<double>::lowest();
  std::vector<double> highest(Y_.size(), unknown), lowest(Y_.size(), -unknown), top(Y_.size(), unknown);
  for (const opening& of : openings_) {
    const auto water = root_of(parent, of.cell);
    highest[water] = std::max(highest[water], of.level);
    lowest[water] = std::min(lowest[water], of.level);
  }
  for (std::size_t place = 0; place < cell_.size(); ++place)
    if (cell_[place] != none) {
      const auto water = root_of(parent, cell_[place]);
      top[water] = std::max(top[water], dx_ * static_cast<double>(place / number_[0] % number_[1] + 1));
    }
  bool all = true;
  for (std::uint32_t i = 0; i < Y_.size(); ++i) {
    const auto water = root_of(parent, i);
    const bool open = highest[water] > unknown;
    Y_[i] = open ? highest[water] : top[water];
    all = all && (!open || highest[water] - lowest[water] < 1e-9 * dx_);
  }
  return all;
}

std::vector<double> united_surface::times_matrix(const std::vector<double>& Y) const {
  std::vector<double> out(Y.size(), 0.0);
  for (const face& f : faces_) {
    const double by = Y[f.first] - Y[f.second];
    out[f.first] += by;
    out[f.second] -= by;
  }
  for (const opening& of : openings_) out[of.cell] += 2.0 * Y[of.cell];
  return out;
}

void united_surface::solve() {
  constexpr double accuracy = 1e-10;  // of the largest head; densities hold 1e-16 of themselves
  std::vector<double> r = times_matrix(Y_), d, Ad;
  for (double& value : r) value = -value;
  for (const opening& of : openings_) r[of.cell] += 2.0 * of.level;
  d = r;
  double r2 = dot(r, r);
  const double end = accuracy * accuracy * r2;
  for (std::size_t n = 0; n < 10 * Y_.size() && r2 > end; ++n) {
    Ad = times_matrix(d);
    const double step = r2 / dot(d, Ad);
    for (std::size_t i = 0; i < r.size(); ++i) {
      Y_[i] += step * d[i];
      r[i] -= step * Ad[i];
    }
    const double before = r2;
    r2 = dot(r, r);
    for (std::size_t i = 0; i < r.size(); ++i) d[i] = r[i] + r2 / before * d[i];
  }
}

double united_surface::level(const point& x, double else_level) const {
  std::array<std::size_t, 3> cell{};
  for (std::size_t a = 0; a < axes_; ++a)
    cell[a] = std::min(static_cast<std::size_t>(std::max(0.0, x[a] / dx_)), number_[a] - 1);
  const auto found = cell_[place_of(cell)];
  return found == none ? else_level : Y_[found];
}

}  // namespace tetsuame::free_surface
