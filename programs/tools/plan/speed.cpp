#include <fmt/format.h>

#include <cmath>
#include <foundation/error.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <plan/speed.hpp>

namespace tetsuame::plan {

namespace {

measured_speed record(const nlohmann::json& r) {
  return {r.at("updates_per_second").get<double>(),
          r.at("name").get<std::string>(),
          r.at("threads").get<int>(),
          r.at("dimension").get<int>(),
          r.at("particles").get<std::int64_t>(),
          r.at("load_average").get<double>(),
          r.at("processor").get<std::string>()};
}

double distance(const measured_speed& s, double particles) {
  return std::fabs(std::log(static_cast<double>(s.particles) / particles));
}

}  // namespace

std::optional<measured_speed> read_speed(const speed_options& o, double particles) {
  std::ifstream file(o.bench);
  if (!file && !o.bench_given) return std::nullopt;
  if (!file) foundation::fail_file(o.bench + ": cannot be read; `bench` writes it");
  std::optional<measured_speed> best;
  try {
    for (const auto& r : nlohmann::json::parse(file)) {
      const measured_speed found = record(r);
      if (found.kind != o.kind || found.dimension != o.dimension) continue;
      if (o.threads > 0 && found.threads != o.threads) continue;
      if (!(found.updates_per_second > 0.0) || found.particles < 1) continue;
      const bool better = !best || (o.threads == 0 && found.threads > best->threads) ||
                          (found.threads == best->threads && distance(found, particles) < distance(*best, particles));
      if (better) best = found;
    }
  } catch (const nlohmann::json::exception& e) {
    foundation::fail_file(fmt::format("{}: is no file of bench: {}", o.bench, e.what()));
  }
  if (!best && (o.bench_given || o.threads > 0))
    foundation::fail_input(fmt::format("{} has no measurement of {} in {} dimensions{}", o.bench, o.kind, o.dimension,
                                       o.threads > 0 ? fmt::format(" with {} threads", o.threads) : ""));
  return best;
}

}  // namespace tetsuame::plan
