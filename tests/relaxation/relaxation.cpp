// Rules of slowed sound and inertia against the tables of the note of February 2023 [S1], and the
// estimates of the note of May 2022 [S0]. The notes print few digits, some of them cut off, not rounded.
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <relaxation/rules.hpp>
#include <relaxation/steps.hpp>

using namespace tetsuame::relaxation;

namespace {

// Whether `printed`, of so many digits, is the value rounded or cut off.
bool printed_as(double value, double printed, int digits) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - digits + 1);
  const double rounded = std::round(value / unit) * unit, cut = std::floor(value / unit + 1e-9) * unit;
  return std::fabs(rounded - printed) < 1e-6 * printed || std::fabs(cut - printed) < 1e-6 * printed;
}
#define CHECK_PRINTED(value, printed, digits) \
  BOOST_CHECK_MESSAGE(printed_as(value, printed, digits), #value " = " << (value) << ", printed " << (printed))

// [S1] table 1 and table 3
fluid_layer air(double dT) { return {0.1, dT, 1.0, 1e-5, 7.1e-6, 10.0, 7.1e-3, 1.4e5}; }
fluid_layer mantle(double nu) { return {1e6, 1000.0, 4e3, 1e-6, nu, 10.0, 2.5e-5, 1e11}; }

}  // namespace

BOOST_AUTO_TEST_CASE(numbers_of_the_note) {
  for (const auto& [dT, Ra] : {std::pair{1e-2, 1e4}, {1e-1, 1e5}, {1.0, 1e6}})
    BOOST_CHECK_CLOSE(rayleigh(air(dT)), Ra, 1e-10);
  BOOST_CHECK_CLOSE(prandtl(air(1.0)), 0.71, 1e-10);
  CHECK_PRINTED(thermal_mach(air(1.0)), 2.67e-7, 3);
  CHECK_PRINTED(sound_speed(air(1.0)), 374.0, 3);
  for (const auto& [nu, Ra] : {std::pair{2.5e19, 1e4}, {2.5e18, 1e5}, {2.5e17, 1e6}}) {
    BOOST_CHECK_CLOSE(rayleigh(mantle(nu)), Ra, 1e-10);
    BOOST_CHECK_CLOSE(prandtl(mantle(nu)), nu * 1e6, 1e-10);
  }
  BOOST_CHECK_CLOSE(thermal_mach(mantle(2.5e19)), 2e-16, 1e-10);
  BOOST_CHECK_CLOSE(sound_speed(mantle(2.5e19)), 5e3, 1e-10);
}

BOOST_AUTO_TEST_CASE(speeds_solve_the_balances_they_stand_for) {
  for (const fluid_layer& f : {air(0.3), mantle(3e18)}) {
    const double buoyancy = f.alpha * f.g * f.dT;
    const auto layer = [&](double V) { return std::sqrt(f.kappa * f.L / V) / f.L; };
    const double Vs = stokes_speed(f, false), Vf = free_fall_speed(f, false);
    BOOST_CHECK_CLOSE(f.nu * Vs / (f.L * f.L), buoyancy, 1e-10);
    BOOST_CHECK_CLOSE(Vf * Vf / f.L, buoyancy, 1e-10);
    const double Vst = stokes_speed(f, true), Vft = free_fall_speed(f, true);
    BOOST_CHECK_CLOSE(f.nu * Vst / (f.L * f.L), buoyancy * layer(Vst), 1e-10);
    BOOST_CHECK_CLOSE(Vft * Vft / f.L, buoyancy * layer(Vft), 1e-10);
  }
  BOOST_CHECK(reached_balance(air(1.0), true) == balance::inertial);
  BOOST_CHECK(reached_balance(mantle(2.5e19), true) == balance::viscous);
  BOOST_CHECK_EQUAL(reached_speed(air(1.0), false), free_fall_speed(air(1.0), false));
  BOOST_CHECK_EQUAL(reached_speed(mantle(2.5e19), true), stokes_speed(mantle(2.5e19), true));
}

