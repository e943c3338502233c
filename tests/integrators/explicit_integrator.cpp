// Explicit steps on one rank: order, bits, work, limits, restarts and failures.
#include <array>
#include <cmath>
#include <foundation/error.hpp>
#include <integrators/explicit_integrator.hpp>
#include <numeric>

#include "ranks.hpp"

using namespace tetsuame::integrators;
using tetsuame::foundation::error;

namespace {

// n uncoupled copies, each with its own constants, of
//   u' = a u cos t,      u = u_0 exp(a sin t)
//   w' = b w (1 - w),    w = 1 / (1 + (1/w_0 - 1) e^{-bt})
struct problem {
  std::vector<double> u, w, a, b;
  std::vector<double> earlier_u, earlier_w;  // rates that 'ab2' and 'kdk' keep with the particles
  int calls = 0;

  explicit problem(std::size_t n = 5) : u(n), w(n), a(n), b(n), earlier_u(n), earlier_w(n) {
    for (std::size_t i = 0; i < n; ++i) {
      a[i] = 1.0 + 0.1 * static_cast<double>(i);
      b[i] = 1.5 - 0.1 * static_cast<double>(i);
      u[i] = 1.0 + 0.3 * static_cast<double>(i % 7);
      w[i] = 0.1 + 0.01 * static_cast<double>(i);
    }
  }
  std::vector<field> fields() {
    return {{"u", u.data(), 1e-9, 0.0, 0.0, 0.0, earlier_u.data()},
            {"w", w.data(), 1e-9, 0.0, 0.0, 0.0, earlier_w.data()}};
  }
  std::vector<std::vector<double>*> arrays() { return {&u, &w, &a, &b, &earlier_u, &earlier_w}; }
  std::size_t size() const { return u.size(); }
  rhs_function rhs() {
    return [this](double t, std::span<double* const> rate) {
      ++calls;
      for (std::size_t i = 0; i < size(); ++i) {
        rate[0][i] = a[i] * u[i] * std::cos(t);
        rate[1][i] = b[i] * w[i] * (1.0 - w[i]);
      }
      return 0;
    };
  }
  double error(double t) const {
    const problem start(size());
    double worst = 0.0;
    for (std::size_t i = 0; i < size(); ++i) {
      worst = std::max(worst, std::fabs(u[i] - start.u[i] * std::exp(a[i] * std::sin(t))));
      worst = std::max(worst, std::fabs(w[i] - 1.0 / (1.0 + (1.0 / start.w[i] - 1.0) * std::exp(-b[i] * t))));
    }
    return worst;
  }
};

void run(explicit_integrator& integrator, double t_end) {
  while (integrator.time() < t_end) integrator.step(t_end);
}

void run_to(explicit_integrator& integrator, long long steps, double t_stop) {
  while (integrator.statistics().steps < steps) integrator.step(t_stop);
}

void check_same_bits(const std::vector<double>& x, const std::vector<double>& y) {
  BOOST_REQUIRE_EQUAL(x.size(), y.size());
  for (std::size_t i = 0; i < x.size(); ++i) BOOST_CHECK_EQUAL(bits(x[i]), bits(y[i]));
}

explicit_options fixed(const std::string& method, double dt) { return {.method = method, .dt = dt}; }
explicit_options adaptive(int order, double rtol, double dt = 0.0) {
  return {.method = "adaptive", .order = order, .dt = dt, .rtol = rtol};
}

explicit_options kicked(double dt) { return {.method = "kdk", .dt = dt, .error_control = false}; }
explicit_options stabilised(const std::string& method) { return {.method = method, .rtol = 1e-4}; }
double radius_bound(double) { return 5.0; }  // 1/s, about twice that of the problem

// All methods with a step of about 0.02, for tests that hold for each of them.
std::vector<explicit_options> all_methods() {
  return {fixed("euler", 0.02),
          fixed("order_2", 0.02),
          fixed("order_3", 0.02),
          fixed("order_4", 0.02),
          fixed("order_5", 0.02),
          adaptive(2, 1e-4),
          adaptive(3, 1e-5),
          adaptive(4, 1e-6),
          adaptive(5, 1e-7),
          fixed("ssp_rk3", 0.02),
          fixed("rk4", 0.02),
          fixed("ab2", 0.02),
          stabilised("rkl2"),
          stabilised("rkc2"),
          {.method = "rkl2", .dt = 0.02, .error_control = false},
          kicked(0.02)};
}

}  // namespace

