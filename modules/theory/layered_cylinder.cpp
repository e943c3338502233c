#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <boost/math/special_functions/bessel.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <foundation/error.hpp>
#include <numbers>
#include <theory/layered_cylinder.hpp>

namespace tetsuame::theory {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Over the planet's radius: thicker boundary layers are as of creeping flow to 1e-6, thinner ones overflow.
constexpr double least_wave_number = 1e-3, largest_wave_number = 600.0;

// A solution of the stream function ψ sin mθ, (∇² - k²) ∇² ψ = 0, with u = (m ψ/r cos mθ, -ψ' sin mθ).
struct stream_solution {
  double value, slope, vorticity;  // ψ, ψ', ∇²ψ
  double pressure;                 // over the viscosity
};

// Those that stay finite on the axis: r^m and (I_m(kr) m! (2/k)^m - r^m)/k², whose limit for k = 0 is
// r^(m+2)/(4 m + 4); and r^-m and (K_m(kr) 2 (k/2)^m/(m - 1)! - r^-m)/k². Lengths are in units of the layer's outer
// radius.
std::array<stream_solution, 4> solutions(std::size_t degree, double k, double r, bool on_axis) {
  const auto n = static_cast<int>(degree);
  const auto m = static_cast<double>(degree);
  const double up = std::pow(r, m), k2 = k * k, x = k * r;
  std::array<stream_solution, 4> all{};
  all[0] = {up, m * up / r, 0.0, -k2 * up};
  double factorial = 1.0;
  for (int j = 2; j < n; ++j) factorial *= j;  // (m - 1)!
  if (x < 2.0) {
    double term = up, sum = 0.0, slope = 0.0, vorticity = up;
    for (int j = 1; j < 30; ++j) {
      term *= r * r / (4.0 * j * (m + j));  // times k^(2 j) below
      const double power = std::pow(k2, j - 1);
      sum += term * power;
      slope += term * power * (m + 2.0 * j) / r;
      vorticity += term * power * k2;
    }
    all[1] = {sum, slope, vorticity, up};
  } else {
    const double scale = factorial * m * std::pow(2.0 / k, m);
    const double value = scale * boost::math::cyl_bessel_i(n, x);
    const double slope = k * scale * boost::math::cyl_bessel_i(n - 1, x) - m / r * value;
    all[1] = {(value - up) / k2, (slope - m * up / r) / k2, value, up};
  }
  if (on_axis) return all;
  const double down = 1.0 / up, scale = 2.0 * std::pow(0.5 * k, m) / factorial;
  const double value = scale * boost::math::cyl_bessel_k(n, x);
  const double slope = -k * scale * boost::math::cyl_bessel_k(n - 1, x) - m / r * value;
  all[2] = {down, -m * down / r, 0.0, k2 * down};
  all[3] = {(value - down) / k2, (slope + m * down / r) / k2, value, -down};
  return all;
}

// Of a unit of each solution at r: outwards, along θ, shear stress, normal stress, the stresses over the viscosity.
struct boundary_values {
  std::array<std::array<double, 4>, 4> of;
};
enum quantity : std::size_t { radial, tangential, shear, normal };

boundary_values values_at(std::size_t degree, double k, double r, bool on_axis) {
  const auto m = static_cast<double>(degree);
  boundary_values v{};
  const auto all = solutions(degree, k, r, on_axis);
  for (std::size_t s = 0; s < 4; ++s) {
    const auto& f = all[s];
    v.of[radial][s] = m * f.value / r;
    v.of[tangential][s] = -f.slope;
    v.of[shear][s] = 2.0 * f.slope / r - 2.0 * m * m * f.value / (r * r) - f.vorticity;
    v.of[normal][s] = 2.0 * m * (f.slope - f.value / r) / r - f.pressure;
  }
  return v;
}

class problem {
 public:
  problem(const layered_cylinder& c, std::size_t degree) : c_(c), degree_(degree), R_(c.layers.back().outer_radius) {
    double mass = 0.0, inner = 0.0;  // kg/m
    for (std::size_t n = 0; n < size(); ++n) {
      const auto& l = c.layers[n];
      mass += std::numbers::pi * l.density * (l.outer_radius * l.outer_radius - inner * inner);
      inner = l.outer_radius;
      jump_.push_back(l.density - (n + 1 < size() ? c.layers[n + 1].density : 0.0));
      gravity_.push_back(2.0 * c.gravitational_constant * mass / inner);
    }
  }
  std::size_t size() const { return c_.layers.size(); }
  double jump(std::size_t n) const { return jump_[n]; }
  // 1/s, of a wave at the surface.
  double scale() const { return std::sqrt(*std::ranges::max_element(gravity_) / R_); }

