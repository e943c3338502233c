// Materials from options: defaults, overrides and refusals.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <foundation/error.hpp>
#include <limits>
#include <string>

#include "materials.hpp"

namespace eos = tetsuame::eos;
namespace foundation = tetsuame::foundation;

namespace {

auto bad_input_naming(const std::string& word) {
  return [word](const foundation::error& e) {
    const bool good =
        e.status() == foundation::exit_status::bad_input && std::string(e.what()).find(word) != std::string::npos;
    if (!good) BOOST_TEST_MESSAGE(e.what());
    return good;
  };
}

}  // namespace

BOOST_AUTO_TEST_CASE(unknown_names_list_the_choices) {
  BOOST_CHECK_EXCEPTION(material("steel"), foundation::error, bad_input_naming("liquid_iron_isentrope"));
  BOOST_CHECK_EXCEPTION(tillotson("cheese"), foundation::error, bad_input_naming("granite"));
  eos::material_options o;
  o.name = "liquid_silicate";
  o.curve = "murnaghan";
  BOOST_CHECK_EXCEPTION(eos::make(o), foundation::error, bad_input_naming("birch_murnaghan"));
}

// Each parameter, given to each equation of state, either changes what it resolves to or is
// refused by name.
BOOST_AUTO_TEST_CASE(every_parameter_is_used_or_refused) {
  for (const std::string_view name : eos::names()) {
    if (name == "table") continue;  // of a file: tables.cpp
    eos::material_options plain;
    plain.name = name;
    const eos::material_options own = eos::resolve(plain);
    for (const eos::parameter& key : eos::parameters) {
      eos::material_options given = plain;
      given.*key.member =
          1.2345 * (own.*key.member).value_or(1.0) + ((own.*key.member).value_or(1.0) == 0.0 ? 1.0 : 0.0);
      if (!(own.*key.member)) {
        BOOST_CHECK_EXCEPTION(eos::make(given), foundation::error, bad_input_naming(std::string(key.key)));
        continue;
      }
      const eos::any m = eos::make(given);
      BOOST_TEST(eos::about(m).source.find(key.key) != std::string::npos);
      // At a state off all reference values something must come out differently; of Tillotson, at one between liquid
      // and vapour too.
      const auto differs = [&](double rho, double T) {
        const eos::properties a = eos::evaluate(eos::make(plain), rho, T), b = eos::evaluate(m, rho, T);
        return std::isfinite(a.p) && (a.p != b.p || a.c_V != b.c_V);
      };
      BOOST_TEST((differs(8123.0, 2345.0) || (name == "tillotson" && differs(7000.0, 11500.0))),
                 name << " does not use " << key.key);
    }
  }
}

BOOST_AUTO_TEST_CASE(texts_that_do_not_belong_are_refused) {
  eos::material_options o;
  o.tillotson = "iron";
  BOOST_CHECK_EXCEPTION(eos::make(o), foundation::error, bad_input_naming("tillotson"));
  o.tillotson.clear();
  o.curve = "vinet";
  BOOST_CHECK_EXCEPTION(eos::make(o), foundation::error, bad_input_naming("curve"));
}

BOOST_AUTO_TEST_CASE(values_out_of_range_are_refused) {
  const auto with = [](const std::string& name, std::optional<double> eos::material_options::*member, double value) {
    eos::material_options o;
    o.name = name;
    o.*member = value;
    return o;
  };
  using options = eos::material_options;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  BOOST_CHECK_EXCEPTION(eos::make(with("linear", &options::reference_density, 0.0)), foundation::error,
                        bad_input_naming("reference_density"));
  BOOST_CHECK_EXCEPTION(eos::make(with("linear", &options::bulk_modulus, -1e9)), foundation::error,
                        bad_input_naming("bulk_modulus"));
  BOOST_CHECK_EXCEPTION(eos::make(with("linear", &options::thermal_expansivity, nan)), foundation::error,
                        bad_input_naming("thermal_expansivity"));
  BOOST_CHECK_EXCEPTION(eos::make(with("linear", &options::reference_pressure, infinity)), foundation::error,
                        bad_input_naming("reference_pressure"));
  BOOST_CHECK_EXCEPTION(eos::make(with("ideal_gas", &options::gamma, 1.0)), foundation::error,
                        bad_input_naming("gamma"));
  BOOST_CHECK_EXCEPTION(eos::make(with("stiffened_gas", &options::p_infinity, -1.0)), foundation::error,
                        bad_input_naming("p_infinity"));
  BOOST_CHECK_EXCEPTION(eos::make(with("liquid_iron", &options::electronic_coefficient, -1e-5)), foundation::error,
                        bad_input_naming("electronic_coefficient"));
}

// Granite out of iron, parameter by parameter; vapour cannot end before it begins.
BOOST_AUTO_TEST_CASE(tillotson_of_any_material) {
  const eos::tillotson_parameters& g = eos::find_tillotson("granite");
  eos::material_options o;
  o.name = "tillotson";
  o.reference_density = g.rho0, o.bulk_modulus = g.A, o.nonlinear_modulus = g.B;
  o.tillotson_a = g.a, o.tillotson_b = g.b, o.tillotson_energy = g.E0;
  o.incipient_energy = g.E_iv, o.complete_energy = g.E_cv, o.heat_capacity = g.c_V;
  const eos::any own = eos::make(o), granite = tillotson("granite");
  for (const double rho : {2000.0, 2680.0, 5000.0})
    for (const double T : {300.0, 9000.0}) {
      BOOST_TEST(eos::evaluate(own, rho, T).p == eos::evaluate(granite, rho, T).p);
      BOOST_TEST(eos::evaluate(own, rho, T).sound_speed == eos::evaluate(granite, rho, T).sound_speed);
    }
  o.complete_energy = *o.incipient_energy;
  BOOST_CHECK_EXCEPTION(eos::make(o), foundation::error, bad_input_naming("complete_energy"));
}

BOOST_AUTO_TEST_CASE(resolving_twice_changes_nothing) {
  for (const std::string_view name : eos::names()) {
    if (name == "table") continue;
    eos::material_options o;
    o.name = name;
    const eos::material_options once = eos::resolve(o), twice = eos::resolve(once);
    for (const eos::parameter& key : eos::parameters) BOOST_TEST((once.*key.member == twice.*key.member));
    BOOST_TEST((once.curve == twice.curve && once.tillotson == twice.tillotson));
    BOOST_TEST(eos::about(eos::make(once)).source.find("changed") == std::string::npos);
  }
}