BOOST_AUTO_TEST_CASE(every_method_converges_with_its_order) {
  const std::vector<std::pair<std::string, double>> methods = {{"euler", 1},   {"order_2", 2}, {"order_3", 3},
                                                               {"order_4", 4}, {"order_5", 5}, {"ssp_rk3", 3},
                                                               {"rk4", 4},     {"ab2", 2},     {"kdk", 2}};
  for (const auto& each : methods) {
    const std::string& method = each.first;
    const double order = each.second;
    const auto error_with = [&](int steps) {
      problem p;
      explicit_integrator integrator(MPI_COMM_SELF, p.fields(), p.size(), 0.0,
                                     method == "kdk" ? kicked(2.0 / steps) : fixed(method, 2.0 / steps), p.rhs());
      run(integrator, 2.0);
      BOOST_CHECK_EQUAL(integrator.time(), 2.0);
      BOOST_CHECK_EQUAL(integrator.statistics().steps, steps);
      return p.error(2.0);
    };
    // Steps fine enough for the next order's share to be below the 0.15 allowed, coarse enough for rounding.
    const int steps = order <= 2 ? 256 : 64;
    const double measured = std::log2(error_with(steps) / error_with(2 * steps));
    BOOST_TEST_MESSAGE(method << ": order " << measured);
    BOOST_CHECK_SMALL(measured - order, 0.15);
  }
}

BOOST_AUTO_TEST_CASE(euler_is_the_hand_loop_in_every_bit) {
  problem p, hand;
  explicit_integrator integrator(MPI_COMM_SELF, p.fields(), p.size(), 0.0, fixed("euler", 0.01), p.rhs());
  run_to(integrator, 300, 1e9);
  double t = 0.0;
  for (int k = 0; k < 300; ++k, t += 0.01)
    for (std::size_t i = 0; i < hand.size(); ++i) {
      const double du = hand.a[i] * hand.u[i] * std::cos(t), dw = hand.b[i] * hand.w[i] * (1.0 - hand.w[i]);
      hand.u[i] += 0.01 * du;
      hand.w[i] += 0.01 * dw;
    }
  check_same_bits(p.u, hand.u);
  check_same_bits(p.w, hand.w);
  BOOST_CHECK_EQUAL(p.calls, 301);  // one a step, and the rate of the state reached
  BOOST_CHECK_EQUAL(integrator.statistics().evaluations, 301);
}

BOOST_AUTO_TEST_CASE(fixed_methods_cost_what_they_should) {
  // Evaluations a step, and those of the start. rk4 asks for the rate at the end only when the next step needs it; so
  // do the others of ARKODE from version 7 on.
  for (const auto& [method, each, start] :
       {std::tuple{"ab2", 1, 2}, {"ssp_rk3", 3, 1}, {"rk4", 4, 0}, {"order_4", 5, 1}}) {
    problem p;
    explicit_integrator integrator(MPI_COMM_SELF, p.fields(), p.size(), 0.0, fixed(method, 0.01), p.rhs());
    run_to(integrator, 100, 1e9);
    const auto besides = integrator.statistics().evaluations - 100 * each;
    BOOST_CHECK(besides == start || (method != std::string("ab2") && besides == 0));
  }
}

// A planet about a sun, GM = 1, at aphelion at first, with friction, a = -x/r^3 - drag v.
struct orbit {
  double drag;
  std::vector<double> x{1.5}, y{0.0}, u{0.0}, v{std::sqrt(1.0 / 3.0)}, kept_u{0.0}, kept_v{0.0};
  int calls = 0, refuse = 0;  // the call that cannot be evaluated

  std::vector<field> fields() {
    std::vector<field> all{{"x", x.data()}, {"y", y.data()}, {"u", u.data()}, {"v", v.data()}};
    all[0].velocity = 2;
    all[1].velocity = 3;
    all[2].previous_rate = kept_u.data();
    all[3].previous_rate = kept_v.data();
    return all;
  }
  rhs_function rhs() {
    return [this](double, std::span<double* const> rate) {
      if (++calls == refuse) return 1;
      const double r2 = x[0] * x[0] + y[0] * y[0], by = -1.0 / (r2 * std::sqrt(r2));
      rate[0][0] = u[0];
      rate[1][0] = v[0];
      rate[2][0] = by * x[0] - drag * u[0];
      rate[3][0] = by * y[0] - drag * v[0];
      return 0;
    };
  }
  double energy() const { return 0.5 * (u[0] * u[0] + v[0] * v[0]) - 1.0 / std::hypot(x[0], y[0]); }
};
constexpr double year = 6.283185307179586;

BOOST_AUTO_TEST_CASE(kick_drift_kick_is_of_second_order) {
  for (const double drag : {0.0, 0.1}) {
    const auto end = [&](const explicit_options& how) {
      orbit o{drag};
      explicit_integrator integrator(MPI_COMM_SELF, o.fields(), 1, 0.0, how, o.rhs());
      run(integrator, year);
      return std::array{o.x[0], o.y[0], o.u[0], o.v[0]};
    };
    const auto exact = end(fixed("rk4", year / 20000));
    const auto error_with = [&](int steps) {
      const auto found = end(kicked(year / steps));
      double most = 0.0;
      for (std::size_t k = 0; k < 4; ++k) most = std::max(most, std::fabs(found[k] - exact[k]));
      return most;
    };
    const double order = std::log2(error_with(1000) / error_with(2000));
    BOOST_TEST_MESSAGE("drag " << drag << ": order " << order << ", error " << error_with(1000));
    BOOST_CHECK_SMALL(order - 2.0, 0.1);
    BOOST_CHECK_SMALL(error_with(1000), 1e-2);
  }
}

