// plan relaxation, of an input of rti: how far sound and inertia of two layers may be slowed, by linear theory.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <plan/shared.hpp>
#include <two_fluids/recommended.hpp>

namespace tetsuame::plan {

namespace {

using namespace two_fluids;

void say_layers(const options& o, const parameters& p, const slowing_scales& s, answer& a) {
  const auto& [lower, upper] = s.inertia_share;
  a.add("Two layers", {{"L", "/given/L_m", o.domain.length[1], "m", "height of the box"},
                       {"growth", "/numbers/growth_1_s", *p.growth, "1/s", "of the wave, as the liquids are"},
                       {"D/K", "/numbers/dynamic_pressure", s.dynamic_pressure, "", "Delta_rho g L/(2 K)"},
                       {"I_lower", "/numbers/inertia_share_lower", lower, "", "growth rho/(eta k^2), over friction"},
                       {"I_upper", "/numbers/inertia_share_upper", upper, "", "the same of the upper layer"},
                       {"V", "/numbers/V_m_s", s.speed, "m/s", "of the overturn, some growth L/4"},
                       {"c", "/numbers/c_m_s", s.sound, "m/s", "the faster sound at the contact"}});
}

// The notes' rules, for a flow whose buoyancy is in its layers and not in thermal boundary layers.
void say_notes_rules(const slowing_scales& s, double tolerance, answer& a) {
  const double share = std::max(s.inertia_share[0], s.inertia_share[1]);
  a.add("Rules of orders of magnitude",
        {{"zeta", "/rules/zeta", std::max(1.0, std::sqrt(tolerance / s.dynamic_pressure)), "",
          "(error/(D/K))^1/2: what slowed sound compresses", "after S1 (17)"},
         {"xi", "/rules/xi", std::max(1.0, std::sqrt(tolerance / share)), "", "(error/I)^1/2", "after S1 (38)"},
         {"zeta xi", "/rules/zeta_xi", std::max(1.0, 0.1 * s.sound / s.speed), "", "0.1 c/V: Mach number",
          "after S1 (49)"}});
}

void say_recommended(const options& o, const recommended_slowing& r, double tolerance, answer& a) {
  const auto& z = r.slowing;
  std::vector<quantity> rows{{"zeta", "/recommended/zeta", z.zeta}};
  if (z.xi_of[0] || z.xi_of[1]) {
    rows.push_back({"xi_lower", "/recommended/xi_lower", z.xi_n(0)});
    rows.push_back({"xi_upper", "/recommended/xi_upper", z.xi_n(1)});
  } else {
    rows.push_back({"xi", "/recommended/xi", z.xi});
  }
  // A stabilised method takes viscosity by its stages: its steps are bound by sound.
  const auto& method = o.common.time.method;
  const bool by_stages = method == "rkl2" || method == "rkc2";
  const json viscous = by_stages ? json(nullptr) : json(r.viscous_as_is);
  const std::vector<quantity> rest{
      {"error", "/recommended/growth_error", r.error, "", "of the growth rate, with both"},
      {"", "/recommended/growth_error_sound", r.error_of_sound, "", "by sound alone"},
      {"", "/recommended/growth_error_inertia", r.error_of_inertia, "", "by inertia alone"},
      {"dt", "/recommended/step_s", r.step, "s",
       fmt::format("of {}, with {} x {} particles", method, o.domain.particles[0], o.domain.particles[1])},
      {"dt as is", "/recommended/step_as_is_s", r.step_as_is, "s", "nothing slowed"},
      {"", "/recommended/step_sound_as_is_s", r.sound_as_is, "s", "sound alone"},
      {"", "/recommended/step_viscous_as_is_s", viscous, by_stages ? "" : "s",
       by_stages ? "viscosity: taken by stages" : "viscosity alone"},
      {"gain", "/recommended/gain", r.step / r.step_as_is, "", "fewer steps"}};
  rows.insert(rows.end(), rest.begin(), rest.end());
  a.add(fmt::format("Recommended: errors of the growth rate, added without their signs, of {}", number(tolerance)),
        rows);
}

// Errors of the growth rate over zeta and xi, to ten times what the tolerance allows of each by itself.
json map_of(const options& o, const parameters& p, const slowing_options& most, std::int64_t points) {
  json map;
  const auto axis = [&](double top) {
    std::vector<double> values;
    for (std::int64_t i = 0; i < points; ++i)
      values.push_back(std::pow(top, static_cast<double>(i) / static_cast<double>(points - 1)));
    return values;
  };
  const auto zetas = axis(10.0 * most.zeta), xis = axis(10.0 * most.xi);
  map["zeta"] = zetas;
  map["xi"] = xis;
  for (const double zeta : zetas) {
    json line;
    for (const double xi : xis) line.push_back(growth_error(o, p, {.zeta = zeta, .xi = xi}));
    map["error"].push_back(line);
  }
  return map;
}

}  // namespace

void answer_overturn(const relaxation_question& q, const namelist::document& document) {
  if (q.convection_only())
    foundation::fail_input(document.name() + ": of an input of rti: change it by --set, not by numbers of convection");
  options o;
  namelist::schema schema;
  declare(schema, problem_kind::rayleigh_taylor, o);
  schema.read(document);
  const auto p = resolve(schema, problem_kind::rayleigh_taylor, o);
  const auto scales = slowing_scales_of(o, p);
  const auto r = recommend_slowing(o, p, q.error);
  answer a;
  a.all["question"] = "relaxation";
  a.all["given"]["error"] = q.error;
  say_layers(o, p, scales, a);
  say_notes_rules(scales, q.error, a);
  say_recommended(o, r, q.error, a);
  if (q.map > 1) a.all["map"] = map_of(o, p, widest_slowing(o, p, q.error), q.map);
  a.give(q.shared, "docs/theory/slowed_layers.md; S1: note of February 2023 (docs/theory/relaxation.md)");
}

}  // namespace tetsuame::plan
