#include <cmath>
#include <dem/damping.hpp>

namespace tetsuame::dem {

// y'' = -y^a - α y^b y', from y = 0, y' = 1, in steps of the classical Runge-Kutta method until the right-hand side is
// no longer negative. Hertz: a = 3/2, b = 1/4; Hooke: a = 1, b = 0.
double restitution_of(contact_model model, double alpha) {
  const bool hertz = model == contact_model::hertz_mindlin;
  const auto force = [&](double y, double v) {
    if (!(y > 0.0)) return hertz ? 0.0 : alpha * v;
    return hertz ? y * std::sqrt(y) + alpha * std::sqrt(std::sqrt(y)) * v : y + alpha * v;
  };
  // The contact lasts some 3 units of time, longer where it creeps apart.
  const double dt = 1e-4 / std::fmax(1.0, alpha);
  double y = 0.0, v = 1.0;
  for (bool first = true;; first = false) {
    const double a1 = -force(y, v);
    if (!first && !(a1 < 0.0)) break;
    const double a2 = -force(y + 0.5 * dt * v, v + 0.5 * dt * a1), v2 = v + 0.5 * dt * a1;
    const double a3 = -force(y + 0.5 * dt * v2, v + 0.5 * dt * a2), v3 = v + 0.5 * dt * a2;
    const double a4 = -force(y + dt * v3, v + dt * a3), v4 = v + dt * a3;
    const double next_y = y + dt / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
    const double next_v = v + dt / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    if (!(next_y > 0.0) || !(next_v < v)) break;
    y = next_y;
    v = next_v;
  }
  return std::fmax(0.0, -v);
}

double damping_for(contact_model model, double restitution) {
  if (restitution >= 1.0) return 0.0;
  double low = 0.0, high = 1.0;
  while (restitution_of(model, high) > restitution) high *= 2.0;
  for (int n = 0; n < 50; ++n) {
    const double middle = 0.5 * (low + high);
    (restitution_of(model, middle) > restitution ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace tetsuame::dem
