#include <algorithm>
#include <array>
#include <boost/numeric/odeint/integrate/integrate_adaptive.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <cmath>
#include <exact/instability.hpp>
#include <foundation/error.hpp>
#include <optional>

namespace tetsuame::exact {

namespace {

using complex = std::complex<double>;
using state = std::array<double, 4>;  // eta, P: real and imaginary parts

struct mode {
  complex eta, P;
};

struct slopes {
  const layered_flow& flow;
  double k;
  complex c;
  double pressure;  // unit of P in the state

  void operator()(const state& y, state& by_y, double place) const {
    const layer_state s = flow.at(place);
    const complex eta(y[0], y[1]), P = pressure * complex(y[2], y[3]), v = s.U - c, v2 = v * v;
    const complex eta_slope = flow.g * eta / v2 + P * (1.0 / (s.rho * v2) - 1.0 / (flow.gamma * s.p));
    const complex P_slope = s.rho * (k * k * v2 - flow.g * flow.g / v2) * eta - flow.g * P / v2;
    by_y = {eta_slope.real(), eta_slope.imag(), P_slope.real() / pressure, P_slope.imag() / pressure};
  }
};

// The solution that fits an edge; `up`: 1 at the low edge, -1 at the high one.
mode begin(const layered_flow& flow, double k, complex c, double y, edge kind, double up) {
  if (kind == edge::wall) return {0.0, 1.0};
  if (kind == edge::free) return {1.0, 0.0};
  const layer_state s = flow.at(y);
  const complex v2 = (s.U - c) * (s.U - c);
  const complex decay = k * std::sqrt(1.0 - v2 * s.rho / (flow.gamma * s.p));  // Re > 0
  return {1.0, up * s.rho * k * k * v2 / decay};
}

// From one edge to the place of matching, with a break at each jump.
mode carry(const layered_flow& flow, double k, complex c, mode m, double from, double to) {
  namespace odeint = boost::numeric::odeint;
  std::vector<double> stops;
  for (const double y : flow.jumps)
    if (y > std::min(from, to) && y < std::max(from, to)) stops.push_back(y);
  if (to < from) std::ranges::reverse(stops);
  stops.push_back(to);
  // In units that make all of the state of order 1 at the start, for the tolerance's sake.
  const layer_state s = flow.at(from);
  const double pressure = s.rho * k * std::norm(s.U - c), size = std::max(std::abs(m.eta), std::abs(m.P) / pressure);
  const complex eta = m.eta / size, P = m.P / (size * pressure);
  state y{eta.real(), eta.imag(), P.real(), P.imag()};
  auto stepper = odeint::make_controlled(1e-13, 1e-12, odeint::runge_kutta_fehlberg78<state>());
  const slopes inside{flow, k, c, pressure};
  double a = from;
  for (const double b : stops) {
    // The profile is asked within the piece only: at a jump it is that of the piece's side.
    const double edge_of_piece = 1e-12 * (b - a);
    const auto piece = [&](const state& in, state& out, double place) {
      const double low = std::min(a, b) + std::abs(edge_of_piece), high = std::max(a, b) - std::abs(edge_of_piece);
      inside(in, out, std::clamp(place, low, high));
    };
    odeint::integrate_adaptive(stepper, piece, y, a, b, (b - a) / 64.0);
    a = b;
  }
  return {size * complex(y[0], y[1]), size * pressure * complex(y[2], y[3])};
}

// The system integrated from both edges; in the middle it does not match but for a mode. Analytic for Im c > 0.
complex mismatch(const layered_flow& flow, double k, complex c) {
  if (flow.g != 0.0 && (flow.at_low == edge::decaying || flow.at_high == edge::decaying))
    foundation::fail_input("growth of waves: an edge 'decaying' has no meaning under gravity; put a wall there");
  const double middle = 0.5 * (flow.low + flow.high);
  const mode below = carry(flow, k, c, begin(flow, k, c, flow.low, flow.at_low, 1.0), flow.low, middle);
  const mode above = carry(flow, k, c, begin(flow, k, c, flow.high, flow.at_high, -1.0), flow.high, middle);
  // Both grow towards the middle like exp(k y); the factor keeps the product a double.
  return (below.eta * above.P - above.eta * below.P) * std::exp(-k * (flow.high - flow.low));
}

// The mode next to the guess (m/s), by the secant method.
std::optional<complex> search(const layered_flow& flow, double k, complex guess, double width) {
  complex a = guess, b = guess + 1e-3 * width * complex(1.0, 1.0), f_a = mismatch(flow, k, a);
  for (int step = 0; step < 60; ++step) {
    const complex f_b = mismatch(flow, k, b);
    if (f_b == f_a) return std::nullopt;
    complex change = -f_b * (b - a) / (f_b - f_a);
    if (std::abs(change) > 0.3 * width) change *= 0.3 * width / std::abs(change);
    a = b;
    f_a = f_b;
    b += change;
    // The integration has a singular point at Im c = 0.
    if (!(b.imag() > 1e-7 * width) || !(std::abs(b - guess) < 10.0 * width)) return std::nullopt;
    if (std::abs(change) < 1e-11 * std::abs(b)) return b;
  }
  return std::nullopt;
}

struct range {
  double U_low, U_high, width;
};

range speeds(const layered_flow& flow, double k) {
  range r{1e300, -1e300, 0.0};
  constexpr int samples = 257;  // odd: no sample in the middle of the flow
  for (int i = 0; i < samples; ++i) {
    const double U = flow.at(flow.low + (flow.high - flow.low) * (i + 0.5) / (samples + 0.25)).U;
    r.U_low = std::min(r.U_low, U);
    r.U_high = std::max(r.U_high, U);
  }
  r.width = 0.5 * (r.U_high - r.U_low) + std::sqrt(std::abs(flow.g) / k);
  return r;
}

}  // namespace

double rayleigh_taylor_growth(double k, double g, double rho_upper, double rho_lower, double h_upper, double h_lower) {
  const double inertia = rho_upper / std::tanh(k * h_upper) + rho_lower / std::tanh(k * h_lower);
  return std::sqrt(std::max(g * k * (rho_upper - rho_lower) / inertia, 0.0));
}

complex fastest_mode(const layered_flow& flow, double k) {
  const range r = speeds(flow, k);
  complex best = 0.0;
  const int across = r.U_high > r.U_low ? 5 : 1;
  for (int i = 0; i < across; ++i)
    for (const double height : {1.0, 0.7, 0.45, 0.25, 0.1, 0.03}) {
      const double U = r.U_low + (r.U_high - r.U_low) * (i + 0.5) / across;
      const std::optional<complex> c = search(flow, k, {U, height * r.width}, r.width);
      if (c && c->imag() > std::max(best.imag(), 1e-6 * r.width)) best = *c;
    }
  return best;
}

}  // namespace tetsuame::exact
