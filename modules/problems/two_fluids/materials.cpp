// Materials beside the two of the problem: group &material, once for each, as lists with an element for each.
//
//   &material  name = 'sulfide'  eos = 'linear'  density = 5000  viscosity = 1e11 /
//   &material  name = 'crust'  eos = 'tillotson'  tillotson = 'granite'  viscosity = 1e12 /
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <eos/keys.hpp>
#include <namelist/lists.hpp>
#include <namelist/text.hpp>
#include <two_fluids/groups.hpp>

namespace tetsuame::two_fluids {

namespace {

using namelist::element_of;

constexpr std::size_t most_materials = 30, own = 2;
constexpr const char* group = "material";

namelist::key_info list(namelist::key_info of_one) { return namelist::one_each(std::move(of_one), most_materials); }

std::size_t given(const more_materials& m) {
  std::size_t most =
      namelist::longest(m.name, m.eos, m.curve, m.tillotson, m.table, m.metal, m.melts, m.density, m.viscosity,
                        m.conductivity, m.temperature, m.solidus, m.liquidus, m.latent_heat);
  for (const auto& values : m.parameters) most = std::max(most, values.size());
  return most;
}

std::string check_name(const namelist::schema& schema, const options& o, std::size_t n) {
  const auto name = element_of(o.more.name, n);
  const auto fail = [&](const std::string& what) { schema.fail_at(group, "name", n, what); };
  if (name.empty())
    schema.fail_at(group,
                   element_of(o.more.viscosity, n) ? "viscosity"
                   : element_of(o.more.density, n) ? "density"
                                                   : "name",
                   n, fmt::format("the {}. &material has no name", n + 1));
  if (!std::ranges::all_of(name, namelist::is_name_character))
    fail(fmt::format("expected letters, digits and '_', found {}", namelist::quote(namelist::excerpt(name))));
  for (const auto& other : o.material)
    if (namelist::lower(other.name) == namelist::lower(name))
      fail(fmt::format("two materials are called '{}'", other.name));
  return name;
}

// What does not go together, each in a sentence at its key.
void check_together(const namelist::schema& schema, const options& o, const material_options& m, std::size_t n) {
  const auto fail = [&](const char* key, const std::string& what) {
    schema.fail_at(group, key, n, fmt::format("of '{}': {}", m.name, what));
  };
  const bool linear = m.eos == "linear", enthalpy = o.temperature_law == "enthalpy";
  const bool has_density = element_of(o.more.density, n).has_value();
  if (!element_of(o.more.viscosity, n)) schema.fail_at(group, "name", n, fmt::format("'{}' has no viscosity", m.name));
  if (linear && !has_density)
    schema.fail_at(group, "name", n, fmt::format("'{}' has no density, which eos = 'linear' needs", m.name));
  if (!linear && has_density) fail("density", "is of the linear equation of state; '" + m.eos + "' has its own");
  for (std::size_t k = 0; k < eos::parameters.size(); ++k)
    if (const auto& key = eos::parameters[k]; linear && m.parameters.*key.member)
      fail(std::string(key.key).c_str(), "'linear' has density, bulk_modulus and heat_capacity");
  if (m.eos != "table" && !m.table.empty()) fail("table", "is of eos = 'table'");
  if (m.eos != "tillotson" && !m.parameters.tillotson.empty()) fail("tillotson", "is of eos = 'tillotson'");
  if (m.eos != "liquid_silicate" && !m.parameters.curve.empty()) fail("curve", "is of eos = 'liquid_silicate'");
  if (enthalpy && !linear)
    fail("eos", "with temperature_law = 'enthalpy' pressure must not depend on temperature: 'linear' only");
  if (!enthalpy && m.temperature)
    fail("temperature", "belongs to temperature_law = 'enthalpy'; else &region gives temperatures");
  if (m.metal && m.melts) fail("melts", "metal does not melt by &melting, which is of silicate");
  if (m.melts && o.melting.curve == "none") fail("melts", "nothing melts: &melting curve is 'none'");
  for (const auto& [key, values] :
       {std::pair{"solidus", &o.more.solidus}, {"liquidus", &o.more.liquidus}, {"latent_heat", &o.more.latent_heat}})
    if (!m.melts && element_of(*values, n)) fail(key, "is of a material that melts = 'yes'");
  if (m.melts && m.solidus.has_value() != m.liquidus.has_value())
    fail(m.solidus ? "solidus" : "liquidus", "takes solidus and liquidus together; without them those of &melting");
  if (m.solidus && m.liquidus && !(*m.liquidus > *m.solidus)) fail("liquidus", "must be above the solidus");
}

}  // namespace

void declare(namelist::schema& schema, more_materials& m) {
  schema.group(group,
               "a material beside the two of the problem, which &region or &initial file places; may stand several "
               "times");
  const auto add = [&](const char* key, auto& to, const namelist::key_info& info) {
    schema.add(group, key, to, list(info));
  };
  const std::vector<std::string> no_or_yes{"no", "yes"};
  std::vector<std::string> equations;
  for (const auto& name : eos::names()) equations.emplace_back(name);
  add("name", m.name, {.meaning = "letters, digits and _"});
  add("eos", m.eos, {.choices = equations, .meaning = "equation of state; its parameters follow"});
  add("density", m.density, positive("kg/m^3", "linear equation of state: at zero pressure"));
  add("viscosity", m.viscosity, positive("Pa s", "dynamic"));
  add("conductivity", m.conductivity, not_negative("W/(m K)", "thermal; not given: that of all"));
  add("temperature", m.temperature, positive("K", "at the start, enthalpy law; not given: that of all"));
  add("metal", m.metal,
      {.choices = no_or_yes,
       .meaning = "whether it counts as metal, like the upper layer or the drop, for measures, surface tension and "
                  "&element; else as silicate"});
  add("melts", m.melts, {.choices = no_or_yes, .meaning = "whether it melts by &melting, enthalpy law"});
  add("solidus", m.solidus, positive("K", "of what melts, with liquidus; not given: those of &melting"));
  add("liquidus", m.liquidus, positive("K", "of what melts"));
  add("latent_heat", m.latent_heat, not_negative("J/kg", "of fusion; not given: that of &melting"));
  add("table", m.table, eos::key_of_table());
  add("tillotson", m.tillotson, {.meaning = "of eos = 'tillotson': iron, granite or basalt; not given: iron"});
  add("curve", m.curve, {.meaning = "of eos = 'liquid_silicate': vinet or birch_murnaghan"});
  for (std::size_t k = 0; k < eos::parameters.size(); ++k)
    schema.add(group, std::string(eos::parameters[k].key), m.parameters[k], list(eos::key_of(eos::parameters[k])));
}

void read_materials(const namelist::schema& schema, problem_kind kind, options& o) {
  o.material.resize(own);
  for (std::size_t n = 0; n < own; ++n) o.material[n].name = names_of(kind)[n];
  o.material[0].melts = true;
  o.material[1].metal = true;
  const auto& from = o.more;
  const std::size_t number = given(from);
  for (std::size_t n = 0; n < number; ++n) {
    material_options m;
    m.name = check_name(schema, o, n);
    if (const auto eos = element_of(from.eos, n); !eos.empty()) m.eos = eos;
    m.table = element_of(from.table, n);
    m.parameters.tillotson = element_of(from.tillotson, n);
    m.parameters.curve = element_of(from.curve, n);
    for (std::size_t k = 0; k < eos::parameters.size(); ++k) {
      const auto value = element_of(from.parameters[k], n);
      if (eos::parameters[k].key == "bulk_modulus")
        m.bulk_modulus = value;
      else if (eos::parameters[k].key == "heat_capacity")
        m.heat_capacity = value;
      else
        m.parameters.*eos::parameters[k].member = value;
    }
    m.density = element_of(from.density, n).value_or(0.0);
    m.viscosity = element_of(from.viscosity, n).value_or(0.0);
    m.conductivity = element_of(from.conductivity, n);
    m.temperature = element_of(from.temperature, n);
    m.solidus = element_of(from.solidus, n);
    m.liquidus = element_of(from.liquidus, n);
    m.latent_heat = element_of(from.latent_heat, n);
    m.metal = element_of(from.metal, n) == "yes";
    m.melts = element_of(from.melts, n) == "yes";
    check_together(schema, o, m, n);
    o.material.push_back(std::move(m));
  }
  if (number > 0 && o.masses == "equal_mass")
    schema.fail(group_of(kind), "masses", "'equal_mass' is of two materials, and &material adds others");
}

void make_more_materials(const namelist::schema& schema, const options& o, parameters& p) {
  for (std::size_t n = own; n < o.material.size(); ++n) {
    const auto at_fault = [&](const std::string& what) {
      schema.fail_at(group, o.material[n].eos == "linear" ? "name" : "eos", n - own,
                     fmt::format("of '{}': {}", o.material[n].name, what));
    };
    try {
      p.material->push_back(make(o, n));
      at_pressure({&p.material->back(), o.p_top, o.temperature, o.temperature_law == "adiabatic"}, o.p_top);
    } catch (const foundation::error& e) {
      at_fault(e.what());
    }
  }
}

std::vector<melting::options> melting_by_material(const options& o) {
  std::vector<melting::options> all;
  for (const auto& m : o.material) {
    auto& own_law = all.emplace_back(o.melting);
    if (!m.melts) own_law = {.curve = "none", .latent_heat = 0.0, .viscosity_law = "constant"};
    if (m.solidus && m.liquidus) {
      own_law.curve = "constant";
      own_law.solidus = *m.solidus;
      own_law.liquidus = *m.liquidus;
    }
    own_law.latent_heat = m.latent_heat.value_or(own_law.latent_heat);
  }
  return all;
}

void expect_places(const namelist::schema& schema, const options& o, const parameters& p) {
  if (!o.common.start.file.empty()) return;  // told once it is read
  for (std::size_t n = own; n < o.material.size(); ++n)
    if (!p.regions.give_material(static_cast<std::int32_t>(n)))
      schema.fail_at(group, "name", n - own,
                     fmt::format("nothing of '{0}' is in the box: expected a &region with material = '{0}', or "
                                 "&initial file",
                                 o.material[n].name));
}

}  // namespace tetsuame::two_fluids
