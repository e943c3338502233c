// Measures of convection: gradients at a wall, time averages, when a flow is steady; and the input's overrides.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <convection/graded_viscosity.hpp>
#include <convection/measures.hpp>
#include <convection/options.hpp>
#include <convection/steady.hpp>
#include <convection/viscosity.hpp>
#include <filesystem>
#include <foundation/error.hpp>
#include <fstream>
#include <melting/melting.hpp>
#include <namelist/document.hpp>
#include <numbers>
#include <random>

using namespace tetsuame;
using namespace tetsuame::convection;
namespace tt = boost::test_tools;

namespace {

std::vector<near_wall> samples_of(int dimension, double (*f)(double y, double x, double z)) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(-0.2, 0.2);
  std::vector<near_wall> all;
  const int depth = dimension == 3 ? 9 : 1;
  for (int row = 0; row < 4; ++row)
    for (int n = 0; n < 12; ++n)
      for (int l = 0; l < depth; ++l) {
        const double y = row + 0.5 + jitter(random), x = n + 0.5 + jitter(random);
        const double z = dimension == 3 ? l + 0.5 + jitter(random) : 0.0;
        all.push_back({y, {x, z}, f(y, x, z), static_cast<std::int64_t>(all.size())});
      }
  sort(all);
  return all;
}

parameters resolved(const std::string& text, options& o) {
  namelist::schema schema;
  declare(schema, o);
  schema.read(namelist::parse_text(text, "test.nml"));
  return resolve(schema, o);
}

}  // namespace

BOOST_AUTO_TEST_CASE(gradient_at_a_wall_is_exact_for_its_polynomial) {
  const auto flat = samples_of(2, [](double y, double x, double) {
    const double t = x - 6.0;
    return y * (2.0 + 0.3 * t - 0.05 * t * t) + y * y * y * (0.01 - 0.002 * t) + 1e-4 * y * y * y * y * y;
  });
  BOOST_TEST(wall_gradient(flat, {6.0, 0.0}, 3.5, 2) == 2.0, tt::tolerance(1e-10));
  const auto deep = samples_of(3, [](double y, double x, double z) {
    const double t = x - 6.0, s = z - 4.5;
    return y * (2.0 + 0.3 * t - 0.05 * t * t + 0.1 * s + 0.02 * s * s - 0.03 * t * s) + y * y * y * (0.01 + 0.001 * s);
  });
  BOOST_TEST(wall_gradient(deep, {6.0, 4.5}, 3.5, 3) == 2.0, tt::tolerance(1e-10));
  BOOST_TEST(std::isnan(wall_gradient({}, {6.0, 0.0}, 3.5, 2)));
}

BOOST_AUTO_TEST_CASE(interpolation_is_exact_for_polynomials_of_second_degree) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> jitter(-0.2, 0.2);
  const auto first = [](double x, double y) { return 1.0 + 2.0 * x - y + 0.3 * x * x - 0.1 * x * y + 0.2 * y * y; };
  const auto second = [](double x, double y) { return y * y - 4.0 * x; };
  particles::particles<2> s;
  particles::allocate(s, 100, 0, 0, 0);
  particles::array f(s.total()), g(s.total());
  for (std::size_t i = 0; i < s.fluid; ++i) {
    s.id[i] = static_cast<std::int64_t>(i);
    s.x[0][i] = static_cast<double>(i % 10) + jitter(random);
    const std::size_t row = i / 10;
    s.x[1][i] = static_cast<double>(row) + jitter(random);
    f[i] = first(s.x[0][i], s.x[1][i]);
    g[i] = second(s.x[0][i], s.x[1][i]);
  }
  const interpolation<2> at(s, 2.6);
  const auto inside = at({4.3, 5.1}, std::array<const double*, 2>{f.data(), g.data()});
  BOOST_REQUIRE(inside.has_value());
  BOOST_TEST((*inside)[0] == first(4.3, 5.1), tt::tolerance(1e-10));
  BOOST_TEST((*inside)[1] == second(4.3, 5.1), tt::tolerance(1e-10));
  BOOST_TEST(!at({30.0, 5.0}, std::array<const double*, 1>{f.data()}).has_value());
}

