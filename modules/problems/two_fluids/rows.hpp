// Rows of the start lattice, moved a little and with a little more or less pressure, so that the sums over neighbours
// hold their weight (docs/theory/core_formation.md#rows-in-balance). All particles of a row move together; volumes stay
// Δx^D. Row r between rows s and mirror images:
//
//   f_r = -Σ_s (p_r + p_s) Δx^2D Φ(y_r - y_s)/(ρ_r Δx^D g) - 1,   Φ(Y) = Y Σ_x F(√(x² + Y²)) over a row
//
// is its unbalance, in weights: least squares (Levenberg, Gauss-Newton steps) of
//   Σ f² + λ² Σ [(δ/Δx)² + (Δp/(ρ g Δx))²], λ = 0.1: a whole spacing counts like a tenth of the weight.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <kernels/kernel.hpp>
#include <vector>

namespace tetsuame::two_fluids {

struct row_of_rest {
  double y, p, rho;  // m, Pa, kg/m3
};

// Σ_x F(√(x² + Y²)) Y of one row, 1/m^(D+1).
template <int D>
double row_slope(const kernels::any<D>& kernel, double dx, double Y) {
  return std::visit(
      [&](const auto& k) {
        const int n = static_cast<int>(std::ceil(k.support() / dx)), depth = D == 3 ? n : 0;
        double sum = 0.0;
        for (int a = -n; a <= n; ++a)
          for (int c = -depth; c <= depth; ++c) {
            const double r = std::sqrt(Y * Y + dx * dx * (a * a + c * c));
            if (r > k.smallest_r() && r < k.support()) sum += k.gradient_over_r(r);
          }
        return sum * Y;
      },
      kernel);
}

template <int D>
class column_of_rows {
 public:
  column_of_rows(const kernels::any<D>& kernel, double dx, double height, bool open, double g)
      : kernel_(kernel), dx_(dx), height_(height), open_(open), g_(g) {
    reach_ = static_cast<int>(std::ceil(std::visit([](const auto& k) { return k.support(); }, kernel) / dx)) + 1;
  }
  int reach() const { return reach_; }

  // f_r, in weights.
  double unbalance(const std::vector<row_of_rest>& rows, int r) const {
    const auto number = static_cast<int>(rows.size());
    const row_of_rest& here = rows[static_cast<std::size_t>(r)];
    double force = 0.0;
    for (int s = r - reach_; s <= r + reach_; ++s) {
      if (s == r || (s >= number && open_)) continue;
      const row_of_rest other = s < 0         ? mirrored(rows[static_cast<std::size_t>(-1 - s)], 0.0)
                                : s >= number ? mirrored(rows[static_cast<std::size_t>(2 * number - 1 - s)], height_)
                                              : rows[static_cast<std::size_t>(s)];
      force -= (here.p + other.p) * row_slope<D>(kernel_, dx_, here.y - other.y);
    }
    return force * std::pow(dx_, D) / (here.rho * g_) - 1.0;
  }

 private:
  row_of_rest mirrored(const row_of_rest& row, double wall) const {
    const double y = 2.0 * wall - row.y;
    return {y, row.p + row.rho * g_ * (row.y - y), row.rho};
  }

  const kernels::any<D>& kernel_;
  double dx_, height_;
  bool open_;
  double g_;
  int reach_;
};

// x of A x = b, A symmetric and positive definite, row by row; overwrites both.
inline void solve_cholesky(std::vector<double>& A, std::vector<double>& b) {
  const std::size_t n = b.size();
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = j; i < n; ++i) {
      double sum = A[i * n + j];
      for (std::size_t k = 0; k < j; ++k) sum -= A[i * n + k] * A[j * n + k];
      A[i * n + j] = i == j ? std::sqrt(sum) : sum / A[j * n + j];
    }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= A[i * n + k] * b[k];
    b[i] /= A[i * n + i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) b[i] -= A[k * n + i] * b[k];
    b[i] /= A[i * n + i];
  }
}

