#include <algorithm>
#include <cmath>
#include <theory/radial_exchange.hpp>

namespace tetsuame::theory {

namespace {

// Potentials u of the cells, capacities C = ρ P V (inside) or ρ V, and conductances G between neighbours, each over
// 2 pi (2-D) or 4 pi (3-D):  C_k du_k/dt = G_k (u_(k+1) - u_k) - G_(k-1) (u_k - u_(k-1)).
struct shells {
  std::vector<double> mass, length, from;  // kg; m, width; m, inner edge
  std::size_t inside;                      // cells
};

shells cut(const radial_exchange& p, int cells) {
  shells s{{}, {}, {}, static_cast<std::size_t>(cells)};
  const auto add = [&](double from, double width, double density) {
    s.from.push_back(from);
    s.length.push_back(width);
    s.mass.push_back(density * (std::pow(from + width, p.dimension) - std::pow(from, p.dimension)) / p.dimension);
  };
  const double dr = p.radius / cells;
  for (int k = 0; k < cells; ++k) add(k * dr, dr, p.density_inside);
  const int outside = static_cast<int>(std::ceil((p.shell - p.radius) / dr));
  const double width = (p.shell - p.radius) / outside;
  for (int k = 0; k < outside; ++k) add(p.radius + k * width, width, p.density_outside);
  return s;
}

// (C/dt' + A) x = b, tridiagonal; A's off-diagonals are -G.
void solve(const std::vector<double>& C, const std::vector<double>& G, double dt, std::vector<double>& b) {
  const std::size_t n = C.size();
  std::vector<double> upper(n);
  double below = 0.0, pivot = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const double above = k + 1 < n ? G[k] : 0.0;
    pivot = C[k] / dt + below + above - (k > 0 ? below * upper[k - 1] : 0.0);
    upper[k] = above / pivot;
    b[k] = (b[k] + (k > 0 ? below * b[k - 1] : 0.0)) / pivot;
    below = above;
  }
  for (std::size_t k = n - 1; k-- > 0;) b[k] += upper[k] * b[k + 1];
}

}  // namespace

std::vector<double> mean_inside(const radial_exchange& p, std::span<const double> times, int cells) {
  const shells s = cut(p, cells);
  const std::size_t n = s.mass.size();
  std::vector<double> c(n, p.start_outside), C(n), G(n - 1), u(n), middle(n), result;
  std::fill_n(c.begin(), s.inside, p.start_inside);
  const auto mean = [&] {
    double sum = 0.0, mass = 0.0;
    for (std::size_t k = 0; k < s.inside; ++k) {
      sum += s.mass[k] * c[k];
      mass += s.mass[k];
    }
    return sum / mass;
  };
  const double longest = times.empty() ? 0.0 : times.back() / 1000.0;
  double t = 0.0;
  for (const double end : times) {
    const int steps = end > t ? static_cast<int>(std::ceil((end - t) / longest)) : 0;
    for (int step = 0; step < steps; ++step) {
      const double dt = (end - t) / (steps - step), P = p.partition(t + 0.5 * dt);
      for (std::size_t k = 0; k < n; ++k) {
        const double a = k < s.inside ? P : 1.0;
        C[k] = s.mass[k] * a;
        u[k] = c[k] / a;
      }
      const auto resistance = [&](std::size_t k) {  // of half a cell
        return 0.5 * s.length[k] /
               (k < s.inside ? p.density_inside * p.diffusivity_inside * P : p.density_outside * p.diffusivity_outside);
      };
      for (std::size_t k = 0; k + 1 < n; ++k)
        G[k] = std::pow(s.from[k + 1], p.dimension - 1) / (resistance(k) + resistance(k + 1));
      // Trapezoidal rule to t + γ dt, then the second-order backward formula.
      const double gamma = 2.0 - std::sqrt(2.0);
      for (std::size_t k = 0; k < n; ++k) {
        const double flow = (k + 1 < n ? G[k] * (u[k + 1] - u[k]) : 0.0) - (k > 0 ? G[k - 1] * (u[k] - u[k - 1]) : 0.0);
        middle[k] = 2.0 * C[k] / (gamma * dt) * u[k] + flow;
      }
      solve(C, G, 0.5 * gamma * dt, middle);
      const double w = (1.0 - gamma) / (2.0 - gamma) * dt;
      for (std::size_t k = 0; k < n; ++k)
        u[k] = C[k] / w * (middle[k] - (1.0 - gamma) * (1.0 - gamma) * u[k]) / (gamma * (2.0 - gamma));
      solve(C, G, w, u);
      for (std::size_t k = 0; k < n; ++k) c[k] = u[k] * (k < s.inside ? P : 1.0);
      t += dt;
    }
    result.push_back(mean());
  }
  return result;
}

}  // namespace tetsuame::theory
