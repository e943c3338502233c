// When a flow is steady, and its time averages with their uncertainty.
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

namespace tetsuame::convection {

struct average {
  double mean = 0.0;
  std::optional<double> uncertainty = {};
};

// Samples of several measures over time.
class record {
 public:
  explicit record(std::size_t measures) : values_(measures) {}

  void add(double t, const std::vector<double>& values) {
    times_.push_back(t);
    for (std::size_t m = 0; m < values_.size(); ++m) values_[m].push_back(values[m]);
  }
  std::size_t size() const { return times_.size(); }
  double last_time() const { return times_.back(); }

  // Of the samples later than the last one's time less `window` (s), at least the last. Uncertainty: standard error of
  // the means of four quarters of the window, none with fewer than eight samples.
  average over(std::size_t measure, double window) const {
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
  // Whether the window is full and the means of its two halves differ by less than `tolerance` of their mean.
  bool settled(std::size_t measure, double window, double tolerance) const {
    if (size() < 8 || last_time() - times_.front() < window) return false;
    const double t = last_time();
    const std::size_t begin = first_after(t - window), middle = first_after(t - 0.5 * window), end = size();
    if (middle - begin < 4 || end - middle < 4) return false;
    const double before = mean(measure, begin, middle), after = mean(measure, middle, end);
    return std::abs(after - before) <= tolerance * 0.5 * std::abs(after + before);
  }

  // As plain numbers, for a checkpoint: all times, then all values of each measure.
  std::vector<double> flat() const {
    std::vector<double> all = times_;
    for (const auto& v : values_) all.insert(all.end(), v.begin(), v.end());
    return all;
  }
  void restore(const std::vector<double>& flat) {
    const auto n = static_cast<std::ptrdiff_t>(flat.size() / (values_.size() + 1));
    auto from = flat.begin();
    times_.assign(from, from + n);
    for (auto& v : values_) {
      from += n;
      v.assign(from, from + n);
    }
  }

 private:
  std::size_t first_after(double t) const {
    return static_cast<std::size_t>(std::upper_bound(times_.begin(), times_.end(), t) - times_.begin());
  }
  double mean(std::size_t measure, std::size_t begin, std::size_t end) const {
    const auto at = [first = values_[measure].begin()](std::size_t n) {
      return first + static_cast<std::ptrdiff_t>(n);
    };
    return std::accumulate(at(begin), at(end), 0.0) / static_cast<double>(end - begin);
  }

  std::vector<double> times_;
  std::vector<std::vector<double>> values_;
};

}  // namespace tetsuame::convection