BOOST_AUTO_TEST_CASE(averages) {
  record r(3);
  for (int n = 0; n <= 100; ++n)
    r.add(n, {5.0 + (n % 2 == 0 ? 0.1 : -0.1), 1.0 + 1e-3 * n, 5.0 + std::sin(0.2 * std::numbers::pi * n)});
  const auto swinging = r.over(0, 40.0), growing = r.over(1, 40.0);
  BOOST_TEST(swinging.mean == 5.0, tt::tolerance(1e-12));  // 40 samples, later than 60
  // Samples that alternate know their mean: by (1 + ρ)/(1 - ρ)/40, ρ = -39/40, of the variance.
  BOOST_TEST(*swinging.uncertainty == 0.1 * std::sqrt(1.0 / 79.0 / 40.0), tt::tolerance(1e-9));
  BOOST_TEST(swinging.swing == 0.1, tt::tolerance(1e-9));
  BOOST_TEST(growing.mean == 1.0 + 1e-3 * 80.5, tt::tolerance(1e-12));
  // Quarters' means lie at -15, -5, 5, 15 steps: standard error sqrt(500/12) steps. Each sample is like the next: more,
  // but not more than the standard deviation of what grows by 40 steps, sqrt((40² - 1)/12).
  BOOST_TEST(*growing.uncertainty > 1e-3 * std::sqrt(500.0 / 12.0));
  BOOST_TEST(*growing.uncertainty < 1e-3 * std::sqrt(1599.0 / 12.0));
  // Ten samples a period: the quarters agree, and know nothing.
  const auto periodic = r.over(2, 40.0);
  BOOST_TEST(periodic.mean == 5.0, tt::tolerance(1e-12));
  BOOST_TEST(periodic.swing == std::sqrt(0.5), tt::tolerance(1e-9));
  BOOST_TEST(*periodic.uncertainty > 0.3 * periodic.swing);
  BOOST_TEST(r.settled(0, 40.0, 1e-6));
  BOOST_TEST(!r.settled(1, 40.0, 0.01));
  BOOST_TEST(r.settled(1, 40.0, 0.03));   // halves differ by 20 steps: 1.85 %
  BOOST_TEST(!r.settled(0, 200.0, 0.1));  // not that long yet
  record again(3);
  again.restore(r.flat());
  BOOST_TEST(again.size() == r.size());
  BOOST_TEST(again.over(1, 17.0).mean == r.over(1, 17.0).mean);
}

// Of another period and another decay than those it is told by: 1a of Blankenbach has 0.84 to 0.96 a turnover, 1b 0.63
// to 0.8.
BOOST_AUTO_TEST_CASE(what_a_swing_leaves) {
  for (const auto& [decay, period] : {std::pair{0.85, 1.75}, {0.95, 1.7}, {0.65, 1.8}}) {
    record r(1);
    const auto add = [&, decay = decay, period = period](int n) {
      const double s = n * 0.1;  // turnovers
      r.add(n * 10.0, {5.0 + 0.5 * std::exp(-decay * s) * std::cos(2.0 * std::numbers::pi * s / period + 1.0)});
    };
    for (int n = 0; n < 5; ++n) add(n);
    BOOST_TEST(!r.beside_a_swing(0, 175.0, 100.0).uncertainty);  // too few to tell
    for (int n = 5; n <= 40; ++n) add(n);
    const auto a = r.beside_a_swing(0, 175.0, 100.0);
    const double amplitude = 0.5 * std::exp(-decay * 4.0);
    const bool exact = decay == 0.85;
    BOOST_TEST(a.swing == amplitude, tt::tolerance(exact ? 1e-9 : 0.35));
    BOOST_TEST(std::abs(a.mean - 5.0) < (exact ? 1e-12 : 0.15 * amplitude));
    BOOST_TEST(*a.uncertainty < (exact ? 1e-12 : 0.1 * amplitude));
    // What is left is smooth, and no noise: for that it would be three to five times the uncertainty.
    BOOST_TEST(std::abs(a.mean - 5.0) < 2.5 * *a.uncertainty + 1e-12);
  }
}

