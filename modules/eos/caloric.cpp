#include <cmath>
#include <eos/caloric.hpp>

namespace tetsuame::eos {

namespace {

// Of equations of state with an energy of their own; Tillotson's begins from it, and has its own sound.
template <class Material>
concept has_energy = requires(const Material& m, double x) {
  m.internal_energy(x, x);
  m.temperature(x, x);
};

bool knows_energy(const any& material) {
  return std::visit([]<class Material>(const Material&) { return has_energy<Material>; }, material);
}

}  // namespace

caloric::caloric(any material) : material_(std::move(material)), has_own_energy_(knows_energy(material_)) {
  if (has_own_energy_) return;
  std::visit(
      [&](const auto& m) {
        if constexpr (requires { m.thermal; })
          rho0_ = m.rho0, T0_ = m.thermal.T0;
        else if constexpr (requires {
                             m.rho0;
                             m.T0;
                           })
          rho0_ = m.rho0, T0_ = m.T0;
      },
      material_);
  if (T0_ == 0.0) return;
  // Cubic pieces with the slope of the integrand, whose integral Simpson's rule takes from node to node: with 1024
  // steps both errors are below 1e-9 of K/rho.
  constexpr int half = 512;
  constexpr double reach = 2.302585092994046;  // ln 10
  step_ = reach / half;
  low_ = -reach;
  table_.resize(2 * half + 1);
  const auto slope = [&](double L) {
    const double r = rho0_ * std::exp(L);
    const properties s = evaluate(material_, r, T0_);
    return (s.p - T0_ * s.alpha * s.K_T) / r;
  };
  const heat here = capacity(rho0_);
  table_[half] = {T0_ * (here.a + 0.5 * here.b * T0_), slope(0.0)};
  for (const int way : {-1, 1})
    for (int k = 1; k <= half; ++k) {
      const part& last = table_[static_cast<std::size_t>(half + way * (k - 1))];
      part& next = table_[static_cast<std::size_t>(half + way * k)];
      const double L = way * k * step_, middle = slope(L - 0.5 * way * step_);
      next.slope = slope(L);
      next.u = last.u + way * step_ / 6.0 * (last.slope + 4.0 * middle + next.slope);
    }
}

caloric::part caloric::isotherm(double rho) const {
  if (table_.empty()) {
    const auto* stiff = std::get_if<stiffened_gas>(&material_);
    const double u = stiff != nullptr ? stiff->p_infinity / rho : 0.0;
    return {u, -u};
  }
  const double place = (std::log(rho / rho0_) - low_) / step_;
  const auto last = static_cast<double>(table_.size() - 1);
  if (!(place >= 0.0 && place <= last)) return {nan, nan};
  const auto k = std::min(static_cast<std::size_t>(place), table_.size() - 2);
  const double t = place - static_cast<double>(k), s = 1.0 - t;
  const part &a = table_[k], &b = table_[k + 1];
  // Hermite's cubic and its derivative
  const double rise = b.u - a.u, da = step_ * a.slope, db = step_ * b.slope;
  return {a.u * s * s * (1.0 + 2.0 * t) + b.u * t * t * (3.0 - 2.0 * t) + s * t * (da * s - db * t),
          (6.0 * s * t * rise + da * s * (1.0 - 3.0 * t) + db * t * (3.0 * t - 2.0)) / step_};
}

caloric::heat caloric::capacity(double rho) const {
  return std::visit(
      [&]<class Material>(const Material& m) -> heat {
        if constexpr (has_energy<Material>) {
          return {nan, nan, nan};  // asks for none
        } else if constexpr (requires { m.thermal; }) {
          const thermal_part& t = m.thermal;
          const double e = t.e0 == 0.0 ? 0.0 : t.e0 * std::pow(rho / m.rho0, -t.g);
          return {t.c, 2.0 * t.c * e, -t.g};
        } else {
          return {m.c_V, 0.0, 0.0};
        }
      },
      material_);
}

double caloric::internal_energy(double rho, double T) const {
  return std::visit(
      [&]<class Material>(const Material& m) {
        if constexpr (has_energy<Material>) {
          return m.internal_energy(rho, T);
        } else {
          const heat c = capacity(rho);
          return isotherm(rho).u + (T - T0_) * (c.a + 0.5 * c.b * (T + T0_));
        }
      },
      material_);
}

double caloric::temperature(double rho, double u) const { return at(rho, u).T; }

caloric_state caloric::at(double rho, double u) const {
  if (const auto* own = std::get_if<tillotson>(&material_)) {
    const double T = own->temperature(rho, u);
    const tillotson_state s = tillotson_pressure(own->material, rho, u);
    // Beyond its table T is not a number, and no sound is then known either.
    return {s.p, T, std::isnan(T) ? nan : std::sqrt(s.p_rho + s.p * s.p_u / (rho * rho))};
  }
  if (has_own_energy_) {
    const double T = std::visit(
        [&]<class Material>(const Material& m) {
          if constexpr (has_energy<Material>) return m.temperature(rho, u);
          return nan;
        },
        material_);
    const properties s = evaluate(material_, rho, T);
    return {s.p, T, s.sound_speed};
  }
  const part cold = isotherm(rho);
  const heat c = capacity(rho);
  // b/2 dT^2 + c_V(T0) dT = gained, in the form that stands b = 0
  const double gained = u - cold.u, of_T0 = c.a + c.b * T0_;
  const double T = T0_ + 2.0 * gained / (of_T0 + std::sqrt(of_T0 * of_T0 + 2.0 * c.b * gained));
  const properties s = evaluate(material_, rho, T);
  const double u_rho = (cold.slope + 0.5 * c.slope * c.b * (T * T - T0_ * T0_)) / rho;
  const double c2 = s.K_T / rho + s.alpha * s.K_T / s.c_V * (s.p / (rho * rho) - u_rho);
  return {s.p, T, std::sqrt(c2)};
}

double caloric::stiffening(double rho, double u) const {
  constexpr double d = 1e-4;
  const auto neighbour = [&](double step) {
    // du = p/rho^2 drho, by the middle
    const double middle = rho * std::exp(0.5 * step), end = rho * std::exp(step);
    const double half = u + 0.5 * step * at(rho, u).p / rho;
    return std::pair{end, at(end, u + step * at(middle, half).p / middle)};
  };
  const auto [up, above] = neighbour(d);
  const auto [down, below] = neighbour(-d);
  return (up * above.c * above.c - down * below.c * below.c) / (above.p - below.p);
}

}  // namespace tetsuame::eos
