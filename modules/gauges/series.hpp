// Values over time: what was read on the way, or measured, and what curves say.
#pragma once

#include <optional>
#include <output/history.hpp>
#include <string>
#include <vector>

namespace tetsuame::gauges {

struct series {
  std::vector<double> time, value;  // s
  bool empty() const { return time.empty(); }
};

// Readings of several quantities at the same times.
class readings {
 public:
  std::vector<output::history_column> columns;

  void add(double time, const std::vector<double>& values);
  std::size_t size() const { return time_.size(); }
  // Of the column of that name, which is there.
  series of(const std::string& name) const;

  std::vector<double> saved() const;  // all of it, line after line
  void restore(const std::vector<double>& saved);

 private:
  std::vector<double> time_;                 // s
  std::vector<std::vector<double>> values_;  // [line][column]
};

// ---- of curves: linear between their points; none where they do not say ----------------------------

std::optional<double> value_at(const series& s, double time);
std::optional<double> first_above(const series& s, double value);  // s
double integral(const series& s, double from, double until);       // over what there is of it
// Root of the mean squared difference at those of the reference's times that the run has come to.
std::optional<double> rms_difference(const series& run, const series& reference);
std::optional<double> mean_difference(const series& run, const series& reference);  // of absolute values, at the same
// Whether it has been read from then until then, but for a fiftieth of that and no more than one of its readings.
bool covers(const series& s, double from, double until);

// A cosine that dies away: from its zero crossings, and from a line through the logarithms of its largest values.
struct oscillation {
  std::optional<double> period, decay;  // s, 1/s (of the amplitude)
};
oscillation measured_oscillation(const series& s);

}  // namespace tetsuame::gauges
