// plan relaxation: numbers, rules and steps of slowed convection.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <command.hpp>
#include <convection/options.hpp>
#include <functional>
#include <iostream>
#include <memory>
#include <plan/shared.hpp>
#include <relaxation/options.hpp>

namespace tetsuame::plan {

namespace {

using namespace relaxation;

struct question {
  shared_options shared;
  std::string input;
  std::vector<std::string> set;
  bool describe = false;
  double fraction = 0.1;
  std::optional<double> L, dT, rho, kappa, nu, g, alpha, c_p, K;
  std::optional<std::int64_t> n;
};

// The input of the convection program, and what came from the command line.
struct case_data {
  convection::options all;
  options& values = all.physics;
  double& temperature_bottom() { return all.walls.sides[2].temperature; }
  double& temperature_top() { return all.walls.sides[3].temperature; }
};

void declare_all(namelist::schema& schema, case_data& c) {
  convection::declare(schema, c.all);
  schema.pass_over("smoothing");
}

// Of the box to its height^dimension.
double volume_ratio(const domain::options& d) {
  const double across = d.length[0] / d.length[1];
  return d.dimension == 3 ? across * d.length[2] / d.length[1] : across;
}

void apply(const question& q, case_data& c) {
  auto& m = c.values.material;
  auto& d = c.all.domain;
  // kappa and nu are kept when the density or c_p alone changes hands.
  const double kappa = q.kappa.value_or(m.conductivity / (m.density * m.heat_capacity));
  const double nu = q.nu.value_or(m.viscosity / m.density);
  const bool dense = q.rho || q.c_p;
  if (q.rho) m.density = *q.rho;
  if (q.c_p) m.heat_capacity = *q.c_p;
  if (q.kappa || dense) m.conductivity = kappa * m.density * m.heat_capacity;
  if (q.nu || q.rho) m.viscosity = nu * m.density;
  if (q.alpha) m.expansivity = *q.alpha;
  if (q.K) m.bulk_modulus = *q.K;
  if (q.g) c.values.g = *q.g;
  if (q.dT) c.temperature_bottom() = c.temperature_top() + *q.dT;
  if (q.L)
    for (const std::size_t a : {0, 2, 1}) d.length[a] *= *q.L / d.length[1];  // the height last: it scales the others
  if (q.n)
    for (const std::size_t a : {0, 2, 1})
      d.particles[a] = std::llround(static_cast<double>(*q.n) * d.length[a] / d.length[1]);
}

void say_numbers(const fluid_layer& f, const case_data& c, answer& a) {
  const auto& m = c.values.material;
  a.add("Given", {{"L", "/given/L_m", f.L, "m", "height of the box"},
                  {"DeltaT", "/given/dT_K", f.dT, "K", "bottom less top"},
                  {"rho_0", "/given/rho_kg_m3", f.rho, "kg/m^3", "density"},
                  {"alpha", "/given/alpha_1_K", f.alpha, "1/K", "thermal expansivity"},
                  {"g", "/given/g_m_s2", f.g, "m/s^2", "gravity"},
                  {"kappa", "/given/kappa_m2_s", f.kappa, "m^2/s",
                   fmt::format("thermal diffusivity; k = {} W/(m K)", number(m.conductivity))},
                  {"nu", "/given/nu_m2_s", f.nu, "m^2/s",
                   fmt::format("kinematic viscosity; eta = {} Pa s", number(m.viscosity))},
                  {"K_0", "/given/K_Pa", f.K, "Pa", "bulk modulus"}});
  a.add("Numbers and speeds",
        {{"Ra", "/numbers/Ra", rayleigh(f), "", "alpha g DeltaT L^3/(kappa nu)", "S1 (19)"},
         {"Pr", "/numbers/Pr", prandtl(f), "", "nu/kappa", "S1 (20)"},
         {"M_th", "/numbers/M_th", thermal_mach(f), "", "kappa/(L c_0)", "S1 (21)"},
         {"eps", "/numbers/eps", thermal_strain(f), "", "alpha DeltaT", "S1 (22)"},
         {"c_0", "/speeds/c_0_m_s", sound_speed(f), "m/s", "(K_0/rho_0)^1/2", "S1 (69)"},
         {"V_s", "/speeds/stokes_m_s", stokes_speed(f, false), "m/s", "Stokes speed", "S1 (23)"},
         {"V_f", "/speeds/free_fall_m_s", free_fall_speed(f, false), "m/s", "free-fall speed", "S1 (24)"},
         {"V_s^tb", "/speeds/stokes_layers_m_s", stokes_speed(f, true), "m/s", "Stokes speed, boundary layers",
          "S1 (25)"},
         {"V_f^tb", "/speeds/free_fall_layers_m_s", free_fall_speed(f, true), "m/s", "free-fall speed, boundary layers",
          "S1 (26)"}});
}

void say_rules(const std::vector<rule>& rules, const recommendation& r, answer& a) {
  table t{"Rules: each quantity must lie far below its bound",
          {{"limits", "bound", "formula", "source", "for", ""}},
          {false, true},
          true};
  for (const auto& one : rules) {
    const char* mark = one.source == r.zeta_rule ? "<- sets zeta" : one.source == r.xi_rule ? "<- sets xi" : "";
    t.rows.push_back({one.limits, number(one.bound), one.formula, one.source, one.says, mark});
    a.all["rules"].push_back({{"limits", one.limits},
                              {"bound", one.bound},
                              {"formula", one.formula},
                              {"source", one.source},
                              {"for", one.says}});
  }
  a.tables.push_back(t);
}

// "0.1 of S1 (54)": a rule of the list above, and how far below its bound.
std::string set_by(const std::string& rule, double part) {
  return rule.starts_with("S1") ? fmt::format("{} of {}", number(part), rule) : rule;
}

void say_choice(const fluid_layer& f, const recommendation& r, const choice& w, answer& a) {
  const double xi_part = r.xi_rule == "S1 (43)" || r.xi_rule == "S1 (44)" ? w.mach : w.phi_xi;
  const bool viscous = reached_balance(f, r.layers) == relaxation::balance::viscous;
  a.all["recommended"] = {{"method", r.how}, {"zeta_rule", r.zeta_rule}, {"xi_rule", r.xi_rule}};
  a.add(fmt::format("Recommended: {}, {} boundary layers", r.how, r.layers ? "with" : "without"),
        {{"zeta", "/recommended/zeta", r.zeta, "", set_by(r.zeta_rule, w.mach)},
         {"xi", "/recommended/xi", r.xi, "", set_by(r.xi_rule, xi_part)},
         {"c_eff", "/recommended/c_eff_m_s", r.c_eff, "m/s", "c_0/(zeta xi), slowed sound"},
         {"Pr_eff", "/recommended/Pr_eff", r.Pr_eff, "", "Pr/xi^2"},
         {"V", "/recommended/V_m_s", r.speed, "m/s",
          fmt::format("reached: {} balances buoyancy", viscous ? "viscosity" : "inertia")},
         {"Mach", "/recommended/mach", r.mach, "", "V/c_eff"},
         {"Re_xi", "/recommended/reynolds", r.reynolds, "", "xi^2 V L/nu"}});
}

json bounds_json(const step_bounds& b) {
  return {{"sound_s", b.sound},
          {"momentum_s", b.momentum},
          {"heat_s", b.heat},
          {"least_s", b.least()},
          {"binding", b.binding()}};
}

json plan_json(const convection_plan& p) {
  return {{"n", p.n},
          {"particles", p.particles},
          {"dx_m", p.dx},
          {"time_step", bounds_json(p.dt)},
          {"turnover_s", p.tau},
          {"steps", p.steps},
          {"run_time_s", or_null(p.seconds)}};
}

void say_steps(const fluid_layer& f, const recommendation& r, const convection_plan& p, double fraction,
               const machine& m, answer& a) {
  const step_bounds plain = bounds(f, 1.0, 1.0, p.dx, fraction);
  const auto row = [&](const char* which, double slowed, double not_slowed, const std::string& formula, double over) {
    return std::vector<std::string>{which,
                                    number(slowed),
                                    number(not_slowed),
                                    "s",
                                    over == 1.0 ? formula : fmt::format("{}, over {}", formula, number(over)),
                                    p.dt.binding() == which ? "<- binds" : ""};
  };
  a.tables.push_back(
      {fmt::format("Time steps: {} of the limits, n = {}, dx = {} m", number(fraction), p.n, number(p.dx)),
       {{"", "slowed", "not slowed", "unit", "formula", ""},
        row("sound", p.dt.sound, plain.sound, "zeta xi dx/c_0", r.wave_share),
        row("momentum", p.dt.momentum, plain.momentum, "xi^2 dx^2/(2 nu)", r.viscous_share),
        row("heat", p.dt.heat, plain.heat, "dx^2/(2 kappa)", 1.0)},
       {false, true, true},
       true});
  a.all["plan"] = plan_json(p);
  a.all["not_slowed"] = {{"time_step", bounds_json(plain)}};
  std::vector<quantity> rows{
      {"tau", "", p.tau, "s", "L/V"},
      {"steps", "", p.steps, "", fmt::format("tau/dt; not slowed {}", number(p.tau / plain.least()))}};
  for (const auto& cost : costs(m, p.particles, p.seconds, "/plan", a)) rows.push_back(cost);
  a.add("One turnover", rows);
}

// Backwards: the largest n, with what it costs.
void answer_backwards(const question& q, const fluid_layer& f, const recommendation& r, const case_data& c,
                      const machine& m, answer& a) {
  const int dimension = static_cast<int>(c.all.domain.dimension);
  const double ratio = volume_ratio(c.all.domain);
  table t{"Backwards: the largest n for one turnover",
          {{"within", "n", "particles", "steps", "run time"}},
          {false, true, true, true, true},
          true};
  auto& all = a.all;
  const auto add = [&](const std::string& within, const char* key, const budget& b) {
    const std::int64_t n = largest_n(f, r, dimension, ratio, q.fraction, m.cost, b);
    if (n == 0) {
      t.rows.push_back({within, "none", "", "", ""});
      all["backwards"][key] = nullptr;
      return;
    }
    const auto p = plan_convection(f, r, n, dimension, ratio, q.fraction, m.cost);
    t.rows.push_back({within, fmt::format("{}", n), number(p.particles), number(p.steps),
                      p.seconds > 0.0 ? run::duration_text(p.seconds) : "not known"});
    all["backwards"][key] = plan_json(p);
  };
  if (q.shared.steps) add(number(*q.shared.steps) + " steps", "in_steps", {.steps = *q.shared.steps});
  if (q.shared.seconds) add(run::duration_text(*q.shared.seconds), "in_run_time", {.seconds = *q.shared.seconds});
  a.tables.push_back(t);
}

// The part of a wide range in which a turnover fits into the budget at this n, as others are.
struct span {
  double low, high;          // 0, 0: nowhere
  bool low_open, high_open;  // as far as was looked
};
span affordable_span(const std::function<bool(double)>& fits, double value) {
  constexpr int a_decade = 20, decades = 4;
  span found{0.0, 0.0, false, false};
  for (int k = -decades * a_decade; k <= decades * a_decade; ++k) {
    const double x = value * std::pow(10.0, static_cast<double>(k) / a_decade);
    if (!fits(x)) continue;
    if (found.high == 0.0) {
      found.low = x;
      found.low_open = k == -decades * a_decade;
    }
    found.high = x;
    found.high_open = k == decades * a_decade;
  }
  return found;
}

// L and the viscosity, where the note's rules choose the slowing: with them its steps depend on n far more than on
// these.
void answer_others(const question& q, const fluid_layer& f, const choice& w, const case_data& c, const machine& m,
                   answer& a) {
  auto& all = a.all;
  const auto& d = c.all.domain;
  const auto plan_of = [&](const fluid_layer& g) {
    return plan_convection(g, recommend(g, w), d.particles[1], static_cast<int>(d.dimension), volume_ratio(d),
                           q.fraction, m.cost);
  };
  const auto fits = [&](const fluid_layer& g) {
    const auto p = plan_of(g);
    return p.steps <= q.shared.steps.value_or(HUGE_VAL) && p.seconds <= q.shared.seconds.value_or(HUGE_VAL);
  };
  table t{fmt::format("Backwards: at n = {}, each with all else as given", d.particles[1]),
          {{"", "from", "to", "unit", "given", ""}},
          {false, true, true, false, true, false},
          true};
  const auto add = [&](const char* name, const char* key, const char* unit, double value, auto change) {
    const span s = affordable_span(
        [&](double x) {
          fluid_layer g = f;
          change(g, x);
          return fits(g);
        },
        value);
    if (s.high == 0.0) {
      fluid_layer less = f, more = f;
      change(less, 0.1 * value);
      change(more, 10.0 * value);
      const double fewest = plan_of(less).steps, most = plan_of(more).steps;
      const bool same = std::abs(most / fewest - 1.0) < 1e-9;
      t.rows.push_back({name, "none", "none", unit, number(value),
                        same ? "does not change the steps: n does" : "none within 4 decades of what is given"});
      all["backwards"][key] = nullptr;
      return;
    }
    t.rows.push_back({name, s.low_open ? "any" : number(s.low), s.high_open ? "any" : number(s.high), unit,
                      number(value), s.low_open && s.high_open ? "does not decide" : ""});
    all["backwards"][key] = {{"from", s.low_open ? json(nullptr) : json(s.low)},
                             {"to", s.high_open ? json(nullptr) : json(s.high)}};
  };
  add("L", "L_m", "m", f.L, [](fluid_layer& g, double x) { g.L = x; });
  add("nu", "nu_m2_s", "m^2/s", f.nu, [](fluid_layer& g, double x) { g.nu = x; });
  a.tables.push_back(t);
}

void run(const question& q) {
  case_data c;
  namelist::schema schema;
  declare_all(schema, c);
  if (q.describe) return schema.describe(std::cout);
  auto document = q.input.empty() ? namelist::document("the command line") : namelist::parse_file(q.input);
  for (const auto& argument : q.set) document.set(argument);
  schema.read(document);
  apply(q, c);
  fluid_layer f = layer(schema, c.values, c.all.domain.length[1], c.temperature_bottom(), c.temperature_top());
  const choice w = c.values.relaxation;
  recommendation r = recommend(f, w);
  // With &convection, what the program will run with; without, the note's rules.
  const auto& groups = document.groups();
  const bool programs_own =
      std::any_of(groups.begin(), groups.end(), [](const auto& g) { return g.name == "convection"; });
  if (programs_own) {
    const auto p = convection::resolve(schema, c.all);
    f = p.fluid;
    r = p.slowing;
    for (const auto& text : p.lines) fmt::print("convection: {}\n", text);
    for (const auto& side : c.all.walls.sides)
      if (side.thermal == "flux" && side.flux != 0.0)
        fmt::print("convection: {} W/m^2 through a side, beside {:.4g} of conduction from bottom to top\n", side.flux,
                   c.values.material.conductivity * f.dT / f.L);
  }
  const auto& d = c.all.domain;
  const int dimension = static_cast<int>(d.dimension);
  const double ratio = volume_ratio(d);
  const machine m = this_machine(q.shared, dimension,
                                 ratio * std::pow(static_cast<double>(d.particles[1]), static_cast<double>(dimension)));
  const auto p = plan_convection(f, r, d.particles[1], dimension, ratio, q.fraction, m.cost);
  answer a;
  a.all["question"] = "relaxation";
  a.all["given"]["fraction"] = q.fraction;
  say_numbers(f, c, a);
  say_rules(all_rules(f, w.phi_xi), r, a);
  say_choice(f, r, w, a);
  say_steps(f, r, p, q.fraction, m, a);
  if (q.shared.steps || q.shared.seconds) {
    answer_backwards(q, f, r, c, m, a);
    // With &convection the Rayleigh number and the program's own slowing are given, not L and the viscosity.
    if (!programs_own) answer_others(q, f, w, c, m, a);
  }
  a.give(q.shared, "S1: note of February 2023, S1b: of June 2023");
}

}  // namespace

std::function<void()> relaxation_question(CLI::App& app) {
  auto q = std::make_shared<question>();
  app.add_option("INPUT", q->input, "namelist file of a convection problem (default: the mantle, case 1a)")
      ->type_name("INPUT.nml");
  tools::add_many(app, "--set", q->set, "group.key=value, over what the file says; may be repeated", "group.key=value");
  app.add_flag("--describe", q->describe, "print every group and key that is read, and stop");
  const auto add = [&](const char* option, std::optional<double>& value, const char* meaning) {
    app.add_option(option, value, meaning)->check(above_zero());
  };
  add("--L", q->L, "height (m); the box keeps its shape");
  add("--dT", q->dT, "bottom less top (K)");
  add("--rho", q->rho, "density (kg/m3)");
  add("--kappa", q->kappa, "thermal diffusivity (m2/s)");
  add("--nu", q->nu, "kinematic viscosity (m2/s)");
  add("--g", q->g, "gravity (m/s2)");
  add("--alpha", q->alpha, "thermal expansivity (1/K)");
  add("--c-p", q->c_p, "heat capacity (J/(kg K))");
  add("--K", q->K, "bulk modulus (Pa)");
  app.add_option("--n", q->n, "particles along the height")->check(CLI::Range(std::int64_t{1}, std::int64_t{1} << 30));
  app.add_option("--fraction", q->fraction, "of the largest stable steps")
      ->check(finite(1e-6, 10.0, false))
      ->capture_default_str();
  add_shared(app, q->shared);
  return [q] { run(*q); };
}

}  // namespace tetsuame::plan
