// summary.json and the lines a run ends with.
#pragma once

#include <cmath>
#include <cstdint>
#include <domain/communicator.hpp>
#include <integrators/explicit_integrator.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <output/history.hpp>
#include <span>
#include <string>
#include <vector>

namespace tetsuame::run {

// A number that may be absent, which is no fault.
inline nlohmann::ordered_json or_null(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

// A bound that is infinite where nothing binds.
inline nlohmann::ordered_json bound_or_null(double bound) {
  return or_null(std::isfinite(bound) ? std::optional(bound) : std::nullopt);
}

// The first number in it that is not finite, as "name.part"; empty: there is none. (In a file such a number would be
// null, as one that is absent.)
std::string first_not_finite(const nlohmann::ordered_json& j);

// fail_calculation where a value of a line of the history is not finite, which it then names.
void check_line(const std::vector<output::history_column>& columns, std::span<const double> values);

// Whether a run with this status came to its end: "completed", or "completed_doubtful" where its own measures say that
// the result means nothing.
inline bool has_completed(const std::string& status) { return status.starts_with("completed"); }

struct summary {
  std::string program, status = "failed", message, state_hash;
  std::vector<std::string> warnings;  // of rank 0
  std::int64_t steps = 0;
  double time = 0.0;  // s
  int dimension = 2;
  std::int64_t fluid_particles = 0, wall_particles = 0;
  int ranks = 1, threads = 1, simd_lanes = 1;
  double wall_seconds = 0.0, stepping_seconds = 0.0;
  integrators::explicit_statistics statistics;
  std::optional<double> particle_updates;  // where the number of particles changed on the way
  std::optional<std::int64_t> diverged_step, diverged_iteration;
  std::map<std::string, double> stages;  // s
  nlohmann::ordered_json errors = nullptr, conservation = nullptr, metrics = nlohmann::ordered_json::object();

  // Collective: fail_calculation where one of rank 0's numbers is not finite. A run has completed only if they are.
  void check_finite(const domain::communicator& where) const;
  // Collective: DIRECTORY/summary.json.
  void write(const domain::communicator& where, const std::string& directory) const;
  void print(const std::string& directory) const;
};

}  // namespace tetsuame::run
