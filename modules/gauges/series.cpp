#include <algorithm>
#include <cmath>
#include <gauges/series.hpp>

namespace tetsuame::gauges {

void readings::add(double time, const std::vector<double>& values) {
  time_.push_back(time);
  values_.push_back(values);
}

series readings::of(const std::string& name) const {
  const auto found = std::ranges::find_if(columns, [&](const auto& c) { return c.name == name; });
  const auto k = static_cast<std::size_t>(found - columns.begin());
  series s{time_, {}};
  for (const auto& line : values_) s.value.push_back(line.at(k));
  return s;
}

std::vector<double> readings::saved() const {
  std::vector<double> flat;
  for (std::size_t n = 0; n < time_.size(); ++n) {
    flat.push_back(time_[n]);
    flat.insert(flat.end(), values_[n].begin(), values_[n].end());
  }
  return flat;
}

void readings::restore(const std::vector<double>& saved) {
  const auto width = static_cast<std::ptrdiff_t>(columns.size());
  for (auto at = saved.begin(); at != saved.end(); at += width + 1) add(*at, {at + 1, at + 1 + width});
}

std::optional<double> value_at(const series& s, double time) {
  if (s.empty() || time < s.time.front() || time > s.time.back()) return {};
  const auto after = std::lower_bound(s.time.begin(), s.time.end(), time);
  const auto k = static_cast<std::size_t>(after - s.time.begin());
  if (k == 0) return s.value.front();
  const double part = (time - s.time[k - 1]) / (s.time[k] - s.time[k - 1]);
  return s.value[k - 1] + part * (s.value[k] - s.value[k - 1]);
}

std::optional<double> first_above(const series& s, double value) {
  for (std::size_t k = 0; k < s.time.size(); ++k) {
    if (!(s.value[k] > value)) continue;
    if (k == 0) return s.time[0];
    const double part = (value - s.value[k - 1]) / (s.value[k] - s.value[k - 1]);
    return s.time[k - 1] + part * (s.time[k] - s.time[k - 1]);
  }
  return {};
}

double integral(const series& s, double from, double until) {
  double sum = 0.0;
  for (std::size_t k = 1; k < s.time.size(); ++k) {
    const double a = std::max(from, s.time[k - 1]), b = std::min(until, s.time[k]);
    if (b > a) sum += 0.5 * (b - a) * (*value_at(s, a) + *value_at(s, b));
  }
  return sum;
}

std::optional<double> rms_difference(const series& run, const series& reference) {
  double sum = 0.0, n = 0.0;
  for (std::size_t k = 0; k < reference.time.size(); ++k)
    if (const auto value = value_at(run, reference.time[k])) {
      sum += (*value - reference.value[k]) * (*value - reference.value[k]);
      n += 1.0;
    }
  return n > 0.0 ? std::optional(std::sqrt(sum / n)) : std::nullopt;
}

std::optional<double> mean_difference(const series& run, const series& reference) {
  double sum = 0.0, n = 0.0;
  for (std::size_t k = 0; k < reference.time.size(); ++k)
    if (const auto value = value_at(run, reference.time[k])) {
      sum += std::abs(*value - reference.value[k]);
      n += 1.0;
    }
  return n > 0.0 ? std::optional(sum / n) : std::nullopt;
}

bool covers(const series& s, double from, double until) {
  if (s.time.size() < 2) return false;
  const std::size_t n = s.time.size();
  const double slack = 0.02 * (until - from);
  const double first = std::min(slack, s.time[1] - s.time[0]), last = std::min(slack, s.time[n - 1] - s.time[n - 2]);
  return from >= s.time[0] - first && until <= s.time[n - 1] + last;
}

namespace {

// The slope of y by x, by least squares; none of fewer than two points.
std::optional<double> slope_of(const series& s) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (std::size_t k = 0; k < s.time.size(); ++k) {
    n += 1.0;
    x += s.time[k];
    y += s.value[k];
    xx += s.time[k] * s.time[k];
    xy += s.time[k] * s.value[k];
  }
  return n >= 2.0 ? std::optional((n * xy - x * y) / (n * xx - x * x)) : std::nullopt;
}

// Of the largest |value| between two crossings, by the parabola through it and its neighbours.
void add_extreme(const series& s, std::size_t first, std::size_t last, series& extremes) {
  std::size_t k = first;
  for (std::size_t n = first; n < last; ++n)
    if (std::abs(s.value[n]) > std::abs(s.value[k])) k = n;
  if (k == 0 || k + 1 >= s.time.size()) return;
  const double x1 = s.time[k - 1] - s.time[k], x2 = s.time[k + 1] - s.time[k];
  const double y0 = std::abs(s.value[k]), y1 = std::abs(s.value[k - 1]) - y0, y2 = std::abs(s.value[k + 1]) - y0;
  const double curvature = (y1 / x1 - y2 / x2) / (x1 - x2), slope = y1 / x1 - curvature * x1;
  if (!(curvature < 0.0)) return;
  extremes.time.push_back(s.time[k] - 0.5 * slope / curvature);
  extremes.value.push_back(std::log(y0 - 0.25 * slope * slope / curvature));
}

}  // namespace

oscillation measured_oscillation(const series& s) {
  std::vector<double> crossings;
  std::vector<std::size_t> first_behind;
  for (std::size_t k = 1; k < s.time.size(); ++k)
    if ((s.value[k - 1] < 0.0) != (s.value[k] < 0.0)) {
      const double part = s.value[k - 1] / (s.value[k - 1] - s.value[k]);
      crossings.push_back(s.time[k - 1] + part * (s.time[k] - s.time[k - 1]));
      first_behind.push_back(k);
    }
  oscillation o;
  if (crossings.size() < 2) return o;
  o.period = 2.0 * (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
  series extremes;
  for (std::size_t n = 0; n + 1 < first_behind.size(); ++n)
    add_extreme(s, first_behind[n], first_behind[n + 1], extremes);
  if (const auto slope = slope_of(extremes)) o.decay = -*slope;
  return o;
}

}  // namespace tetsuame::gauges
