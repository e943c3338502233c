// What gauges of water tell at the end of what they read on the way, the columns of gauges.csv.
#pragma once

#include <free_surface/options.hpp>
#include <nlohmann/json.hpp>

namespace tetsuame::free_surface {

using gauges::readings;

// A metric that cannot be told is null, and beside it NAME_reason says why in words.

// Of pressure gauges: arrival, largest value, impulse; with the reference's own, by the same rules.
void report_pressure(const options& o, const std::string& name, const series& run, const series& reference,
                     nlohmann::ordered_json& metrics);
void report_height(const std::string& name, const series& run, const series& reference,
                   nlohmann::ordered_json& metrics);
// Names of the columns of so many gauges of forces, in their order.
std::vector<std::string> force_names(std::size_t gauges, int dimension);
std::string impulse_name(const std::string& force);  // of the column of its impulse
// impulse: since the start (N s), as the run has integrated it; the reference's is that of its curve.
void report_force(const options& o, const std::string& name, const series& run, const series& impulse,
                  const series& reference, nlohmann::ordered_json& metrics);
void report_front(const parameters& p, const series& run, nlohmann::ordered_json& metrics);

}  // namespace tetsuame::free_surface