BOOST_AUTO_TEST_CASE(table_2_air) {
  struct row {
    double dT, zeta, zeta_tb, c, c_tb, dt, dt_tb;  // the steps: (73)-(78)
  };
  for (const row& r : {row{1e-2, 4440, 10800, 8.43e-2, 3.47e-2, 1.19e-2, 2.88e-2},
                       row{1e-1, 1400, 4290, 2.66e-1, 8.72e-2, 3.75e-3, 1.15e-2},
                       row{1.0, 444, 1710, 8.43e-1, 2.19e-1, 1.19e-3, 4.57e-3}}) {
    const fluid_layer f = air(r.dT);
    for (const bool layers : {false, true}) {
      const auto found = recommend(f, {.boundary_layers = layers});
      BOOST_CHECK(found.how == "rsst");
      BOOST_CHECK_EQUAL(found.zeta_rule, layers ? "S1 (34)" : "S1 (32)");
      BOOST_CHECK_EQUAL(found.xi, 1.0);
      BOOST_CHECK_CLOSE(found.mach, 0.1, 1e-9);
      CHECK_PRINTED(found.zeta, layers ? r.zeta_tb : r.zeta, 3);
      CHECK_PRINTED(found.c_eff, layers ? r.c_tb : r.c, 3);
      // The note rounds c_eff before it divides: its last digit is good to one.
      const double dt = bounds(f, found.zeta, found.xi, 1e-3, 1.0).sound, printed = layers ? r.dt_tb : r.dt;
      BOOST_CHECK_SMALL(dt / printed - 1.0, 0.005);
    }
  }
  const auto plain = bounds(air(1.0), 1.0, 1.0, 1e-3, 1.0);  // (70)-(72)
  CHECK_PRINTED(plain.sound, 2.67e-6, 3);
  CHECK_PRINTED(plain.momentum, 7.04e-2, 3);
  CHECK_PRINTED(plain.heat, 5.00e-2, 3);
  BOOST_CHECK_EQUAL(plain.binding(), "sound");
}

BOOST_AUTO_TEST_CASE(table_4_mantle) {
  struct row {
    double nu, Pr, Pr_tb, zeta, zeta_tb, xi, xi_tb, c, c_tb;
    int digits_tb;                                  // of Pr_tb, zeta_tb, xi_tb, c_tb
    double dt_sound, dt_mo, dt_sound_tb, dt_mo_tb;  // (92)-(103)
  };
  for (const row& r :
       {row{2.5e19, 4.0e4, 1.8e3, 2.0, 9.2, 2.5e10, 1.1e11, 1.0e-7, 4.6e-9, 2, 1.0e11, 1.2e9, 2.1e12, 2.6e10},
        row{2.5e18, 4.0e5, 8.6e3, 2.0, 13, 2.5e9, 1.7e10, 1.0e-6, 2.1e-8, 2, 1.0e10, 1.2e8, 4.6e11, 5.8e9},
        row{2.5e17, 4.0e6, 4.0e4, 2.0, 20, 2.5e8, 2.5e9, 1.0e-5, 1.0e-7, 2, 1.0e9, 1.2e7, 1.0e11, 1.2e9}}) {
    const fluid_layer f = mantle(r.nu);
    for (const bool layers : {false, true}) {
      const auto found = recommend(f, {.boundary_layers = layers});
      BOOST_CHECK(found.how == "rsst_vim");
      BOOST_CHECK_EQUAL(found.zeta_rule, layers ? "S1 (54)" : "S1 (53)");
      BOOST_CHECK_EQUAL(found.xi_rule, layers ? "S1 (40)" : "S1 (39)");
      BOOST_CHECK_CLOSE(found.mach, 0.1, 1e-9);
      CHECK_PRINTED(found.Pr_eff, layers ? r.Pr_tb : r.Pr, 2);
      CHECK_PRINTED(found.zeta, layers ? r.zeta_tb : r.zeta, 2);
      CHECK_PRINTED(found.xi, layers ? r.xi_tb : r.xi, 2);
      CHECK_PRINTED(found.c_eff, layers ? r.c_tb : r.c, 2);
      const auto dt = bounds(f, found.zeta, found.xi, 1e4, 1.0);
      CHECK_PRINTED(dt.sound, layers ? r.dt_sound_tb : r.dt_sound, 2);
      CHECK_PRINTED(dt.momentum, layers ? r.dt_mo_tb : r.dt_mo, 2);
      BOOST_CHECK_EQUAL(dt.binding(), "momentum");
    }
  }
  const auto plain = bounds(mantle(2.5e19), 1.0, 1.0, 1e4, 1.0);  // (89)-(91)
  BOOST_CHECK_CLOSE(plain.sound, 2.0, 1e-9);
  BOOST_CHECK_CLOSE(plain.momentum, 2.0e-12, 1e-9);
  BOOST_CHECK_CLOSE(plain.heat, 5.0e13, 1e-9);
}

