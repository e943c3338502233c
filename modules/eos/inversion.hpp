// Density of given pressure and temperature, for an equation of state without a closed inverse: Newton steps in ln rho,
// of at most 20 %, kept inside a bracket that shrinks. The bracket's lower end may be a state beyond the spinodal
// (K_T <= 0), so the root found lies on the stable branch that reaches up to the highest density searched.
#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <foundation/error.hpp>
#include <limits>
#include <optional>

namespace tetsuame::eos {

// kg/m^3, 0 < low < start < high; the search stays inside.
struct density_search {
  double low, start, high;
};

namespace detail {

struct bracket {
  double low, high;   // kg/m^3
  bool below, above;  // whether p(low) < p on the stable branch and p(high) >= p were seen
  std::optional<double> root;
};

template <class Eos>
bracket search(const Eos& eos, double p, double T, const density_search& range) {
  constexpr double epsilon = std::numeric_limits<double>::epsilon(), largest_step = 0.2;
  bracket b{range.low, range.high, false, false, std::nullopt};
  double rho = range.start;
  while (b.high > b.low * (1.0 + 2.0 * epsilon)) {
    const auto state = eos.evaluate(rho, T);
    const bool stable = state.K_T > 0.0;
    const double step = stable ? std::clamp((p - state.p) / state.K_T, -largest_step, largest_step) : largest_step;
    if (std::abs(step) <= epsilon) {
      b.root = rho;
      return b;
    }
    if (stable && state.p >= p) {
      b.high = rho;
      b.above = true;
    } else {
      b.low = rho;
      b.below = stable;
    }
    rho *= std::exp(step);
    if (!(rho > b.low && rho < b.high)) rho = std::sqrt(b.low * b.high);
    if (!(rho > b.low && rho < b.high)) break;  // neighbouring doubles
  }
  if (b.below && b.above) b.root = b.high;
  return b;
}

}  // namespace detail

// kg/m^3, of p in Pa and T in K; fail_calculation with the pressures that can be had at
// this temperature if p is not one of them.
template <class Eos>
double invert(const Eos& eos, double p, double T, const density_search& range) {
  if (std::isfinite(p) && std::isfinite(T) && T >= 0.0) {
    const detail::bracket b = detail::search(eos, p, T, range);
    if (b.root) return *b.root;
  }
  const double least = std::isfinite(T) ? detail::search(eos, -std::numeric_limits<double>::infinity(), T, range).high
                                        : std::numeric_limits<double>::quiet_NaN();
  foundation::fail_calculation(fmt::format(
      "equation of state '{}': no density has p = {:g} Pa at T = {:g} K; with T >= 0 and at this temperature the "
      "pressure goes from {:g} Pa (at {:g} kg/m^3) to {:g} Pa (at {:g} kg/m^3): check the initial pressure and "
      "temperature, or the material's parameters",
      eos.about.name, p, T, eos.evaluate(least, T).p, least, eos.evaluate(range.high, T).p, range.high));
}

}  // namespace tetsuame::eos
