// A number that is none, in any field that travels with the particles, in a step of any problem: that evaluation fails,
// with the particle and the field, or the field is one that no evaluation reads and the rates stay as they were.
#include <boost/test/unit_test.hpp>
#include <convection/options.hpp>
#include <foundation/error.hpp>
#include <free_surface/make.hpp>
#include <gas/convergence.hpp>
#include <gas/options.hpp>
#include <liquid/scheme_of.hpp>
#include <map>
#include <namelist/document.hpp>
#include <problems/make.hpp>
#include <programs/schemes.hpp>
#include <run/particle_simulation.hpp>
#include <set>

#include "../support/mpi.hpp"

using namespace tetsuame;

namespace {

using test::mpi_environment;
BOOST_TEST_GLOBAL_FIXTURE(mpi_environment);

using names = std::set<std::string>;

// Of one problem: each field in turn, between two evaluations.
class trial {
 public:
  explicit trial(std::unique_ptr<run::simulation> of)
      : simulation_(std::move(of)), box_(static_cast<run::particle_simulation<2>&>(*simulation_)) {
    box_.rebuild(false);
    const auto arrays = simulation_->arrays();
    for (const auto& f : arrays.fields) rates_.emplace_back(f.number.value_or(arrays.size));
    BOOST_TEST(evaluate() == "");
    simulation_->commit();  // what evaluations lag behind is known
    BOOST_TEST(evaluate() == "");
    clean_ = rates_;
  }

  // Those that no evaluation reads.
  names unread() {
    names all;
    auto& s = box_.box.w.s;
    for (const auto& field : run::fields_of_table(s)) {
      if (!particles::travels(field.kind)) continue;
      const std::size_t i = s.fluid / 2;
      double& value = const_cast<double*>(field.values)[i];
      const double kept = std::exchange(value, std::numeric_limits<double>::quiet_NaN());
      const std::string fault = evaluate();
      value = kept;
      if (fault.empty()) {
        BOOST_TEST((rates_ == clean_), field.name << " changes rates that are finite");
        all.insert(field.name);
        continue;
      }
      BOOST_TEST(fault.find("particle " + std::to_string(s.id[i])) != std::string::npos, fault);
      BOOST_TEST(names_it(fault, field), field.name << ": " << fault);
    }
    BOOST_TEST(evaluate() == "");
    return all;
  }

 private:
  std::string evaluate() {
    std::vector<double*> to;
    for (auto& r : rates_) to.push_back(r.data());
    try {
      simulation_->evaluate({.time = 0.0, .of = run::purpose::step}, to);
    } catch (const foundation::error& e) {
      return e.what();
    }
    return "";
  }
  // By its name in checkpoints, or that of what is integrated.
  bool names_it(const std::string& fault, const run::table_field& field) {
    if (fault.find(field.name) != std::string::npos) return true;
    for (const auto& f : simulation_->arrays().fields)
      if (f.data == field.values && fault.find(f.name + " is nan") != std::string::npos) return true;
    return false;
  }

  std::unique_ptr<run::simulation> simulation_;
  run::particle_simulation<2>& box_;
  std::vector<std::vector<double>> rates_, clean_;
};

template <class Program>
names unread_by_liquid() {
  hydrostatic::options o;
  o.domain.dimension = 2;
  o.domain.length = {12.0, 12.0, 1.0};
  o.domain.particles = {12, 12, 1};
  o.domain.periodic = {true, false, true};
  o.initial.profile = "uniform";
  o.g = 10.0;
  o.kernel.h_over_dx = 1.2;
  o.walls.treatment = "virtual_marker";
  o.material.eos = eos::resolve(o.material.eos);
  o.material.conductivity = 10.0;
  o.time.dt = 1e-5;
  liquid::program program{};  // in three dimensions it would be compiled once more
  program.in_2d = [](const volume::options& how) { return std::make_unique<liquid::scheme_of<Program, 2>>(how); };
  return trial(problems::at_rest(o, program)).unread();
}

}  // namespace

// Positions of the start are measured against; Y that is not carried is found anew, and so is ρ.
BOOST_AUTO_TEST_CASE(of_a_liquid) {
  BOOST_TEST((unread_by_liquid<programs::disph_c>() == names{"Weight"}));
  BOOST_TEST((unread_by_liquid<programs::disph_y>() == names{"Density"}));
  BOOST_TEST((unread_by_liquid<programs::disph_n>() == names{"Density", "Weight"}));
}

BOOST_AUTO_TEST_CASE(of_two_fluids) {
  two_fluids::options o;
  namelist::schema schema;
  two_fluids::declare(schema, two_fluids::problem_kind::rayleigh_taylor, o);
  schema.read(
      namelist::parse_text("&domain particles_x = 16 particles_y = 16 periodic_x = .true. /\n"
                           "&rti viscosity_upper = 1e9 viscosity_lower = 1e9 p_top = 1e10 conductivity = 4 "
                           "temperature_law = 'adiabatic' amplitude = 3e4 start = 'displaced' volume = "
                           "'our_method' supports = 'volume' /\n&time t_end = 1.0 /",
                           "test.nml"));
  const auto p = two_fluids::resolve(schema, two_fluids::problem_kind::rayleigh_taylor, o);
  // Supports move on between steps; what the start was is measured against.
  BOOST_TEST((trial(problems::two_fluids_2d(two_fluids::problem_kind::rayleigh_taylor, o, p, nullptr)).unread() ==
              names{"ListSupport", "StartCoordinates_0", "StartCoordinates_1", "StartDensity", "StartTemperature",
                    "Support", "Weight"}));
}

