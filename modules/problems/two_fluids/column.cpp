#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <eos/compression.hpp>
#include <foundation/error.hpp>
#include <two_fluids/column.hpp>

namespace tetsuame::two_fluids {

place at_pressure(const barotropic& b, double pressure) {
  double T = b.temperature;
  if (b.adiabatic && pressure != b.pressure) {
    const auto state = [&](double p, double t) {
      return eos::evaluate(*b.material, eos::density(*b.material, p, t), t);
    };
    const auto slope = [&](double p, double t) {  // γ_th T/K_S = α T/(ρ c_V + γ_th α T ρ c_V), K/Pa
      const double rho = eos::density(*b.material, p, t);
      const auto e = eos::evaluate(*b.material, rho, t);
      return e.alpha * e.K_T * t / (rho * e.c_V * rho * e.sound_speed * e.sound_speed);
    };
    const auto e = state(b.pressure, T);
    const double rho = eos::density(*b.material, b.pressure, T), K_S = rho * e.sound_speed * e.sound_speed;
    const double steps = std::ceil(100.0 * std::abs(pressure - b.pressure) / K_S);
    if (!(steps <= 1e5))
      foundation::fail_calculation(fmt::format(
          "an adiabat from {:.6g} to {:.6g} Pa, beside a bulk modulus of {:.6g} Pa", b.pressure, pressure, K_S));
    const auto n = static_cast<int>(steps);
    const double dp = (pressure - b.pressure) / n;
    double p = b.pressure;
    for (int k = 0; k < n; ++k, p += dp) {
      const double k1 = slope(p, T), k2 = slope(p + 0.5 * dp, T + 0.5 * dp * k1),
                   k3 = slope(p + 0.5 * dp, T + 0.5 * dp * k2), k4 = slope(p + dp, T + dp * k3);
      T += dp * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
    }
  }
  return {pressure, eos::density(*b.material, pressure, T), T};
}

theory::barotrope curve(const barotropic& b) {
  return [b](double p) -> theory::material_state {
    const place here = at_pressure(b, p);
    const auto e = eos::evaluate(*b.material, here.density, here.temperature);
    return {here.density, b.adiabatic ? here.density * e.sound_speed * e.sound_speed : e.K_T};
  };
}

column::column(const barotropic& lower, const barotropic& upper, double interface, double top, double g,
               std::optional<double> cover_from)
    : lower_(lower), upper_(upper), cover_(lower), interface_(interface), cover_from_(cover_from.value_or(top)), g_(g) {
  if (cover_from) {
    descend(cover_, top, cover_from_, cover_.pressure, covering_);
    upper_.pressure = covering_.back().state.pressure;
  }
  descend(upper_, cover_from_, interface, upper_.pressure, above_);
  lower_.pressure = above_.back().state.pressure;
  if (lower_.adiabatic) lower_.temperature = above_.back().state.temperature;
  descend(lower_, interface, 0.0, lower_.pressure, below_);
}

void column::descend(const barotropic& b, double from, double to, double p, std::vector<node>& nodes) const {
  constexpr int n = 256;
  const double dy = (to - from) / n;
  auto on = b;  // from the last node, so that an adiabat is followed once
  on.pressure = p;
  if (b.adiabatic) on.temperature = at_pressure(b, p).temperature;
  const auto slope = [&](double pressure) { return -g_ * at_pressure(on, pressure).density; };
  for (int k = 0;; ++k) {
    const place here = at_pressure(on, p);
    nodes.push_back({from + k * dy, here});
    eos::check_column(*b.material, nodes.front().state.density, nodes.front().state.temperature, nodes.back().y, p,
                      here.density);
    if (k == n) break;
    if (on.adiabatic) {
      on.pressure = p;
      on.temperature = here.temperature;
    }
    const double k1 = slope(p), k2 = slope(p + 0.5 * dy * k1), k3 = slope(p + 0.5 * dy * k2), k4 = slope(p + dy * k3);
    p += dy * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
  }
}

namespace {

double spacing(double from, double to, std::size_t nodes) { return (from - to) / static_cast<double>(nodes - 1); }

std::size_t node_above(double from, double to, std::size_t nodes, double y) {
  const double from_top = std::clamp((from - y) / spacing(from, to, nodes), 0.0, static_cast<double>(nodes - 1));
  return std::min(static_cast<std::size_t>(from_top), nodes - 2);
}

}  // namespace

column::cubic::cubic(const std::vector<node>& nodes, double y)
    : high(nodes[node_above(nodes.front().y, nodes.back().y, nodes.size(), y)]),
      low(*(&high + 1)),
      dy(spacing(nodes.front().y, nodes.back().y, nodes.size())),
      g_dy((low.state.pressure - high.state.pressure) / (0.5 * (low.state.density + high.state.density))) {
  const double from_top = std::clamp((nodes.front().y - y) / dy, 0.0, static_cast<double>(nodes.size() - 1));
  t = from_top - static_cast<double>(&high - nodes.data());
}

double column::cubic::pressure() const {
  const double s = 1.0 - t;
  return s * s * (1.0 + 2.0 * t) * high.state.pressure + t * t * (3.0 - 2.0 * t) * low.state.pressure +
         g_dy * (s * s * t * high.state.density - t * t * s * low.state.density);
}

double column::cubic::slope() const {
  const double s = 1.0 - t,
               by_t = 6.0 * s * t * (low.state.pressure - high.state.pressure) +
                      g_dy * (s * (1.0 - 3.0 * t) * high.state.density - t * (2.0 - 3.0 * t) * low.state.density);
  return -by_t / dy;
}

// ρ and T on the material's curve.
place column::between(const barotropic& b, const std::vector<node>& nodes, double y) {
  const cubic at(nodes, y);
  auto on = b;
  on.pressure = at.high.state.pressure;
  on.temperature = at.high.state.temperature;
  return at_pressure(on, at.pressure());
}

column::pressure_at_rest column::pressure(double y) const {
  const auto& nodes = !covering_.empty() && y >= cover_from_ ? covering_ : y >= interface_ ? above_ : below_;
  const cubic at(nodes, y);
  const double top = covering_.empty() ? above_.front().y : covering_.front().y;
  return {at.pressure(), y >= top || y <= 0.0 ? 0.0 : at.slope()};
}

place column::at(double y) const {
  if (!covering_.empty() && y >= cover_from_) return between(cover_, covering_, y);
  return y >= interface_ ? between(upper_, above_, y) : between(lower_, below_, y);
}

}  // namespace tetsuame::two_fluids
