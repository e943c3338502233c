#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <eos/tillotson.hpp>
#include <foundation/error.hpp>
#include <limits>
#include <utility>

namespace tetsuame::eos {

namespace {

constexpr std::array<tillotson_parameters, 3> materials{{
    {"iron", 7800.0, 128e9, 105e9, 0.5, 1.5, 9.5e6, 2.4e6, 8.67e6, 5.0, 5.0},
    {"granite", 2680.0, 18e9, 18e9, 0.5, 1.3, 1.6e7, 3.5e6, 1.8e7, 5.0, 5.0},
    {"basalt", 2700.0, 26.7e9, 26.7e9, 0.5, 1.5, 4.87e8, 4.72e6, 1.82e7, 5.0, 5.0},
}};

// Steps of the isentrope: the error of u_s is below 1e-9 of E0 (fourth order).
constexpr std::size_t intervals = 256;

struct slopes {
  double u, ln_T;  // d/d ln rho
};

slopes isentrope_slopes(const tillotson_parameters& m, double L, double u) {
  const double rho = m.rho0 * std::exp(L);
  const tillotson_state s = tillotson_pressure(m, rho, u);
  return {s.p / rho, s.p_u / rho};
}

}  // namespace

const tillotson_parameters& find_tillotson(std::string_view material) {
  for (const tillotson_parameters& m : materials)
    if (m.material == material) return m;
  foundation::fail_input(
      fmt::format("there is no Tillotson material '{}': choose one of iron, granite, basalt", material));
}

tillotson_state tillotson_pressure(const tillotson_parameters& m, double rho, double u) {
  const double eta = rho / m.rho0, mu = eta - 1.0;
  const double omega = u / (m.E0 * eta * eta) + 1.0;
  // d(b/omega)/d rho = 2 (b/omega)(omega - 1)/(omega rho); d(rho u b/omega)/du = rho b/omega^2
  const double g = m.b / omega, g_rho = 2.0 * g * (omega - 1.0) / omega;
  const tillotson_state condensed{(m.a + g) * rho * u + m.A * mu + m.B * mu * mu,
                                  (m.a + g + g_rho) * u + (m.A + 2.0 * m.B * mu) / m.rho0, (m.a + g / omega) * rho};
  if (rho >= m.rho0 || u <= m.E_iv) return condensed;

  const double z = 1.0 / eta - 1.0, z_rho = -(1.0 + z) / rho;
  const double damp = std::exp(-m.alpha * z * z), cold = m.A * mu * std::exp(-m.beta * z);
  const double bracket = g * rho * u + cold;
  const double bracket_rho = (g + g_rho) * u + m.A / m.rho0 * std::exp(-m.beta * z) - m.beta * z_rho * cold;
  const tillotson_state expanded{m.a * rho * u + bracket * damp,
                                 m.a * u + (bracket_rho - 2.0 * m.alpha * z * z_rho * bracket) * damp,
                                 (m.a + g / omega * damp) * rho};
  if (u >= m.E_cv) return expanded;

  const double s = (u - m.E_iv) / (m.E_cv - m.E_iv);
  return {s * expanded.p + (1.0 - s) * condensed.p, s * expanded.p_rho + (1.0 - s) * condensed.p_rho,
          s * expanded.p_u + (1.0 - s) * condensed.p_u + (expanded.p - condensed.p) / (m.E_cv - m.E_iv)};
}

tillotson::tillotson(description about_, const tillotson_parameters& material_, double T0_, double c_V_)
    : about(std::move(about_)),
      material(material_),
      T0(T0_),
      c_V(c_V_),
      step_(std::log(largest_compression) / static_cast<double>(intervals)) {
  table_.reserve(intervals + 1);
  double u = 0.0, ln_T = std::log(T0);
  for (std::size_t k = 0; k <= intervals; ++k) {  // fourth-order Runge-Kutta
    const double L = step_ * static_cast<double>(k), h = step_;
    const slopes s1 = isentrope_slopes(material, L, u);
    table_.push_back({u, s1.u, ln_T, s1.ln_T});
    const slopes s2 = isentrope_slopes(material, L + 0.5 * h, u + 0.5 * h * s1.u);
    const slopes s3 = isentrope_slopes(material, L + 0.5 * h, u + 0.5 * h * s2.u);
    const slopes s4 = isentrope_slopes(material, L + h, u + h * s3.u);
    u += h / 6.0 * (s1.u + 2.0 * (s2.u + s3.u) + s4.u);
    ln_T += h / 6.0 * (s1.ln_T + 2.0 * (s2.ln_T + s3.ln_T) + s4.ln_T);
  }
}

tillotson::isentrope_point tillotson::isentrope(double rho) const {
  const double L = std::log(rho / material.rho0);
  if (!(L > 0.0)) {
    const double gamma = material.a + material.b;
    const double T = T0 * std::exp(gamma * L);
    return {0.0, T, 0.0, gamma * T / rho};
  }
  const double position = L / step_;
  if (!(position <= static_cast<double>(intervals) * (1.0 + 1e-12))) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, nan, nan, nan};
  }
  const std::size_t k = std::min(static_cast<std::size_t>(position), intervals - 1);
  const double t = position - static_cast<double>(k), s = 1.0 - t;
  // Hermite's cubic in t on [0, 1] and its derivative, from values v and slopes d.
  const auto value = [&](double v0, double d0, double v1, double d1) {
    return s * s * ((1.0 + 2.0 * t) * v0 + t * step_ * d0) + t * t * ((3.0 - 2.0 * t) * v1 - s * step_ * d1);
  };
  const auto slope = [&](double v0, double d0, double v1, double d1) {
    return 6.0 * s * t * (v1 - v0) / step_ + s * (1.0 - 3.0 * t) * d0 + t * (3.0 * t - 2.0) * d1;
  };
  const node &n0 = table_[k], &n1 = table_[k + 1];
  const double T = std::exp(value(n0.ln_T, n0.ln_T_slope, n1.ln_T, n1.ln_T_slope));
  return {value(n0.u, n0.u_slope, n1.u, n1.u_slope), T, slope(n0.u, n0.u_slope, n1.u, n1.u_slope) / rho,
          slope(n0.ln_T, n0.ln_T_slope, n1.ln_T, n1.ln_T_slope) * T / rho};
}

double tillotson::internal_energy(double rho, double T) const {
  const isentrope_point s = isentrope(rho);
  return s.u + c_V * (T - s.T);
}

double tillotson::temperature(double rho, double u) const {
  const isentrope_point s = isentrope(rho);
  return s.T + (u - s.u) / c_V;
}

double tillotson::pressure(double rho, double T) const {
  return tillotson_pressure(material, rho, internal_energy(rho, T)).p;
}

properties tillotson::evaluate(double rho, double T) const {
  const isentrope_point s = isentrope(rho);
  const tillotson_state state = tillotson_pressure(material, rho, s.u + c_V * (T - s.T));
  const double K_T = rho * (state.p_rho + state.p_u * (s.u_slope - c_V * s.T_slope));
  const double c2 = state.p_rho + state.p * state.p_u / (rho * rho);
  return {state.p, K_T, c_V * state.p_u / K_T, c_V, std::sqrt(c2)};
}

double tillotson::density(double p, double T) const {
  return invert(*this, p, T, {1e-6 * material.rho0, material.rho0, largest_compression * material.rho0});
}

}  // namespace tetsuame::eos