  // What the weight of displaced interfaces gives, by area: symmetric, N/m² a metre.
  MatrixXd weight() const {
    const auto m = static_cast<double>(degree_);
    MatrixXd K(rows(), rows());
    for (std::size_t a = 0; a < size(); ++a)
      for (std::size_t b = 0; b < size(); ++b) {
        const double x = radius(a), y = radius(b), ratio = std::min(x, y) / std::max(x, y);
        double value = -2.0 * std::numbers::pi * c_.gravitational_constant / m * y * jump_[b] * std::pow(ratio, m);
        if (a == b) value += gravity_[a];
        K(static_cast<Index>(a), static_cast<Index>(b)) = x * jump_[a] * value;
      }
    return K;
  }

  double wave_number(std::size_t n, double growth) const {
    const double k = std::sqrt(c_.layers[n].density * growth / c_.layers[n].viscosity);
    if (k * R_ > largest_wave_number)
      foundation::fail_calculation(
          "theory of a layered cylinder: the viscosity is so low that boundary layers are thinner than 1/600 of the "
          "radius");
    return std::max(k, least_wave_number / R_);
  }

  // Factors of the solutions of all layers, one after the other, for a velocity of 1 of each interface.
  MatrixXd respond(double growth) const {
    const auto unknowns = static_cast<Index>(4 * size() - 2);
    MatrixXd system = MatrixXd::Zero(unknowns, unknowns), right = MatrixXd::Zero(unknowns, rows());
    Index row = 0;
    for (std::size_t n = 0; n < size(); ++n) {
      const bool surface = n + 1 == size();
      put(system, row, n, radius(n), growth, radial, 1.0);
      right(row++, static_cast<Index>(n)) = 1.0;
      if (!surface) {
        put(system, row, n + 1, radius(n), growth, radial, 1.0);
        right(row++, static_cast<Index>(n)) = 1.0;
        put(system, row, n, radius(n), growth, tangential, 1.0);
        put(system, row++, n + 1, radius(n), growth, tangential, -1.0);
        put(system, row, n + 1, radius(n), growth, shear, -c_.layers[n + 1].viscosity);
      }
      put(system, row, n, radius(n), growth, shear, c_.layers[n].viscosity);
      ++row;
    }
    const VectorXd columns = system.cwiseAbs().colwise().maxCoeff().cwiseInverse();
    system = system * columns.asDiagonal();
    for (Index i = 0; i < unknowns; ++i) {
      const double by = 1.0 / system.row(i).cwiseAbs().maxCoeff();
      system.row(i) *= by;
      right.row(i) *= by;
    }
    return columns.asDiagonal() * system.fullPivLu().solve(right);
  }

  // Inertia, friction and weight: σ A + K, whose least eigenvalue rises with σ.
  MatrixXd balance(double growth) const {
    const MatrixXd factors = respond(growth);
    MatrixXd A(rows(), rows());
    for (std::size_t n = 0; n < size(); ++n) {
      MatrixXd stress = MatrixXd::Zero(1, factors.rows());
      put(stress, 0, n, radius(n), growth, normal, c_.layers[n].viscosity);
      if (n + 1 < size()) put(stress, 0, n + 1, radius(n), growth, normal, -c_.layers[n + 1].viscosity);
      A.row(static_cast<Index>(n)) = radius(n) * (stress * factors);
    }
    const MatrixXd all = growth * A + weight();
    return 0.5 * (all + all.transpose());
  }
  double least(double growth) const {
    return Eigen::SelfAdjointEigenSolver<MatrixXd>(balance(growth), Eigen::EigenvaluesOnly).eigenvalues()[0];
  }

