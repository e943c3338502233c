// What both questions of plan share.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <plan/speed.hpp>
#include <plan/table.hpp>
#include <relaxation/steps.hpp>
#include <string>

namespace tetsuame::plan {

struct shared_options {
  std::string json;
  std::optional<double> steps, seconds;  // backwards
  std::string method = "rk4";
  std::optional<double> rate;  // updates a second, instead of bench's
  speed_options speed;
};

// Beyond that no quantity is meant, and products would overflow.
inline constexpr double largest = 1e100;
// A number that is finite and lies between the two, the lower excluded (above_zero) or not.
CLI::Validator finite(double least, double most, bool least_excluded);
inline CLI::Validator above_zero() { return finite(0.0, largest, true); }

void add_shared(CLI::App& app, shared_options& o);

struct machine {
  relaxation::cost cost;
  std::optional<measured_speed> measured;
  std::string note() const;  // where the rate comes from
};

// fail_calculation where a number of the answer is not finite: those of the question are too far apart.
void check_finite(const json& answer);

machine this_machine(shared_options o, int dimension, double particles);
json as_json(const machine& m);

// The two questions; each adds its options and returns what runs it.
std::function<void()> relaxation_question(CLI::App& app);
std::function<void()> timestep_question(CLI::App& app);

}  // namespace tetsuame::plan