// ν = exp(g y), a shear stress 1 + y: u' = (1 + y) exp(-g y). Two neighbours at y = ±1 of a particle at 0 give its
// divergence, 1 (with ν_ij = (ν_i ν_j)^½ it would be 4 % more at g = 1).
BOOST_AUTO_TEST_CASE(viscosity_of_a_line) {
  const double g = 1.0;
  const auto root = [&](double y) { return std::exp(0.5 * g * y); };
  const auto u = [&](double y) { return ((1.0 + 1.0 / g) - (1.0 + 1.0 / g + y) * std::exp(-g * y)) / g; };
  double force = 0.0;
  for (const double y : {-1.0, 1.0}) force += line_viscosity(root(0.0), root(y)) * u(y);
  BOOST_TEST(force == 1.0, tt::tolerance(1e-3));
  // The same force on both ends, and no weight grows without bound.
  BOOST_TEST(4.0 * line_viscosity(2.0, 30.0) == 900.0 * line_viscosity(30.0, 2.0), tt::tolerance(1e-12));
  BOOST_TEST(line_viscosity(1.0, 1e6) < 6.0);
  BOOST_TEST(line_viscosity(3.0, 3.0) == 1.0, tt::tolerance(1e-12));
}

// Relaxed where the steady state is the aim, one viscosity is everywhere and zeta and xi are free.
BOOST_AUTO_TEST_CASE(response_follows_from_aim_and_viscosity) {
  options constant, varies, given, history;
  const auto p = resolved("&convection rayleigh = 1e4 /", constant);
  BOOST_TEST(p.relaxed);
  BOOST_TEST(p.fluid.L / (p.relaxation_time * p.shear_speed) == std::sqrt(2.0) * std::numbers::pi,
             tt::tolerance(1e-12));
  BOOST_TEST(p.start == 10.0, tt::tolerance(1e-12));  // Ra is 1000 then
  BOOST_TEST(p.ramp == 0.033 * p.fluid.L * p.fluid.L / p.fluid.kappa, tt::tolerance(1e-12));
  BOOST_TEST(*constant.convection.pressure_diffusion == 0.02);
  BOOST_TEST(*constant.convection.steady_mach == 1.5);
  const auto q =
      resolved("&convection rayleigh = 1e4 viscosity_law = 'blankenbach_2a' viscosity_ramp = 1e17 /", varies);
  BOOST_TEST(!q.relaxed);
  BOOST_TEST(q.shear_speed == 0.0);
  BOOST_TEST(q.start == 1.0);
  BOOST_TEST(q.ramp == 1e17);
  BOOST_TEST(*varies.convection.pressure_diffusion == 0.2);
  BOOST_TEST(*varies.convection.steady_mach == 1.0);
  BOOST_TEST(!resolved("&convection target = 'steady' / &expert zeta = 2.0 xi = 1e11 /", given).relaxed);
  BOOST_TEST(!resolved("&convection target = 'transient' /", history).relaxed);
  BOOST_TEST(*history.convection.pressure_diffusion == 0.4);
}

BOOST_AUTO_TEST_CASE(numbers_override_dimensional_values) {
  {
    options o;
    const auto p = resolved("&convection rayleigh = 3e5 /", o);
    BOOST_TEST(relaxation::rayleigh(p.fluid) == 3e5, tt::tolerance(1e-12));
    BOOST_TEST(relaxation::prandtl(p.fluid) == 2.5e25, tt::tolerance(1e-12));  // the expansivity gives way
    BOOST_TEST(p.steady);
    BOOST_TEST(p.c_eff == relaxation::sound_speed(p.fluid) / (p.slowing.zeta * p.slowing.xi), tt::tolerance(1e-12));
    BOOST_TEST(p.nu_eff == p.fluid.nu / (p.slowing.xi * p.slowing.xi), tt::tolerance(1e-12));
    // Relaxed viscous response: what answers at once, and waves of shear.
    const double at_once = p.nu_eff * p.instant_share;
    BOOST_TEST(at_once == 0.35 * p.c_eff * p.fluid.L / 100.0, tt::tolerance(1e-12));
    BOOST_TEST(p.nu_eff - at_once == p.relaxation_time * p.shear_speed * p.shear_speed, tt::tolerance(1e-12));
    BOOST_TEST(p.slowing.wave_share == std::hypot(1.0, p.shear_speed / p.c_eff), tt::tolerance(1e-12));
    // While the viscosity is eightfold sound is a fourth as fast.
    auto earlier = p;
    earlier.nu = 8.0 * p.fluid.nu;
    follow(earlier, p.fluid.L / 100.0);
    BOOST_TEST(earlier.c_eff == 0.25 * p.c_eff, tt::tolerance(1e-12));
    BOOST_TEST(earlier.relaxation_time == 4.0 * p.relaxation_time, tt::tolerance(1e-12));
  }
  {
    options o;  // the viscosity of the middle is exp(-3) of the top's
    const auto p = resolved(
        "&convection rayleigh = 3e5 viscosity_law = 'exponential' / &expert temperature_exponent = 6.0 steady_mach = "
        "1.5 /",
        o);
    BOOST_TEST(p.c_eff == std::pow(3e5 * std::exp(3.0), 2.0 / 3.0) * p.fluid.kappa / p.fluid.L / 1.5,
               tt::tolerance(1e-12));
    BOOST_TEST(p.nu_eff == 0.12 * p.c_eff * p.fluid.L / 100.0, tt::tolerance(1e-12));
    BOOST_TEST(p.instant_share == 1.0);
    BOOST_TEST(p.shear_speed == 0.0);
  }
}