inline constexpr double price_of_change = 0.1;  // λ

// One Gauss-Newton step of the changes z of height and pressure, in units of Δx and ρ g Δx of the start.
template <int D>
std::vector<double> step_to_balance(const column_of_rows<D>& column, const std::vector<row_of_rest>& rows,
                                    const std::vector<double>& z,
                                    const std::function<void(std::vector<row_of_rest>&, std::size_t, double)>& change) {
  constexpr double lambda = price_of_change, small = 1e-6;
  const std::size_t n = rows.size(), unknowns = 2 * n;
  std::vector<double> A(unknowns * unknowns, 0.0), b(unknowns, 0.0), f(n), slope(unknowns * n, 0.0);
  for (std::size_t r = 0; r < n; ++r) f[r] = column.unbalance(rows, static_cast<int>(r));
  auto trial = rows;
  for (std::size_t k = 0; k < unknowns; ++k) {
    const auto row = static_cast<int>(k % n), last = static_cast<int>(n) - 1;
    change(trial, k, small);
    for (int r = std::max(row - column.reach(), 0); r <= std::min(row + column.reach(), last); ++r) {
      const auto at = static_cast<std::size_t>(r);
      slope[at * unknowns + k] = (column.unbalance(trial, r) - f[at]) / small;
    }
    trial[k % n] = rows[k % n];
  }
  for (std::size_t i = 0; i < unknowns; ++i) {
    A[i * unknowns + i] = lambda * lambda;
    b[i] = -lambda * lambda * z[i];
  }
  for (std::size_t r = 0; r < n; ++r)
    for (std::size_t i = 0; i < unknowns; ++i) {
      const double by = slope[r * unknowns + i];
      if (by == 0.0) continue;
      b[i] -= by * f[r];
      for (std::size_t k = 0; k < unknowns; ++k) A[i * unknowns + k] += by * slope[r * unknowns + k];
    }
  solve_cholesky(A, b);
  return b;
}

// `density`: kg/m3 of the material of row r at a pressure.
template <int D>
std::vector<row_of_rest> balanced(const column_of_rows<D>& column, const std::vector<row_of_rest>& start, double dx,
                                  double g, const std::function<double(std::size_t, double)>& density) {
  const std::size_t n = start.size();
  const auto change = [&](std::vector<row_of_rest>& rows, std::size_t k, double by) {
    if (k < n)
      rows[k].y += by * dx;
    else
      rows[k - n].p += by * start[k - n].rho * g * dx;
  };
  const auto changed = [&](const std::vector<double>& z) {
    auto rows = start;
    for (std::size_t k = 0; k < 2 * n; ++k) change(rows, k, z[k]);
    for (std::size_t r = 0; r < n; ++r) rows[r].rho = density(r, rows[r].p);
    return rows;
  };
  const auto squares = [&](const std::vector<row_of_rest>& rows, const std::vector<double>& z) {
    double sum = 0.0;
    for (std::size_t r = 0; r < n; ++r) sum += std::pow(column.unbalance(rows, static_cast<int>(r)), 2);
    for (const double by : z) sum += std::pow(price_of_change * by, 2);
    return sum;
  };
  std::vector<double> z(2 * n, 0.0);
  auto rows = start;
  double least = squares(rows, z);
  // Steps that do not lower the sum are halved: with many neighbours the rows' forces are far from linear in shifts.
  for (int round = 0; round < 12; ++round) {
    const auto step = step_to_balance<D>(column, rows, z, change);
    for (double part = 1.0; part > 1e-3; part *= 0.5) {
      auto next = z;
      for (std::size_t k = 0; k < 2 * n; ++k) next[k] += part * step[k];
      const auto there = changed(next);
      const double sum = squares(there, next);
      if (!(sum < least)) continue;
      z = next;
      rows = there;
      least = sum;
      break;
    }
  }
  return rows;
}

}  // namespace tetsuame::two_fluids
