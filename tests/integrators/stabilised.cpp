// RKL2 and RKC2: their polynomials, limits of stability, order, error estimate, the same steps by
// ARKODE, and heat conduction against forward Euler and ARKODE with error control.
#include <cmath>
// arkode_butcher.h needs FILE declared
#include <cstdio>

#include <arkode/arkode_erkstep.h>

#include <foundation/error.hpp>
#include <integrators/explicit_integrator.hpp>
#include <integrators/stabilised.hpp>
#include <integrators/state_vector.hpp>
#include <numbers>

#include "ranks.hpp"

using namespace tetsuame::integrators;
using tetsuame::foundation::error;

namespace {

constexpr stabilised_method both[] = {stabilised_method::rkc2, stabilised_method::rkl2};
const char* name_of(stabilised_method m) { return m == stabilised_method::rkc2 ? "rkc2" : "rkl2"; }

// The recurrence on y' = lambda y, z = dt lambda.
double amplification(const recurrence& r, double z) {
  double before = 1.0, now = 1.0 + r.mu_tilde[1] * z;
  for (std::size_t j = 2; j < r.c.size(); ++j) {
    const double next =
        1.0 - r.mu[j] - r.nu[j] + r.mu[j] * now + r.nu[j] * before + z * (r.mu_tilde[j] * now + r.gamma_tilde[j]);
    before = now;
    now = next;
  }
  return now;
}

// The polynomials as published, from the closed form of T_s and the standard library's L_s.
double chebyshev(double s, double x) {
  return x <= 1.0 ? std::cos(s * std::acos(std::max(x, -1.0))) : std::cosh(s * std::acosh(x));
}
double published(stabilised_method m, unsigned stages, double z) {
  const double s = stages;
  if (m == stabilised_method::rkl2) {
    const double b = (s * s + s - 2.0) / (2.0 * s * (s + 1.0));
    return 1.0 - b + b * std::legendre(stages, std::max(-1.0, 1.0 + 4.0 / (s * s + s - 2.0) * z));
  }
  // T' = s sinh(s a)/sinh a, T'' = [s^2 cosh(s a) - cosh a s sinh(s a)/sinh a] / sinh^2 a, w_0 = cosh a
  const double w0 = 1.0 + 2.0 / 13.0 / (s * s), a = std::acosh(w0), sh = std::sinh(a);
  const double d = s * std::sinh(s * a) / sh, dd = (s * s * std::cosh(s * a) - w0 * d) / (sh * sh);
  const double b = dd / (d * d);
  return 1.0 - b * std::cosh(s * a) + b * chebyshev(s, w0 + d / dd * z);
}

// Where |P| leaves 1 for good, going out from the limit.
double measured_limit(const recurrence& r) {
  double z = 0.5 * r.limit;
  const double step = 1e-5 * r.limit;
  while (std::fabs(amplification(r, -z)) <= 1.0 + 1e-9) z += step;
  return z;
}

// u_t = kappa u_xx on (0, 1), u = 0 at both ends, n inner points.
struct heat {
  std::vector<double> u;
  double kappa = 1.0;
  int calls = 0;
  explicit heat(std::size_t n) : u(n) {}
  double dx() const { return 1.0 / static_cast<double>(u.size() + 1); }
  double radius() const { return 4.0 * kappa / (dx() * dx()); }  // the largest is a little smaller
  // Mode m of the lattice and its decay.
  double mode(int m, std::size_t i) const { return std::sin(m * std::numbers::pi * static_cast<double>(i + 1) * dx()); }
  double decay(int m) const {
    const double s = std::sin(0.5 * m * std::numbers::pi * dx());
    return 4.0 * kappa * s * s / (dx() * dx());
  }
  rhs_function rhs() {
    return [this](double, std::span<double* const> rate) {
      ++calls;
      const double factor = kappa / (dx() * dx());
      for (std::size_t i = 0; i < u.size(); ++i)
        rate[0][i] = factor * ((i > 0 ? u[i - 1] : 0.0) - 2.0 * u[i] + (i + 1 < u.size() ? u[i + 1] : 0.0));
      return 0;
    };
  }
  void start() {
    for (std::size_t i = 0; i < u.size(); ++i) u[i] = mode(1, i) + 0.5 * mode(3, i) + 0.1 * mode(20, i);
  }
  double error(double t) const {  // against the exact solution of the discrete equation
    double worst = 0.0;
    for (std::size_t i = 0; i < u.size(); ++i)
      worst = std::max(
          worst, std::fabs(u[i] - std::exp(-decay(1) * t) * mode(1, i) - 0.5 * std::exp(-decay(3) * t) * mode(3, i) -
                           0.1 * std::exp(-decay(20) * t) * mode(20, i)));
    return worst;
  }
};

explicit_options fixed(const char* method, double dt) { return {.method = method, .dt = dt, .error_control = false}; }

void run(explicit_integrator& integrator, double t_end) {
  while (integrator.time() < t_end) integrator.step(t_end);
}

// A stiff system that is neither linear nor autonomous: reaction, diffusion and a drive in time.
int stiff_rates(double t, const std::vector<double>& u, double* rate) {
  const std::size_t n = u.size();
  for (std::size_t i = 0; i < n; ++i) {
    const double left = i > 0 ? u[i - 1] : std::sin(t), right = i + 1 < n ? u[i + 1] : 0.2;
    rate[i] = 40.0 * (1.0 + 0.3 * u[i] * u[i]) * (left - 2.0 * u[i] + right) + u[i] * (1.0 - u[i]) * std::cos(3.0 * t);
  }
  return 0;
}
std::vector<double> stiff_start() {
  std::vector<double> u(12);
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = 0.3 + 0.2 * std::sin(1.7 * static_cast<double>(i));
  return u;
}

}  // namespace

