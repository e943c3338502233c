#include <fmt/format.h>

#include <cmath>
#include <output/file.hpp>
#include <run/command_line.hpp>
#include <run/summary.hpp>
#include <sstream>
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
  if (metrics.value("wall_crossings", 0) > 0)
    text += fmt::format("  {} particles had to be put back inside the walls\n",
                        metrics["wall_crossings"].get<std::int64_t>());
  text += fmt::format("  state {}\n  results in {}\n", state_hash, directory);
  std::fputs(text.c_str(), stdout);  // whose reader may have gone
}

namespace {

// Whether a key of this group may be another at a restart: all of how long, of the file that only a start reads
// (input_files.hpp), of how to write, and of who does the work.
// In &expert the names of the keys of &time and &balancer begin with their group's.
bool may_change(const std::string& group, const std::string& key) {
  if (group == "&domain") return key == "ranks_x" || key == "balance";
  if (group == "&initial") return key == "file";
  if (group == "&expert") return key.starts_with("balancer_") || key.starts_with("time_");
  return group == "&time" || group == "&output" || group == "&run";
}

// Lines that must be the same.
std::vector<std::string> binding_lines(const std::string& input) {
  std::vector<std::string> lines;
  std::istringstream in(input);
  std::string group;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("&")) group = line.substr(0, line.find(' '));
    const auto key = std::min(line.find_first_not_of(' '), line.size());
    if (!may_change(group, line.substr(key, line.find(' ', key) - key))) lines.push_back(line);
  }
  return lines;
}

}  // namespace

void check_restart(const std::string& saved_program, const std::string& saved_input, const std::string& program,
                   const std::string& input) {
  if (saved_program != program)
    foundation::fail_input("the checkpoint is of program " + saved_program + ", not of " + program);
  const auto was = binding_lines(saved_input), is = binding_lines(input);
  for (std::size_t n = 0; n < std::max(was.size(), is.size()); ++n) {
    const std::string a = n < was.size() ? was[n] : "(nothing)", b = n < is.size() ? is[n] : "(nothing)";
    if (a != b)
      foundation::fail_input(
          "the input is not that of the checkpoint (only &time, &output, &run, &balancer and &domain ranks_x and "
          "balance may change): it was\n  " +
          a + "\nand is now\n  " + b);
  }
}

}  // namespace tetsuame::run
