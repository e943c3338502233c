#include <algorithm>
#include <cmath>
#include <eos/surface.hpp>

namespace tetsuame::eos {

namespace {

// Hermite's four cubics on [0, 1]: of the values and of the slopes at both ends, and their derivatives.
struct hermite {
  std::array<double, 4> value, slope;  // of f0, f1, f0', f1'

  explicit hermite(double t) {
    const double s = 1.0 - t;
    value = {s * s * (1.0 + 2.0 * t), t * t * (3.0 - 2.0 * t), t * s * s, -t * t * s};
    slope = {-6.0 * s * t, 6.0 * s * t, s * (1.0 - 3.0 * t), t * (3.0 * t - 2.0)};
  }
};

double sum(const std::array<double, 4>& weight, double f0, double f1, double d0, double d1) {
  return weight[0] * f0 + weight[1] * f1 + weight[2] * d0 + weight[3] * d1;
}

}  // namespace

axis_place axis::find(double x) const {
  const auto above = std::upper_bound(nodes_.begin() + 1, nodes_.end() - 1, x);
  const auto k = static_cast<std::size_t>(above - nodes_.begin()) - 1;
  const double width = nodes_[k + 1] - nodes_[k];
  return {k, std::clamp((x - nodes_[k]) / width, 0.0, 1.0), width};
}

// Of the polynomial through up to five nodes around each: sum of f_j w_j'(x_i), Lagrange's polynomials.
void axis::slopes(const double* values, double* result, std::size_t stride) const {
  const std::size_t n = nodes_.size(), many = std::min<std::size_t>(n, 5);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t first = std::min(i < 2 ? 0 : i - 2, n - many), own = i - first;
    double slope = 0.0, diagonal = 0.0;
    for (std::size_t j = 0; j < many; ++j) {
      if (j == own) continue;
      const double away = nodes_[i] - nodes_[first + j];
      double weight = 1.0;  // w_j'(x_i)
      for (std::size_t k = 0; k < many; ++k)
        if (k != j)
          weight *= (k == own ? 1.0 : nodes_[i] - nodes_[first + k]) / (nodes_[first + j] - nodes_[first + k]);
      slope += weight * values[(first + j) * stride];
      diagonal += 1.0 / away;
    }
    result[i * stride] = slope + diagonal * values[i * stride];
  }
}

surface::surface(const axis& x, const axis& y, const std::vector<double>& values, bool rises_in_x, bool rises_in_y)
    : x_(&x), y_(&y), nodes_(values.size()) {
  const std::size_t nx = x.size(), ny = y.size();
  std::vector<double> by_x(values.size()), by_y(values.size()), by_both(values.size());
  for (std::size_t j = 0; j < ny; ++j) x.slopes(&values[j * nx], &by_x[j * nx], 1);
  for (std::size_t i = 0; i < nx; ++i) {
    y.slopes(&values[i], &by_y[i], nx);
    y.slopes(&by_x[i], &by_both[i], nx);
  }
  for (std::size_t k = 0; k < values.size(); ++k) nodes_[k] = {values[k], by_x[k], by_y[k], by_both[k]};
  // A cell's slopes are its neighbours' too: until all are left as they are. Slopes of nothing would suit every cell.
  constexpr int most = 200, of_one_coordinate = 40;
  bool changed = true;
  for (int sweep = 0; changed && sweep < most; ++sweep) {
    changed = false;
    for (std::size_t j = 0; j + 1 < ny; ++j)
      for (std::size_t i = 0; i + 1 < nx; ++i)
        for (const bool along_x : {true, false})
          if ((along_x ? rises_in_x : rises_in_y) && !keeps_monotone(i, j, along_x)) {
            reduce(i, j, along_x, sweep >= of_one_coordinate);
            changed = true;
          }
  }
  for (std::size_t k = 0; k < values.size(); ++k) reduced_ += nodes_[k].x != by_x[k] || nodes_[k].y != by_y[k] ? 1 : 0;
}