BOOST_AUTO_TEST_CASE(steps_of_the_note) {
  // (80): 10 n / C, whatever Ra; (105): 2 n^2 / (C phi_xi^2)
  for (const double dT : {1e-2, 1.0})
    for (const bool layers : {false, true}) {
      const auto p = plan_convection(air(dT), recommend(air(dT), {.boundary_layers = layers}), 100, 2, 1.0, 0.1, {});
      BOOST_CHECK_CLOSE(p.steps, 1e4, 1e-9);
    }
  for (const double nu : {2.5e19, 2.5e17})
    for (const bool layers : {false, true}) {
      const auto p =
          plan_convection(mantle(nu), recommend(mantle(nu), {.boundary_layers = layers}), 100, 2, 1.0, 0.1, {});
      BOOST_CHECK_CLOSE(p.steps, 8e5, 1e-9);
    }
}

BOOST_AUTO_TEST_CASE(every_rule_in_its_own_words) {
  // From the physics, not from Ra and Pr: 1/Mach of unslowed sound for RSST, Re^(-1/2) for VIM.
  const fluid_layer f = air(0.2);
  const double c0 = std::sqrt(f.K / f.rho), phi = 0.4;
  const auto rules = all_rules(f, phi);
  const auto bound = [&](const char* source) {
    const auto found = std::ranges::find(rules, std::string(source), &rule::source);
    BOOST_REQUIRE_MESSAGE(found != rules.end(), source);
    return found->bound;
  };
  const double Vs = stokes_speed(f, false), Vf = free_fall_speed(f, false);
  const double Vst = stokes_speed(f, true), Vft = free_fall_speed(f, true);
  BOOST_CHECK_CLOSE(bound("S1 (18)"), c0 / std::sqrt(f.g * f.L), 1e-9);  // from (17): c_zeta^2 >> g L
  BOOST_CHECK_CLOSE(bound("S1 (31)"), c0 / Vs, 1e-9);
  BOOST_CHECK_CLOSE(bound("S1 (32)"), c0 / Vf, 1e-9);
  BOOST_CHECK_CLOSE(bound("S1 (33)"), c0 / Vst, 1e-9);
  BOOST_CHECK_CLOSE(bound("S1 (34)"), c0 / Vft, 1e-9);
  BOOST_CHECK_CLOSE(bound("S1 (35)"), c0 / std::min(Vst, Vft), 1e-9);
  BOOST_CHECK_CLOSE(bound("S1 (39)"), std::sqrt(f.nu / (Vs * f.L)), 1e-9);
  BOOST_CHECK_CLOSE(bound("S1 (40)"), std::sqrt(f.nu / (Vst * f.L)), 1e-9);
  BOOST_CHECK_CLOSE(bound("S1 (43)"), c0 / Vs, 1e-9);
  BOOST_CHECK_CLOSE(bound("S1 (44)"), c0 / Vst, 1e-9);
  BOOST_CHECK_CLOSE(bound("S1 (45)"), std::min(std::sqrt(f.nu / (Vst * f.L)), c0 / Vst), 1e-9);
  BOOST_CHECK_CLOSE(bound("S1 (49)"), c0 / Vs, 1e-9);
  BOOST_CHECK_CLOSE(bound("S1 (50)"), c0 / Vst, 1e-9);
  BOOST_CHECK_CLOSE(bound("S1 (53)") * phi * bound("S1 (39)"), bound("S1 (49)"), 1e-9);
  BOOST_CHECK_CLOSE(bound("S1 (54)") * phi * bound("S1 (40)"), bound("S1 (50)"), 1e-9);
  // Of the later rule only the formula is printed: Ra = 1e7, Pr = 1 make it a power of ten.
  const fluid_layer one{1.0, 1.0, 1.0, 1.0, 1.0, 1e7, 1.0, 1.0};
  const auto later = all_rules(one, 0.5);
  BOOST_CHECK_CLOSE(later.back().bound, 1e-3, 1e-9);
  BOOST_CHECK_EQUAL(later.back().source, "S1b");
}

