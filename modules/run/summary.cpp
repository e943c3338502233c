#include <fmt/format.h>

#include <cmath>
#include <output/file.hpp>
#include <run/command_line.hpp>
#include <run/summary.hpp>
#include <vector>

namespace tetsuame::run {

std::string first_not_finite(const nlohmann::ordered_json& j) {
  if (j.is_number_float() && !std::isfinite(j.get<double>())) return fmt::format(" ({})", j.get<double>());
  if (!j.is_structured()) return {};
  for (const auto& [name, value] : j.items())
    if (const auto found = first_not_finite(value); !found.empty())
      return found.starts_with(' ') ? name + found : name + "." + found;
  return {};
}

void check_line(const std::vector<output::history_column>& columns, std::span<const double> values) {
  for (std::size_t k = 0; k < columns.size(); ++k)
    if (!std::isfinite(values[k]))
      foundation::fail_calculation(
          fmt::format("{} is {}, not a finite number: a quantity has overflowed, or what it is "
                      "divided by is zero",
                      columns[k].name, values[k]));
}

void summary::check_finite(const domain::communicator& where) const {
  const auto lost = where.broadcast(first_not_finite({{"time", time},
                                                      {"last_dt", statistics.last_dt},
                                                      {"errors", errors},
                                                      {"conservation", conservation},
                                                      {"metrics", metrics}}));
  if (!lost.empty())
    foundation::fail_calculation(
        lost +
        " is not a finite number at the end of the run: a quantity has overflowed, or what it is divided by is "
        "zero; are the input's values those of a fluid?");
}

void summary::write(const domain::communicator& where, const std::string& directory) const {
  nlohmann::ordered_json j;
  j["program"] = program;
  j["status"] = status;
  j["message"] = message;
  j["warnings"] = warnings;
  j["steps"] = steps;
  j["time"] = time;
  j["dimension"] = dimension;
  j["fluid_particles"] = fluid_particles;
  j["wall_particles"] = wall_particles;
  j["ranks"] = ranks;
  j["threads"] = threads;
  j["simd_lanes"] = simd_lanes;
  j["wall_seconds"] = wall_seconds;
  j["stepping_seconds"] = stepping_seconds;
  j["rhs_evaluations"] = statistics.evaluations;
  const double updates =
      particle_updates.value_or(static_cast<double>(fluid_particles) * static_cast<double>(statistics.evaluations));
  j["particle_updates"] = updates;
  j["particle_updates_per_second"] = stepping_seconds > 0.0 ? updates / stepping_seconds : 0.0;
  j["attempts"] = statistics.attempts;
  j["rejections"] = statistics.rejections;
  j["last_dt"] = statistics.last_dt;
  j["steps_limited_by"] = statistics.limited_by;
  j["diverged_step"] = diverged_step ? nlohmann::ordered_json(*diverged_step) : nullptr;
  j["diverged_iteration"] = diverged_iteration ? nlohmann::ordered_json(*diverged_iteration) : nullptr;
  j["errors"] = errors;
  j["conservation"] = conservation;
  j["metrics"] = metrics;
  j["stages"] = stages;
  j["state_hash"] = state_hash.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(state_hash);
  j["version"] = version();
  output::write_summary(where.comm, directory + "/summary.json", j);
}

void summary::print(const std::string& directory) const {
  std::string text = fmt::format("{}: {} ({:.2f} s, {} evaluations of the right-hand side", program, message,
                                 wall_seconds, statistics.evaluations);
  if (statistics.rejections > 0) text += fmt::format(", {} steps rejected", statistics.rejections);
  std::string held;
  for (const auto& [name, count] : statistics.limited_by)
    held += fmt::format("{}{} {}", held.empty() ? "" : ", ", name, count);
  text += fmt::format(")\n  step set by: {}\n", held.empty() ? "-" : held);
  if (errors.contains("pressure_mean"))
    text += fmt::format("  pressure error {:.3g} mean, {:.3g} max; density error {:.3g}; displacement {:.3g} dx\n",
                        errors["pressure_mean"].get<double>(), errors["pressure_max"].get<double>(),
                        errors["density_max"].get<double>(), errors["displacement_max_over_dx"].get<double>());
  if (metrics.value("particles_put_back", 0) > 0)
    text += fmt::format("  {} particles had to be put back inside the walls\n",
                        metrics["particles_put_back"].get<std::int64_t>());
  for (const auto& warning : warnings) text += fmt::format("  warning: {}\n", warning);
  text += fmt::format("  state {}\n  results in {}\n", state_hash, directory);
  std::fputs(text.c_str(), stdout);  // whose reader may have gone
}

}  // namespace tetsuame::run
