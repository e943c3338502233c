// When a flow is steady, and its time averages with their uncertainty.
#pragma once

#include <array>
#include <cstddef>
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

  void add(double t, const std::vector<double>& values);
  std::size_t size() const { return times_.size(); }
  double last_time() const { return times_.back(); }

  // Of the samples later than the last one's time less `window` (s), at least the last. Uncertainty: standard error of
  // the means of four quarters of the window, none with fewer than eight samples.
  average over(std::size_t measure, double window) const;
  // Whether the window is full and the means of its two halves differ by less than `tolerance` of their mean.
  bool settled(std::size_t measure, double window, double tolerance) const;

  // As plain numbers, for a checkpoint.
  std::vector<double> flat() const;
  void restore(const std::vector<double>& flat);

 private:
  std::size_t first_after(double t) const;
  double mean(std::size_t measure, std::size_t begin, std::size_t end) const;

  std::vector<double> times_;
  std::vector<std::vector<double>> values_;
};

}  // namespace tetsuame::convection