BOOST_AUTO_TEST_CASE(which_value_a_number_overrides) {
  // Where the expansivity says how much heat compression makes, or a law the viscosity, the viscosity gives way.
  for (const char* bound : {"viscous_heating = T", "adiabatic_heating = T", "gravity_density = 'equation_of_state'"}) {
    options o;
    const std::string warm =
        "&walls temperature_bottom = 1300.0 temperature_top = 300.0 /\n&convection rayleigh = 3e5 ";
    const auto p = resolved(warm + bound + " /", o);
    BOOST_TEST(relaxation::rayleigh(p.fluid) == 3e5, tt::tolerance(1e-12));
    BOOST_TEST(p.fluid.alpha == 2.5e-5);
  }
  {
    options o;
    const auto p = resolved("&convection prandtl = 1e3 /", o);  // the input's Ra: Blankenbach's 1a
    BOOST_TEST(relaxation::prandtl(p.fluid) == 1e3, tt::tolerance(1e-12));
    BOOST_TEST(relaxation::rayleigh(p.fluid) == 1e4, tt::tolerance(1e-12));
  }
  {
    options o;
    const auto p = resolved("&convection rayleigh = 1e4 prandtl = 0.71 /", o);
    BOOST_TEST(relaxation::rayleigh(p.fluid) == 1e4, tt::tolerance(1e-12));
    BOOST_TEST(relaxation::prandtl(p.fluid) == 0.71, tt::tolerance(1e-12));
    BOOST_TEST(!p.steady);
    BOOST_TEST(p.slowing.xi == 1.0);
  }
  {
    options o;
    const auto p = resolved("&convection gravity_density = 'conventional' / &expert zeta = 2.0 xi = 1e11 /", o);
    BOOST_TEST(p.slowing.zeta == 2.0);
    BOOST_TEST(p.slowing.xi == 1e11);
    BOOST_TEST(p.compressibility == 4.0);
  }
  options o;
  BOOST_CHECK_THROW(resolved("&walls temperature_bottom = -1.0 /", o), foundation::error);
}

// ---- gravity by an equation of state --------------------------------------------------------

BOOST_AUTO_TEST_CASE(linear_equation_of_state_weighs_as_the_boussinesq_law) {
  const double rho = 4000.0, alpha = 2.5e-5, K = 1e11, g = 10.0, L = 1e6, T_top = 500.0, T_bottom = 1500.0;
  eos::material_options m;
  m.name = "linear";
  m.reference_density = rho, m.bulk_modulus = K, m.thermal_expansivity = alpha, m.reference_temperature = T_top;
  m.reference_pressure = 0.0, m.heat_capacity = 1250.0;
  const gravity_density weighed(eos::make(m), {L, g, rho, 0.0, T_top, T_bottom});
  std::mt19937 random(3);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  for (int k = 0; k < 200; ++k) {
    // Images of the fluid stand behind the walls, and are hotter than the bottom.
    const double y = L * (1.2 * part(random) - 0.1), T = T_top + (T_bottom - T_top) * (1.6 * part(random) - 0.3);
    const double p = 1e8 * part(random), conductive = T_bottom - (T_bottom - T_top) * y / L;
    const double right = alpha * g * (T - conductive) - g * p / K;
    BOOST_TEST(weighed.buoyancy(y, T, p, 0.0) == alpha * g * (T - conductive), tt::tolerance(1e-9) << "at y = " << y);
    // K and rho both grow by 1 + p/K with depth, and with T by the adiabat: their ratio stays.
    BOOST_TEST(weighed.buoyancy(y, T, p, 1.0) == right, tt::tolerance(1e-9));
    BOOST_TEST(weighed.slope(y, T) == alpha * g, tt::tolerance(1e-9));
    BOOST_TEST(weighed.buoyancy(y, conductive, 0.0, 1.0) == 0.0);
    BOOST_TEST(std::abs(weighed.heat_capacity_change(y, T)) < 1e-6 * 1250.0);
  }
}