BOOST_AUTO_TEST_CASE(the_recurrences_are_the_published_polynomials) {
  for (const auto m : both)
    for (const int s : {3, 5, 9, 21, 51}) {
      const recurrence r = make_recurrence(m, s);
      for (int k = 0; k <= 200; ++k) {
        const double z = -r.limit * k / 200.0;
        // rounding grows with s^2 in three-term recurrences
        BOOST_CHECK_SMALL(amplification(r, z) - published(m, static_cast<unsigned>(s), z), 1e-14 * s * s);
      }
      BOOST_CHECK_CLOSE(r.c.back(), 1.0, 1e-11);
      for (std::size_t j = 1; j < r.c.size(); ++j) BOOST_CHECK_GT(r.c[j] - r.c[j - 1], -1e-13);  // rkc2: c_1 = c_2
    }
}

BOOST_AUTO_TEST_CASE(stable_up_to_the_limit_and_not_far_beyond) {
  for (const auto m : both)
    for (const int s : {3, 4, 7, 10, 15, 31, 50}) {
      const recurrence r = make_recurrence(m, s);
      double largest = 0.0;
      for (int k = 1; k <= 5000; ++k) largest = std::max(largest, std::fabs(amplification(r, -r.limit * k / 5000.0)));
      BOOST_CHECK_LT(largest, 1.0 + 1e-9);
      // Beyond the limit the polynomial has to grow by a factor of up to 3 before |P| > 1: for odd s
      // I_0(s sqrt(2 x)) = 3 or so, x = 2.5/s^2 of half the interval.
      const double measured = measured_limit(r);
      BOOST_TEST_MESSAGE(name_of(m) << ' ' << s << ": limit " << r.limit << ", measured " << measured);
      BOOST_CHECK_GE(measured, r.limit * (1.0 - 1e-9));
      BOOST_CHECK_LE(measured, r.limit * (1.0 + 3.0 / (s * s)));
    }
  // The papers' own: RKC code (s^2 - 1) * 0.653 to 1 %; RKL2 eq. (20): (s^2 + s - 2)/4 Euler steps of 2/radius.
  for (const int s : {10, 40, 100}) {
    BOOST_CHECK_CLOSE(stability_limit(stabilised_method::rkc2, s), 0.653 * (s * s - 1), 1.0);
    BOOST_CHECK_CLOSE(stability_limit(stabilised_method::rkl2, s), (s * s + s - 2) / 4.0 * 2.0, 1e-10);
  }
}

BOOST_AUTO_TEST_CASE(stages_are_the_fewest_that_reach) {
  for (const auto m : both) {
    const int step = m == stabilised_method::rkl2 ? 2 : 1, first = m == stabilised_method::rkl2 ? 3 : 2;
    for (int k = 0; k < 290; ++k) {
      const double z = 3.0 * (std::pow(1.03, k) - 1.0);  // to 1.5e4: 175 stages
      const int s = stages_for(m, z, 200);
      BOOST_CHECK_GE(stability_limit(m, s), z);
      if (s > first) BOOST_CHECK_LT(stability_limit(m, s - step), z);
    }
    BOOST_CHECK_EQUAL(stages_for(m, 1e9, 200), 201);
    BOOST_CHECK_EQUAL(stages_for(m, INFINITY, 200), 201);
  }
}

