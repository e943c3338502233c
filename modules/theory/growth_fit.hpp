// The growth rate of an amplitude that was measured over time.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace tetsuame::theory {

struct growth_fit {
  double rate;         // 1/s
  double uncertainty;  // standard error of the fitted slope, 1/s
  std::size_t samples;
};
// Least squares of ln(amplitude) over the first stretch of time where amplitude/first is in [low, high]. Nothing where
// fewer than three samples lie there.
std::optional<growth_fit> fit_growth(const std::vector<double>& time, const std::vector<double>& amplitude, double low,
                                     double high);

}  // namespace tetsuame::theory
