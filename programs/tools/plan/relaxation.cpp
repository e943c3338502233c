// plan relaxation: numbers, rules and steps of slowed convection.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <convection/options.hpp>
#include <functional>
#include <iostream>
#include <plan/shared.hpp>
#include <run/amounts.hpp>

namespace tetsuame::plan {

namespace {

using namespace relaxation;

// What is planned for, and on what machine.
struct setting {
  std::int64_t n;  // particles along the height
  int dimension;
  double volume_ratio;  // of the box to its height^dimension
  double fraction;      // of the largest stable steps
  machine on;

  setting(const relaxation_question& q, const domain::options& d)
      : n(d.particles[1]), dimension(static_cast<int>(d.dimension)), fraction(q.fraction) {
    volume_ratio = d.length[0] / d.length[1];
    if (dimension == 3) volume_ratio *= d.length[2] / d.length[1];
    on = this_machine(q.shared, dimension, volume_ratio * std::pow(static_cast<double>(n), dimension));
  }
  convection_plan plan(const fluid_layer& f, const recommendation& r, std::int64_t with) const {
    return plan_convection(f, r, with, dimension, volume_ratio, fraction, on.cost);
  }
};

void apply(const relaxation_question& q, convection::options& o) {
  auto& m = o.physics.material;
  auto& d = o.domain;
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
  if (q.g) o.physics.g = *q.g;
  if (q.dT) o.walls.sides[o.hot_side()].temperature = o.temperature_cold() + *q.dT;
  if (q.L)
    for (const std::size_t a : {0, 2, 1}) d.length[a] *= *q.L / d.length[1];  // the height last: it scales the others
  if (q.n)
    for (const std::size_t a : {0, 2, 1})
      d.particles[a] = std::llround(static_cast<double>(*q.n) * d.length[a] / d.length[1]);
}

void say_numbers(const fluid_layer& f, const relaxation::material_options& m, answer& a) {
  a.add("Given", {{"L", "/given/L_m", f.L, "m", "height of the box"},
                  {"DeltaT", "/given/dT_K", f.dT, "K", "of the walls between which heat goes"},
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

void say_steps(const fluid_layer& f, const recommendation& r, const setting& s, answer& a) {
  const auto p = s.plan(f, r, s.n);
  const step_bounds plain = bounds(f, 1.0, 1.0, p.dx, s.fraction);
  const auto row = [&](const char* which, double slowed, double not_slowed, const std::string& formula, double over) {
    return std::vector<std::string>{which,
                                    number(slowed),
                                    number(not_slowed),
                                    "s",
                                    over == 1.0 ? formula : fmt::format("{}, over {}", formula, number(over)),
                                    p.dt.binding() == which ? "<- binds" : ""};
  };
  a.tables.push_back(
      {fmt::format("Time steps: {} of the limits, n = {}, dx = {} m", number(s.fraction), p.n, number(p.dx)),
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
  for (const auto& cost : costs(s.on, p.particles, p.seconds, "/plan", a)) rows.push_back(cost);
  a.add("One turnover", rows);
}

// Backwards: the largest n, with what it costs.
void answer_backwards(const shared_options& o, const fluid_layer& f, const recommendation& r, const setting& s,
                      answer& a) {
  table t{"Backwards: the largest n for one turnover",
          {{"within", "n", "particles", "steps", "run time"}},
          {false, true, true, true, true},
          true};
  auto& backwards = a.all["backwards"];
  const auto add = [&](const std::string& within, const char* key, const budget& b) {
    const std::int64_t n = largest_n(f, r, s.dimension, s.volume_ratio, s.fraction, s.on.cost, b);
    if (n == 0) {
      t.rows.push_back({within, "none", "", "", ""});
      backwards[key] = nullptr;
      return;
    }
    const auto p = s.plan(f, r, n);
    t.rows.push_back({within, fmt::format("{}", n), number(p.particles), number(p.steps),
                      p.seconds > 0.0 ? run::duration_text(p.seconds) : "not known"});
    backwards[key] = plan_json(p);
  };
  if (o.steps) add(number(*o.steps) + " steps", "in_steps", {.steps = *o.steps});
  if (o.seconds) add(run::duration_text(*o.seconds), "in_run_time", {.seconds = *o.seconds});
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
void answer_others(const shared_options& o, const fluid_layer& f, const choice& w, const setting& s, answer& a) {
  auto& backwards = a.all["backwards"];
  const auto plan_of = [&](const fluid_layer& g) { return s.plan(g, recommend(g, w), s.n); };
  const auto fits = [&](const fluid_layer& g) {
    const auto p = plan_of(g);
    return p.steps <= o.steps.value_or(HUGE_VAL) && p.seconds <= o.seconds.value_or(HUGE_VAL);
  };
  table t{fmt::format("Backwards: at n = {}, each with all else as given", s.n),
          {{"", "from", "to", "unit", "given", ""}},
          {false, true, true, false, true, false},
          true};
  const auto add = [&](const char* name, const char* key, const char* unit, double value, auto change) {
    const span range = affordable_span(
        [&](double x) {
          fluid_layer g = f;
          change(g, x);
          return fits(g);
        },
        value);
    if (range.high == 0.0) {
      fluid_layer less = f, more = f;
      change(less, 0.1 * value);
      change(more, 10.0 * value);
      const double fewest = plan_of(less).steps, most = plan_of(more).steps;
      const bool same = std::abs(most / fewest - 1.0) < 1e-9;
      t.rows.push_back({name, "none", "none", unit, number(value),
                        same ? "does not change the steps: n does" : "none within 4 decades of what is given"});
      backwards[key] = nullptr;
      return;
    }
    t.rows.push_back({name, range.low_open ? "any" : number(range.low), range.high_open ? "any" : number(range.high),
                      unit, number(value), range.low_open && range.high_open ? "does not decide" : ""});
    backwards[key] = {{"from", range.low_open ? json(nullptr) : json(range.low)},
                      {"to", range.high_open ? json(nullptr) : json(range.high)}};
  };
  add("L", "L_m", "m", f.L, [](fluid_layer& g, double x) { g.L = x; });
  add("nu", "nu_m2_s", "m^2/s", f.nu, [](fluid_layer& g, double x) { g.nu = x; });
  a.tables.push_back(t);
}

}  // namespace

void answer_relaxation(const relaxation_question& q) {
  convection::options o;
  namelist::schema schema;
  convection::declare(schema, o);
  schema.pass_over("smoothing");
  if (q.describe) return schema.describe(std::cout);
  auto document = q.input.empty() ? namelist::document("the command line") : namelist::parse_file(q.input);
  for (const auto& argument : q.set) document.set(argument);
  const auto is_of = [&](const char* name) {
    return std::ranges::any_of(document.groups(), [&](const auto& g) { return g.name == name; });
  };
  if (is_of("rti")) return answer_overturn(q, document);
  schema.read(document);
  apply(q, o);
  fluid_layer f = layer(schema, o.physics, o.domain.length[1], o.temperature_hot(), o.temperature_cold());
  const choice w = o.physics.relaxation;
  recommendation r = recommend(f, w);
  // With &convection, what the program will run with; without, the note's rules.
  const bool programs_own = is_of("convection");
  if (programs_own) {
    const auto p = convection::resolve(schema, o);
    f = p.fluid;
    r = p.slowing;
    for (const auto& text : p.lines) fmt::print("convection: {}\n", text);
    for (const auto& side : o.walls.sides)
      if (side.thermal == "flux" && side.flux != 0.0)
        fmt::print("convection: {} W/m^2 through a side, beside {:.4g} of conduction from bottom to top\n", side.flux,
                   o.physics.material.conductivity * f.dT / f.L);
  }
  const setting s(q, o.domain);
  answer a;
  a.all["question"] = "relaxation";
  a.all["given"]["fraction"] = q.fraction;
  say_numbers(f, o.physics.material, a);
  say_rules(all_rules(f, w.phi_xi), r, a);
  say_choice(f, r, w, a);
  say_steps(f, r, s, a);
  if (q.shared.steps || q.shared.seconds) {
    answer_backwards(q.shared, f, r, s, a);
    // With &convection the Rayleigh number and the program's own slowing are given, not L and the viscosity.
    if (!programs_own) answer_others(q.shared, f, w, s, a);
  }
  a.give(q.shared, "S1: note of February 2023, S1b: of June 2023 (docs/theory/relaxation.md)");
}

}  // namespace tetsuame::plan
