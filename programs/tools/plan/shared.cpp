#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <foundation/error.hpp>
#include <fstream>
#include <json_file.hpp>
#include <numeric>
#include <plan/shared.hpp>
#include <run/amounts.hpp>
#include <run/summary.hpp>

namespace tetsuame::plan {

namespace {

// What bench measured, if it did.
std::optional<machine> read_speed(const shared_options& o, int dimension, double particles) {
  std::ifstream file(o.bench);
  if (!file && !o.bench_given) return std::nullopt;
  if (!file) foundation::fail_file(o.bench + ": cannot be read; `bench` writes it");
  std::optional<machine> best;
  auto best_rank = std::pair(0, 0.0);  // the most threads, the nearest in size
  try {
    for (const auto& r : nlohmann::json::parse(file)) {
      const auto rate = r.at("updates_per_second").get<double>(), n = r.at("particles").get<double>();
      const int threads = r.at("threads").get<int>();
      if (r.at("name") != o.kind || r.at("dimension") != dimension || !(rate > 0.0) || n < 1.0) continue;
      if (o.threads > 0 && threads != o.threads) continue;
      const auto rank = std::pair(-threads, std::fabs(std::log(n / particles)));
      if (best && rank >= best_rank) continue;
      best_rank = rank;
      best = machine{{.updates_per_second = rate},
                     fmt::format("bench: {} {}-D, {} particles, threads {}, load average {:.1f}, {}", o.kind, dimension,
                                 n, threads, r.at("load_average").get<double>(), r.at("processor").get<std::string>())};
    }
  } catch (const nlohmann::json::exception& e) {
    foundation::fail_file(fmt::format("{}: is no file of bench: {}", o.bench, e.what()));
  }
  if (!best && (o.bench_given || o.threads > 0))
    foundation::fail_input(fmt::format("{} has no measurement of {} in {} dimensions{}", o.bench, o.kind, dimension,
                                       o.threads > 0 ? fmt::format(" with {} threads", o.threads) : ""));
  return best;
}

void print(const table& t) {
  std::vector<std::size_t> width;
  for (const auto& row : t.rows) {
    width.resize(std::max(width.size(), row.size()));
    for (std::size_t k = 0; k < row.size(); ++k) width[k] = std::max(width[k], row[k].size());
  }
  fmt::print("{}\n", t.title);
  for (std::size_t n = 0; n < t.rows.size(); ++n) {
    std::string line = " ";
    for (std::size_t k = 0; k < t.rows[n].size(); ++k)
      line +=
          fmt::format(fmt::runtime(k < t.right.size() && t.right[k] ? " {:>{}}" : " {:<{}}"), t.rows[n][k], width[k]);
    line.erase(line.find_last_not_of(' ') + 1);
    fmt::print("{}\n", line);
    if (n == 0 && t.has_head)
      fmt::print("  {}\n", std::string(std::accumulate(width.begin(), width.end(), width.size() - 1), '-'));
  }
  fmt::print("{}\n", t.notes);
}

}  // namespace

machine this_machine(const shared_options& o, int dimension, double particles) {
  machine m{.cost = {}, .note = "not known: run bench, or give --rate"};
  if (o.rate) {
    m = {{.updates_per_second = *o.rate}, "given"};
  } else if (const auto found = read_speed(o, dimension, particles)) {
    m = *found;
  }
  m.cost.evaluations_per_step = evaluations.at(o.method);
  if (o.seconds && !(m.cost.updates_per_second > 0.0))
    foundation::fail_input("--run-time: needs the rate of updates of the machine: run bench, or give --rate");
  return m;
}

void answer::add(const std::string& title, const std::vector<quantity>& rows) {
  table t{title, {}, {false, true}};
  for (const auto& q : rows) {
    if (!q.place.empty()) all[json::json_pointer(q.place)] = q.value;
    const auto said = q.value.is_null()           ? "none"
                      : q.value.is_string()       ? q.value.get<std::string>()
                      : q.value.is_number_float() ? number(q.value.get<double>())
                                                  : q.value.dump();
    t.rows.push_back({q.symbol, said, q.unit, q.meaning, q.source, q.mark});
  }
  tables.push_back(t);
}

void answer::give(const shared_options& o, const char* sources) const {
  if (const auto lost = run::first_not_finite(all); !lost.empty())
    foundation::fail_calculation(lost + " is not a finite number: what is given lies too far apart");
  for (const auto& t : tables) print(t);
  fmt::print("{}\n", sources);
  if (!o.json.empty()) tools::write_json(o.json, all);
}

std::vector<quantity> costs(const machine& m, double particles, double seconds, const std::string& plan, answer& a) {
  const double per_step = m.cost.evaluations_per_step;
  const auto rate = or_null(m.cost.updates_per_second);
  a.all["machine"] = {{"evaluations_per_step", per_step}, {"updates_per_second", rate}, {"source", m.note}};
  a.all[json::json_pointer(plan + "/run_time_s")] = or_null(seconds);
  std::vector<quantity> rows{{"particles", plan + "/particles", particles}, {"rate", "", rate, "1/s", m.note}};
  if (seconds > 0.0)
    rows.push_back({"run time", "", run::duration_text(seconds), "",
                    fmt::format("at {} right-hand sides a step", number(per_step))});
  return rows;
}

std::string number(double value) { return fmt::format("{:.4g}", value); }

}  // namespace tetsuame::plan
