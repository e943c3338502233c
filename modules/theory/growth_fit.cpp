#include <cmath>
#include <theory/growth_fit.hpp>

namespace tetsuame::theory {

std::optional<growth_fit> fit_growth(const std::vector<double>& time, const std::vector<double>& amplitude, double low,
                                     double high) {
  std::vector<double> t, y;
  for (std::size_t k = 0; k < time.size(); ++k) {
    const double ratio = amplitude[k] / amplitude[0];
    if (ratio > high) break;
    if (ratio < low) {
      t.clear();
      y.clear();
    } else {
      t.push_back(time[k]);
      y.push_back(std::log(ratio));
    }
  }
  const double n = static_cast<double>(t.size());
  if (t.size() < 3) return std::nullopt;
  double t_mean = 0.0, y_mean = 0.0, tt = 0.0, ty = 0.0, left = 0.0;
  for (std::size_t k = 0; k < t.size(); ++k) t_mean += t[k] / n, y_mean += y[k] / n;
  for (std::size_t k = 0; k < t.size(); ++k) {
    tt += (t[k] - t_mean) * (t[k] - t_mean);
    ty += (t[k] - t_mean) * (y[k] - y_mean);
  }
  const double rate = ty / tt;
  for (std::size_t k = 0; k < t.size(); ++k) left += std::pow(y[k] - y_mean - rate * (t[k] - t_mean), 2);
  return growth_fit{rate, std::sqrt(left / (n - 2.0) / tt), t.size()};
}

}  // namespace tetsuame::theory