BOOST_AUTO_TEST_CASE(kick_drift_kick_keeps_the_energy_of_an_orbit_with_one_evaluation_a_step) {
  const auto drift = [](const explicit_options& how, int years, int steps) {
    orbit o{0.0};
    const double start = o.energy();
    explicit_integrator integrator(MPI_COMM_SELF, o.fields(), 1, 0.0, how, o.rhs());
    run(integrator, years * year);
    if (how.method == "kdk") BOOST_CHECK_EQUAL(o.calls, steps + 1);
    BOOST_CHECK_EQUAL(o.calls, integrator.statistics().evaluations);
    return std::fabs(o.energy() / start - 1.0);
  };
  // What is left after whole years does not grow with their number; that of a Runge-Kutta method does.
  BOOST_CHECK_SMALL(drift(kicked(year / 200), 10, 2000), 2e-3);
  BOOST_CHECK_SMALL(drift(kicked(year / 200), 200, 40000), 2e-3);
  const double few = drift(fixed("order_3", year / 67), 2, 0), many = drift(fixed("order_3", year / 67), 20, 0);
  BOOST_CHECK_GT(many, 5.0 * few);
}

BOOST_AUTO_TEST_CASE(kick_drift_kick_takes_stable_steps_and_goes_on_in_every_bit) {
  const auto limit_of = [](orbit& o) {
    return [&o](double) {
      const double r = std::hypot(o.x[0], o.y[0]);
      return step_limit{0.02 * std::sqrt(r * r * r), "orbit"};
    };
  };
  for (const int substeps : {1, 3}) {
    const explicit_options how{.method = "kdk", .substeps = substeps};
    orbit whole{0.05}, part{0.05};
    explicit_integrator all(MPI_COMM_SELF, whole.fields(), 1, 0.0, how, whole.rhs(), limit_of(whole));
    run(all, year);
    BOOST_CHECK_EQUAL(all.statistics().limited_by.at("orbit") + all.statistics().limited_by.at("output"),
                      all.statistics().steps);
    explicit_memory memory;
    {
      explicit_integrator first(MPI_COMM_SELF, part.fields(), 1, 0.0, how, part.rhs(), limit_of(part));
      for (int k = 0; k < 100; ++k) first.step(year);
      memory = first.save();
    }
    explicit_integrator rest(MPI_COMM_SELF, part.fields(), 1, 0.0, how, part.rhs(), limit_of(part));
    rest.restore(memory);
    rest.prepare();  // as what follows from the state is not saved
    run(rest, year);
    check_same_bits(whole.x, part.x);
    check_same_bits(whole.v, part.v);
    BOOST_CHECK_EQUAL(rest.statistics().steps, all.statistics().steps);
    BOOST_CHECK_EQUAL(rest.statistics().evaluations, all.statistics().evaluations);
  }
}

BOOST_AUTO_TEST_CASE(kick_drift_kick_tries_a_shorter_step_where_a_state_cannot_be_evaluated) {
  for (const int substeps : {1, 3})
    for (const int refused : {11, 12}) {
      orbit o{0.0};
      o.refuse = refused;
      explicit_integrator integrator(MPI_COMM_SELF, o.fields(), 1, 0.0, {.method = "kdk", .substeps = substeps},
                                     o.rhs(), [&](double) {
                                       return step_limit{0.01 * substeps, "orbit"};
                                     });
      const double start = o.energy();
      for (int k = 0; k < 40; ++k) integrator.step(1e9);
      BOOST_CHECK_EQUAL(integrator.statistics().unevaluable, 1);
      BOOST_CHECK_EQUAL(integrator.statistics().limited_by.at("accuracy"), 2);  // that step and the one after it
      BOOST_CHECK_SMALL(o.energy() / start - 1.0, 1e-5);
    }
}

// Two springs that pull at one mass: the stiff one is the fast force, the other one the slow force. With friction,
// whose heat is integrated too.
struct two_springs {
  double x = 1.0, v = 0.0, heat = 0.0, kept_v = 0.0, kept_heat = 0.0, slow_v = 0.0;
  double fast2 = 100.0, slow2 = 1.0, friction = 0.0;  // 1/s², 1/s
  int calls = 0, slow_calls = 0, refuse = 0;          // the call that cannot be evaluated
  bool for_good = false;                              // and all that follow

