// plan timestep: how many steps metal takes to sink through silicate if sound is damped, not slowed.
#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cmath>
#include <foundation/error.hpp>
#include <fstream>
#include <map>
#include <memory>
#include <plan/shared.hpp>
#include <relaxation/steps.hpp>
#include <two_fluids/options.hpp>

namespace tetsuame::plan {

namespace {

using namespace relaxation;

// What a run of rti or drop measured, to stand beside the estimates.
struct measured_overturn {
  std::string folder, program, status;
  relaxation::two_layers system;  // as run; c from the linear equations of state, else the default
  bool sound_known;               // whether c is that of the run
  std::int64_t n;                 // particles along the height
  int dimension;
  double eta_lower, eta_upper;          // Pa s
  double V;                             // m/s, largest of the metal's mean velocity downwards
  std::optional<double> tau;            // s, until the metal's centroid has fallen by 0.3 L
  std::optional<double> steps_to_tau;   // steps until then
  double time, steps, evaluations, dt;  // s, of the whole run; dt: mean
  std::optional<double> seconds;        // of computing, the whole run
  std::optional<double> v_rms_max;      // m/s
};

std::ifstream open(const std::string& path) {
  std::ifstream file(path);
  if (!file) foundation::fail_file(path + ": cannot be read; is it the output folder of a run?");
  return file;
}

// The columns of history.csv by name, without units.
std::map<std::string, std::vector<double>> read_history(const std::string& path) {
  auto file = open(path);
  std::vector<std::string> names, cells;
  std::string line;
  const auto split = [&](std::vector<std::string>& into) {
    boost::algorithm::split(into, line, boost::is_any_of(","));
  };
  if (!std::getline(file, line)) foundation::fail_file(path + ": is empty");
  split(names);
  for (auto& name : names) name = name.substr(0, name.find(" ["));
  std::map<std::string, std::vector<double>> columns;
  for (std::size_t row = 2; std::getline(file, line); ++row) {
    split(cells);
    if (cells.size() != names.size())
      foundation::fail_file(fmt::format("{}:{}: {} values under {} names", path, row, cells.size(), names.size()));
    try {
      for (std::size_t k = 0; k < names.size(); ++k) columns[names[k]].push_back(std::stod(cells[k]));
    } catch (const std::exception&) {
      foundation::fail_file(fmt::format("{}:{}: is no line of numbers", path, row));
    }
  }
  for (const char* name : {"time", "step", "fall_velocity"})
    if (columns[name].empty()) foundation::fail_file(fmt::format("{}: has no values of {}", path, name));
  return columns;
}

std::optional<double> maybe(const nlohmann::json& j, const std::string& key) {
  const auto found = j.find(key);
  return found != j.end() && found->is_number() ? std::optional(found->get<double>()) : std::nullopt;
}

// Of a run's folder: resolved.nml, summary.json, history.csv. fail_file if one is missing or damaged, fail_input if it
// is no run of rti or drop.
measured_overturn read_run(const std::string& folder) {
  measured_overturn m{};
  m.folder = folder;
  nlohmann::json summary;
  try {
    auto file = open(folder + "/summary.json");
    summary = nlohmann::json::parse(file);
    m.program = summary.at("program").get<std::string>();
    m.status = summary.at("status").get<std::string>();
    m.time = summary.at("time").get<double>();
    m.steps = summary.at("steps").get<double>();
    m.evaluations = summary.at("rhs_evaluations").get<double>();
  } catch (const nlohmann::json::exception& e) {
    foundation::fail_file(fmt::format("{}/summary.json: is no summary of a run: {}", folder, e.what()));
  }
  if (m.program != "rti" && m.program != "drop")
    foundation::fail_input(
        fmt::format("--run {}: a run of {}; metal through silicate is run by rti and drop", folder, m.program));

  two_fluids::options o;
  namelist::schema schema;
  two_fluids::declare(
      schema, m.program == "rti" ? two_fluids::problem_kind::rayleigh_taylor : two_fluids::problem_kind::drop, o);
  schema.read(namelist::parse_file(folder + "/resolved.nml"));
  const auto& [lower, upper] = o.material;
  m.dimension = static_cast<int>(o.domain.dimension);
  m.n = o.domain.particles[1];
  m.eta_lower = lower.viscosity;
  m.eta_upper = upper.viscosity;
  m.system.L = o.domain.length[1];
  m.system.g = o.gravity;
  m.system.rho_min = std::min(lower.density, upper.density);
  m.system.delta_rho = std::abs(upper.density - lower.density);
  m.system.eta = std::max(lower.viscosity, upper.viscosity);
  m.sound_known = lower.eos == "linear" && upper.eos == "linear";
  if (m.sound_known) {
    m.system.c = 0.0;
    for (const auto& one : o.material)
      m.system.c = std::max(m.system.c, std::sqrt(one.bulk_modulus.value_or(o.bulk_modulus) / one.density));
  }

  const auto columns = read_history(folder + "/history.csv");
  const auto& velocity = columns.at("fall_velocity");
  m.V = *std::max_element(velocity.begin(), velocity.end());
  m.dt = m.steps > 0.0 ? m.time / m.steps : 0.0;
  const auto metrics = summary.value("metrics", nlohmann::json::object());
  m.tau = maybe(metrics, "time_of_fall_0.3");
  m.v_rms_max = maybe(metrics, "v_rms_max");
  m.seconds = maybe(summary, "stepping_seconds");
  if (m.tau) {
    const auto& time = columns.at("time");
    const auto at = std::lower_bound(time.begin(), time.end(), *m.tau) - time.begin();
    m.steps_to_tau = columns.at("step")[std::min(static_cast<std::size_t>(at), time.size() - 1)];
  }
  return m;
}

struct question {
  shared_options shared;
  two_layers system;
  std::int64_t n = 75;
  int dimension = 2;
  std::string run;  // folder of a run; empty: none
  CLI::App* app = nullptr;
  bool given(const char* option) const { return app->get_option(option)->count() > 0; }
};

// The system that was run, but for what the command line says.
void take_over(question& q, const measured_overturn& m) {
  auto& s = q.system;
  if (!q.given("--L")) s.L = m.system.L;
  if (!q.given("--g")) s.g = m.system.g;
  if (!q.given("--rho-min")) s.rho_min = m.system.rho_min;
  if (!q.given("--delta-rho")) s.delta_rho = m.system.delta_rho;
  if (!q.given("--c")) s.c = m.system.c;
  if (!q.given("--eta")) s.eta = m.system.eta;
  if (!q.given("--n")) q.n = m.n;
  if (!q.given("--dimension")) q.dimension = m.dimension;
}

// Beside the run; what the note prints for its example, n = 75 in 1500 km, is rounded at each step on the way [S0,
// section 2].
void say_beside(const overturn_plan& p, const measured_overturn& m, answer& a) {
  const auto or_null = [](const std::optional<double>& x) { return x ? json(*x) : json(nullptr); };
  a.all["measured"] = {{"folder", m.folder},
                       {"program", m.program},
                       {"status", m.status},
                       {"n", m.n},
                       {"eta_lower_Pa_s", m.eta_lower},
                       {"eta_upper_Pa_s", m.eta_upper},
                       {"v_rms_max_m_s", or_null(m.v_rms_max)},
                       {"steps_to_tau", or_null(m.steps_to_tau)},
                       {"time_s", m.time},
                       {"steps", m.steps},
                       {"rhs_evaluations", m.evaluations},
                       {"run_time_s", or_null(m.seconds)}};
  table t{fmt::format("Beside the run {} ({}, {}, n = {})", m.folder, m.program, m.status, m.n),
          {{"", "note", "estimate", "measured", "measured/estimate", "unit", "measured as"}},
          {false, true, true, true, true},
          true};
  const auto add = [&](const char* name, const char* unit, double note, double estimate, std::optional<double> measured,
                       const std::string& how) {
    const auto ratio = measured && estimate > 0.0 ? fmt::format("{:.3g}", *measured / estimate) : "";
    t.rows.push_back(
        {name, number(note), number(estimate), measured ? number(*measured) : "not reached", ratio, unit, how});
  };
  const double V = 20.0, tau = 7e4, dt = 2.0, steps = 5e3;  // of the note
  a.all["note"] = {{"V_m_s", V}, {"tau_s", tau}, {"dt_s", dt}, {"steps", steps}};
  a.all["measured"].update({{"V_m_s", m.V}, {"tau_s", or_null(m.tau)}, {"dt_s", m.dt}});
  add("V", "m/s", V, p.V, m.V, "largest mean velocity of the metal");
  add("tau", "s", tau, p.tau, m.tau, "until the metal's centroid has fallen by 0.3 L");
  add("dt", "s", dt, p.dt, m.dt, "mean of the run");
  add("steps", "", steps, p.steps, m.steps_to_tau,
      fmt::format("until then; the whole run {} ({} right-hand sides)", number(m.steps), number(m.evaluations)));
  t.notes = fmt::format(
      "{}note: as printed there, for n = 75 and L = 1.5e6 m; estimate: its formulas for what was run, c = {} m/s\n",
      m.sound_known ? "" : "The run's equations of state are not linear: c as given, or the note's.\n",
      number(m.sound_known ? m.system.c : p.dx / p.dt_sound));
  a.tables.push_back(t);
}

void say_plan(const question& q, const overturn_plan& p, const machine& m, answer& a) {
  const auto& s = q.system;
  a.add("Given", {{"L", "/given/L_m", s.L, "m", "edge of the box"},
                  {"n", "/given/n", q.n, "", "particles along it"},
                  {"c", "/given/c_m_s", s.c, "m/s", "speed of sound"},
                  {"rho_min", "/given/rho_min_kg_m3", s.rho_min, "kg/m^3", "least density"},
                  {"Delta_rho", "/given/delta_rho_kg_m3", s.delta_rho, "kg/m^3", "density difference"},
                  {"g", "/given/g_m_s2", s.g, "m/s^2", "gravity"}});
  a.all["given"]["dimension"] = q.dimension;
  a.all["given"]["eta_Pa_s"] = s.eta ? json(*s.eta) : json(nullptr);
  const auto mark = [&](const char* which) { return p.binding == which ? "<- binds" : ""; };
  a.add("Time steps",
        {{"dx", "/plan/dx_m", p.dx, "m", "L/n", "S0 (26)"},
         {"eta", "/plan/eta_Pa_s", p.eta, "Pa s", s.eta ? "given" : "c rho_min dx: sound dies at once",
          s.eta ? "" : "S0 (18)"},
         {"dt_CFL", "/plan/dt_sound_s", p.dt_sound, "s", "dx/c", "S0 (9)", mark("sound")},
         {"dt_mom", "/plan/dt_momentum_s", p.dt_momentum, "s", "rho_min dx^2/eta", "S0 (10)", mark("momentum")},
         {"dt_heat", "/plan/dt_heat_s", s.conductivity > 0.0 ? json(p.dt_heat) : json(nullptr), "s",
          "rho_min c_p dx^2/k", "S0 (11)", mark("heat")}});
  a.all["plan"]["binding"] = p.binding;
  std::vector<quantity> rows{{"V", "/plan/V_m_s", p.V, "m/s", "dx^2 Delta_rho g/(2 eta)", "S0 (16)"},
                             {"tau", "/plan/tau_s", p.tau, "s", "L/V", "S0 (17)"},
                             {"steps", "/plan/steps", p.steps, "", "tau/dt", "S0 (13)"},
                             {"", "/plan/steps_of_20", steps_of_20(s, q.n), "",
                              "2 c^2 rho_min n^2/(L Delta_rho g), at eta of (18)", "S0 (20)"}};
  for (const auto& cost : costs(m, p.particles, p.seconds, "/plan", a)) rows.push_back(cost);
  a.add("One overturn", rows);
}

void say_backwards(const question& q, const machine& m, answer& a) {
  budget b;
  if (q.shared.steps) b.steps = *q.shared.steps;
  if (q.shared.seconds) b.seconds = *q.shared.seconds;
  const affordable f = afford(q.system, q.n, q.dimension, m.cost, b);
  std::string within = q.shared.steps ? number(*q.shared.steps) + " steps" : "";
  if (q.shared.seconds) within += (within.empty() ? "" : " and ") + run::duration_text(*q.shared.seconds);
  a.add("Backwards: what fits into " + within,
        {{"n", "/backwards/n", f.n, "", "the largest, at L as given; 0: none"},
         {"L", "/backwards/L_m", f.L, "m", "the smallest, at n as given and eta by (18)"},
         {"eta", "/backwards/eta_Pa_s", f.eta, "Pa s",
          fmt::format("the largest, at n and L as given; {} of (18){}", number(f.eta_over_damping),
                      f.eta_over_damping < 1.0 ? ": sound outlives a step" : "")}});
  a.all["backwards"]["eta_over_damping"] = f.eta_over_damping;
}

void run(question q) {
  std::optional<measured_overturn> measured;
  if (!q.run.empty()) {
    measured = read_run(q.run);
    take_over(q, *measured);
  }
  const machine m = this_machine(q.shared, q.dimension, std::pow(static_cast<double>(q.n), q.dimension));
  const auto p = plan_overturn(q.system, q.n, q.dimension, m.cost);
  answer a;
  a.all["question"] = "timestep";
  say_plan(q, p, m, a);
  if (measured) say_beside(p, *measured, a);
  if (q.shared.steps || q.shared.seconds) say_backwards(q, m, a);
  a.give(q.shared, "S0: note of May 2022, section 2: estimates of orders of magnitude");
}

}  // namespace

std::function<void()> timestep_question(CLI::App& app) {
  auto q = std::make_shared<question>();
  q->shared.method = "euler";  // the note's
  q->shared.kind = "program_c";
  auto& s = q->system;
  app.add_option("--n", q->n, "particles along an edge")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1} << 30))
      ->capture_default_str();
  const auto add = [&](const char* option, auto& value, const char* meaning) {
    return app.add_option(option, value, meaning)->check(above_zero());
  };
  add("--L", s.L, "edge of the box (m)")->capture_default_str();
  add("--c", s.c, "speed of sound (m/s)")->capture_default_str();
  add("--rho-min", s.rho_min, "least density (kg/m3)")->capture_default_str();
  add("--delta-rho", s.delta_rho, "density difference (kg/m3)")->capture_default_str();
  add("--g", s.g, "gravity (m/s2)")->capture_default_str();
  add("--eta", s.eta, "viscosity (Pa s); default: c rho_min dx");
  add("--c-p", s.heat_capacity, "heat capacity (J/(kg K))")->capture_default_str();
  app.add_option("--k", s.conductivity, "thermal conductivity (W/(m K)); 0: no limit from it")
      ->check(finite(0.0, largest, false))
      ->capture_default_str();
  app.add_option("--run", q->run,
                 "output folder of a run of rti or drop: its system, and what it measured beside the estimates")
      ->type_name("DIR");
  q->app = &app;
  app.add_option("--dimension", q->dimension, "of space")->check(CLI::IsMember({2, 3}))->capture_default_str();
  add_shared(app, q->shared);
  return [q] { run(*q); };
}

}  // namespace tetsuame::plan
