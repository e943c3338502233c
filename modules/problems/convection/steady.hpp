// When a flow is steady, and its time averages with their uncertainty: docs/theory/convection.md, "When a flow is
// steady".
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <operators/symmetric.hpp>
#include <optional>
#include <vector>

namespace tetsuame::convection {

struct average {
  double mean = 0.0;
  std::optional<double> uncertainty = {};
  double swing = 0.0;  // amplitude of what dies beside it, now; of a mean: standard deviation of the samples
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

  // Of the samples later than the last one's time less `window` (s), at least the last. Uncertainty: the larger of the
  // standard error of the means of four quarters of the window, and that of samples of which each is correlated with
  // the next by ρ, (1 + ρ)/(1 - ρ) times the variance of independent ones but never more than one sample's: a flow
  // that swings with the window's own period has quarters that agree. None with fewer than eight samples.
  average over(std::size_t measure, double window) const {
    const std::size_t end = size(), begin = std::min(first_after(last_time() - window), end - 1), n = end - begin;
    average a{mean(measure, begin, end)};
    if (n < 8) return a;
    double squares = 0.0;
    for (std::size_t q = 0; q < 4; ++q) {
      const double part = mean(measure, begin + n * q / 4, begin + n * (q + 1) / 4) - a.mean;
      squares += part * part;
    }
    double variance = 0.0, products = 0.0, before = 0.0;
    for (std::size_t k = begin; k < end; ++k) {
      const double off = values_[measure][k] - a.mean;
      variance += off * off;
      products += off * before;
      before = off;
    }
    const double correlation = variance > 0.0 ? std::clamp(products / variance, -0.999, 0.999) : 0.0;
    variance /= static_cast<double>(n);
    a.swing = std::sqrt(variance);
    const double of_mean = (1.0 + correlation) / (1.0 - correlation) / static_cast<double>(n);
    a.uncertainty = std::sqrt(std::max(squares / (4.0 * 3.0), variance * std::min(1.0, of_mean)));
    return a;
  }
  // What a swing about a steady state leaves when it dies: a of y = a + exp(-γ s) (b cos ω s + c sin ω s), s the time
  // in turnovers (s), by least squares over that window, eight samples at least. Uncertainty: standard error of a, as
  // if what the fit leaves were of the first order in its correlation ρ from sample to sample: (1 + ρ)/(1 - ρ) times
  // the variance of ρ = 0. Noise of the particles has none; what a swing with another γ or ω leaves is almost the same
  // from sample to sample.
  average beside_a_swing(std::size_t measure, double window, double turnover) const {
    constexpr double decay = 0.85, period = 1.75;  // per turnover, turnovers
    const std::size_t end = size(),
                      first = std::min(first_after(last_time() - window), end - std::min<std::size_t>(8, end));
    const auto terms = [&](std::size_t k) {
      const double s = (times_[k] - last_time()) / turnover, size = std::exp(-decay * s);
      const double phase = 2.0 * std::numbers::pi * s / period;
      return std::array{1.0, size * std::cos(phase), size * std::sin(phase)};
    };
    const auto& y = values_[measure];
    std::array<std::array<double, 3>, 3> A{};
    std::array<double, 3> b{};
    for (std::size_t k = first; k < end; ++k) {
      const auto P = terms(k);
      for (std::size_t m = 0; m < 3; ++m) {
        for (std::size_t n = 0; n < 3; ++n) A[m][n] += P[m] * P[n];
        b[m] += P[m] * y[k];
      }
    }
    if (end - first < 8 || !operators::factorise(A)) return {mean(measure, first, end)};
    const auto c = operators::solve(A, b);
    double squares = 0.0, products = 0.0, before = 0.0;
    for (std::size_t k = first; k < end; ++k) {
      const auto P = terms(k);
      const double left = y[k] - c[0] * P[0] - c[1] * P[1] - c[2] * P[2];
      squares += left * left;
      products += left * before;
      before = left;
    }
    const double variance = operators::solve(A, {1.0, 0.0, 0.0})[0] / static_cast<double>(end - first - 3);
    const double correlation = squares > 0.0 ? std::clamp(products / squares, 0.0, 0.99) : 0.0;
    const double correlated = (1.0 + correlation) / (1.0 - correlation);
    return {c[0], std::sqrt(squares * variance * correlated), std::hypot(c[1], c[2])};
  }
  bool full(double window) const { return size() >= 8 && last_time() - times_.front() >= window; }
  // Whether the window is full and the means of its two halves differ by less than `tolerance` of their mean.
  bool settled(std::size_t measure, double window, double tolerance) const {
    if (!full(window)) return false;
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