  double exact(double t) const { return std::cos(std::sqrt(fast2 + slow2) * t); }
  double energy() const { return 0.5 * (v * v + (fast2 + slow2) * x * x) + heat; }
  void find_slow() { slow_v = -slow2 * x; }
  // The end after steps of dt each, with so many substeps.
  explicit_statistics go(double dt, int steps, int substeps) {
    std::vector<field> fields{{"x", &x}, {"v", &v}, {"heat", &heat}};
    fields[0].velocity = 1;
    fields[1].previous_rate = &kept_v;
    fields[1].slow_rate = &slow_v;
    fields[2].previous_rate = &kept_heat;
    explicit_integrator* by = nullptr;
    const auto rhs = [&](double, std::span<double* const> rate) {
      if (++calls == refuse || (for_good && calls > refuse)) return 1;
      const double weight = by->weight_of_slow_forces();
      if (weight != 0.0) {
        ++slow_calls;
        find_slow();
      }
      rate[0][0] = v;
      rate[1][0] = -fast2 * x + weight * slow_v - friction * v;
      rate[2][0] = friction * v * v;
      return 0;
    };
    explicit_integrator integrator(
        MPI_COMM_SELF, fields, 1, 0.0, {.method = "kdk", .substeps = substeps}, rhs,
        [dt](double) {
          return step_limit{dt, "spring"};
        },
        {}, [&] { find_slow(); });
    by = &integrator;
    run_to(integrator, steps, 1e9);
    return integrator.statistics();
  }
};

BOOST_AUTO_TEST_CASE(slow_forces_act_at_the_ends_of_a_step) {
  constexpr int steps = 200, substeps = 4;
  const auto error_with = [](int refined) {
    two_springs s;
    s.go(2.0 / (steps * refined), steps * refined, substeps);
    BOOST_CHECK_EQUAL(s.calls, steps * refined * substeps + 1);
    BOOST_CHECK_EQUAL(s.slow_calls, steps * refined + 1);
    return std::fabs(s.x - s.exact(2.0));
  };
  BOOST_CHECK_SMALL(std::log2(error_with(1) / error_with(2)) - 2.0, 0.05);

  // By hand: half an impulse, four steps of the stiff spring, half an impulse.
  two_springs s;
  const double dt = 0.01, part = dt / substeps;
  s.go(dt, steps, substeps);
  double x = 1.0, v = 0.0;
  for (int k = 0; k < steps; ++k) {
    v -= 0.5 * dt * s.slow2 * x;
    for (int j = 0; j < substeps; ++j) {
      v -= 0.5 * part * s.fast2 * x;
      x += part * v;
      v -= 0.5 * part * s.fast2 * x;
    }
    v -= 0.5 * dt * s.slow2 * x;
  }
  BOOST_CHECK_SMALL(s.x - x, 1e-12);
  BOOST_CHECK_SMALL(s.v - v, 1e-11);

  // The energy of a symplectic method does not drift.
  two_springs longer;
  longer.go(0.01, 100000, substeps);
  const double energy = 0.5 * (longer.v * longer.v + (longer.fast2 + longer.slow2) * longer.x * longer.x);
  BOOST_CHECK_SMALL(energy / (0.5 * (longer.fast2 + longer.slow2)) - 1.0, 1e-3);
}

BOOST_AUTO_TEST_CASE(slow_forces_and_rates_of_velocities) {
  // Friction is evaluated at velocities with half of the slow impulse there: heat and motion together keep the energy.
  const auto change = [](double dt, int substeps) {
    two_springs s;
    s.fast2 = 1.0, s.slow2 = 4.0, s.friction = 0.3;
    const double before = s.energy();
    s.go(dt, static_cast<int>(std::lround(8.0 / dt)), substeps);
    return std::fabs(s.energy() / before - 1.0);
  };
  BOOST_CHECK_SMALL(change(0.02, 2), 5e-4);
  BOOST_CHECK_SMALL(std::log2(change(0.02, 2) / change(0.01, 2)) - 2.0, 0.3);

  // After an attempt that failed in its second or third part the shorter steps begin where the longer one did.
  for (const int part : {2, 3}) {
    two_springs failed, whole;
    failed.refuse = 1 + 3 * 10 + part;
    BOOST_CHECK_EQUAL(failed.go(0.01, 12, 3).unevaluable, 1);
    whole.go(0.01, 10, 3);
    whole.go(0.01 / 4, 2, 3);
    BOOST_CHECK_SMALL(failed.x - whole.x, 1e-14);
    BOOST_CHECK_SMALL(failed.v - whole.v, 1e-13);
  }
  // Where none passes, the slow rate is again that of the state at the start of the step.
  two_springs stopped;
  stopped.refuse = 1 + 3 * 10 + 3;
  stopped.for_good = true;
  BOOST_CHECK_THROW(stopped.go(0.01, 12, 3), error);
  BOOST_CHECK_EQUAL(bits(stopped.slow_v), bits(-stopped.slow2 * stopped.x));
}

