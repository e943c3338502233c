#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <foundation/error.hpp>
#include <limits>
#include <numbers>
#include <theory/rayleigh_taylor.hpp>

namespace tetsuame::theory {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// y = (u, v, s, n), s = tau_xy and n = tau_yy - p', as amplitudes of sin, cos, sin, cos.
enum unknown : Index { U, V, S, N };

// On [-1, 1]: values at the M + 1 Chebyshev extrema represent a polynomial of degree M; the
// equations hold at the M zeros [T. A. Driscoll and N. Hale, IMA J. Numer. Anal. 36, 108 (2016)],
// which leaves room for exactly as many boundary conditions as there are unknown functions.
struct chebyshev {
  VectorXd points, weights, zeros;      // extrema in ascending order, their barycentric weights
  MatrixXd interpolate, differentiate;  // from the extrema to the zeros
};

double end_weight(Index j, Index last) { return (j % 2 ? -1.0 : 1.0) * (j == 0 || j == last ? 0.5 : 1.0); }

// At `at`, the polynomial with these values at the extrema x.
double barycentric(const std::vector<double>& x, const std::vector<double>& values, double at) {
  double above = 0.0, below = 0.0;
  for (std::size_t j = 0; j < x.size(); ++j) {
    if (at == x[j]) return values[j];
    const double c = end_weight(static_cast<Index>(j), static_cast<Index>(x.size()) - 1) / (at - x[j]);
    above += c * values[j];
    below += c;
  }
  return above / below;
}

chebyshev chebyshev_points(Index M) {
  chebyshev c{VectorXd(M + 1), VectorXd(M + 1), VectorXd(M), MatrixXd(M, M + 1), MatrixXd(M, M + 1)};
  for (Index j = 0; j <= M; ++j) {
    c.points[j] = -std::cos(std::numbers::pi * static_cast<double>(j) / static_cast<double>(M));
    c.weights[j] = end_weight(j, M);
  }
  for (Index i = 0; i < M; ++i) {
    const double x = -std::cos(std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(M));
    c.zeros[i] = x;
    // l_j = (w_j/(x - x_j))/B, B = sum of the w/(x - x_j); l_j' = l_j [-1/(x - x_j) + C/B], C = sum of the w/(x -
    // x_j)^2
    double B = 0.0, C = 0.0;
    for (Index j = 0; j <= M; ++j) {
      const double d = x - c.points[j];
      B += c.weights[j] / d;
      C += c.weights[j] / (d * d);
    }
    for (Index j = 0; j <= M; ++j) {
      const double d = x - c.points[j];
      c.interpolate(i, j) = c.weights[j] / d / B;
      c.differentiate(i, j) = c.interpolate(i, j) * (C / B - 1.0 / d);
    }
  }
  return c;
}

// dp/dy = -rho g downward: the material at `to` below y, where the pressure is p; both move there.
material_state descend(const barotrope& material, double g, double to, double& y, double& p) {
  constexpr int steps = 16;
  const auto slope = [&](double pressure) { return material(pressure).density * g; };
  const double d = (y - to) / steps;
  for (int s = 0; s < steps && d > 0.0; ++s) {
    const double k1 = slope(p), k2 = slope(p + 0.5 * d * k1), k3 = slope(p + 0.5 * d * k2), k4 = slope(p + d * k3);
    p += d / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  y = to;
  const material_state at = material(p);
  if (!(at.density > 0.0 && at.bulk_modulus > 0.0)) {
    foundation::fail_input(
        fmt::format("the material has density {} kg/m^3 and bulk modulus {} Pa at {} Pa; both must be > 0", at.density,
                    at.bulk_modulus, p));
  }
  return at;
}

struct grid_layer {
  const layer* properties;
  double from, to;  // m
  boundary wall;
  bool wall_is_first;        // the wall is at `from`
  VectorXd rho, beta;        // at the zeros, ascending
  VectorXd rho_at, beta_at;  // at the extrema, ascending
};

struct discretisation {
  chebyshev points;
  grid_layer lower, upper;
  double density_jump;  // upper - lower at the interface
};

double height(const grid_layer& l, double x) { return 0.5 * ((1.0 - x) * l.from + (1.0 + x) * l.to); }

discretisation discretise(const two_layers& flow, Index M) {
  discretisation d{chebyshev_points(M), {}, {}, 0.0};
  d.lower = {&flow.lower, -flow.lower.thickness, 0.0, flow.floor, true, {}, {}, {}, {}};
  d.upper = {&flow.upper, 0.0, flow.upper.thickness, flow.lid, false, {}, {}, {}, {}};
  double p = flow.top_pressure;
  for (grid_layer* l : {&d.upper, &d.lower}) {
    for (VectorXd* v : {&l->rho, &l->beta}) v->resize(M);
    for (VectorXd* v : {&l->rho_at, &l->beta_at}) v->resize(M + 1);
    double y = l->to;
    const auto fill = [&](double x, double& rho, double& beta) {
      const material_state at = descend(l->properties->material, flow.gravity, height(*l, x), y, p);
      rho = at.density;
      beta = 1.0 / at.bulk_modulus;
    };
    for (Index j = M; j >= 0; --j) {  // extrema and zeros alternate
      fill(d.points.points[j], l->rho_at[j], l->beta_at[j]);
      if (j > 0) fill(d.points.zeros[j - 1], l->rho[j - 1], l->beta[j - 1]);
    }
  }
  d.density_jump = d.upper.rho_at[0] - d.lower.rho_at[M];
  return d;
}

struct local {  // what the equations need at a point
  double rho, beta, eta, lambda, g, k, growth;
  double inertia, softness;  // xi^2, 0: none; zeta^2
};

// Coefficients of (u, v, n) in the divergence: from continuity in the form
// growth zeta^2 beta p' = beta rho g v - div, and n = -p' + 2 eta v' + lambda div.
Eigen::Vector4d divergence(const local& c) {
  const double gb = c.growth * c.beta * c.softness;
  return Eigen::Vector4d(2.0 * c.eta * c.k * gb, c.beta * c.rho * c.g, 0.0, gb) / (1.0 + gb * (2.0 * c.eta + c.lambda));
}

Eigen::Vector4d pressure(const local& c) {
  Eigen::Vector4d p = (2.0 * c.eta + c.lambda) * divergence(c);
  p[U] -= 2.0 * c.eta * c.k;
  p[N] -= 1.0;
  return p;
}

// dy/dy = A y
Eigen::Matrix4d coefficients(const local& c) {
  const Eigen::Vector4d div = divergence(c), p = pressure(c);
  const double mass = c.inertia * c.growth * c.rho;
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  A(U, S) = 1.0 / c.eta;
  A(U, V) = c.k;
  A.row(V) = div;
  A(V, U) -= c.k;
  A.row(S) = c.k * (c.lambda * div - p);
  A(S, U) += mass + 2.0 * c.eta * c.k * c.k;
  A.row(N) = c.rho * c.beta * c.g * p;
  A(N, V) += mass;
  A(N, S) -= c.k;
  return A;
}

local local_at(const two_layers& flow, const grid_layer& l, double rho, double beta, double k, double growth) {
  const double eta = l.properties->viscosity;
  const double inertia = flow.inertia ? l.properties->inertia : 0.0;
  return {rho,    beta,    eta,          l.properties->bulk_viscosity - 2.0 / 3.0 * eta, flow.gravity, k,
          growth, inertia, flow.softness};
}

double stress_scale(const two_layers& flow, const discretisation& d, double k, double growth) {
  const double eta = std::max(flow.lower.viscosity, flow.upper.viscosity);
  const double rho =
      std::max(flow.lower.inertia * d.lower.rho_at.maxCoeff(), flow.upper.inertia * d.upper.rho_at.maxCoeff());
  return eta * k + (flow.inertia ? growth * rho / k : 0.0);
}

// The layer's fields, 4 (M + 1) rows (unknown-major), for unit (u, v) at the interface in
// column 0 and 1. Stresses are in units of `scale`.
MatrixXd respond(const two_layers& flow, const discretisation& d, const grid_layer& l, double k, double growth,
                 double scale) {
  const Index M = d.points.zeros.size(), P = M + 1;
  const double half = 0.5 * (l.to - l.from);
  const Eigen::Vector4d unit(1.0, 1.0, scale, scale);
  MatrixXd system = MatrixXd::Zero(4 * P, 4 * P), right = MatrixXd::Zero(4 * P, 2);
  for (Index i = 0; i < M; ++i) {
    const Eigen::Matrix4d A = unit.cwiseInverse().asDiagonal() *
                              coefficients(local_at(flow, l, l.rho[i], l.beta[i], k, growth)) * unit.asDiagonal();
    for (Index a = 0; a < 4; ++a) {
      const Index row = a * M + i;
      system.block(row, a * P, 1, P) = d.points.differentiate.row(i) / half;
      for (Index b = 0; b < 4; ++b) system.block(row, b * P, 1, P) -= A(a, b) * d.points.interpolate.row(i);
      system.row(row) /= system.row(row).cwiseAbs().maxCoeff();
    }
  }
  const Index wall = l.wall_is_first ? 0 : M, inner = M - wall, row = 4 * M;
  if (l.wall == boundary::free_surface) {  // n + rho g v/growth = 0 on the moved surface
    system(row, N * P + wall) = 1.0;
    system(row, V * P + wall) = l.rho_at[wall] * flow.gravity / (growth * scale);
    system.row(row) /= system.row(row).cwiseAbs().maxCoeff();
  } else {
    system(row, V * P + wall) = 1.0;
  }
  system(row + 1, (l.wall == boundary::no_slip ? U : S) * P + wall) = 1.0;
  for (Index a : {Index{U}, Index{V}}) {
    system(row + 2 + a, a * P + inner) = 1.0;
    right(row + 2 + a, a) = 1.0;
  }
  return system.partialPivLu().solve(right);
}

struct matched {
  double imbalance;  // Pa/m; its root is the growth rate, below which it is negative
  double slip;       // u at the interface for v = 1
  MatrixXd lower, upper;
  double scale;
};

// Continuous u, v and s; n jumps by (sigma k^2 - [rho] g) v/growth, the weight and the tension of
// the displaced interface.
matched match(const two_layers& flow, const discretisation& d, double k, double growth) {
  const Index M = d.points.zeros.size(), P = M + 1;
  matched m;
  m.scale = stress_scale(flow, d, k, growth);
  m.lower = respond(flow, d, d.lower, k, growth, m.scale);
  m.upper = respond(flow, d, d.upper, k, growth, m.scale);
  const auto jump = [&](Index a, Index column) { return m.upper(a * P, column) - m.lower(a * P + M, column); };
  m.slip = -jump(S, V) / jump(S, U);
  const double normal = (jump(N, V) + jump(N, U) * m.slip) * m.scale;
  m.imbalance = -growth * normal + flow.surface_tension * k * k - d.density_jump * flow.gravity;
  return m;
}

struct solution {
  discretisation grid;
  double growth;  // 0: stable
};

// The imbalance rises with the growth rate (it is growth^2 kinetic + growth dissipation +
// potential energy, minimised over all flows that move the interface), so any bracket will do.
double root(const two_layers& flow, const discretisation& d, double k, double guess, double factor) {
  const auto f = [&](double log_growth) { return match(flow, d, k, std::exp(log_growth)).imbalance; };
  const double step = std::log(factor);
  double a = std::log(guess), fa = f(a);
  if (fa == 0.0) return guess;
  double b = a, fb = fa;
  for (int tries = 0; (fa < 0.0) == (fb < 0.0); ++tries) {
    if (tries == 200 || !std::isfinite(fb))
      foundation::fail_calculation("Rayleigh-Taylor theory: no growth rate found");
    a = b;
    fa = fb;
    b += (fa < 0.0 ? step : -step) * (1 << std::min(tries, 4));
    fb = f(b);
  }
  if (a > b) {
    std::swap(a, b);
    std::swap(fa, fb);
  }
  std::uintmax_t iterations = 100;
  const auto bracket = boost::math::tools::toms748_solve(
      f, a, b, fa, fb, [](double x, double y) { return std::abs(x - y) < 1e-13 * (1.0 + std::abs(x)); }, iterations);
  return std::exp(0.5 * (bracket.first + bracket.second));
}

solution solve(const two_layers& flow, double k) {
  constexpr double tolerance = 1e-9;
  double growth = 0.0, change = std::numeric_limits<double>::infinity();
  for (const Index M : {16, 24, 36, 54, 80, 120, 180}) {
    discretisation d = discretise(flow, M);
    const double drive = d.density_jump * flow.gravity - flow.surface_tension * k * k;
    if (drive <= 0.0) return {std::move(d), 0.0};
    if (growth == 0.0) {
      const double rho = flow.upper.inertia * d.upper.rho_at[0] + flow.lower.inertia * d.lower.rho_at[M];
      const double eta = flow.lower.viscosity + flow.upper.viscosity;
      const double viscous = drive / (2.0 * eta * k);
      const double guess = flow.inertia ? std::min(std::sqrt(drive * k / rho), viscous) : viscous;
      growth = root(flow, d, k, guess, 2.0);
      continue;
    }
    const double finer = root(flow, d, k, growth, 1.0 + std::clamp(10.0 * change, 1e-7, 0.1));
    change = std::abs(finer / growth - 1.0);
    growth = finer;
    if (change < tolerance) return {std::move(d), growth};
  }
  foundation::fail_calculation(fmt::format(
      "Rayleigh-Taylor theory: at k = {} 1/m the growth rate still changes by {:.1e} of itself at 180 points a layer: "
      "with larger viscosities, whose layers beside the contact are thicker, it settles",
      k, change));
}

mode::profile profile_of(const two_layers& flow, const discretisation& d, const grid_layer& l, const MatrixXd& response,
                         const matched& m, double k, double growth) {
  const Index P = d.points.points.size();
  mode::profile out;
  const VectorXd fields = growth * (response.col(U) * m.slip + response.col(V));  // v = growth at the interface
  for (Index j = 0; j < P; ++j) {
    const Eigen::Vector4d here(fields[j], fields[P + j], m.scale * fields[2 * P + j], m.scale * fields[3 * P + j]);
    out.y.push_back(height(l, d.points.points[j]));
    out.u.push_back(here[U]);
    out.v.push_back(here[V]);
    out.pressure.push_back(pressure(local_at(flow, l, l.rho_at[j], l.beta_at[j], k, growth)).dot(here));
  }
  return out;
}

}  // namespace

barotrope linear_barotrope(double rho0, double K) {
  return [rho0, K](double p) {
    const double ratio = 1.0 + p / K;
    return material_state{rho0 * ratio, K * ratio};
  };
}

double growth_rate(const two_layers& flow, double k) { return solve(flow, k).growth; }

mode eigenmode(const two_layers& flow, double k) {
  const solution s = solve(flow, k);
  if (s.growth == 0.0) {
    foundation::fail_input(
        fmt::format("Rayleigh-Taylor theory: the interface is stable at k = {} 1/m, no mode grows", k));
  }
  const matched m = match(flow, s.grid, k, s.growth);
  return {k, s.growth, profile_of(flow, s.grid, s.grid.lower, m.lower, m, k, s.growth),
          profile_of(flow, s.grid, s.grid.upper, m.upper, m, k, s.growth)};
}

mode_values at(const mode& m, double y) {
  const mode::profile& side = y < 0.0 ? m.lower : m.upper;
  if (!(y >= side.y.front() && y <= side.y.back())) {
    foundation::fail_input(
        fmt::format("y = {} m lies outside the layers, {} to {} m", y, m.lower.y.front(), m.upper.y.back()));
  }
  const auto value = [&](const std::vector<double>& f) { return barycentric(side.y, f, y); };
  return {value(side.u) / m.growth_rate, value(side.v) / m.growth_rate, value(side.pressure)};
}

}  // namespace tetsuame::theory