// By the differences of the Bezier coefficients along a coordinate, for each of the four rows across it. Along y: the
// same with the coordinates' parts exchanged.
bool surface::keeps_monotone(std::size_t i, std::size_t j, bool along_x) const {
  const auto corner = [&](int a, int c) {  // a along the coordinate, c across it
    const node& n = along_x ? of(i + static_cast<std::size_t>(a), j + static_cast<std::size_t>(c))
                            : of(i + static_cast<std::size_t>(c), j + static_cast<std::size_t>(a));
    return along_x ? n : node{n.f, n.y, n.x, n.xy};
  };
  const double along = along_x ? (*x_)[i + 1] - (*x_)[i] : (*y_)[j + 1] - (*y_)[j];
  const double across = along_x ? (*y_)[j + 1] - (*y_)[j] : (*x_)[i + 1] - (*x_)[i];
  std::array<std::array<double, 2>, 4> value, slope;  // of the rows across, at both ends
  for (int a = 0; a < 2; ++a) {
    const node n0 = corner(a, 0), n1 = corner(a, 1);
    if (a == 1 && (n0.f < value[0][0] || n1.f < value[3][0])) return true;  // the data do not rise
    const auto end = static_cast<std::size_t>(a);
    value[0][end] = n0.f, slope[0][end] = n0.x;
    value[1][end] = n0.f + across / 3.0 * n0.y, slope[1][end] = n0.x + across / 3.0 * n0.xy;
    value[2][end] = n1.f - across / 3.0 * n1.y, slope[2][end] = n1.x - across / 3.0 * n1.xy;
    value[3][end] = n1.f, slope[3][end] = n1.x;
  }
  constexpr double rounding = 1e-12;
  for (std::size_t row = 0; row < 4; ++row) {
    const double rise = value[row][1] - value[row][0],
                 least = -rounding * (std::abs(value[0][0]) + std::abs(value[3][1]));
    const double s0 = along / 3.0 * slope[row][0], s1 = along / 3.0 * slope[row][1];
    if (s0 < least || s1 < least || rise - s0 - s1 < least) return false;
  }
  return true;
}

void surface::reduce(std::size_t i, std::size_t j, bool along_x, bool all) {
  for (const std::size_t a : {i, i + 1})
    for (const std::size_t b : {j, j + 1}) {
      node& n = nodes_[b * x_->size() + a];
      if (all || along_x) n.x *= 0.5;
      if (all || !along_x) n.y *= 0.5;
      n.xy *= 0.5;
    }
}

surface_point surface::at(const axis_place& x, const axis_place& y) const {
  const hermite h(x.t), v(y.t);
  std::array<double, 2> value, by_x, by_y, by_both;  // at the lower and the upper node of y
  for (const std::size_t b : {std::size_t{0}, std::size_t{1}}) {
    const node &l = of(x.k, y.k + b), &r = of(x.k + 1, y.k + b);
    value[b] = sum(h.value, l.f, r.f, x.width * l.x, x.width * r.x);
    by_x[b] = sum(h.slope, l.f, r.f, x.width * l.x, x.width * r.x) / x.width;
    by_y[b] = sum(h.value, l.y, r.y, x.width * l.xy, x.width * r.xy);
    by_both[b] = sum(h.slope, l.y, r.y, x.width * l.xy, x.width * r.xy) / x.width;
  }
  return {sum(v.value, value[0], value[1], y.width * by_y[0], y.width * by_y[1]),
          sum(v.value, by_x[0], by_x[1], y.width * by_both[0], y.width * by_both[1]),
          sum(v.slope, value[0], value[1], y.width * by_y[0], y.width * by_y[1]) / y.width};
}

double surface::at_node(const axis_place& x, std::size_t j) const {
  const node &l = of(x.k, j), &r = of(x.k + 1, j);
  return sum(hermite(x.t).value, l.f, r.f, x.width * l.x, x.width * r.x);
}

}  // namespace tetsuame::eos