BOOST_AUTO_TEST_CASE(adams_bashforth_is_the_hand_loop_and_starts_anew_after_a_short_step) {
  // y' = y^2 by hand: Ralston first, then Adams-Bashforth, whose weights follow a change of step
  const auto f = [](double y) { return y * y; };
  const auto ralston = [&](double y, double dt) {
    return y + dt * (0.25 * f(y) + 0.75 * f(y + dt * (2.0 / 3.0) * f(y)));
  };
  double y = 0.5, earlier = 0.0;
  explicit_integrator integrator(MPI_COMM_SELF, {{"y", &y, 0.0, 0.0, 0.0, 0.0, &earlier}}, 1, 0.0, fixed("ab2", 0.1),
                                 [&](double, std::span<double* const> rate) {
                                   rate[0][0] = f(y);
                                   return 0;
                                 });
  const double y1 = ralston(0.5, 0.1);
  const double y2 = y1 + 0.1 * (1.5 * f(y1) - 0.5 * f(0.5));
  const double y3 = y2 + 0.025 * (1.125 * f(y2) - 0.125 * f(y1));  // cut short: r = 1/4
  const double y4 = ralston(y3, 0.1);                              // r = 4: anew
  const double y5 = y4 + 0.1 * (1.5 * f(y4) - 0.5 * f(y3));
  integrator.step(0.225);
  BOOST_CHECK_CLOSE(y, y1, 1e-13);
  integrator.step(0.225);
  BOOST_CHECK_CLOSE(y, y2, 1e-13);
  integrator.step(0.225);
  BOOST_CHECK_CLOSE(y, y3, 1e-12);  // 0.225 - 0.2 is 0.025 to a few units of the last place of 0.2
  integrator.step(9.0);
  BOOST_CHECK_CLOSE(y, y4, 1e-12);
  integrator.step(9.0);
  BOOST_CHECK_CLOSE(y, y5, 1e-12);
  y = 0.25;
  integrator.state_changed();
  integrator.step(9.0);
  BOOST_CHECK_CLOSE(y, ralston(0.25, 0.1), 1e-13);
}

BOOST_AUTO_TEST_CASE(stages_stand_in_the_particle_arrays_and_little_is_copied) {
  for (const auto& options : all_methods()) {
    problem p;
    const double* const arrays[] = {p.u.data(), p.w.data()};
    std::vector<double> stage_times;
    explicit_integrator integrator(
        MPI_COMM_SELF, p.fields(), p.size(), 0.0, options,
        [&](double t, std::span<double* const> rate) {
          stage_times.push_back(t);
          for (std::size_t k = 0; k < 2; ++k) BOOST_CHECK_NE(rate[k], arrays[k]);
          return p.rhs()(t, rate);
        },
        {}, radius_bound);
    run_to(integrator, 1, 100.0);
    const long long copies = integrator.copies(), rejections = integrator.statistics().rejections;
    run_to(integrator, 31, 100.0);
    // the state kept to go back to, which Euler's own sweep keeps; and going back
    const int kept = options.method == "euler" ? 0 : 30;
    BOOST_CHECK_EQUAL(integrator.copies() - copies, kept + integrator.statistics().rejections - rejections);
    BOOST_CHECK_EQUAL(static_cast<long long>(stage_times.size()), integrator.statistics().evaluations);
  }
}

BOOST_AUTO_TEST_CASE(fixed_steps_land_on_output_times) {
  problem p;
  explicit_integrator integrator(MPI_COMM_SELF, p.fields(), p.size(), 0.0, fixed("order_3", 0.1), p.rhs());
  run(integrator, 0.25);
  BOOST_CHECK_EQUAL(integrator.time(), 0.25);
  BOOST_CHECK_EQUAL(integrator.statistics().steps, 3);
  run(integrator, 10.25);  // 100 tenths add up to 10 with rounding
  BOOST_CHECK_EQUAL(integrator.time(), 10.25);
  BOOST_CHECK_EQUAL(integrator.statistics().steps, 103);
  BOOST_CHECK_EQUAL(integrator.statistics().limited_by.at("output"), 1);
  BOOST_CHECK_EQUAL(integrator.statistics().limited_by.at("fixed"), 102);
  BOOST_CHECK_THROW(integrator.step(10.25), error);
}

