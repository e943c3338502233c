// plan timestep: how many steps metal takes to sink through silicate if sound is damped, not slowed.
#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cmath>
#include <foundation/error.hpp>
#include <fstream>
#include <plan/shared.hpp>
#include <run/amounts.hpp>
#include <two_fluids/options.hpp>

namespace tetsuame::plan {

namespace {

using namespace relaxation;

// What a run of rti or drop was, and what it measured, to stand beside the estimates.
struct overturn_run {
  two_layers system;  // as run; c from the linear equations of state, else the default
  bool sound_known;   // whether c is that of the run
  std::int64_t n;     // particles along the height
  int dimension;
  json measured;  // as it goes into the file
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

overturn_run as_run(const two_fluids::options& o) {
  const auto &lower = o.material[0], &upper = o.material[1];
  overturn_run r{};
  r.sound_known = lower.eos == "linear" && upper.eos == "linear";
  r.n = o.domain.particles[1];
  r.dimension = static_cast<int>(o.domain.dimension);
  r.system.L = o.domain.length[1];
  r.system.g = o.gravity;
  r.system.rho_min = std::min(lower.density, upper.density);
  r.system.delta_rho = std::abs(upper.density - lower.density);
  r.system.eta = std::max(lower.viscosity, upper.viscosity);
  if (r.sound_known) {
    r.system.c = 0.0;
    for (const auto& one : o.material)
      r.system.c = std::max(r.system.c, std::sqrt(one.bulk_modulus.value_or(o.bulk_modulus) / one.density));
  }
  return r;
}

// Of a run's folder: resolved.nml, summary.json, history.csv. fail_file if one is missing or damaged, fail_input if it
// is no run of rti or drop.
overturn_run read_run(const std::string& folder) {
  std::string program, status;
  double time, steps, evaluations;
  json fastest, tau, run_time;  // null: not measured, or not reached
  try {
    auto file = open(folder + "/summary.json");
    const auto summary = json::parse(file);
    program = summary.at("program");
    status = summary.at("status");
    time = summary.at("time");
    steps = summary.at("steps");
    evaluations = summary.at("rhs_evaluations");
    const auto number_of = [](const json& all, const char* key) {
      return all.contains(key) && all[key].is_number() ? all[key] : json();
    };
    const auto metrics = summary.value("metrics", json::object());
    fastest = number_of(metrics, "v_rms_max");
    tau = number_of(metrics, "time_of_fall_0.3");
    run_time = number_of(summary, "stepping_seconds");
  } catch (const json::exception& e) {
    foundation::fail_file(fmt::format("{}/summary.json: is no summary of a run: {}", folder, e.what()));
  }
  if (program != "rti" && program != "drop")
    foundation::fail_input(
        fmt::format("--run {}: a run of {}; metal through silicate is run by rti and drop", folder, program));

  using two_fluids::problem_kind;
  two_fluids::options o;
  namelist::schema schema;
  two_fluids::declare(schema, program == "rti" ? problem_kind::rayleigh_taylor : problem_kind::drop, o);
  schema.read(namelist::parse_file(folder + "/resolved.nml"));
  auto r = as_run(o);
  const auto columns = read_history(folder + "/history.csv");
  const auto& velocity = columns.at("fall_velocity");
  json steps_to_tau;
  if (tau.is_number()) {
    const auto& times = columns.at("time");
    const auto at = std::lower_bound(times.begin(), times.end(), tau.get<double>()) - times.begin();
    steps_to_tau = columns.at("step")[std::min(static_cast<std::size_t>(at), times.size() - 1)];
  }
  r.measured = {{"folder", folder},
                {"program", program},
                {"status", status},
                {"n", r.n},
                {"eta_lower_Pa_s", o.material[0].viscosity},
                {"eta_upper_Pa_s", o.material[1].viscosity},
                {"v_rms_max_m_s", fastest},
                {"steps_to_tau", steps_to_tau},
                {"time_s", time},
                {"steps", steps},
                {"rhs_evaluations", evaluations},
                {"run_time_s", run_time},
                {"V_m_s", *std::max_element(velocity.begin(), velocity.end())},
                {"tau_s", tau},
                {"dt_s", steps > 0.0 ? time / steps : 0.0}};
  return r;
}

// Beside the run; what the note prints for its example, n = 75 in 1500 km, is rounded at each step on the way [S0,
// section 2].
void say_beside(const overturn_plan& p, const overturn_run& r, answer& a) {
  const json& m = r.measured;
  a.all["measured"] = m;
  const double V = 20.0, tau = 7e4, dt = 2.0, steps = 5e3;  // of the note
  a.all["note"] = {{"V_m_s", V}, {"tau_s", tau}, {"dt_s", dt}, {"steps", steps}};
  const auto text = [&](const char* key) { return m[key].get<std::string>(); };
  table t{fmt::format("Beside the run {} ({}, {}, n = {})", text("folder"), text("program"), text("status"), r.n),
          {{"", "note", "estimate", "measured", "measured/estimate", "unit", "measured as"}},
          {false, true, true, true, true},
          true};
  const auto add = [&](const char* name, const char* unit, double note, double estimate, const json& measured,
                       const std::string& how) {
    const bool reached = measured.is_number();
    const auto value = reached ? measured.get<double>() : 0.0;
    t.rows.push_back({name, number(note), number(estimate), reached ? number(value) : "not reached",
                      reached && estimate > 0.0 ? fmt::format("{:.3g}", value / estimate) : "", unit, how});
  };
  add("V", "m/s", V, p.V, m["V_m_s"], "largest mean velocity of the metal");
  add("tau", "s", tau, p.tau, m["tau_s"], "until the metal's centroid has fallen by 0.3 L");
  add("dt", "s", dt, p.dt, m["dt_s"], "mean of the run");
  add("steps", "", steps, p.steps, m["steps_to_tau"],
      fmt::format("until then; the whole run {} ({} right-hand sides)", number(m["steps"]),
                  number(m["rhs_evaluations"])));
  t.notes = fmt::format(
      "{}note: as printed there, for n = 75 and L = 1.5e6 m; estimate: its formulas for what was run, c = {} m/s\n",
      r.sound_known ? "" : "The run's equations of state are not linear: c as given, or the note's.\n",
      number(r.sound_known ? r.system.c : p.dx / p.dt_sound));
  a.tables.push_back(t);
}

void say_plan(const timestep_question& q, const overturn_plan& p, const machine& m, answer& a) {
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

void say_backwards(const timestep_question& q, const machine& m, answer& a) {
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

}  // namespace

void answer_timestep(timestep_question& q) {
  std::optional<overturn_run> ran;
  if (!q.run.empty()) {
    ran = read_run(q.run);
    // The system that was run, but for what the command line says.
    q.system = ran->system;
    q.n = ran->n;
    q.dimension = ran->dimension;
    q.say_again();
  }
  const machine m = this_machine(q.shared, q.dimension, std::pow(static_cast<double>(q.n), q.dimension));
  const auto p = plan_overturn(q.system, q.n, q.dimension, m.cost);
  answer a;
  a.all["question"] = "timestep";
  say_plan(q, p, m, a);
  if (ran) say_beside(p, *ran, a);
  if (q.shared.steps || q.shared.seconds) say_backwards(q, m, a);
  a.give(q.shared, "S0: note of May 2022, section 2: estimates of orders of magnitude (docs/theory/relaxation.md)");
}

}  // namespace tetsuame::plan
