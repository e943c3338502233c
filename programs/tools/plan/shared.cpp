#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <foundation/error.hpp>
#include <fstream>
#include <map>
#include <plan/shared.hpp>
#include <run/summary.hpp>

namespace tetsuame::plan {

namespace {

// Right-hand sides a step of the methods of &time with fixed steps.
const std::map<std::string, double> evaluations{{"euler", 1},   {"ab2", 1}, {"order_2", 2}, {"ssp_rk3", 3},
                                                {"order_3", 3}, {"rk4", 4}, {"order_4", 5}, {"order_5", 6}};

struct measured_speed {
  double updates_per_second;
  std::string kind;
  int threads, dimension;
  std::int64_t particles;
  double load_average;
  std::string processor;
};

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

std::optional<measured_speed> read_speed(const shared_options& o, int dimension, double particles) {
  std::ifstream file(o.bench);
  if (!file && !o.bench_given) return std::nullopt;
  if (!file) foundation::fail_file(o.bench + ": cannot be read; `bench` writes it");
  std::optional<measured_speed> best;
  try {
    for (const auto& r : nlohmann::json::parse(file)) {
      const measured_speed found = record(r);
      if (found.kind != o.kind || found.dimension != dimension) continue;
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
    foundation::fail_input(fmt::format("{} has no measurement of {} in {} dimensions{}", o.bench, o.kind, dimension,
                                       o.threads > 0 ? fmt::format(" with {} threads", o.threads) : ""));
  return best;
}

}  // namespace

CLI::Validator finite(double least, double most, bool least_excluded) {
  const auto refusal = [=](const std::string& text) {
    double x = 0.0;
    const bool good = CLI::detail::lexical_cast(text, x) && (least_excluded ? x > least : x >= least) && x <= most;
    return good
               ? std::string()
               : fmt::format("expected a number in {}{}, {}], found {}", least_excluded ? '(' : '[', least, most, text);
  };
  return CLI::Validator(refusal, least_excluded ? "POSITIVE" : "NUMBER");
}

void check_finite(const json& answer) {
  if (const auto lost = run::first_not_finite(answer); !lost.empty())
    foundation::fail_calculation(lost + " is not a finite number: what is given lies too far apart");
}

void add_shared(CLI::App& app, shared_options& o) {
  app.add_option("--steps", o.steps, "backwards: what can be afforded in so many steps")->check(above_zero());
  app.add_option("--run-time,--seconds", o.seconds,
                 "backwards: what can be afforded in so long a run (s, or 90s, 20min, 8h, 3d)")
      ->transform(CLI::AsNumberWithUnit(std::map<std::string, double>{{"s", 1}, {"min", 60}, {"h", 3600}, {"d", 86400}},
                                        CLI::AsNumberWithUnit::CASE_SENSITIVE, "TIME"))
      ->check(above_zero());
  app.add_option("--method", o.method, "time integration: its right-hand sides a step count for the run time")
      ->check(CLI::IsMember(evaluations))
      ->capture_default_str();
  app.add_option("--rate", o.rate, "particles times right-hand sides a second (default: what bench measured)")
      ->check(above_zero());
  app.add_option("--bench", o.bench, "file of bench")
      ->type_name("FILE")
      ->each([&o](const std::string&) { o.bench_given = true; })
      ->capture_default_str();
  app.add_option("--case", o.kind, "case of bench")->capture_default_str();
  app.add_option("--threads", o.threads, "threads of the run (default: the most that bench measured)")
      ->check(CLI::Range(1, 4096));
  app.add_option("--json", o.json, "write everything to this file as well")->type_name("FILE");
}

machine this_machine(const shared_options& o, int dimension, double particles) {
  machine m{.cost = {}, .note = "not known: run bench, or give --rate"};
  m.cost.evaluations_per_step = evaluations.at(o.method);
  if (o.rate) {
    m.cost.updates_per_second = *o.rate;
    m.note = "given";
  } else if (const auto found = read_speed(o, dimension, particles)) {
    m.cost.updates_per_second = found->updates_per_second;
    m.note = fmt::format("bench: {} {}-D, {} particles, threads {}, load average {:.1f}, {}", found->kind,
                         found->dimension, found->particles, found->threads, found->load_average, found->processor);
  }
  if (o.seconds && !(m.cost.updates_per_second > 0.0))
    foundation::fail_input("--run-time: needs the rate of updates of the machine: run bench, or give --rate");
  return m;
}

json as_json(const machine& m) {
  json j;
  j["evaluations_per_step"] = m.cost.evaluations_per_step;
  j["updates_per_second"] = or_null(m.cost.updates_per_second);
  j["source"] = m.note;
  return j;
}

void table::print() const {
  std::vector<std::size_t> width;
  for (const auto& row : rows)
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (k == width.size()) width.push_back(0);
      width[k] = std::max(width[k], row[k].size());
    }
  fmt::print("{}\n", title);
  for (std::size_t n = 0; n < rows.size(); ++n) {
    std::string line = " ";
    for (std::size_t k = 0; k < rows[n].size(); ++k)
      line += k < right.size() && right[k] ? fmt::format(" {:>{}}", rows[n][k], width[k])
                                           : fmt::format(" {:<{}}", rows[n][k], width[k]);
    line.erase(line.find_last_not_of(' ') + 1);
    fmt::print("{}\n", line);
    if (n == 0 && has_head) {
      std::size_t all = 1;
      for (const std::size_t w : width) all += w + 1;
      fmt::print("  {}\n", std::string(all - 2, '-'));
    }
  }
  fmt::print("\n");
}

std::string number(double value) { return fmt::format("{:.4g}", value); }

std::string duration(double seconds) {
  if (seconds < 60.0) return fmt::format("{:.3g} s", seconds);
  if (seconds < 3600.0) return fmt::format("{:.3g} min", seconds / 60.0);
  if (seconds < 86400.0) return fmt::format("{:.3g} h", seconds / 3600.0);
  if (seconds < 365.25 * 86400.0) return fmt::format("{:.3g} days", seconds / 86400.0);
  return fmt::format("{:.3g} years", seconds / (365.25 * 86400.0));
}

}  // namespace tetsuame::plan
