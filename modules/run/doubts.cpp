#include <fmt/format.h>

#include <cmath>
#include <run/doubts.hpp>

namespace tetsuame::run {

namespace {

std::optional<double> number(const nlohmann::ordered_json& metrics, const char* name) {
  const auto found = metrics.find(name);
  return found != metrics.end() && found->is_number() ? std::optional(found->get<double>()) : std::nullopt;
}

}  // namespace

std::string doubts(const summary& s) {
  std::string all;
  const auto add = [&](const std::string& text) { all += (all.empty() ? "" : "; ") + text; };
  auto energy = number(s.metrics, "energy_residual_max");
  if (!energy) energy = number(s.metrics, "energy_residual");
  if (energy && std::abs(*energy) > most_energy_made)
    add(fmt::format("the energy is off by {:.3g} of its scale (energy_residual)", *energy));
  const double layer = std::pow(static_cast<double>(s.fluid_particles), 1.0 - 1.0 / static_cast<double>(s.dimension));
  const auto put_back = number(s.metrics, "particles_put_back");
  if (put_back && *put_back > most_put_back * layer * static_cast<double>(s.steps))
    add(fmt::format("{:.0f} particles had to be put back inside the walls in {} steps", *put_back, s.steps));
  const auto excess = number(s.metrics, "density_excess");
  if (excess && *excess > most_density_excess)
    add(fmt::format("a density has left the range of the start's pressures by a factor of {:.3g} (density_excess)",
                    *excess));
  return all;
}

}  // namespace tetsuame::run