BOOST_AUTO_TEST_CASE(adaptive_error_and_work_follow_rtol) {
  for (int order : {2, 3, 4, 5}) {
    double errors[2], work[2];
    for (int k : {0, 1}) {
      problem p;
      explicit_integrator integrator(MPI_COMM_SELF, p.fields(), p.size(), 0.0, adaptive(order, k == 0 ? 1e-4 : 1e-7),
                                     p.rhs());
      run(integrator, 3.0);
      BOOST_CHECK_EQUAL(integrator.time(), 3.0);
      errors[k] = p.error(3.0);
      work[k] = static_cast<double>(integrator.statistics().evaluations);
    }
    BOOST_TEST_MESSAGE("order " << order << ": errors " << errors[0] << ", " << errors[1] << ", work " << work[0]
                                << ", " << work[1]);
    // Tens of steps, each of error up to rtol |u|, |u| < 4; at the larger rtol the steps are so few that
    // the climb from the small first one makes them better than asked.
    BOOST_CHECK_LT(errors[0], 20 * 1e-4);
    BOOST_CHECK_LT(errors[1], 20 * 1e-7);
    BOOST_CHECK_LT(errors[1], errors[0] / 20);
    // dt ~ rtol^(1/k), k the order of the embedding + 1 = `order`; wide, since the steps at 1e-4 are few
    const double expected = std::pow(1e3, 1.0 / order);
    BOOST_CHECK_GT(work[1] / work[0], 0.5 * expected);
    BOOST_CHECK_LT(work[1] / work[0], 2.0 * expected);
  }
}

BOOST_AUTO_TEST_CASE(a_sudden_bump_is_found_by_rejections) {
  // y' = -1000 (y - bump(t)), bump a step of width 1e-4 at t = 1 after a long quiet time
  double y = 0.0;
  const auto bump = [](double t) { return 0.5 * (1.0 + std::tanh((t - 1.0) / 1e-4)); };
  explicit_integrator integrator(MPI_COMM_SELF, {{"y", &y, 1e-6}}, 1, 0.0, adaptive(3, 1e-5, 1e-3),
                                 [&](double t, std::span<double* const> rate) {
                                   rate[0][0] = -1000.0 * (y - bump(t));
                                   return 0;
                                 });
  run(integrator, 0.99);
  const auto quiet = integrator.statistics();
  run(integrator, 1.05);
  BOOST_CHECK_GT(integrator.statistics().rejections, quiet.rejections);
  BOOST_CHECK_EQUAL(integrator.statistics().attempts,
                    integrator.statistics().steps + integrator.statistics().rejections);
  BOOST_CHECK_SMALL(y - 1.0, 1e-4);
}

BOOST_AUTO_TEST_CASE(the_stable_step_is_held_and_counted) {
  problem p;
  double largest = 0.0;
  explicit_integrator integrator(MPI_COMM_SELF, p.fields(), p.size(), 0.0, adaptive(3, 1e-3), p.rhs(), [](double t) {
    return t < 1.0 ? step_limit{0.01, "cfl"} : step_limit{0.004, "viscous"};
  });
  while (integrator.time() < 1.0) {
    integrator.step(1.0);
    largest = std::max(largest, integrator.statistics().last_dt);
  }
  BOOST_CHECK_EQUAL(largest, 0.01);
  run(integrator, 1.5);
  const auto& by = integrator.statistics().limited_by;
  BOOST_CHECK_GE(by.at("cfl"), 95);
  BOOST_CHECK_GE(by.at("viscous"), 120);
  BOOST_CHECK_EQUAL(std::accumulate(by.begin(), by.end(), 0LL, [](long long n, const auto& e) { return n + e.second; }),
                    integrator.statistics().steps);
}

BOOST_AUTO_TEST_CASE(an_output_time_costs_no_later_steps) {
  const auto steps_with = [](int outputs) {
    problem p;
    explicit_integrator integrator(MPI_COMM_SELF, p.fields(), p.size(), 0.0, adaptive(4, 1e-8), p.rhs());
    for (int k = 1; k <= outputs; ++k) run(integrator, 3.0 * k / outputs);
    return integrator.statistics().steps;
  };
  const auto without = steps_with(1), with = steps_with(7);
  BOOST_CHECK_LE(with, without + 3 * 7);  // a few shortened steps at each, no new climb
}

BOOST_AUTO_TEST_CASE(a_scaled_field_is_weighed_by_its_scale) {
  // Far from the origin a tolerance relative to the position would let the oscillation go wrong.
  const auto error_with = [](double scale, double offset) {
    double x = offset + 1.0, v = 0.0;
    explicit_integrator integrator(MPI_COMM_SELF, {{"x", &x, 1e-12, scale}, {"v", &v, 1e-12, 1.0}}, 1, 0.0,
                                   adaptive(3, 1e-6), [&](double, std::span<double* const> rate) {
                                     rate[0][0] = v;
                                     rate[1][0] = offset - x;
                                     return 0;
                                   });
    run(integrator, 6.0);
    return std::pair{std::fabs(x - offset - std::cos(6.0)), integrator.statistics().steps};
  };
  const auto near = error_with(1.0, 0.0), far = error_with(1.0, 1e4);
  BOOST_CHECK_LT(near.first, 1e-4);
  BOOST_CHECK_LT(far.first, 1e-4);
  BOOST_CHECK_LE(std::abs(far.second - near.second), 2);
}

