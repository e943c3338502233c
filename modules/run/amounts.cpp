#include <fmt/format.h>

#include <map>
#include <numbers>
#include <run/amounts.hpp>
#include <utility>

namespace tetsuame::run {

std::string duration_text(double seconds) {
  if (seconds < 60.0) return fmt::format("{:.3g} s", seconds);
  if (seconds < 3600.0) return fmt::format("{:.3g} min", seconds / 60.0);
  if (seconds < 86400.0) return fmt::format("{:.3g} h", seconds / 3600.0);
  if (seconds < 365.25 * 86400.0) return fmt::format("{:.3g} days", seconds / 86400.0);
  return fmt::format("{:.3g} years", seconds / (365.25 * 86400.0));
}

std::string size_text(double bytes) {
  for (const auto& [unit, name] : {std::pair{1e12, "TB"}, {1e9, "GB"}, {1e6, "MB"}})
    if (bytes >= unit) return fmt::format("{:.3g} {}", bytes / unit, name);
  return fmt::format("{:.3g} kB", bytes / 1e3);
}

double particles_within(double r_over_dx, std::int64_t dimension) {
  const double r = r_over_dx;
  return dimension == 1   ? 2.0 * r
         : dimension == 2 ? std::numbers::pi * r * r
                          : 4.0 / 3.0 * std::numbers::pi * r * r * r;
}

std::string program_of_group(const std::string& group) {
  static const std::map<std::string, std::string> of = {{"shock", "shock"},
                                                        {"convection", "convection"},
                                                        {"relaxation", "convection"},
                                                        {"conduction", "conduction"},
                                                        {"rti", "rti"},
                                                        {"drop", "drop"},
                                                        {"machine", "balance"},
                                                        {"distribution", "balance"}};
  const auto found = of.find(group);
  return found == of.end() ? "" : found->second;
}

}  // namespace tetsuame::run