BOOST_AUTO_TEST_CASE(one_step_is_the_same_as_arkode_makes_it_from_the_butcher_table) {
  // Each stage of the recurrence as a row of weights of F_0, F_1, …: an explicit Runge-Kutta table.
  for (const auto m : both)
    for (const int s : {3, 5, 9, 15}) {
      const recurrence r = make_recurrence(m, s);
      const auto n = static_cast<std::size_t>(s);
      std::vector<std::vector<double>> row(n + 1, std::vector<double>(n));
      row[1][0] = r.mu_tilde[1];
      for (std::size_t j = 2; j <= n; ++j) {
        for (std::size_t i = 0; i < n; ++i) row[j][i] = r.mu[j] * row[j - 1][i] + r.nu[j] * row[j - 2][i];
        row[j][j - 1] += r.mu_tilde[j];
        row[j][0] += r.gamma_tilde[j];
      }
      std::vector<double> a, c = r.c;
      for (std::size_t j = 0; j < n; ++j) a.insert(a.end(), row[j].begin(), row[j].end());
      ARKodeButcherTable table = ARKodeButcherTable_Create(s, 2, 0, c.data(), a.data(), row[n].data(), nullptr);

      const double dt = 0.9 * r.limit / 200.0;  // near the limit: the radius is about 4 * 40 * 1.1
      std::vector<double> by_arkode = stiff_start(), ours = stiff_start();
      sundials::Context context;
      const vector_handle y = make_state_vector(context, MPI_COMM_SELF, {{by_arkode.data(), by_arkode.size()}});
      void* memory = ERKStepCreate(
          [](double t, N_Vector state, N_Vector rate, void*) {
            const double* u = values(state)[0];
            return stiff_rates(t, {u, u + N_VGetLength(state)}, values_to_overwrite(rate)[0]);
          },
          0.2, y.get(), context);
      BOOST_REQUIRE(memory != nullptr);
      BOOST_REQUIRE_EQUAL(ERKStepSetTable(memory, table), ARK_SUCCESS);
      BOOST_REQUIRE_EQUAL(ERKStepSetFixedStep(memory, dt), ARK_SUCCESS);
      double reached = 0.0;
      BOOST_REQUIRE_EQUAL(ERKStepEvolve(memory, 0.2 + dt, y.get(), &reached, ARK_ONE_STEP), ARK_SUCCESS);
      ERKStepFree(&memory);
      ARKodeButcherTable_Free(table);

      explicit_integrator integrator(
          MPI_COMM_SELF, {{"u", ours.data()}}, ours.size(), 0.2, fixed(name_of(m), dt),
          [&](double t, std::span<double* const> rate) { return stiff_rates(t, ours, rate[0]); }, {},
          [&](double) { return r.limit / dt * (1.0 - 1e-12); });
      integrator.step(1.0);
      BOOST_CHECK_EQUAL(integrator.statistics().stages, s);
      BOOST_CHECK_EQUAL(integrator.statistics().evaluations, s + 1);  // the start's, s - 1 stages, the end's
      const auto start = stiff_start();
      double moved = 0.0;
      for (std::size_t i = 0; i < ours.size(); ++i) {
        BOOST_CHECK_SMALL(ours[i] - by_arkode[i], 1e-12);
        moved = std::max(moved, std::fabs(ours[i] - start[i]));
      }
      BOOST_CHECK_GT(moved, 0.01);
    }
}

BOOST_AUTO_TEST_CASE(second_order_on_a_stiff_nonlinear_driven_system) {
  for (const auto m : both) {
    // five stages whatever the step, as the constant of the error depends on them
    const auto result = [&](const explicit_options& options) {
      std::vector<double> u = stiff_start();
      explicit_integrator integrator(
          MPI_COMM_SELF, {{"u", u.data(), 1e-13}}, u.size(), 0.0, options,
          [&](double t, std::span<double* const> rate) { return stiff_rates(t, u, rate[0]); }, {},
          [&](double) { return 0.999 * stability_limit(m, 5) / options.dt; });
      run(integrator, 1.0);
      return u;
    };
    const auto exact = result({.method = "adaptive", .order = 5, .rtol = 1e-12});
    const auto error_with = [&](int steps) {
      const auto u = result(fixed(name_of(m), 1.0 / steps));
      double worst = 0.0;
      for (std::size_t i = 0; i < u.size(); ++i) worst = std::max(worst, std::fabs(u[i] - exact[i]));
      return worst;
    };
    const double measured = std::log2(error_with(320) / error_with(640));
    BOOST_TEST_MESSAGE(name_of(m) << ": order " << measured);
    BOOST_CHECK_SMALL(measured - 2.0, 0.15);
  }
}