BOOST_AUTO_TEST_CASE(steps_are_judged_beyond_what_all_have_in_common) {
  // An oscillation in a frame that moves: from the first step on the steps of one at rest.
  const auto in_frame = [](double U) {
    double x = 1.0, v = U;
    explicit_integrator integrator(MPI_COMM_SELF, {{"x", &x, 1e-12, 1.0, 0.0, U}, {"v", &v, 1e-6, 0.0, U, 0.0}}, 1, 0.0,
                                   adaptive(3, 1e-6), [&](double t, std::span<double* const> rate) {
                                     rate[0][0] = v;
                                     rate[1][0] = U * t - x;
                                     return 0;
                                   });
    run(integrator, 6.0);
    return std::pair{x - 6.0 * U, integrator.statistics().steps};
  };
  const auto at_rest = in_frame(0.0), moving = in_frame(64.0);
  BOOST_CHECK_EQUAL(moving.second, at_rest.second);
  BOOST_CHECK_SMALL(moving.first - at_rest.first, 1e-9);
  BOOST_CHECK_SMALL(at_rest.first - std::cos(6.0), 1e-4);
}

BOOST_AUTO_TEST_CASE(a_restart_gives_the_same_bits) {
  for (const auto& options : all_methods()) {
    problem p;
    explicit_integrator whole(MPI_COMM_SELF, p.fields(), p.size(), 0.0, options, p.rhs(), {}, radius_bound);
    run_to(whole, 5, 0.7);
    problem q = p;
    const explicit_memory memory = whole.save();
    run(whole, 0.7);
    run(whole, 1.9);

    explicit_integrator second(MPI_COMM_SELF, q.fields(), q.size(), 0.0, options, q.rhs(), {}, radius_bound);
    second.restore(memory);
    run(second, 0.7);
    run(second, 1.9);
    check_same_bits(q.u, p.u);
    check_same_bits(q.w, p.w);
    BOOST_CHECK_EQUAL(second.statistics().steps, whole.statistics().steps);
    BOOST_CHECK_EQUAL(bits(second.statistics().next_dt), bits(whole.statistics().next_dt));
    BOOST_CHECK(second.statistics().limited_by == whole.statistics().limited_by);
  }
}

BOOST_AUTO_TEST_CASE(permuted_moved_and_fewer_particles_go_on_with_the_same_bits) {
  for (const auto& options : all_methods()) {
    problem p(40);
    explicit_integrator whole(MPI_COMM_SELF, p.fields(), p.size(), 0.0, options, p.rhs(), {}, radius_bound);
    run_to(whole, 20, 5.0);
    run_to(whole, 40, 5.0);

    problem q(40), other;
    problem* current = &q;
    explicit_integrator moved(
        MPI_COMM_SELF, q.fields(), q.size(), 0.0, options,
        [&](double t, std::span<double* const> rate) { return current->rhs()(t, rate); }, {}, radius_bound);
    run_to(moved, 20, 5.0);
    other = q;
    for (auto* array : other.arrays()) std::reverse(array->begin(), array->end());
    current = &other;
    moved.resize(other.fields(), other.size());
    run_to(moved, 40, 5.0);
    std::reverse(other.u.begin(), other.u.end());
    std::reverse(other.w.begin(), other.w.end());
    check_same_bits(other.u, p.u);
    check_same_bits(other.w, p.w);
    BOOST_CHECK_EQUAL(bits(moved.time()), bits(whole.time()));
  }
  problem p(40);
  explicit_integrator integrator(MPI_COMM_SELF, p.fields(), p.size(), 0.0, adaptive(3, 1e-6), p.rhs());
  run_to(integrator, 20, 5.0);
  const double next = integrator.statistics().next_dt;
  for (auto* array : p.arrays()) array->resize(25);
  integrator.resize(p.fields(), p.size());
  BOOST_CHECK_EQUAL(integrator.statistics().next_dt, next);
  run(integrator, 2.0);
  BOOST_CHECK_LT(p.error(2.0), 1e-3);  // the largest u passes 60
}

BOOST_AUTO_TEST_CASE(values_changed_in_place_are_taken_up) {
  double y = 1.0;
  explicit_integrator integrator(MPI_COMM_SELF, {{"y", &y, 1e-9}}, 1, 0.0, fixed("euler", 0.5),
                                 [&](double, std::span<double* const> rate) {
                                   rate[0][0] = y;
                                   return 0;
                                 });
  integrator.step(10.0);
  BOOST_CHECK_EQUAL(y, 1.5);
  y = 4.0;
  integrator.state_changed();
  integrator.step(10.0);
  BOOST_CHECK_EQUAL(y, 6.0);
}

