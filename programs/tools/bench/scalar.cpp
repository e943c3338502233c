#include <bench/scalar.hpp>
#include <cmath>
#include <numbers>

namespace tetsuame::bench {

namespace {

struct quintic {
  double h, scale;  // m, 1/m^D

  quintic(double length, int dimension) : h(length) {
    scale = dimension == 2 ? 7.0 / (478.0 * std::numbers::pi * h * h) : 1.0 / (120.0 * std::numbers::pi * h * h * h);
  }
  static double power(double x, int n) {
    double product = 1.0;
    for (int k = 0; k < n; ++k) product *= x;
    return product;
  }
  // The spline's three pieces, each to the n-th power.
  static double sum(double q, int n) {
    double pieces = power(3.0 - q, n);
    if (q < 2.0) pieces -= 6.0 * power(2.0 - q, n);
    if (q < 1.0) pieces += 15.0 * power(1.0 - q, n);
    return pieces;
  }
  double W(double r) const { return scale * sum(r / h, 5); }
  double gradient_over_r(double r) const { return -5.0 * scale / (h * r) * sum(r / h, 4); }
};

template <int D>
void smooth(const scalar_problem<D>& a, const quintic& kernel, scalar_sums<D>& out) {
  const auto& s = a.s;
  const double support2 = 9.0 * a.h * a.h;
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < out.p.size(); ++i) {
    double p = s.Y[i] * kernel.W(0.0);
    for (std::size_t k = a.start[i]; k < a.start[i + 1]; ++k) {
      const auto j = static_cast<std::size_t>(a.neighbours[k]);
      double r2 = 0.0;
      for (std::size_t c = 0; c < D; ++c) r2 += (s.x[c][i] - s.x[c][j]) * (s.x[c][i] - s.x[c][j]);
      if (r2 >= support2) continue;
      p += s.Y[j] * kernel.W(std::sqrt(r2));
    }
    out.p[i] = p;
  }
}

template <int D>
void accelerate(const scalar_problem<D>& a, const quintic& kernel, scalar_sums<D>& out) {
  const auto& s = a.s;
  const double support2 = 9.0 * a.h * a.h;
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < out.p.size(); ++i) {
    std::array<double, D> force{};
    double work = 0.0, dlnrho = 0.0, heat = 0.0;
    for (std::size_t k = a.start[i]; k < a.start[i + 1]; ++k) {
      const auto j = static_cast<std::size_t>(a.neighbours[k]);
      std::array<double, D> x, v;
      double r2 = 0.0, v2 = 0.0, vx = 0.0;
      for (std::size_t c = 0; c < D; ++c) {
        x[c] = s.x[c][i] - s.x[c][j];
        r2 += x[c] * x[c];
      }
      if (r2 >= support2) continue;
      for (std::size_t c = 0; c < D; ++c) {
        v[c] = s.v[c][i] - s.v[c][j];
        v2 += v[c] * v[c];
        vx += v[c] * x[c];
      }
      const double F = kernel.gradient_over_r(std::sqrt(r2));
      const double stress = s.p[i] * s.dV[i] * s.dV[i] + s.p[j] * s.dV[j] * s.dV[j];
      const double viscous = 2.0 * a.eta * s.dV[i] * s.dV[j] * F;
      for (std::size_t c = 0; c < D; ++c) force[c] += viscous * v[c] - stress * F * x[c];
      work += 0.5 * stress * F * vx;
      dlnrho += s.dV[j] * F * vx;
      heat -= 0.5 * viscous * v2;
    }
    for (std::size_t c = 0; c < D; ++c) out.dv[c][i] = force[c] / s.m[i] + a.g[c];
    out.work[i] = work / s.m[i];
    out.dlnrho[i] = dlnrho;
    out.heat[i] = heat;
  }
}

}  // namespace

template <int D>
void sum_scalar(const scalar_problem<D>& problem, scalar_sums<D>& sums) {
  const quintic kernel(problem.h, D);
  smooth(problem, kernel, sums);
  accelerate(problem, kernel, sums);
}

template void sum_scalar<2>(const scalar_problem<2>&, scalar_sums<2>&);
template void sum_scalar<3>(const scalar_problem<3>&, scalar_sums<3>&);

}  // namespace tetsuame::bench
