#include <fmt/format.h>

#include <foundation/error.hpp>
#include <map>
#include <plan/shared.hpp>
#include <run/summary.hpp>

namespace tetsuame::plan {

namespace {

// Right-hand sides a step of the methods of &time with fixed steps.
const std::map<std::string, double> evaluations{{"euler", 1},   {"ab2", 1}, {"order_2", 2}, {"ssp_rk3", 3},
                                                {"order_3", 3}, {"rk4", 4}, {"order_4", 5}, {"order_5", 6}};

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
  app.add_option("--bench", o.speed.bench, "file of bench")
      ->type_name("FILE")
      ->each([&o](const std::string&) { o.speed.bench_given = true; })
      ->capture_default_str();
  app.add_option("--case", o.speed.kind, "case of bench")->capture_default_str();
  app.add_option("--threads", o.speed.threads, "threads of the run (default: the most that bench measured)")
      ->check(CLI::Range(1, 4096));
  app.add_option("--json", o.json, "write everything to this file as well")->type_name("FILE");
}

machine this_machine(shared_options o, int dimension, double particles) {
  machine m;
  m.cost.evaluations_per_step = evaluations.at(o.method);
  if (o.rate) {
    m.cost.updates_per_second = *o.rate;
    return m;
  }
  o.speed.dimension = dimension;
  m.measured = read_speed(o.speed, particles);
  if (m.measured) m.cost.updates_per_second = m.measured->updates_per_second;
  if (o.seconds && !(m.cost.updates_per_second > 0.0))
    foundation::fail_input("--run-time: needs the rate of updates of the machine: run bench, or give --rate");
  return m;
}

std::string machine::note() const {
  if (measured)
    return fmt::format("bench: {} {}-D, {} particles, threads {}, load average {:.1f}, {}", measured->kind,
                       measured->dimension, measured->particles, measured->threads, measured->load_average,
                       measured->processor);
  return cost.updates_per_second > 0.0 ? "given" : "not known: run bench, or give --rate";
}

json as_json(const machine& m) {
  json j;
  j["evaluations_per_step"] = m.cost.evaluations_per_step;
  j["updates_per_second"] = m.cost.updates_per_second > 0.0 ? json(m.cost.updates_per_second) : json(nullptr);
  j["source"] = m.note();
  return j;
}

}  // namespace tetsuame::plan