BOOST_AUTO_TEST_CASE(a_state_that_cannot_be_evaluated_shortens_the_step) {
  // y' = -y^2 is refused below 0, where too long a first step leads
  for (int order : {2, 3, 4, 5}) {
    double y = 1.0;
    auto options = adaptive(order, 1e-4, 50.0);
    const rhs_function refusing = [&](double, std::span<double* const> rate) {
      rate[0][0] = -y * y;
      return y < 0.0 ? 1 : 0;
    };
    explicit_integrator integrator(MPI_COMM_SELF, {{"y", &y, 1e-9}}, 1, 0.0, options, refusing);
    run(integrator, 100.0);
    BOOST_CHECK_GT(integrator.statistics().unevaluable, 0);
    BOOST_CHECK_CLOSE(y, 1.0 / 101.0, 0.5);
  }
  double y = 1.0;
  explicit_integrator euler(MPI_COMM_SELF, {{"y", &y, 1e-9}}, 1, 0.0, fixed("euler", 5.0),
                            [&](double, std::span<double* const> rate) {
                              rate[0][0] = -y * y;
                              return y < 0.0 ? 1 : 0;
                            });
  BOOST_CHECK_EXCEPTION(euler.step(100.0), error,
                        [](const error& e) { return std::string(e.what()).find("fixed step") != std::string::npos; });
  BOOST_CHECK_EQUAL(y, 1.0);
}

BOOST_AUTO_TEST_CASE(exceptions_pass_through_and_leave_the_old_state) {
  for (const auto& options : all_methods()) {
    problem p;
    int calls_left = 1000;
    explicit_integrator integrator(
        MPI_COMM_SELF, p.fields(), p.size(), 0.0, options,
        [&](double t, std::span<double* const> rate) {
          if (--calls_left == 0) tetsuame::foundation::fail_calculation("p <= 0 at particle 3");
          return p.rhs()(t, rate);
        },
        {}, radius_bound);
    run_to(integrator, 5, 5.0);
    const auto u = p.u;
    calls_left = 1;
    BOOST_CHECK_EXCEPTION(integrator.step(5.0), error,
                          [](const error& e) { return std::string(e.what()) == "p <= 0 at particle 3"; });
    check_same_bits(p.u, u);

    calls_left = 1000;  // and one can go on from there as if nothing had been
    run_to(integrator, 9, 5.0);
    problem q;
    explicit_integrator undisturbed(MPI_COMM_SELF, q.fields(), q.size(), 0.0, options, q.rhs(), {}, radius_bound);
    run_to(undisturbed, 9, 5.0);
    check_same_bits(p.u, q.u);
    check_same_bits(p.w, q.w);
  }
}

BOOST_AUTO_TEST_CASE(a_state_that_is_not_finite_fails_with_words) {
  double y = 1.0;
  const rhs_function nan_rate = [&](double t, std::span<double* const> rate) {
    rate[0][0] = t > 0.0 ? std::nan("") : 1.0;
    return 0;
  };
  explicit_integrator integrator(MPI_COMM_SELF, {{"y", &y, 1e-9}}, 1, 0.0, adaptive(3, 1e-4, 0.1), nan_rate);
  BOOST_CHECK_EXCEPTION(integrator.step(1.0), error, [](const error& e) {
    return e.status() == tetsuame::foundation::exit_status::calculation_failed &&
           std::string(e.what()).find("attempts") != std::string::npos;
  });
  BOOST_CHECK_EQUAL(y, 1.0);
}

BOOST_AUTO_TEST_CASE(bad_input_is_told_before_anything_runs) {
  problem p;
  const auto make = [&](const explicit_options& options, std::vector<field> fields) {
    explicit_integrator integrator(MPI_COMM_SELF, std::move(fields), p.size(), 0.0, options, p.rhs(), {}, radius_bound);
  };
  BOOST_CHECK_NO_THROW(make(fixed("euler", 0.1), p.fields()));
  BOOST_CHECK_THROW(make(fixed("heun", 0.1), p.fields()), error);
  BOOST_CHECK_THROW(make(fixed("euler", 0.0), p.fields()), error);
  BOOST_CHECK_THROW(make(adaptive(6, 1e-4), p.fields()), error);
  BOOST_CHECK_THROW(make(adaptive(3, 1e-4), {{"u", p.u.data()}}), error);
  BOOST_CHECK_NO_THROW(make(fixed("euler", 0.1), {{"u", p.u.data()}}));
  BOOST_CHECK_THROW(make(fixed("ab2", 0.1), {{"u", p.u.data()}}), error);
  BOOST_CHECK_THROW(make(kicked(0.1), {{"u", p.u.data()}}), error);
  BOOST_CHECK_THROW(make({.method = "kdk", .dt = 0.1, .error_control = false, .substeps = 0}, p.fields()), error);
  BOOST_CHECK_THROW(make({.method = "kdk"}, p.fields()), error);            // neither a step nor a limit
  BOOST_CHECK_THROW(make(fixed("rkl2", 0.1), {{"u", p.u.data()}}), error);  // its error estimate weighs
  BOOST_CHECK_THROW(make({.method = "rkl2", .error_control = false}, p.fields()), error);
}