BOOST_AUTO_TEST_CASE(column_at_rest_and_its_density) {
  for (const char* name : {"liquid_iron", "liquid_silicate", "isentrope"}) {
    BOOST_TEST_CONTEXT(name) {
      eos::material_options m;
      m.name = std::string(name) == "isentrope" ? "liquid_iron_isentrope" : name;
      const auto material = eos::make(m);
      const double L = 3e6, g = 15.0, rho = 5000.0, T_top = 2000.0, T_bottom = 5000.0, p_top = 3e10;
      const gravity_density weighed(material, {L, g, rho, p_top, T_top, T_bottom});
      BOOST_TEST(weighed.pressure(L) == p_top, tt::tolerance(1e-12));
      BOOST_TEST(weighed.temperature(L) == T_top, tt::tolerance(1e-12));
      for (const double y : {0.03 * L, 0.31 * L, 0.77 * L}) {
        const double d = 1e-3 * L, weight = (weighed.pressure(y - d) - weighed.pressure(y + d)) / (2.0 * d);
        BOOST_TEST(weight == g * weighed.density(y), tt::tolerance(1e-5));
        // On an adiabat d ln T/d ln rho is the Grueneisen parameter alpha K_T/(rho c_V).
        const auto e = eos::evaluate(material, weighed.density(y), weighed.temperature(y));
        const double of_T = std::log(weighed.temperature(y - d) / weighed.temperature(y + d));
        const double of_rho = std::log(weighed.density(y - d) / weighed.density(y + d));
        BOOST_TEST(of_T / of_rho == e.alpha * e.K_T / (weighed.density(y) * e.c_V), tt::tolerance(1e-4));
        // The table against the equation of state itself.
        const double conductive = T_bottom - (T_bottom - T_top) * y / L, p = weighed.pressure(y);
        for (const double T : {1800.0, 3100.0, 5200.0}) {
          const double hot = eos::density(material, p, T), cold = eos::density(material, p, conductive);
          BOOST_TEST(weighed.buoyancy(y, T, 0.0, 0.0) == -g * (hot - cold) / rho, tt::tolerance(1e-5));
          const auto there = eos::evaluate(material, hot, T);
          BOOST_TEST(weighed.slope(y, T) == g * there.alpha * hot / rho, tt::tolerance(1e-4));
        }
      }
    }
  }
}

// What makes enthalpy a function of T and y: dc_p/dy = T d²b/dT², here by differences of b itself.
BOOST_AUTO_TEST_CASE(heat_capacity_follows_the_pressure) {
  eos::material_options m;
  m.name = "liquid_silicate";
  const double L = 2e6;
  const gravity_density weighed(eos::make(m), {L, 20.0, 4000.0, 1e10, 1500.0, 5000.0});
  BOOST_TEST(weighed.heat_capacity_change(L, 3000.0) == 0.0);
  for (const double y : {0.1 * L, 0.5 * L, 0.9 * L})
    for (const double T : {1800.0, 3000.0, 4500.0}) {
      const double d = 1e-2 * L, e = 50.0;
      const double grows =
          (weighed.heat_capacity_change(y + d, T) - weighed.heat_capacity_change(y - d, T)) / (2.0 * d);
      const double bends = (weighed.slope(y, T + e) - weighed.slope(y, T - e)) / (2.0 * e);
      BOOST_TEST(grows == T * bends, tt::tolerance(5e-3) << "y = " << y << ", T = " << T);
    }
}

BOOST_AUTO_TEST_CASE(input_of_gravity_by_an_equation_of_state) {
  options o;
  const std::string walls = "&walls temperature_bottom = 4000 temperature_top = 1500 /\n";
  const auto p = resolved(walls + "&convection gravity_density = 'equation_of_state' eos = 'liquid_silicate' /\n", o);
  BOOST_TEST_REQUIRE(p.weighed != nullptr);
  BOOST_TEST(p.weighed->temperature(o.domain.length[1]) == 1500.0, tt::tolerance(1e-12));
  options cold, plain;
  BOOST_CHECK_THROW(resolved("&convection gravity_density = 'equation_of_state' /\n", cold), foundation::error);
  BOOST_CHECK_THROW(resolved("&convection eos = 'liquid_iron' /\n", plain), foundation::error);
}

