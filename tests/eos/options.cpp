// Materials from options: defaults, overrides and refusals.
#include <boost/test/unit_test.hpp>
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
    eos::material_options plain;
    plain.name = name;
    const eos::material_options own = eos::resolve(plain);
    for (const eos::parameter& key : eos::parameters) {
      eos::material_options given = plain;
      given.*key.member = 1.2345;
      if (!(own.*key.member)) {
        BOOST_CHECK_EXCEPTION(eos::make(given), foundation::error, bad_input_naming(std::string(key.key)));
        continue;
      }
      const eos::any m = eos::make(given);
      BOOST_TEST(eos::about(m).source.find(key.key) != std::string::npos);
      // At a state off all reference values something must come out differently.
      const eos::properties a = eos::evaluate(eos::make(plain), 8123.0, 2345.0), b = eos::evaluate(m, 8123.0, 2345.0);
      BOOST_TEST((a.p != b.p || a.c_V != b.c_V), name << " does not use " << key.key);
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

BOOST_AUTO_TEST_CASE(resolving_twice_changes_nothing) {
  for (const std::string_view name : eos::names()) {
    eos::material_options o;
    o.name = name;
    const eos::material_options once = eos::resolve(o), twice = eos::resolve(once);
    for (const eos::parameter& key : eos::parameters) BOOST_TEST((once.*key.member == twice.*key.member));
    BOOST_TEST((once.curve == twice.curve && once.tillotson == twice.tillotson));
    BOOST_TEST(eos::about(eos::make(once)).source.find("changed") == std::string::npos);
  }
}