// Fields of liquids, supports that move on between steps, weights of other choices of the scheme.
BOOST_AUTO_TEST_CASE(of_gas) {
  const std::map<std::string, names> own{
      {"ssph", {"EvolvedDensity"}}, {"gdisph", {"Alpha", "EvolvedDensity"}}, {"remix", {"Alpha"}}};
  for (const auto& [scheme, others] : own) {
    gas::options o;
    namelist::schema schema;
    gas::declare(schema, o);
    schema.read(
        namelist::parse_text("&domain dimension = 2 particles_x = 16 particles_y = 16 periodic_x = T "
                             "periodic_y = T /\n&shock test = 'square' masses = 'equal_spacing' rho_l = 4 p_l = "
                             "2.5 rho_r = 1 p_r = 2.5 scheme = '" +
                                 scheme + "' /\n&time t_end = 1 /",
                             "test.nml"));
    gas::resolve(schema, o);
    const std::vector<gas::level> alone;
    names expected{"Conductivity", "Density",     "ListSupport", "StartSum", "StartVolume",
                   "Support",      "Temperature", "Viscosity",   "Weight"};
    expected.insert(others.begin(), others.end());
    BOOST_TEST_CONTEXT(scheme) { BOOST_TEST((trial(gas::make_2d(o, alone)).unread() == expected)); }
  }
}

BOOST_AUTO_TEST_CASE(of_water) {
  free_surface::options o;
  namelist::schema schema;
  free_surface::declare(schema, o);
  schema.read(
      namelist::parse_text("&domain length_x = 1.0 length_y = 1.2 particles_x = 20 particles_y = 24 /\n"
                           "&flow high_y = 1.0 /\n&walls slip_top = 'free_surface' /\n&time t_end = 1 /",
                           "test.nml"));
  const auto p = free_surface::resolve(schema, o);
  BOOST_TEST((trial(free_surface::make_2d(o, p)).unread() ==
              names{"Conductivity", "InternalEnergyGain", "Temperature", "Viscosity", "Weight"}));
}

names operator+(names a, const names& b) {
  a.insert(b.begin(), b.end());
  return a;
}

// Nothing moves; without an operator that lags behind itself nothing reads what that would.
BOOST_AUTO_TEST_CASE(of_conduction) {
  const names of_liquids{"Density",      "InternalEnergyGain", "Masses", "Velocities_0",
                         "Velocities_1", "Viscosity",          "Weight"};
  for (const std::string scheme : {"sum", "consistent", "corrected"}) {
    conduction::options o;
    namelist::schema schema;
    conduction::declare(schema, o);
    schema.read(namelist::parse_text("&domain particles_x = 12 particles_y = 12 /\n&conduction operator = '" + scheme +
                                         "' /\n&walls temperature_top = 0 temperature_bottom = 1 /",
                                     "test.nml"));
    conduction::resolve(schema, o);
    const names of_sum{"LaplacianOfT", "LaplacianWeight_0", "LaplacianWeight_1", "LaplacianWeight_2"};
    const names expected = of_liquids + (scheme == "sum" ? of_sum : names{"Conductivity"});
    BOOST_TEST_CONTEXT(scheme) { BOOST_TEST((trial(problems::conduction(o)).unread() == expected)); }
  }
}

// Of one viscosity, of a response to it that is relaxed, of a viscosity that varies; of steps that know the rates of
// the step before, or its sums: those the integration and commit() read. Walls alone, where the particle is not, ask
// for the viscosity of the step before and for the stress across them.
BOOST_AUTO_TEST_CASE(of_convection) {
  const std::string mantle =
      "&domain length_x = 1e6 length_y = 1e6 particles_x = 12 particles_y = 12 /\n"
      "&material density = 4e3 expansivity = 2.5e-5 heat_capacity = 1250 conductivity = 5 viscosity = 1e23 "
      "bulk_modulus = 1e11 /\n&gravity g = 10 /\n&initial perturbation = 0.3 /\n&walls slip = 'free_slip' thermal = "
      "'adiabatic' thermal_bottom = 'fixed' temperature_bottom = 1000 thermal_top = 'fixed' temperature_top = 0 /\n";
  struct trial_of {
    std::string input, between_steps;  // the beginning of the names of fields that evaluations do not read
    names at_walls;
  };
  const std::map<std::string, trial_of> trials{
      {"one viscosity", {"target = 'transient' /\n&time method = 'ab2' /", "EarlierRate_", {}}},
      {"relaxed", {"target = 'steady' /\n&time method = 'rk4' /", "", {}}},
      {"varies",
       {"target = 'steady' viscosity_law = 'blankenbach_2a' viscosity_ramp = 5e16 /",
        "",
        {"EarlierViscosity", "GradedStress_0"}}},
      {"extrapolates", {"target = 'steady' /\n&time method = 'rkl2' /", "Before", {}}},
  };
  for (const auto& [name, t] : trials) {
    convection::options o;
    namelist::schema schema;
    convection::declare(schema, o);
    schema.read(namelist::parse_text(mantle + "&convection rayleigh = 1e4 " + t.input, "test.nml"));
    const auto p = convection::resolve(schema, o);
    BOOST_TEST_CONTEXT(name) {
      auto found = trial(convection::make(o, p)).unread();
      const auto between = std::erase_if(
          found, [&](const auto& f) { return !t.between_steps.empty() && f.starts_with(t.between_steps); });
      BOOST_TEST((between > 0) == !t.between_steps.empty());
      const names of_liquids{"Conductivity", "Density", "InternalEnergyGain", "Masses", "Viscosity", "Weight"};
      BOOST_TEST((found == of_liquids + t.at_walls));
    }
  }
}