  cylinder_mode mode(double growth) const {
    cylinder_mode found;
    found.degree = degree_;
    found.growth_rate = growth;
    VectorXd shape = Eigen::SelfAdjointEigenSolver<MatrixXd>(balance(growth)).eigenvectors().col(0);
    double most = 0.0;
    for (std::size_t n = 0; n < size(); ++n)
      if (const double moved = std::abs(shape[static_cast<Index>(n)]); jump_[n] < 0.0 && moved > most) {
        most = moved;
        found.fastest = n;
      }
    shape /= shape[static_cast<Index>(found.fastest)];
    // Creeping, a motion of the whole balances as well as the mode does: that part is what has the momentum.
    if (degree_ == 1) {
      double momentum = 0.0, mass = 0.0;
      for (std::size_t n = 0; n < size(); ++n) {
        const double per_metre = jump_[n] * radius(n) * radius(n);
        momentum += per_metre * shape[static_cast<Index>(n)];
        mass += per_metre;
      }
      shape.array() -= momentum / mass;
      shape /= shape[static_cast<Index>(found.fastest)];
    }
    found.displacement.assign(shape.begin(), shape.end());
    const VectorXd factors = respond(growth) * shape;
    for (std::size_t n = 0; n < size(); ++n) {
      const auto from = factors.begin() + static_cast<Index>(first(n));
      found.streams.push_back(
          {n == 0 ? 0.0 : radius(n - 1), radius(n), wave_number(n, growth), {from, from + (n == 0 ? 2 : 4)}});
    }
    return found;
  }

 private:
  Index rows() const { return static_cast<Index>(size()); }
  double radius(std::size_t n) const { return c_.layers[n].outer_radius; }
  static std::size_t first(std::size_t n) { return n == 0 ? 0 : 4 * n - 2; }
  // Adds `sign` times a quantity at r of the layer n; its lengths are in units of its outer radius.
  void put(MatrixXd& to, Index row, std::size_t n, double r, double growth, quantity q, double sign) const {
    const double unit = radius(n);
    const auto v = values_at(degree_, wave_number(n, growth) * unit, r / unit, n == 0);
    const double of_stress = q == shear || q == normal ? 1.0 / unit : 1.0;
    for (std::size_t s = 0; s < (n == 0 ? 2U : 4U); ++s)
      to(row, static_cast<Index>(first(n) + s)) += sign * of_stress * v.of[q][s];
  }

  const layered_cylinder& c_;
  std::size_t degree_;
  double R_;
  std::vector<double> jump_, gravity_;  // kg/m³, m/s²
};

}  // namespace

cylinder_mode::vector cylinder_mode::at(double r) const {
  const auto in = std::ranges::find_if(streams, [r](const stream& s) { return r < s.outer; });
  const stream& s = in == streams.end() ? streams.back() : *in;
  // On the axis: the limit, in which only degree 1 moves.
  const double within = std::clamp(r / s.outer, 1e-12, 1.0);
  const auto v = values_at(degree, s.wave_number * s.outer, within, s.inner == 0.0);
  vector sum{0.0, 0.0};
  for (std::size_t k = 0; k < s.factors.size(); ++k) {
    sum.radial += s.factors[k] * v.of[radial][k];
    sum.tangential += s.factors[k] * v.of[tangential][k];
  }
  return sum;
}

cylinder_mode growing_mode(const layered_cylinder& cylinder, std::size_t degree) {
  const problem p(cylinder, degree);
  bool inverted = false;
  for (std::size_t n = 0; n < p.size(); ++n) inverted = inverted || p.jump(n) < 0.0;
  const MatrixXd K = p.weight();
  const VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<MatrixXd>(K, Eigen::EigenvaluesOnly).eigenvalues();
  if (!inverted || eigenvalues[0] > -1e-10 * eigenvalues.cwiseAbs().maxCoeff()) return {};
  const auto f = [&](double log_growth) { return p.least(std::exp(log_growth)); };
  double high = std::log(0.1 * p.scale()), at_high = f(high);
  double low = high, at_low = at_high;
  while (at_high < 0.0) {
    low = high, at_low = at_high;
    high += 1.0, at_high = f(high);
  }
  while (at_low >= 0.0) {
    high = low, at_high = at_low;
    low -= 1.0, at_low = f(low);
  }
  std::uintmax_t most = 100;
  const auto found = boost::math::tools::toms748_solve(f, low, high, at_low, at_high,
                                                       boost::math::tools::eps_tolerance<double>(46), most);
  return p.mode(std::exp(0.5 * (found.first + found.second)));
}

}  // namespace tetsuame::theory
