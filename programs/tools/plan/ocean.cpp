// plan ocean: how deep a magma ocean was, if metal that gathered on its floor left nickel and cobalt in the mantle as
// they are found there (docs/theory/magma_ocean.md).
#include <fmt/format.h>

#include <cmath>
#include <eos/eos.hpp>
#include <foundation/error.hpp>
#include <melting/melting.hpp>
#include <plan/shared.hpp>
#include <theory/partition.hpp>

namespace tetsuame::plan {

namespace {

constexpr double highest = 140e9;  // Pa: the mantle's floor
constexpr double step = 0.25e9;    // Pa, of the column and of the search

struct level {
  double p, T, depth;  // Pa, K, m
};

double temperature(const ocean_question& q, double p) {
  const auto kind =
      q.composition == "chondritic" ? melting::composition::chondritic : melting::composition::peridotitic;
  const double low = melting::solidus(p);
  return low + q.melt_fraction * (melting::liquidus(kind, p) - low);
}

// Where the coefficient is the one observed: the least pressure. None where there is no such depth.
std::optional<double> pressure_of(const ocean_question& q, const theory::exchange_law& law, double observed) {
  const auto miss = [&](double p) {
    return std::log(theory::partition_coefficient(law, p, temperature(q, p), q.iron_ratio) / observed);
  };
  for (double p = 0.0; p < highest; p += step) {
    if ((miss(p) > 0.0) == (miss(p + step) > 0.0)) continue;
    double low = p, high = p + step;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      ((miss(middle) > 0.0) == (miss(low) > 0.0) ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }
  return {};
}

// m: ∫ dp/(ρ g) by the trapezoidal rule.
double depth_of(const ocean_question& q, const eos::any& rock, double p) {
  const auto slope = [&](double at) { return 1.0 / (eos::density(rock, at, temperature(q, at)) * q.g); };
  const int parts = std::max(1, static_cast<int>(std::ceil(p / step)));
  double sum = 0.5 * (slope(0.0) + slope(p));
  for (int k = 1; k < parts; ++k) sum += slope(p * k / parts);
  return sum * p / parts;
}

// Both at once: two equations, log10 K_D = a + b/T + c p/T, linear in p and T.
level of_both(const ocean_question& q) {
  const auto of = [&](const theory::exchange_law& law, double observed) {
    return std::log10(observed) - 0.5 * law.valence * std::log10(q.iron_ratio) - law.a;  // (b + c p)/T
  };
  const double n = of(theory::nickel, q.nickel), c = of(theory::cobalt, q.cobalt);
  const auto& [ni, co] = std::pair(theory::nickel, theory::cobalt);  // n T - ni.c p = ni.b and the same of cobalt
  const double determinant = ni.c * c - co.c * n;
  const double p = (n * co.b - c * ni.b) / determinant, T = (ni.c * co.b - co.c * ni.b) / determinant;
  return {p * 1e9, T, 0.0};
}

}  // namespace

void answer_ocean(ocean_question& q) {
  const eos::any rock = eos::make(eos::resolve({.name = q.rock}));
  answer a;
  a.all["question"] = "ocean";
  a.all["iron_ratio"] = q.iron_ratio;
  a.all["melt_fraction"] = q.melt_fraction;
  table t{
      .title = fmt::format("floor of the magma ocean, at a melt fraction of {:g} ({})", q.melt_fraction, q.composition),
      .rows = {{"element", "metal/silicate", "pressure", "temperature", "depth"}, {"", "", "GPa", "K", "km"}},
      .right = {false, true, true, true, true},
      .has_head = true};
  const auto add = [&](const char* name, const theory::exchange_law& law, double observed) {
    const auto p = pressure_of(q, law, observed);
    auto& out = a.all[name];
    out["observed"] = observed;
    out["pressure_Pa"] = p ? json(*p) : json(nullptr);
    if (!p) {
      t.rows.push_back({name, number(observed), "none to 140", "", ""});
      return;
    }
    const level l{*p, temperature(q, *p), depth_of(q, rock, *p)};
    out["temperature_K"] = l.T;
    out["depth_m"] = l.depth;
    t.rows.push_back({name, number(observed), fmt::format("{:.1f}", l.p * 1e-9), fmt::format("{:.0f}", l.T),
                      fmt::format("{:.0f}", l.depth * 1e-3)});
  };
  add("nickel", theory::nickel, q.nickel);
  add("cobalt", theory::cobalt, q.cobalt);
  const level both = of_both(q);
  a.all["both"] = {{"pressure_Pa", both.p}, {"temperature_K", both.T}};
  t.notes = fmt::format("both at one place: {:.1f} GPa, {:.0f} K", both.p * 1e-9, both.T);
  if (both.p > 0.0 && both.p < highest) {
    const double solid = melting::solidus(both.p);
    a.all["both"]["solidus_K"] = solid;
    t.notes += fmt::format("; the solidus there is {:.0f} K{}\n", solid,
                           both.T < solid ? ": no melt, one equilibrium cannot give both" : "");
  } else {
    t.notes += ": not in the mantle\n";
  }
  a.tables.push_back(t);
  shared_options shared;
  shared.json = q.json;
  a.give(shared, "docs/theory/magma_ocean.md");
}

}  // namespace tetsuame::plan
