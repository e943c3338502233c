#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <exact/norms.hpp>
#include <foundation/error.hpp>
#include <foundation/exact_sum.hpp>
#include <vector>

namespace tetsuame::exact {

error_norms norms(std::span<const double> value, std::span<const double> exact, std::span<const double> weight) {
  if (value.empty() || value.size() != exact.size() || value.size() != weight.size())
    foundation::fail_input(fmt::format("error norms: {} values, {} exact ones, {} weights; must be equal and above 0",
                                       value.size(), exact.size(), weight.size()));
  foundation::exact_sum w, we, wee;
  double maximum = 0.0;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const double e = std::abs(value[i] - exact[i]);
    w.add(weight[i]);
    we.add(weight[i] * e);
    wee.add(weight[i] * e * e);
    if (!(e <= maximum)) maximum = std::isnan(maximum) ? maximum : e;
  }
  return {we.value() / w.value(), std::sqrt(wee.value() / w.value()), maximum};
}

error_norms norms(std::span<const double> value, std::span<const double> exact) {
  return norms(value, exact, std::vector<double>(value.size(), 1.0));
}

order_fit fit_order(std::span<const double> spacing, std::span<const double> error) {
  const auto positive = [](double x) { return x > 0.0 && std::isfinite(x); };
  if (spacing.size() != error.size() || !std::ranges::all_of(spacing, positive) ||
      !std::ranges::all_of(error, positive))
    foundation::fail_input("order of a scheme: as many spacings as errors are needed, all above 0 and finite");
  const double n = static_cast<double>(spacing.size());
  double x_mean = 0.0, y_mean = 0.0, xx = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < spacing.size(); ++i) {
    x_mean += std::log(spacing[i]) / n;
    y_mean += std::log(error[i]) / n;
  }
  for (std::size_t i = 0; i < spacing.size(); ++i) {
    const double x = std::log(spacing[i]) - x_mean;
    xx += x * x;
    xy += x * (std::log(error[i]) - y_mean);
  }
  if (!(xx > 0.0)) foundation::fail_input("order of a scheme: at least two different spacings are needed");
  return {xy / xx, y_mean - xy / xx * x_mean};
}

}  // namespace tetsuame::exact
