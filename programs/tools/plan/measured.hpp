// What a run of rti or drop measured, to stand beside the estimates.
#pragma once

#include <cstdint>
#include <optional>
#include <plan/table.hpp>
#include <relaxation/steps.hpp>
#include <string>

namespace tetsuame::plan {

struct measured_overturn {
  std::string folder, program, status;
  relaxation::two_layers system;  // as run; c from the linear equations of state, else the default
  bool sound_known;               // whether c is that of the run
  std::int64_t n;                 // particles along the height
  int dimension;
  double eta_lower, eta_upper;          // Pa s
  double V;                             // m/s, largest of the metal's mean velocity downwards
  std::optional<double> tau;            // s, until the metal's centroid has fallen by 0.3 L
  std::optional<double> steps_to_tau;   // steps until then
  double time, steps, evaluations, dt;  // s, of the whole run; dt: mean
  std::optional<double> seconds;        // of computing, the whole run
  std::optional<double> v_rms_max;      // m/s
};

// Of a run's folder: resolved.nml, summary.json, history.csv. fail_file if one is missing or damaged, fail_input if it
// is no run of rti or drop.
measured_overturn read_run(const std::string& folder);
json as_json(const measured_overturn& m);

}  // namespace tetsuame::plan