// ---- viscosity by a table, and by melt fraction -----------------------------------------------

namespace {

struct table_file {
  std::string path = (std::filesystem::temp_directory_path() / "tetsuame_viscosity_test.txt").string();
  explicit table_file(const std::string& text) { std::ofstream(path) << text; }
  ~table_file() { std::filesystem::remove(path); }
  table_file(const table_file&) = delete;
  table_file& operator=(const table_file&) = delete;
};

std::string complaint(const std::string& text) {
  const table_file file(text);
  try {
    viscosity_table::read(file.path);
  } catch (const foundation::error& e) {
    return e.what();
  }
  return "none";
}

}  // namespace

BOOST_AUTO_TEST_CASE(table_is_exact_for_an_exponential) {
  const auto law = [](double T, double z) { return 1e20 * std::exp(-0.01 * T + 3e-6 * z); };
  const viscosity_table table({300.0, 500.0, 1300.0}, {0.0, 1e5, 1e6}, law);
  for (const double T : {220.0, 300.0, 317.0, 500.0, 1299.0, 1380.0})
    for (const double z : {-5e4, 0.0, 3e4, 4e5, 1.05e6})
      BOOST_TEST(table.log(T, z) == std::log(law(T, z)), tt::tolerance(1e-12) << "at " << T << " K, " << z << " m");
  // A tenth of the extent beyond the grid it is constant.
  BOOST_TEST(table.log(9000.0, 0.0) == std::log(law(1400.0, 0.0)), tt::tolerance(1e-12));
  BOOST_TEST(table.covers(300.0, 1e6));
  BOOST_TEST(!table.covers(299.0, 1e6));
  BOOST_TEST(!table.covers(300.0, -1.0));
}

BOOST_AUTO_TEST_CASE(table_from_a_file) {
  {
    const table_file file(
        "# a comment\ntemperature, depth, viscosity\n300, 0, 1e20\n300, 1e6, 1e22 # deep\n\n900 0 1e18\n900\t1e6 "
        "1e21\n");
    const auto table = viscosity_table::read(file.path);
    BOOST_TEST(table.temperatures() == (std::vector<double>{300.0, 900.0}), tt::per_element());
    BOOST_TEST(table.depths() == (std::vector<double>{0.0, 1e6}), tt::per_element());
    BOOST_TEST(table.log(600.0, 0.0) == std::log(1e19), tt::tolerance(1e-12));
    BOOST_TEST(table.log(300.0, 5e5) == std::log(1e21), tt::tolerance(1e-12));
  }
  const table_file by_name("depth (m);temperature (K);viscosity;source\n0;300;1e20;a\n0;900;1e18;nan\n");
  BOOST_TEST(viscosity_table::read(by_name.path).log(600.0, 7e5) == std::log(1e19), tt::tolerance(1e-12));
  const table_file one_depth("300 0 1e20\n900 0 1e18\n");
  BOOST_TEST(viscosity_table::read(one_depth.path).log(600.0, 7e5) == std::log(1e19), tt::tolerance(1e-12));
  for (const auto& [text, why] : std::vector<std::pair<std::string, std::string>>{
           {"", "no line of numbers"},
           {"300 0\n", "three columns are wanted"},
           {"depth, temperature, eta\n300, 0, 1e20\n", "three columns are wanted"},
           {"300 0 abc\n", ":1: column 3: expected a finite number, found 'abc'"},
           {"300 0 inf\n", ":1: column 3: expected a finite number, found 'inf'"},
           {"300 0 1e20\n300 1 -5\n", ":2: column 3: the viscosity must be above 0"},
           {"300 5 1e20\n300 1 1e20\n", "depths must ascend"},
           {"300 0 1e20\n200 0 1e20\n", "temperatures must ascend"},
           {"300 0 1e20\n300 1 1e20\n400 0 1e20\n", "there are 1 of 2 depths"},
           {"300 0 1e20\n300 1 1e20\n400 0 1e20\n400 2 1e20\n", ":4: the table is not rectangular"},
           {"300 0 1e20\n300 1 1e20\n400 0 1e20\n500 1 1e20\n", ":4: the table is not rectangular"}})
    BOOST_TEST(complaint(text).find(why) != std::string::npos, "'" << text << "': " << complaint(text));
  BOOST_CHECK_THROW(viscosity_table::read("/nowhere/at all"), foundation::error);
}

