#include <fmt/core.h>

#include <array>
#include <boost/math/interpolators/cubic_hermite.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>
#include <cmath>
#include <eos/tillotson.hpp>
#include <foundation/error.hpp>
#include <utility>
#include <vector>

namespace tetsuame::eos {

namespace {

constexpr std::array<tillotson_parameters, 3> materials{{
    {"iron", 7800.0, 128e9, 105e9, 0.5, 1.5, 9.5e6, 2.4e6, 8.67e6, 5.0, 5.0, 449.0},
    {"granite", 2680.0, 18e9, 18e9, 0.5, 1.3, 1.6e7, 3.5e6, 1.8e7, 5.0, 5.0, 790.0},
    {"basalt", 2700.0, 26.7e9, 26.7e9, 0.5, 1.5, 4.87e8, 4.72e6, 1.82e7, 5.0, 5.0, 840.0},
}};

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

// By ln(rho/rho0): u_s and ln T_s.
struct tillotson::curves {
  using curve = boost::math::interpolators::cardinal_cubic_hermite<std::vector<double>>;
  curve u, ln_T;
};

tillotson::tillotson(description about_, const tillotson_parameters& material_, double T0_, double c_V_)
    : about(std::move(about_)), material(material_), T0(T0_), c_V(c_V_) {
  // Steps of the isentrope: the error of u_s is below 1e-9 of E0 (fourth order). One more than is asked for, so that
  // rounding finds a piece at the end.
  constexpr int intervals = 256;
  const double step = std::log(largest_compression) / intervals;
  using state = std::array<double, 2>;  // u_s, ln T_s
  const auto slopes = [&](const state& y, state& by_L, double L) {
    const double rho = material.rho0 * std::exp(L);
    const tillotson_state s = tillotson_pressure(material, rho, y[0]);
    by_L = {s.p / rho, s.p_u / rho};
  };
  boost::numeric::odeint::runge_kutta4<state> stepper;
  state y{0.0, std::log(T0)};
  std::vector<double> u, u_slope, ln_T, ln_T_slope;
  for (int k = 0; k <= intervals + 1; ++k) {
    state by_L;
    slopes(y, by_L, step * k);
    u.push_back(y[0]);
    u_slope.push_back(by_L[0]);
    ln_T.push_back(y[1]);
    ln_T_slope.push_back(by_L[1]);
    stepper.do_step(slopes, y, step * k, step);
  }
  curves_ = std::make_shared<const curves>(
      curves{{std::move(u), std::move(u_slope), 0.0, step}, {std::move(ln_T), std::move(ln_T_slope), 0.0, step}});
}

tillotson::isentrope_point tillotson::isentrope(double rho) const {
  const double L = std::log(rho / material.rho0);
  if (!(L > 0.0)) {
    const double gamma = material.a + material.b;
    const double T = T0 * std::exp(gamma * L);
    return {0.0, T, 0.0, gamma * T / rho};
  }
  if (!(rho <= material.rho0 * largest_compression * (1.0 + 1e-12))) {
    return {nan, nan, nan, nan};
  }
  const auto& [u, ln_T] = *curves_;
  const double T = std::exp(ln_T(L));
  return {u(L), T, u.prime(L) / rho, ln_T.prime(L) * T / rho};
}

double tillotson::internal_energy(double rho, double T) const {
  const isentrope_point s = isentrope(rho);
  return s.u + c_V * (T - s.T);
}

double tillotson::temperature(double rho, double u) const {
  const isentrope_point s = isentrope(rho);
  return s.T + (u - s.u) / c_V;
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
