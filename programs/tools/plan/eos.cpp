// plan eos: states, curves and tables of an equation of state.
#include <fmt/format.h>
#include <fmt/ostream.h>

#include <cmath>
#include <eos/tabulate.hpp>
#include <filesystem>
#include <foundation/error.hpp>
#include <fstream>
#include <json_file.hpp>
#include <optional>
#include <plan/shared.hpp>
#include <tables/cells.hpp>

namespace tetsuame::plan {

namespace {

constexpr int points = 120;  // of a curve

struct state {
  double rho, p, T, u, c;
  double shock = 0.0, particle = 0.0;  // m/s: velocities of a shock that reaches it
};

struct curve {
  std::string kind;
  double start;  // K, at its foot
  std::vector<state> states;
};

eos::material_options material_of(const eos_question& q) {
  eos::material_options o;
  o.name = q.name;
  o.tillotson = q.tillotson;
  o.table = q.file;
  o.curve = q.curve;
  for (const auto& argument : q.set) {
    const std::size_t equals = argument.find('=');
    const auto key = argument.substr(0, equals);
    const auto found = std::ranges::find(eos::parameters, key, &eos::parameter::key);
    const auto value = equals == std::string::npos ? std::nullopt : tables::number_of(argument.substr(equals + 1));
    if (found == eos::parameters.end() || !value)
      foundation::fail_input(fmt::format("--set {}: expected key=number, with a key of &material", argument));
    o.*(found->member) = value;
  }
  return o;
}

// What is drawn where the question does not say: three temperatures, some pressures.
void choose_states(const eos::any& m, const eos::material_options& o, eos_question& q) {
  const bool gas = o.gamma.has_value();
  if (q.pressures.empty()) q.pressures = gas ? std::vector{1e5, 1e6, 1e7} : std::vector{1e5, 1e10, 1e11, 3e11, 1e12};
  if (!q.temperatures.empty()) return;
  if (const auto* table = std::get_if<eos::tabulated>(&m)) {
    const auto& r = table->reach();
    for (const double part : {0.2, 0.5, 0.8}) q.temperatures.push_back(r.T_low * std::pow(r.T_high / r.T_low, part));
  } else {
    for (const double times : {1.0, 2.0, 4.0})
      q.temperatures.push_back(times * o.reference_temperature.value_or(300.0));
  }
}

// None where the material has no such state.
std::optional<double> density_at(const eos::any& m, double p, double T) {
  try {
    return eos::density(m, p, T);
  } catch (const foundation::error&) {
    return {};
  }
}

state state_at(const eos::caloric& m, double rho, double T) {
  const double u = m.internal_energy(rho, T);
  return {rho, eos::pressure(m.material(), rho, T), T, u, m.at(rho, u).c};
}

// Where curves begin: the lowest pressure that the material has at T, as an isotherm's density.
std::optional<state> foot(const eos::caloric& m, const eos_question& q, double T) {
  for (const double p : q.pressures)
    if (const auto rho = density_at(m.material(), p, T)) return state_at(m, *rho, T);
  return {};
}

bool is_finite(const state& s) { return std::isfinite(s.p) && std::isfinite(s.T) && std::isfinite(s.u); }

curve isotherm(const eos::caloric& m, const state& from, double p_high) {
  curve line{"isotherm", from.T, {}};
  const auto end = density_at(m.material(), p_high, from.T);
  for (int k = 0; end && k <= points; ++k)
    line.states.push_back(state_at(m, from.rho * std::pow(*end / from.rho, static_cast<double>(k) / points), from.T));
  return line;
}

// du = p/rho^2 drho by the classical Runge-Kutta steps in ln rho.
curve isentrope(const eos::caloric& m, const state& from, double p_high) {
  constexpr double step = 0.01;
  curve line{"isentrope", from.T, {from}};
  while (line.states.back().p < p_high && is_finite(line.states.back())) {
    const state& last = line.states.back();
    const auto slope = [&](double h, double u) {
      const double rho = last.rho * std::exp(h);
      return m.at(rho, u).p / rho;
    };
    const double a = slope(0.0, last.u), b = slope(0.5 * step, last.u + 0.5 * step * a);
    const double c = slope(0.5 * step, last.u + 0.5 * step * b), d = slope(step, last.u + step * c);
    const double u = last.u + step / 6.0 * (a + 2.0 * (b + c) + d), rho = last.rho * std::exp(step);
    const eos::caloric_state s = m.at(rho, u);
    line.states.push_back({rho, s.p, s.T, u, s.c});
  }
  if (!is_finite(line.states.back())) line.states.pop_back();
  return line;
}

// u = u_0 + (p + p_0)/2 (1/rho_0 - 1/rho), p by secant steps at each density.
curve hugoniot(const eos::caloric& m, const state& from, double p_high) {
  constexpr double step = 0.005;
  curve line{"hugoniot", from.T, {from}};
  for (double rho = from.rho * (1.0 + step); line.states.back().p < p_high; rho *= 1.0 + step) {
    const double dV = 1.0 / from.rho - 1.0 / rho;
    const auto energy = [&](double p) { return from.u + 0.5 * (p + from.p) * dV; };
    const auto miss = [&](double p) { return m.at(rho, energy(p)).p - p; };
    double p0 = line.states.back().p, f0 = miss(p0), p1 = p0 + f0, f1 = miss(p1);
    for (int n = 0; n < 50 && f1 != f0 && std::abs(p1 - p0) > 1e-13 * std::abs(p1); ++n) {
      const double next = p1 - f1 * (p1 - p0) / (f1 - f0);
      p0 = p1, f0 = f1, p1 = next, f1 = miss(p1);
    }
    const eos::caloric_state s = m.at(rho, energy(p1));
    if (!(std::abs(s.p - p1) <= 1e-6 * std::abs(p1) && p1 > line.states.back().p)) break;  // as dense as it gets
    line.states.push_back({rho, p1, s.T, energy(p1), s.c, std::sqrt((p1 - from.p) / (from.rho * from.rho * dV)),
                           std::sqrt((p1 - from.p) * dV)});
  }
  return line;
}

std::vector<curve> curves_of(const eos::caloric& m, const eos_question& q) {
  const double p_high = q.pressures.back();
  std::vector<curve> all;
  for (const double T : q.temperatures)
    if (const auto from = foot(m, q, T)) {
      all.push_back(isotherm(m, *from, p_high));
      all.push_back(isentrope(m, *from, p_high));
    }
  if (const auto from = foot(m, q, q.temperatures.front())) all.push_back(hugoniot(m, *from, p_high));
  std::erase_if(all, [](const curve& line) { return line.states.size() < 2; });
  return all;
}

std::ofstream opened(const std::string& path) {
  std::ofstream file(path);
  if (!file) foundation::fail_file(path + ": cannot be written");
  return file;
}

void close(std::ofstream& file, const std::string& path) {
  file.close();
  if (!file) foundation::fail_file(path + ": cannot be written; is there space?");
}

// A file of each kind: isotherm.csv, isentrope.csv, hugoniot.csv.
void write_curves(const std::string& folder, const std::vector<curve>& curves) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  for (const std::string kind : {"isotherm", "isentrope", "hugoniot"}) {
    const auto path = (std::filesystem::path(folder) / (kind + ".csv")).string();
    auto file = opened(path);
    fmt::print(file,
               "start [K],rho [kg/m^3],p [Pa],T [K],u [J/kg],c [m/s],shock velocity [m/s],particle velocity [m/s]\n");
    for (const auto& line : curves)
      for (const state& s : line.states)
        if (line.kind == kind)
          fmt::print(file, "{:g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", line.start, s.rho, s.p, s.T, s.u,
                     s.c, s.shock, s.particle);
    close(file, path);
  }
}

void write_table(const eos::caloric& m, const eos_question& q) {
  if (q.rho.size() != 2 || q.T.size() != 2)
    foundation::fail_input("--table: needs --rho LOW HIGH and --T LOW HIGH, its range");
  for (const auto& range : {q.rho, q.T})
    if (!(range[0] > 0.0 && range[1] > range[0]))
      foundation::fail_input(fmt::format("--rho, --T: expected 0 < LOW < HIGH, found {:g} {:g}", range[0], range[1]));
  const auto table = eos::tabulate(m, {q.rho[0], q.rho[1], q.T[0], q.T[1], q.nodes[0], q.nodes[1]});
  auto file = opened(q.table);
  eos::write_table(file, table);
  close(file, q.table);
  fmt::print("{}: {} densities from {:g} to {:g} kg/m^3, {} temperatures from {:g} to {:g} K\n", q.table, q.nodes[0],
             q.rho[0], q.rho[1], q.nodes[1], q.T[0], q.T[1]);
}

// Lines of all states that the material has, and how many it has not.
table say_states(const eos::any& m, const eos_question& q, json& all) {
  table t{.title = fmt::format("{}: {}", eos::about(m).name, eos::about(m).source),
          .rows = {{"T", "p", "rho", "K_T", "K_S", "c", "alpha", "c_V", "gamma"},
                   {"K", "Pa", "kg/m^3", "Pa", "Pa", "m/s", "1/K", "J/(kg K)", ""}},
          .right = std::vector<bool>(9, true),
          .has_head = true};
  if (eos::about(m).illustrative) t.title += " (illustrative)";
  const auto known = [](double x) { return std::isfinite(x) ? json(x) : json(nullptr); };
  for (const double T : q.temperatures)
    for (const double p : q.pressures) {
      const auto rho = density_at(m, p, T);
      if (!rho) {
        t.rows.push_back({number(T), number(p), "none", "", "", "", "", "", ""});
        continue;
      }
      const auto s = eos::evaluate(m, *rho, T);
      const double gamma = s.alpha * s.K_T / (*rho * s.c_V), K_S = *rho * s.sound_speed * s.sound_speed;
      t.rows.push_back({number(T), number(p), fmt::format("{:.6g}", *rho), number(s.K_T), number(K_S),
                        number(s.sound_speed), number(s.alpha), number(s.c_V), number(gamma)});
      all.push_back({{"T_K", T},
                     {"p_Pa", p},
                     {"rho_kg_m3", *rho},
                     {"K_T_Pa", s.K_T},
                     {"K_S_Pa", known(K_S)},
                     {"c_m_s", known(s.sound_speed)},
                     {"alpha_1_K", known(s.alpha)},
                     {"c_V_J_kg_K", known(s.c_V)},
                     {"gamma", known(gamma)}});
    }
  return t;
}

}  // namespace

void answer_eos(eos_question& q) {
  const auto options = eos::resolve(material_of(q));
  const eos::any m = eos::make(options);
  choose_states(m, options, q);
  std::ranges::sort(q.pressures);
  answer a;
  a.all["question"] = "eos";
  a.all["name"] = eos::about(m).name;
  a.all["source"] = eos::about(m).source;
  a.all["illustrative"] = eos::about(m).illustrative;
  a.all["states"] = json::array();
  a.tables.push_back(say_states(m, q, a.all["states"]));
  shared_options shared;
  shared.json = q.json;
  a.give(shared, "docs/theory/eos.md");
  const eos::caloric energy(m);
  if (!q.output.empty()) write_curves(q.output, curves_of(energy, q));
  if (!q.table.empty()) write_table(energy, q);
}

}  // namespace tetsuame::plan