BOOST_AUTO_TEST_CASE(the_later_rule_switches_at_its_own_prandtl_number) {
  // Ra = 1e6: Ra^(2/3) = 1e4 and Ra^(5/6) = 1e5 lie either side of Pr = 3e4
  const fluid_layer f{1.0, 1.0, 1.0, 1.0, 3e4, 3e10, 1.0, 1e20};
  BOOST_CHECK_CLOSE(rayleigh(f), 1e6, 1e-9);
  BOOST_CHECK(recommend(f, {}).how == "rsst_vim");
  const auto later = recommend(f, {.rule = "later"});
  BOOST_CHECK(later.how == "rsst");
  BOOST_CHECK_EQUAL(later.zeta_rule, "S1b");
  BOOST_CHECK_CLOSE(later.zeta, 0.1 * 1e10 / (std::pow(1e6, 3.0 / 7.0) * std::pow(3e4, 2.0 / 7.0)), 1e-9);
  // far on the viscous side both rules are the same
  const auto a = recommend(mantle(2.5e19), {}), b = recommend(mantle(2.5e19), {.rule = "later"});
  BOOST_CHECK_EQUAL(a.zeta, b.zeta);
  BOOST_CHECK_EQUAL(a.xi, b.xi);
}

BOOST_AUTO_TEST_CASE(what_is_given_is_taken_and_never_below_one) {
  const auto both = recommend(mantle(2.5e19), {.zeta = 3.0, .xi = 1e9});
  BOOST_CHECK_EQUAL(both.zeta, 3.0);
  BOOST_CHECK_EQUAL(both.xi, 1e9);
  BOOST_CHECK_EQUAL(both.zeta_rule, "given");
  BOOST_CHECK_CLOSE(both.c_eff, 5e3 / 3e9, 1e-9);
  // xi given: zeta makes up to the same Mach number
  const auto one = recommend(mantle(2.5e19), {.xi = 1e10});
  BOOST_CHECK_CLOSE(one.mach, 0.1, 1e-9);
  const auto none = recommend(mantle(2.5e19), {.method = "none"});
  BOOST_CHECK(none.zeta == 1.0 && none.xi == 1.0);
  const auto vim = recommend(mantle(2.5e19), {.method = "vim"});
  BOOST_CHECK_EQUAL(vim.zeta, 1.0);
  CHECK_PRINTED(vim.xi, 1.1e11, 2);
  // A soft fluid: sound is hardly faster than the flow, nothing may be slowed.
  fluid_layer soft = air(1.0);
  soft.K = 1e-4;
  BOOST_CHECK_EQUAL(recommend(soft, {}).zeta, 1.0);
  BOOST_CHECK_EQUAL(recommend(soft, {}).zeta_rule, "at least 1");
}

BOOST_AUTO_TEST_CASE(backwards_is_the_largest_that_fits) {
  const cost c{.evaluations_per_step = 4, .updates_per_second = 2e6};
  for (const fluid_layer& f : {air(1.0), mantle(2.5e18)}) {
    const auto r = recommend(f, {});
    const auto n = largest_n(f, r, 2, 1.0, 0.1, {}, {.steps = 3e5});
    BOOST_CHECK_GT(n, 10);
    BOOST_CHECK_LE(plan_convection(f, r, n, 2, 1.0, 0.1, c).steps, 3e5);
    BOOST_CHECK_GT(plan_convection(f, r, n + 1, 2, 1.0, 0.1, c).steps, 3e5);
    for (const int d : {2, 3}) {
      const auto m = largest_n(f, r, d, 2.5, 0.1, c, {.seconds = 3600.0});
      const auto p = plan_convection(f, r, m, d, 2.5, 0.1, c);
      BOOST_CHECK_LE(p.seconds, 3600.0);
      BOOST_CHECK_GT(plan_convection(f, r, m + 1, d, 2.5, 0.1, c).seconds, 3600.0);
      BOOST_CHECK_CLOSE(p.seconds, p.steps * 4 * 2.5 * std::pow(m, d) / 2e6, 1e-9);
    }
    BOOST_CHECK_EQUAL(largest_n(f, r, 2, 1.0, 0.1, {}, {.steps = 1e-3}), 0);
  }
}

