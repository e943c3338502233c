// The groups &melting and &element of a planet, and what is measured of melt and of the element.
#include <fmt/format.h>

#include <algorithm>
#include <elements/equilibration.hpp>
#include <memory>
#include <namelist/lists.hpp>
#include <planet/options.hpp>
#include <planet/sums.hpp>

namespace tetsuame::planet {

namespace {

using gas::view, gas::samples, gas::numbers;

bool is_iron(const eos::material_options& m) {
  if (m.name == "tillotson") return m.tillotson.empty() || m.tillotson == "iron";
  return m.name == "liquid_iron" || m.name == "liquid_iron_isentrope" || m.name == "iron_hcp";
}

// Which materials are metal, by number.
std::vector<bool> metals_by_material(const options& o) {
  std::vector<bool> by_number;
  for (std::size_t n = 0; n < o.metals.size(); ++n)
    by_number.push_back(o.metals[o.layer_of(static_cast<std::int32_t>(n))]);
  return by_number;
}

// Those parts of a cloud that an element is in.
struct parts {
  std::vector<bool> metals;
  std::int64_t impactor = -1;  // ID of its first particle; -1: there is none

  auto metal(const view& w, bool wanted = true) const {
    return [this, &w, wanted](std::size_t i) { return metals[static_cast<std::size_t>(w.material[i])] == wanted; };
  }
  auto metal_of_impactor(const view& w) const {
    return [is_metal = metal(w), &w, first = impactor](std::size_t i) { return w.id[i] >= first && is_metal(i); };
  }
};

template <class Which>
double mean_concentration(const view& w, const Which& which) {
  return mean_by_mass(w, which, [&](std::size_t i) { return w.concentration[i]; });
}

// Where the columns of the element stand in a line of the samples, after the time.
struct columns {
  std::size_t element, metal, of_impactor;
};

numbers tell_element(const parts& of, const columns& at, const view& w, const samples& lines) {
  const auto& first = lines.front();
  const double total = sum_by_mass(w, all, [&](std::size_t i) { return w.concentration[i]; });
  const double P = mean_by_mass(w, of.metal(w), [&](std::size_t i) { return w.partition[i]; });
  const elements::holders holders{first[at.element], mass_of(w, of.metal(w)), mass_of(w, of.metal(w, false))};
  const double in_metal = mean_concentration(w, of.metal(w));
  numbers told{{"element_mass_drift", total / first[at.element] - 1.0},
               {"concentration_metal", in_metal},
               {"concentration_silicate", mean_concentration(w, of.metal(w, false))},
               {"partition_coefficient", P},
               {"equilibration", elements::equilibration(holders, first[at.metal], in_metal, P)}};
  if (of.impactor < 0) return told;
  const double in_impactor = mean_concentration(w, of.metal_of_impactor(w));
  told.emplace_back("impactor_metal_concentration", in_impactor);
  told.emplace_back("impactor_metal_equilibration",
                    elements::equilibration(holders, first[at.of_impactor], in_impactor, P));
  return told;
}

void resolve_metals(const namelist::schema& schema, options& o) {
  for (std::size_t n = 0; n < o.materials.size(); ++n) {
    const auto given = namelist::element_of(o.layer.metal, n);
    o.metals.push_back(given == "yes" || (given != "no" && is_iron(o.materials[n])));
  }
  const bool any = std::ranges::find(o.metals, true) != o.metals.end(),
             all = std::ranges::find(o.metals, false) == o.metals.end();
  if (o.gas.element.any() && (!any || all))
    schema.fail("element", "name",
                fmt::format("metal and silicate exchange it, and {} (&layer metal)",
                            any ? "all layers are metal" : "no layer is metal"));
  if (o.gas.melting.melts() && all) schema.fail("melting", "curve", "melts silicate, and all layers are metal");
}

}  // namespace

void resolve_melting(const namelist::schema& schema, options& o) {
  auto& m = o.gas.melting;
  elements::check(schema, o.gas.element);
  melting::check(schema, m);
  resolve_metals(schema, o);
  if (!m.melts()) return;
  if (o.degree != 0) schema.fail("planet", "degree", "linear theory is of layers that stay as they are: no &melting");
  for (std::size_t n = 0; n < o.metals.size() && m.viscosity_varies(); ++n)
    if (!o.metals[n] && namelist::element_of(o.layer.viscosity, n))
      schema.fail_at(layer_group, "viscosity", n,
                     fmt::format("of layer '{}' follows from &melting viscosity_law: leave it out", o.names[n]));
  if (m.inertia_viscosity == 0.0) return;
  const char* const why = "is of a planet that creeps: with a raised inertia ";
  if (o.impact.is_asked_for())
    schema.fail("melting", "inertia_viscosity", std::string(why) + "a body that is thrown does not keep its orbit");
  for (const char* key : {"spin_period", "expansion"})
    if (schema.changed("planet", key))
      schema.fail("melting", "inertia_viscosity", std::string(why) + "&planet " + key + " would not be kept");
}

void expect_melting_range(const namelist::schema& schema, const options& o) {
  if (!o.gas.melting.melts()) return;
  for (std::size_t n = 0; n < o.metals.size(); ++n) {
    if (o.metals[n]) continue;
    for (const level& l : o.structure->layers()[n].levels)
      if (const auto [T_s, T_l] = melting::range(o.gas.melting, l.p); !(T_s < T_l))
        schema.fail("melting", "curve",
                    fmt::format("the fits for the mantle end before {:.4g} Pa, which layer '{}' has {:.6g} m from the "
                                "centre: solidus {:.6g} K, liquidus {:.6g} K",
                                l.p, o.names[n], l.r, T_s, T_l));
  }
}

void follow_melt_and_element(const options& o, gas::setup& t) {
  const auto of = std::make_shared<const parts>(
      parts{metals_by_material(o),
            o.impact_of ? static_cast<std::int64_t>(o.impact_of->target.particles.size()) : std::int64_t{-1}});
  const auto also_tell = [&t](auto more) {
    t.measures = [before = std::move(t.measures), more](const view& w, const samples& lines) {
      numbers told = before(w, lines);
      for (auto& one : more(w, lines)) told.push_back(std::move(one));
      return told;
    };
  };
  if (o.gas.melting.melts()) {
    const auto melt = [of](const view& w) {
      return mean_by_mass(w, of->metal(w, false), [&](std::size_t i) { return w.melt[i]; });
    };
    t.traces.push_back({"melt_fraction", "1", melt});
    also_tell([melt](const view& w, const samples&) { return numbers{{"melt_fraction", melt(w)}}; });
  }
  if (!o.gas.element.any()) return;
  const std::size_t next = t.traces.size() + 1;
  t.traces.push_back({"element", o.dimension == 3 ? "kg" : "kg/m", [](const view& w) {
                        return sum_by_mass(w, all, [&](std::size_t i) { return w.concentration[i]; });
                      }});
  t.traces.push_back({"concentration_metal", "1", [of](const view& w) { return mean_concentration(w, of->metal(w)); }});
  if (of->impactor >= 0)
    t.traces.push_back({"impactor_metal_concentration", "1",
                        [of](const view& w) { return mean_concentration(w, of->metal_of_impactor(w)); }});
  also_tell([of, at = columns{next, next + 1, next + 2}](const view& w, const samples& lines) {
    return tell_element(*of, at, w, lines);
  });
}

}  // namespace tetsuame::planet