// ln η = (1 - s) ln η_solid + s ln η_liquid, s = ½ {1 + tanh[(f - 0.4)/0.15]} [Lebrun et al. 2013 for both ends]: at
// the table's own places, since between two of them it is bilinear.
BOOST_AUTO_TEST_CASE(viscosity_blended_by_melt_fraction) {
  options o;
  const auto p = resolved(
      "&walls temperature_top = 1700 temperature_bottom = 2300 /\n&convection viscosity_law = 'melt' melt_viscosity = "
      "'blended' viscosity_min = 1e-3 viscosity_max = 1e25 p_top = 2e9 /",
      o);
  const double first = 1640.0, step = 720.0 / 512.0;
  double low = 1e300, high = 0.0;
  for (int k = 0; k <= 512; k += 32) {
    const double T = first + k * step, T_s = melting::solidus(2e9),
                 T_l = melting::liquidus(melting::composition::peridotitic, 2e9);
    const double f = std::clamp((T - T_s) / (T_l - T_s), 0.0, 1.0), s = 0.5 * (1.0 + std::tanh((f - 0.4) / 0.15));
    const double solid = std::log(3.8e9) + 3.5e5 / (8.31446261815324 * T),
                 liquid = std::log(2.4e-4) + 4600.0 / (T - 1000);
    const double right = (1.0 - s) * solid + s * liquid;
    BOOST_TEST(p.law.table->log(T, 0.0) == right, tt::tolerance(1e-9) << "at " << T << " K");
    low = std::min(low, f);
    high = std::max(high, f);
  }
  BOOST_TEST(low == 0.0);
  BOOST_TEST(high > 0.9);
  options unused;
  BOOST_CHECK_THROW(resolved("&convection melt_viscosity = 'blended' /", unused), foundation::error);
}

BOOST_AUTO_TEST_CASE(viscosity_by_melt_fraction) {
  const std::string law = "&convection viscosity_law = 'melt' viscosity_min = 1e18 viscosity_max = 1e21 p_top = 2e9 ";
  const std::string walls = "&walls temperature_top = 1700 temperature_bottom = 3500 /\n";
  options o;
  const auto p = resolved(walls + law + "/", o);
  BOOST_TEST_REQUIRE(p.law.table != nullptr);
  const double L = p.fluid.L;
  for (const double depth : {0.0, 0.25 * L, L})
    for (const double T : {1700.0, 2105.0, 3500.0}) {
      const double P = 2e9 + p.fluid.rho * p.fluid.g * depth;
      const double f =
          melting::melt_fraction(T, melting::solidus(P), melting::liquidus(melting::composition::peridotitic, P));
      const double right = std::clamp(melting::suspension_viscosity(T, f), 1e18, 1e21);
      // Between two of 513 temperatures it may fall by the whole contrast.
      if (right == 1e18 || right == 1e21)
        BOOST_TEST(std::exp(p.law.table->log(T, depth)) == right, tt::tolerance(1e-9)
                                                                      << "at " << T << " K, " << depth << " m");
    }
  BOOST_TEST(p.fluid.nu * p.fluid.rho == std::exp(p.law.table->log(1700.0, 0.0)), tt::tolerance(1e-12));
  options scaled, cold, reversed, unused, missing;
  BOOST_TEST(relaxation::rayleigh(resolved(walls + law + "rayleigh = 1e5 /", scaled).fluid) == 1e5,
             tt::tolerance(1e-12));
  BOOST_CHECK_THROW(resolved(law + "/", cold), foundation::error);
  BOOST_CHECK_THROW(
      resolved(walls + "&convection viscosity_law = 'melt' viscosity_min = 1e22 viscosity_max = 1e21 /", reversed),
      foundation::error);
  BOOST_CHECK_THROW(resolved("&convection viscosity_min = 1e18 /", unused), foundation::error);
  BOOST_CHECK_THROW(resolved("&convection viscosity_law = 'table' /", missing), foundation::error);
}