BOOST_AUTO_TEST_CASE(overturn_of_the_note) {
  // [S0 (26)-(32)]: its own figures are rounded at each step, so orders are what is compared; the values
  // are those of the formulas.
  const two_layers s;
  const auto p = plan_overturn(s, 75, 2, {});
  BOOST_CHECK_CLOSE(p.dx, 2e4, 1e-9);
  BOOST_CHECK_CLOSE(p.eta, 6e11, 1e-9);
  BOOST_CHECK_CLOSE(p.dt_sound, 2.0, 1e-9);
  BOOST_CHECK_CLOSE(p.dt_momentum, 2.0, 1e-9);
  BOOST_CHECK_EQUAL(p.binding, "sound");
  BOOST_CHECK_CLOSE(p.V, 4e8 * 7e4 / 1.2e12, 1e-9);
  CHECK_PRINTED(p.V, 20.0, 1);
  BOOST_CHECK_SMALL(std::log10(p.tau / 7e4), 0.1);
  BOOST_CHECK_SMALL(std::log10(p.steps / 5e3), 1.0);
  BOOST_CHECK_CLOSE(p.steps, steps_of_20(s, 75), 1e-9);
  // (21): 1e7 n^2/L; (23), (25)
  for (const auto& [n, L, N] : {std::tuple{10, 1e5, 1e4}, {10, 1e6, 1e3}, {100, 1e5, 1e6}, {100, 1e6, 1e5}})
    BOOST_CHECK_SMALL(std::log10(steps_of_20({.L = L}, n) / N), 0.1);
}

BOOST_AUTO_TEST_CASE(overturn_with_its_own_viscosity_and_heat) {
  // thicker than (18): momentum binds; thinner: sound does, and the flow is faster
  const auto thick = plan_overturn({.eta = 6e12}, 75, 2, {}), thin = plan_overturn({.eta = 1e11}, 75, 2, {});
  BOOST_CHECK_EQUAL(thick.binding, "momentum");
  BOOST_CHECK_CLOSE(thick.dt, 0.2, 1e-9);
  BOOST_CHECK_CLOSE(thick.steps, 100 * plan_overturn({}, 75, 2, {}).steps, 1e-9);
  BOOST_CHECK_EQUAL(thin.binding, "sound");
  BOOST_CHECK_CLOSE(thin.V, 140.0, 1e-9);
  const auto hot = plan_overturn({.conductivity = 1e16}, 75, 2, {});
  BOOST_CHECK_EQUAL(hot.binding, "heat");
  BOOST_CHECK_CLOSE(hot.dt, 3e3 * 1e3 * 4e8 / 1e16, 1e-9);
}

BOOST_AUTO_TEST_CASE(overturn_backwards) {
  const cost c{.evaluations_per_step = 1, .updates_per_second = 3e6};
  const budget steps{.steps = 1000}, time{.seconds = 20.0};
  const two_layers s;
  for (const budget& b : {steps, time, budget{.steps = 4e4, .seconds = 20.0}, budget{.steps = 1e7}}) {
    const auto a = afford(s, 75, 2, c, b);
    const auto fits = [&](const two_layers& what, std::int64_t n) {
      const auto p = plan_overturn(what, n, 2, c);
      return p.steps <= b.steps * (1 + 1e-9) && p.seconds <= b.seconds * (1 + 1e-9);
    };
    BOOST_CHECK(fits(s, a.n));
    BOOST_CHECK(!fits(s, a.n + 1));
    BOOST_CHECK(fits({.L = a.L}, 75));
    BOOST_CHECK(!fits({.L = 0.999 * a.L}, 75));
    BOOST_CHECK(fits({.eta = a.eta}, 75));
    BOOST_CHECK(!fits({.eta = 1.001 * a.eta}, 75));
  }
  // [S0, 2.6]: a thousand steps and L of 1000 km allow about ten particles
  BOOST_CHECK_EQUAL(afford({.L = 1e6}, 75, 2, {}, steps).n, 10);
}