BOOST_AUTO_TEST_CASE(the_error_estimate_is_the_local_error) {
  // y' = lambda y, small z: rkl2's estimate is the error itself, rkc2's at most 1.8 times it.
  for (const auto m : both)
    for (const int s : {3, 7, 21}) {
      const recurrence r = make_recurrence(m, s);
      const double z = -0.01, p = amplification(r, z);
      const double bracket = 1.0 - p + 0.5 * z * (1.0 + p), local = std::exp(z) - p;
      const double ratio = r.error_factor * bracket / local;
      BOOST_TEST_MESSAGE(name_of(m) << ' ' << s << ": estimate/error " << ratio);
      if (m == stabilised_method::rkl2) BOOST_CHECK_CLOSE(ratio, 1.0, 2.0);  // next order: about z
      if (m == stabilised_method::rkc2) BOOST_CHECK(ratio > 1.0 && ratio < 2.6);
    }
}

BOOST_AUTO_TEST_CASE(the_integrator_reports_that_estimate) {
  for (const char* method : {"rkl2", "rkc2"}) {
    double y = 1.0;
    const double dt = 0.01, rtol = 1e-6, atol = 1e-9;
    explicit_integrator integrator(
        MPI_COMM_SELF, {{"y", &y, atol}}, 1, 0.0, {.method = method, .dt = dt, .rtol = rtol},
        [&](double, std::span<double* const> rate) {
          rate[0][0] = -y;
          return 0;
        },
        {}, [](double) { return 1.0; });
    integrator.step(1.0);
    const auto& statistics = integrator.statistics();
    BOOST_REQUIRE_EQUAL(statistics.rejections, 0);
    const recurrence r = make_recurrence(
        method == std::string("rkl2") ? stabilised_method::rkl2 : stabilised_method::rkc2, statistics.stages);
    const double estimate = r.error_factor * (1.0 - y - 0.5 * dt * (1.0 + y));
    BOOST_CHECK_CLOSE(statistics.last_error, std::fabs(estimate) / (rtol + atol), 1e-6);
  }
}

BOOST_AUTO_TEST_CASE(heat_conduction_is_stable_at_a_hundred_euler_steps_and_not_with_too_few_stages) {
  for (const char* method : {"rkl2", "rkc2"})
    for (const double told : {1.0, 0.7}) {
      heat h(100);
      for (std::size_t i = 0; i < h.u.size(); ++i) h.u[i] = i % 3 == 0 ? 1.0 : -0.5;  // every mode
      const double euler = 2.0 / h.radius();
      explicit_integrator integrator(MPI_COMM_SELF, {{"u", h.u.data()}}, h.u.size(), 0.0, fixed(method, 100 * euler),
                                     h.rhs(), {}, [&](double) { return told * h.radius(); });
      for (int k = 0; k < 40; ++k) integrator.step(1e9);
      double largest = 0.0;
      for (const double u : h.u) largest = std::max(largest, std::fabs(u));
      if (told == 1.0) BOOST_CHECK_LT(largest, 1.0);
      if (told < 1.0) BOOST_CHECK_GT(largest, 1e3);
    }
}

BOOST_AUTO_TEST_CASE(heat_conduction_to_one_error_for_an_eighth_of_the_work) {
  // To t = 0.05 within 1e-4: forward Euler and ARKODE with error control are bound by stability.
  constexpr std::size_t n = 400;
  constexpr double t_end = 0.05, wanted = 1e-4;
  const auto work = [&](const explicit_options& options) {
    heat h(n);
    h.start();
    explicit_integrator integrator(MPI_COMM_SELF, {{"u", h.u.data(), 1e-5}}, n, 0.0, options, h.rhs(), {},
                                   [&](double) { return h.radius(); });
    run(integrator, t_end);
    const auto& st = integrator.statistics();
    BOOST_TEST_MESSAGE(options.method << ": " << st.evaluations << " evaluations, " << st.steps << " steps, "
                                      << st.rejections << " rejections, error " << h.error(t_end) << ", last stages "
                                      << st.stages);
    BOOST_CHECK_LT(h.error(t_end), wanted);
    BOOST_CHECK_EQUAL(st.evaluations, h.calls);
    return st.evaluations;
  };
  const double euler_dt = 2.0 / heat(n).radius();
  const auto euler = work({.method = "euler", .dt = euler_dt});
  const auto adaptive = work({.method = "adaptive", .order = 3, .rtol = 1e-4});
  for (const char* method : {"rkl2", "rkc2"}) {
    const auto evaluations = work({.method = method, .rtol = 1e-4});
    BOOST_CHECK_LT(8 * evaluations, euler);
    BOOST_CHECK_LT(8 * evaluations, adaptive);
  }
}

