#include <algorithm>
#include <cmath>
#include <convection/steady.hpp>
#include <numeric>

namespace tetsuame::convection {

void record::add(double t, const std::vector<double>& values) {
  times_.push_back(t);
  for (std::size_t m = 0; m < values_.size(); ++m) values_[m].push_back(values[m]);
}

std::size_t record::first_after(double t) const {
  return static_cast<std::size_t>(std::upper_bound(times_.begin(), times_.end(), t) - times_.begin());
}

double record::mean(std::size_t measure, std::size_t begin, std::size_t end) const {
  const auto& v = values_[measure];
  const auto at = [&](std::size_t n) { return v.begin() + static_cast<std::ptrdiff_t>(n); };
  return std::accumulate(at(begin), at(end), 0.0) / static_cast<double>(end - begin);
}

average record::over(std::size_t measure, double window) const {
  const std::size_t end = size(), begin = std::min(first_after(last_time() - window), end - 1), n = end - begin;
  average a{mean(measure, begin, end)};
  if (n < 8) return a;
  double squares = 0.0;
  for (std::size_t q = 0; q < 4; ++q) {
    const double part = mean(measure, begin + n * q / 4, begin + n * (q + 1) / 4) - a.mean;
    squares += part * part;
  }
  a.uncertainty = std::sqrt(squares / (4.0 * 3.0));
  return a;
}

bool record::settled(std::size_t measure, double window, double tolerance) const {
  if (size() < 8 || last_time() - times_.front() < window) return false;
  const double t = last_time();
  const std::size_t begin = first_after(t - window), middle = first_after(t - 0.5 * window), end = size();
  if (middle - begin < 4 || end - middle < 4) return false;
  const double before = mean(measure, begin, middle), after = mean(measure, middle, end);
  return std::abs(after - before) <= tolerance * 0.5 * std::abs(after + before);
}

std::vector<double> record::flat() const {
  std::vector<double> all = times_;
  for (const auto& v : values_) all.insert(all.end(), v.begin(), v.end());
  return all;
}

void record::restore(const std::vector<double>& flat) {
  const std::size_t n = flat.size() / (values_.size() + 1);
  const auto part = [&](std::size_t k) {
    return std::vector<double>(flat.begin() + static_cast<std::ptrdiff_t>(n * k),
                               flat.begin() + static_cast<std::ptrdiff_t>(n * (k + 1)));
  };
  times_ = part(0);
  for (std::size_t m = 0; m < values_.size(); ++m) values_[m] = part(m + 1);
}

}  // namespace tetsuame::convection
