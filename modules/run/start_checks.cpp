#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <run/start_checks.hpp>

namespace tetsuame::run {

namespace {

constexpr double spacings = 2.5;  // of the kernel

// Of support 1: (1 - q)^4 (1 + 4 q) over its integral [H. Wendland, Adv. Comput. Math. 4, 389 (1995)]; in one dimension
// (1 - q)^3 (1 + 3 q).
double wendland(int dimension, double q) {
  if (q >= 1.0) return 0.0;
  const double a = 1.0 - q;
  if (dimension == 1) return 1.25 * a * a * a * (1.0 + 3.0 * q);
  const double of_integral = dimension == 2 ? 7.0 : 10.5;
  return of_integral / std::numbers::pi * a * a * a * a * (1.0 + 4.0 * q);
}

// Particles by the cell that they lie in, of the box along periodic axes, of what they fill along others.
class cell_grid {
 public:
  cell_grid(const start_region& where, const std::vector<double>& places, double edge)
      : where_(where), x_(places), D_(static_cast<std::size_t>(where.dimension)) {
    const std::size_t n = places.size() / D_;
    const double most = std::ceil(std::pow(4.0 * static_cast<double>(n), 1.0 / where.dimension));  // along each axis
    for (std::size_t a = 0; a < D_; ++a) {
      find_extent(a);
      cells_[a] = static_cast<std::int64_t>(std::clamp(std::floor(extent_[a] / edge), 1.0, most));
    }
    std::vector<std::size_t> cell(n);
    for (std::size_t i = 0; i < n; ++i) cell[i] = number_of(cell_of(i));
    begin_.assign(static_cast<std::size_t>(cells_[0] * cells_[1] * cells_[2]) + 1, 0);
    for (const std::size_t c : cell) ++begin_[c + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    members_.resize(n);
    auto next = begin_;
    for (std::size_t i = 0; i < n; ++i) members_[next[cell[i]]++] = i;
  }

  // visit(j, r²) of every other particle nearer than the edge, and of some that are farther.
  template <class F>
  void for_each_near(std::size_t i, const F& visit) const {
    const auto home = cell_of(i);
    std::array<std::vector<std::int64_t>, 3> near{{{0}, {0}, {0}}};
    for (std::size_t a = 0; a < D_; ++a) near[a] = cells_near(a, home[a]);
    for (const auto z : near[2])
      for (const auto y : near[1])
        for (const auto x : near[0]) {
          const std::size_t c = number_of({x, y, z});
          for (std::size_t k = begin_[c]; k < begin_[c + 1]; ++k)
            if (members_[k] != i) visit(members_[k], distance2(i, members_[k]));
        }
  }

 private:
  void find_extent(std::size_t a) {
    extent_[a] = where_.length[a];
    if (where_.periodic[a]) return;
    double high = -std::numeric_limits<double>::infinity();
    low_[a] = -high;
    for (std::size_t k = a; k < x_.size(); k += D_) {
      low_[a] = std::min(low_[a], x_[k]);
      high = std::max(high, x_[k]);
    }
    extent_[a] = std::max(high - low_[a], 1e-9 * where_.length[a]);
  }
  std::array<std::int64_t, 3> cell_of(std::size_t i) const {
    std::array<std::int64_t, 3> c{};
    for (std::size_t a = 0; a < D_; ++a) {
      const double at = (x_[D_ * i + a] - low_[a]) / extent_[a] * static_cast<double>(cells_[a]);
      c[a] = static_cast<std::int64_t>(std::clamp(std::floor(at), 0.0, static_cast<double>(cells_[a] - 1)));
    }
    return c;
  }
  std::size_t number_of(const std::array<std::int64_t, 3>& c) const {
    return static_cast<std::size_t>(c[0] + cells_[0] * (c[1] + cells_[1] * c[2]));
  }
  // Each once.
  std::vector<std::int64_t> cells_near(std::size_t a, std::int64_t home) const {
    std::vector<std::int64_t> all;
    for (std::int64_t c = home - 1; c <= home + 1; ++c) {
      const bool inside = c >= 0 && c < cells_[a];
      if (!inside && !where_.periodic[a]) continue;
      const std::int64_t cell = (c + cells_[a]) % cells_[a];
      if (std::ranges::find(all, cell) == all.end()) all.push_back(cell);
    }
    return all;
  }
  double distance2(std::size_t i, std::size_t j) const {
    double r2 = 0.0;
    for (std::size_t a = 0; a < D_; ++a) {
      double d = x_[D_ * i + a] - x_[D_ * j + a];
      if (where_.periodic[a]) d -= where_.length[a] * std::round(d / where_.length[a]);
      r2 += d * d;
    }
    return r2;
  }

  const start_region& where_;
  const std::vector<double>& x_;
  std::size_t D_;
  std::array<double, 3> low_{}, extent_{};  // m
  std::array<std::int64_t, 3> cells_{1, 1, 1};
  std::vector<std::size_t> begin_, members_;
};

}  // namespace

// They are sorted by cells that are a little wider than `near`; one near a cell's edge is in the next as well.
std::optional<std::pair<std::size_t, std::size_t>> find_coincident(const start_region& where,
                                                                   const std::vector<double>& x, double near) {
  const std::size_t D = static_cast<std::size_t>(where.dimension), n = x.size() / D;
  const double edge = 64.0 * near;
  struct entry {
    std::array<std::int64_t, 3> cell;
    std::size_t number;
  };
  std::vector<entry> entries;
  entries.reserve(n + n / 4);
  for (std::size_t i = 0; i < n; ++i) {
    std::array<std::array<std::int64_t, 2>, 3> cells{};  // along each axis, of the place less and more `near`
    for (std::size_t a = 0; a < D; ++a)
      for (const std::size_t side : {0, 1}) {
        double at = x[D * i + a] + (side == 0 ? -near : near);
        const double L = where.length[a];
        if (where.periodic[a]) at = at < 0.0 ? at + L : at >= L ? at - L : at;
        cells[a][side] = static_cast<std::int64_t>(std::floor(at / edge));
      }
    for (std::size_t corner = 0; corner < std::size_t{1} << D; ++corner) {
      entry e{{}, i};
      bool repeats = false;
      for (std::size_t a = 0; a < D; ++a) {
        const std::size_t side = corner >> a & 1;
        repeats = repeats || (side == 1 && cells[a][1] == cells[a][0]);
        e.cell[a] = cells[a][side];
      }
      if (!repeats) entries.push_back(e);
    }
  }
  std::ranges::sort(entries, {}, [](const entry& e) { return std::pair(e.cell, e.number); });
  const auto apart = [&](std::size_t i, std::size_t j) {
    double r2 = 0.0;
    for (std::size_t a = 0; a < D; ++a) {
      double d = x[D * i + a] - x[D * j + a];
      if (where.periodic[a]) d -= where.length[a] * std::round(d / where.length[a]);
      r2 += d * d;
    }
    return r2 > near * near;
  };
  for (std::size_t k = 0; k < entries.size(); ++k)
    for (std::size_t l = k + 1; l < entries.size() && entries[l].cell == entries[k].cell; ++l)
      if (!apart(entries[k].number, entries[l].number)) return std::pair(entries[k].number, entries[l].number);
  return {};
}

neighbourhoods find_neighbourhoods(const start_region& where, const std::vector<double>& places,
                                   const std::vector<double>& volumes, const std::vector<double>& reach) {
  const std::size_t n = volumes.size();
  const int D = where.dimension;
  neighbourhoods all{std::vector<double>(n, std::numeric_limits<double>::infinity()), std::vector<double>(n)};
  std::vector<double> support(n);
  double widest = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    support[i] = spacings * std::pow(volumes[i], 1.0 / D);
    widest = std::max({widest, support[i], reach[i]});
  }
  if (n == 0) return all;
  const cell_grid grid(where, places, widest);
  for (std::size_t i = 0; i < n; ++i) {
    double least = std::numeric_limits<double>::infinity(), sum = volumes[i] * wendland(D, 0.0);
    grid.for_each_near(i, [&](std::size_t j, double r2) {
      least = std::min(least, r2);
      if (r2 < support[i] * support[i]) sum += volumes[j] * wendland(D, std::sqrt(r2) / support[i]);
    });
    if (least < reach[i] * reach[i]) all.nearest[i] = std::sqrt(least);
    all.filled[i] = sum / std::pow(support[i], D);
  }
  return all;
}

}  // namespace tetsuame::run