BOOST_AUTO_TEST_CASE(a_sudden_source_is_met_by_rejections) {
  // y' = -1000 (y - bump(t)): quiet, then a front of width 1e-4 at t = 1
  for (const char* method : {"rkl2", "rkc2"}) {
    double y = 0.0;
    const auto bump = [](double t) { return 0.5 * (1.0 + std::tanh((t - 1.0) / 1e-4)); };
    explicit_integrator integrator(
        MPI_COMM_SELF, {{"y", &y, 1e-6}}, 1, 0.0, {.method = method, .dt = 1e-3, .rtol = 1e-5},
        [&](double t, std::span<double* const> rate) {
          rate[0][0] = -1000.0 * (y - bump(t));
          return 0;
        },
        {}, [](double) { return 1000.0; });
    run(integrator, 0.99);
    const auto quiet = integrator.statistics().rejections;
    run(integrator, 1.05);
    const auto& statistics = integrator.statistics();
    BOOST_CHECK_GT(statistics.rejections, quiet);
    BOOST_CHECK_EQUAL(statistics.attempts, statistics.steps + statistics.rejections);
    BOOST_CHECK_SMALL(y - 1.0, 1e-4);
  }
}

BOOST_AUTO_TEST_CASE(stages_are_bounded_and_told) {
  heat h(100);
  h.start();
  explicit_integrator integrator(MPI_COMM_SELF, {{"u", h.u.data(), 1e-3}}, h.u.size(), 0.0,
                                 {.method = "rkl2", .rtol = 1e-2, .max_stages = 6}, h.rhs(), {},
                                 [&](double) { return h.radius(); });
  int most = 0;
  for (int k = 0; k < 60; ++k) {
    integrator.step(1e9);
    most = std::max(most, integrator.statistics().stages);
  }
  BOOST_CHECK_EQUAL(most, 5);  // odd ones only
  BOOST_CHECK_GT(integrator.statistics().limited_by.at("stages"), 30);

  explicit_integrator too_long(MPI_COMM_SELF, {{"u", h.u.data()}}, h.u.size(), 0.0,
                               {.method = "rkc2", .dt = 1.0, .error_control = false, .max_stages = 20}, h.rhs(), {},
                               [&](double) { return h.radius(); });
  const auto before = h.u;
  BOOST_CHECK_EXCEPTION(too_long.step(2.0), error,
                        [](const error& e) { return std::string(e.what()).find("max_stages") != std::string::npos; });
  BOOST_CHECK(h.u == before);
}

BOOST_AUTO_TEST_CASE(what_cannot_be_evaluated_shortens_the_step) {
  for (const char* method : {"rkl2", "rkc2"}) {
    double y = 1.0;
    const rhs_function refusing = [&](double, std::span<double* const> rate) {
      rate[0][0] = -y * y;
      return y < 0.0 ? 1 : 0;
    };
    explicit_integrator integrator(MPI_COMM_SELF, {{"y", &y, 1e-9}}, 1, 0.0,
                                   {.method = method, .dt = 50.0, .rtol = 1e-4}, refusing, {},
                                   [](double) { return 0.01; });  // far too low: the stage goes below 0
    run(integrator, 100.0);
    BOOST_CHECK_GT(integrator.statistics().unevaluable, 0);
    BOOST_CHECK_CLOSE(y, 1.0 / 101.0, 1.0);
  }
  double y = 1.0;
  explicit_integrator wrong(
      MPI_COMM_SELF, {{"y", &y, 1e-9}}, 1, 0.0, {.method = "rkl2"},
      [](double, std::span<double* const> rate) {
        rate[0][0] = 1.0;
        return 0;
      },
      {}, [](double) { return std::nan(""); });
  BOOST_CHECK_THROW(wrong.step(1.0), error);
}
