#include <integrators/explicit_integrator.hpp>
// arkode_butcher.h needs FILE declared
#include <cstdio>

#include <arkode/arkode_erkstep.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <foundation/error.hpp>
#include <foundation/threads.hpp>
#include <integrators/stabilised.hpp>
#include <integrators/state_vector.hpp>
#include <limits>
#include <utility>

namespace tetsuame::integrators {

namespace {

using foundation::fail_calculation;
using foundation::fail_input;

// Of the error control. The growth is that of dt from one step to the next.
constexpr double safety = 0.9, most_growth = 5.0;
constexpr int most_attempts = 20;  // at one step

using table_handle = std::unique_ptr<ARKodeButcherTableMem, freed_by<ARKodeButcherTable_Free>>;
using arkode_handle = std::unique_ptr<void, freed_by<[](void* memory) { ERKStepFree(&memory); }>>;

// A. Ralston, Math. Comp. 16, 431 (1962): of the two-stage methods of order 2 the one with the
// smallest bound on the error; forward Euler is embedded.
ARKodeButcherTable ralston_table() {
  double c[] = {0.0, 2.0 / 3.0}, a[] = {0.0, 0.0, 2.0 / 3.0, 0.0}, b[] = {0.25, 0.75}, d[] = {1.0, 0.0};
  return ARKodeButcherTable_Create(2, 2, 1, c, a, b, d);
}

// C.-W. Shu, S. Osher, J. Comput. Phys. 77, 439 (1988), (2.18)
ARKodeButcherTable ssp_rk3_table() {
  double c[] = {0.0, 1.0, 0.5}, a[] = {0, 0, 0, 1.0, 0, 0, 0.25, 0.25, 0}, b[] = {1.0 / 6, 1.0 / 6, 2.0 / 3};
  return ARKodeButcherTable_Create(3, 3, 0, c, a, b, nullptr);
}

// W. Kutta, Z. Math. Phys. 46, 435 (1901)
ARKodeButcherTable rk4_table() {
  double c[] = {0.0, 0.5, 0.5, 1.0}, b[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
  double a[] = {0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1.0, 0};
  return ARKodeButcherTable_Create(4, 4, 0, c, a, b, nullptr);
}

// What ARKODE steps by; none for the methods that are formed here.
table_handle table_of(const explicit_options& o) {
  const std::map<std::string, std::function<ARKodeButcherTable()>> methods{
      {"euler", nullptr},
      {"ab2", nullptr},
      {"kdk", nullptr},
      {"rkl2", nullptr},
      {"rkc2", nullptr},
      {"order_2", ralston_table},
      {"order_3", [] { return ARKodeButcherTable_LoadERK(ARKODE_BOGACKI_SHAMPINE_4_2_3); }},
      {"order_4", [] { return ARKodeButcherTable_LoadERK(ARKODE_ZONNEVELD_5_3_4); }},
      {"order_5", [] { return ARKodeButcherTable_LoadERK(ARKODE_DORMAND_PRINCE_7_4_5); }},
      {"ssp_rk3", ssp_rk3_table},
      {"rk4", rk4_table}};
  const auto found = methods.find(o.method == "adaptive" ? fmt::format("order_{}", o.order) : o.method);
  if (found == methods.end())
    fail_input(fmt::format("time integration method '{}' of order {} is unknown", o.method, o.order));
  return table_handle(found->second ? found->second() : nullptr);
}

std::vector<double*> arrays(const std::vector<field>& fields) {
  std::vector<double*> result;
  result.reserve(fields.size());
  for (const field& f : fields) result.push_back(f.data);
  return result;
}

}  // namespace

struct explicit_integrator::implementation {
  enum class outcome { accepted, rejected, unevaluable };
  struct plan {
    double dt;
    std::string limited_by;
    bool reaches_stop, cut_for_output;
  };

  MPI_Comm communicator;
  std::vector<field> fields;
  std::size_t n;
  explicit_options options;
  rhs_function rhs;
  limit_function limit;
  radius_function radius_bound;
  slow_function slow;
  double t;

  bool is_ab2 = options.method == "ab2", is_euler = options.method == "euler", is_kdk = options.method == "kdk",
       is_stabilised = options.method == "rkl2" || options.method == "rkc2";
  bool adaptive = options.method == "adaptive" || ((is_stabilised || is_kdk) && options.error_control);
  stabilised_method kind = options.method == "rkc2" ? stabilised_method::rkc2 : stabilised_method::rkl2;
  table_handle table = table_of(options);  // none: the steps are formed here

  double previous_error = 0.0;
  double previous_dt = 0.0;         // explicit_memory
  step_limit stable_step{0.0, {}};  // explicit_memory::stable
  explicit_statistics statistics{};

  sundials::Context context{};
  sundials_messages messages{};
  exception_carrier thrown{};
  vector_handle home{};         // over the particle arrays; ARKODE forms every stage in it
  vector_handle start_rate{};   // f(t, y) if rate_known
  vector_handle latest_rate{};  // what f gave last
  vector_handle saved{};        // formed here: the state at the start of the step
  vector_handle spare{};        // stage j-2, error
  vector_handle between{};      // of 'kdk' with substeps: the state at the start of one
  vector_handle kept{};         // and the kept rates at the start of the step, with slow rates in those of positions
  arkode_handle arkode{};
  bool rate_known = false;
  bool repeats = false;            // the next evaluation was counted before the state was saved
  bool starting = false;           // ARKODE's next call of f is that at the start of the step
  N_Vector first_stage = nullptr;  // ARKODE's own, for the rate at the start
  int stages_left = 0;             // to be evaluated in this step; -1: and the rate at its end is, too
  int rhs_status = 0;              // the last value of f that was not 0
  double step_error = 0.0;         // e of the last attempt
  double slow_weight = 1.0;        // of the slow forces in f

  // ---- setting up ------------------------------------------------------------------------------

  bool has_substeps() const { return is_kdk && options.substeps > 1; }
  std::size_t number(const field& f) const { return f.number.value_or(n); }
  std::vector<state_field> state() const {
    std::vector<state_field> all;
    for (const field& f : fields) all.push_back({f.data, number(f)});
    return all;
  }

  void check_fields() const {
    for (const field& f : fields) {
      if ((is_ab2 || (is_kdk && !f.velocity)) && number(f) > 0 && f.previous_rate == nullptr)
        fail_input(fmt::format("method '{}' needs an array for the earlier rate of {}", options.method, f.name));
      if (adaptive && !is_kdk && f.absolute_tolerance == 0.0 && f.scale == 0.0)
        fail_input(fmt::format(
            "{} needs an absolute tolerance or a scale: where it vanishes a relative one means nothing", f.name));
    }
  }

  void build() {
    arkode.reset();
    start_rate.reset();
    latest_rate.reset();
    for (auto* one : {&saved, &spare, &between, &kept}) one->reset();
    home = make_state_vector(context, communicator, state());
    // ARKODE asks for a norm a step even where the step is fixed and nobody uses it.
    if (!adaptive) home->ops->nvwrmsnorm = [](N_Vector, N_Vector) { return 0.0; };
    start_rate.reset(N_VClone(home.get()));
    latest_rate.reset(N_VClone(home.get()));
    rate_known = false;
    if (table) {
      set_up_arkode();
    } else {
      saved.reset(N_VClone(home.get()));
      spare.reset(is_stabilised || is_kdk ? N_VClone(home.get()) : nullptr);
      if (has_substeps())
        for (auto* one : {&between, &kept}) one->reset(N_VClone(home.get()));
    }
  }

  void set_up_arkode() {
    const ARKRhsFn call_rhs = [](double at, N_Vector y, N_Vector ydot, void* data) {
      return static_cast<implementation*>(data)->called_by_arkode(at, y, ydot);
    };
    const ARKEwtFn call_weights = [](N_Vector y, N_Vector w, void* data) {
      const auto* self = static_cast<const implementation*>(data);
      if (self->adaptive) self->weights(y, w);
      return 0;
    };
    // ARKODE's only word on the error estimate; the step that follows is chosen here, not there.
    const ARKAdaptFn note_error = [](N_Vector, double, double h, double, double, double e, double, double, int, int,
                                     double* h_new, void* data) {
      static_cast<implementation*>(data)->step_error = e;
      *h_new = h;
      return 0;
    };
    arkode.reset(ERKStepCreate(call_rhs, t, home.get(), context));
    void* m = arkode.get();
    if (m == nullptr || !TETSUAME_KEEP_MESSAGES(ERKStepSetErrHandlerFn, m, context, messages) ||
        ERKStepSetUserData(m, this) != ARK_SUCCESS ||
        // Nothing is asked for between steps: a history of one state, which shares the step's own memory.
        ERKStepSetInterpolantType(m, ARK_INTERP_LAGRANGE) != ARK_SUCCESS ||
        ERKStepSetInterpolantDegree(m, 0) != ARK_SUCCESS || ERKStepSetTable(m, table.get()) != ARK_SUCCESS ||
        ERKStepWFtolerances(m, call_weights) != ARK_SUCCESS ||
        ERKStepSetAdaptivityFn(m, note_error, this) != ARK_SUCCESS || ERKStepSetErrorBias(m, 1.0) != ARK_SUCCESS ||
        ERKStepSetMaxErrTestFails(m, 1) != ARK_SUCCESS)
      fail_calculation("ARKODE could not be set up: " + messages.last);
  }

  // ---- rates and states ------------------------------------------------------------------------

  int evaluate(double at, N_Vector rate) {
    ++statistics.evaluations;
    const int status = thrown.guard(communicator, [&] { return rhs(at, values_to_overwrite(rate)); });
    if (status != 0) rhs_status = status;
    return status;
  }

  int called_by_arkode(double at, N_Vector state, N_Vector rate) {
    if (std::exchange(starting, false)) {
      N_VScale(1.0, start_rate.get(), rate);
      first_stage = rate;
      stages_left = table->stages - 1;
      return 0;
    }
    // After the last stage ARKODE asks for the rate of the new state. A fixed step is not tried again, so
    // that by then nobody needs the rate at its start: the new one may stand in its place.
    if (stages_left-- == 0 && !adaptive) {
      for (N_Vector done : {first_stage, start_rate.get(), latest_rate.get()}) forget_values(done);
      rate_known = false;
    }
    if (!holds_values_of(home.get(), state)) N_VScale(1.0, state, home.get());
    const int status = evaluate(at, rate);
    if (status == 0) N_VScale(1.0, rate, latest_rate.get());
    return status;
  }

  // Whether the latest rate is that of the state at the end of the step. ARKODE before 7 asks for that unless the
  // table's last abscissa is 1, from 7 on it does not: then it is the last stage's, which is the same for a table whose
  // last row holds its weights (first same as last).
  bool latest_is_of_the_end() const {
    return !table || stages_left < 0 || std::equal(table->b, table->b + table->stages, table->A[table->stages - 1]);
  }

  // f(k, i) for value i of field k
  template <class F>
  void for_all_values(const F& f) const {
    std::size_t most = 0;
    for (const field& of : fields) most = std::max(most, number(of));
    constexpr std::size_t block = 2048, worth_threads = 4096;
    foundation::for_chunks(most, block, most > worth_threads, [&](std::size_t first, std::size_t last) {
      for (std::size_t k = 0; k < fields.size(); ++k) {
        const std::size_t end = std::min(last, number(fields[k]));
#pragma omp simd
        for (std::size_t i = first; i < end; ++i) f(k, i);
      }
    });
  }

  // Array k of the particles at i = value(k, i), which may read what it replaces.
  template <class Value>
  void set_arrays(const Value& value) {
    for_all_values([&](std::size_t k, std::size_t i) { fields[k].data[i] = value(k, i); });
    home_was_changed(home.get());
  }

  double magnitude(std::size_t k, double y) const { return fields[k].scale > 0.0 ? fields[k].scale : y; }

  void weights(N_Vector state, N_Vector weight) const {
    const auto y = values(state);
    const auto w = values_to_overwrite(weight);
    for_all_values([&](std::size_t k, std::size_t i) {
      w[k][i] =
          1.0 / (options.rtol * magnitude(k, std::fabs(y[k][i] - fields[k].common)) + fields[k].absolute_tolerance);
    });
  }

  void raise_rhs_failure() {
    thrown.rethrow();
    if (rhs_status < 0)
      fail_calculation(
          fmt::format("the rates of change could not be evaluated in the step from t = {:.17g} s (on this or "
                      "another rank, which says why)",
                      t));
  }

  [[noreturn]] void raise_unevaluable(double dt) const {
    fail_calculation(
        fmt::format("the rates of change could not be evaluated in the fixed step of {} s from t = {:.17g} s", dt, t));
  }

  void know_rate() {
    if (rate_known) return;
    // Of 'kdk' a step needs the kept rates alone, which went with the particles into new lists.
    if (is_kdk && previous_dt != 0.0) {
      repeats = false;
      return;
    }
    rhs_status = 0;
    if (std::exchange(repeats, false)) --statistics.evaluations;
    if (is_kdk) slow_weight = options.substeps;
    if (evaluate(t, start_rate.get()) != 0) {
      raise_rhs_failure();
      fail_calculation(
          fmt::format("the rates of change could not be evaluated at t = {:.17g} s, the start of a step", t));
    }
    rate_known = true;
    if (!is_kdk || previous_dt != 0.0) return;
    keep_rates(start_rate.get());
    choose_next_kdk(t);
  }

  // Of 'kdk': the kicks of the next step, and its length.
  void keep_rates(N_Vector rate) {
    const auto f = values(rate);
    for_all_values([&](std::size_t k, std::size_t i) {
      if (!fields[k].velocity) fields[k].previous_rate[i] = f[k][i];
    });
  }
  void choose_next_kdk(double at) {
    if (adaptive) stable_step = limit(at);
    statistics.next_dt = adaptive ? stable_step.dt : options.dt;
  }

  void know_radius() {
    statistics.radius = radius_bound(t);
    if (!(statistics.radius >= 0.0) || !std::isfinite(statistics.radius))
      fail_calculation(fmt::format("the spectral radius at t = {:.17g} s is {} 1/s, not a finite number >= 0", t,
                                   statistics.radius));
  }

  // ---- the length of a step --------------------------------------------------------------------

  // A change of one percent of the state, or of one tolerance, whichever allows more.
  // [E. Hairer, S. P. Nørsett, G. Wanner, Solving ODEs I, II.4, first guess]
  double first_dt(double t_stop) {
    if (options.dt > 0.0) return options.dt;
    const vector_handle weight(N_VClone(home.get())), size(N_VClone(home.get()));
    weights(home.get(), weight.get());
    const auto y = values(home.get());
    const auto of_state = values_to_overwrite(size.get());
    for_all_values([&](std::size_t k, std::size_t i) { of_state[k][i] = magnitude(k, y[k][i] - fields[k].common); });
    const double state = N_VWrmsNorm(size.get(), weight.get());
    const auto f = values(start_rate.get());
    for_all_values([&](std::size_t k, std::size_t i) { of_state[k][i] = f[k][i] - fields[k].common_rate; });
    const double rate = N_VWrmsNorm(size.get(), weight.get());
    return rate > 0.0 ? std::max(1.0, 0.01 * state) / rate : t_stop - t;
  }

  plan choose_fixed(double t_stop, const std::string& stop_is) const {
    const double rest = t_stop - t, dt = options.dt;
    // Rounding accumulated over many steps must not leave a sliver before an output time.
    if (std::fabs(rest - dt) <= 1e-6 * dt) return {dt, options.dt_is, true, false};
    if (rest < dt) return {rest, stop_is, true, true};
    return {dt, options.dt_is, false, false};
  }

  void cut_for_stop(double t_stop, const std::string& stop_is, plan& p) const {
    const double rest = t_stop - t;
    if (p.dt >= rest) {
      p.cut_for_output = p.dt > rest;
      p.reaches_stop = true;
      p.dt = rest;
      // so that the last stage's time is t_stop in every bit
      for (int k = 0; k < 4 && t + p.dt != t_stop; ++k) p.dt = std::nextafter(p.dt, t + p.dt < t_stop ? 2 * rest : 0.0);
    } else if (p.dt > 0.5 * rest) {  // two equal steps rather than one and a sliver
      p.cut_for_output = true;
      p.dt = 0.5 * rest;
    }
    if (p.cut_for_output) p.limited_by = stop_is;
  }

  // Of the most stages; a little below the limit, so that rounding of dt * radius does not ask for a stage more.
  double largest_stabilised_dt() const {
    const double largest = stability_limit(kind, largest_stages(kind, options.max_stages)) * (1.0 - 1e-12);
    return statistics.radius > 0.0 ? largest / statistics.radius : std::numeric_limits<double>::infinity();
  }

  plan choose(double t_stop, const std::string& stop_is) {
    if (!adaptive) {
      if (is_stabilised) know_radius();
      return choose_fixed(t_stop, stop_is);
    }
    if (statistics.next_dt == 0.0 && !is_kdk) statistics.next_dt = first_dt(t_stop);
    plan p{statistics.next_dt, "accuracy", false, false};
    if (limit) {
      const step_limit stable = is_kdk ? stable_step : limit(t);
      if (!(stable.dt > 0.0))
        fail_calculation(
            fmt::format("the stable step by '{}' at t = {:.17g} s is {}, not > 0", stable.name, t, stable.dt));
      if (stable.dt <= p.dt) p = {stable.dt, stable.name, false, false};
    }
    if (is_stabilised) {
      know_radius();
      if (const double dt = largest_stabilised_dt(); dt < p.dt) p = {dt, "stages", false, false};
    }
    cut_for_stop(t_stop, stop_is, p);
    return p;
  }

  // The estimates of 'rkl2' and 'rkc2' are of third order in dt.
  double embedding_exponent() const { return is_stabilised ? 1.0 / 3.0 : 1.0 / (table->p + 1); }

  double accepted_factor(bool after_failure) const {
    const double smallest = 1e-10;  // an error of 0 must not divide
    const double e = std::max(step_error, smallest), k = embedding_exponent();
    const double raw = previous_error > 0.0
                           ? safety * std::pow(e, -0.7 * k) * std::pow(std::max(previous_error, smallest), 0.4 * k)
                           : safety * std::pow(e, -k);
    return std::clamp(raw, 0.2, after_failure ? 1.0 : most_growth);
  }

  double failed_factor(outcome why) const {
    if (why == outcome::unevaluable || !std::isfinite(step_error)) return 0.25;
    return std::clamp(safety * std::pow(step_error, -embedding_exponent()), 0.1, 0.9);
  }

  // ---- attempts at a step ----------------------------------------------------------------------

  outcome attempt(double dt) {
    if (!(t + dt > t))
      fail_calculation(fmt::format("the step of {} s at t = {:.17g} s no longer advances the time", dt, t));
    ++statistics.attempts;
    rhs_status = 0;
    step_error = 0.0;
    return table ? attempt_with_arkode(dt) : attempt_here(dt);
  }

  outcome attempt_with_arkode(double dt) {
    starting = true;
    messages.last.clear();
    void* m = arkode.get();
    double reached = t;
    int flag = adaptive ? ERKStepSetInitStep(m, dt) : ERKStepSetFixedStep(m, dt);
    if (flag == ARK_SUCCESS) flag = ERKStepReset(m, t, home.get());
    if (flag == ARK_SUCCESS) flag = ERKStepEvolve(m, t + dt, home.get(), &reached, ARK_ONE_STEP);
    if (flag == ARK_SUCCESS) return outcome::accepted;

    raise_rhs_failure();
    if (rhs_status > 0 && adaptive) return outcome::unevaluable;
    if (rhs_status > 0) raise_unevaluable(dt);
    if (flag == ARK_ERR_FAILURE && !(step_error <= 1.0)) return outcome::rejected;
    if (flag == ARK_TOO_MUCH_ACC)
      fail_calculation(
          fmt::format("rtol = {} asks for more digits than a double has at t = {:.17g} s: raise it", options.rtol, t));
    fail_calculation(fmt::format("ARKODE failed at t = {:.17g} s (code {}): {}", t, flag, messages.last));
  }

  void return_to_saved() {
    N_VScale(1.0, saved.get(), home.get());
    if (!has_substeps()) return;
    keep_rates(kept.get());
    const auto all = values(kept.get());
    for_all_values([&](std::size_t k, std::size_t i) {
      if (double* const slow_rate = slow_rate_of(k)) slow_rate[i] = all[k][i];
    });
  }
  // Of the velocity of a position.
  double* slow_rate_of(std::size_t k) const {
    return fields[k].velocity ? fields[*fields[k].velocity].slow_rate : nullptr;
  }

  outcome attempt_here(double dt) {
    if (is_euler)
      values_to_overwrite(saved.get());  // by the step
    else
      N_VScale(1.0, home.get(), saved.get());
    int status = 0;
    try {
      status = is_euler ? euler_step(dt) : is_ab2 ? ab2_step(dt) : is_kdk ? kdk_step(dt) : stabilised_stages(dt);
    } catch (...) {
      return_to_saved();
      throw;
    }
    if (status == 0 && (!adaptive || step_error <= 1.0)) {
      if (is_ab2) {
        const auto f0 = values(start_rate.get());
        for_all_values([&](std::size_t k, std::size_t i) { fields[k].previous_rate[i] = f0[k][i]; });
        previous_dt = dt;
      }
      if (is_kdk) previous_dt = dt;
      forget_values(saved.get());
      return outcome::accepted;
    }
    return_to_saved();
    if (status == 0) return outcome::rejected;
    raise_rhs_failure();
    if (!adaptive) raise_unevaluable(dt);
    return outcome::unevaluable;
  }

  // Each step that is formed here, and the rate at its end; gives the value of f that was not 0, or 0.

  // In one sweep: the state is kept and moves on. A fixed step is not tried again, so the rate at its end
  // may stand in the place of that at its start.
  int euler_step(double dt) {
    const auto f = values(start_rate.get());
    const auto before = values_to_overwrite(saved.get());
    set_arrays([&](std::size_t k, std::size_t i) {
      before[k][i] = fields[k].data[i];
      return before[k][i] + dt * f[k][i];
    });
    for (N_Vector done : {start_rate.get(), latest_rate.get()}) forget_values(done);
    rate_known = false;
    return evaluate(t + dt, latest_rate.get());
  }

  int ab2_step(double dt) {
    const auto y0 = values(saved.get()), f0 = values(start_rate.get());
    const double ratio = previous_dt > 0.0 ? dt / previous_dt : 0.0;
    if (ratio > 0.0 && ratio <= 1.5) {
      const double now = dt * (1.0 + 0.5 * ratio), before = dt * 0.5 * ratio;
      set_arrays([&](std::size_t k, std::size_t i) {
        return y0[k][i] + (now * f0[k][i] - before * fields[k].previous_rate[i]);
      });
    } else {
      set_arrays([&](std::size_t k, std::size_t i) { return y0[k][i] + dt * (2.0 / 3.0) * f0[k][i]; });
      if (const int status = evaluate(t + dt * (2.0 / 3.0), latest_rate.get()); status != 0) return status;
      const auto f1 = values(latest_rate.get());
      set_arrays([&](std::size_t k, std::size_t i) { return y0[k][i] + dt * (0.25 * f0[k][i] + 0.75 * f1[k][i]); });
    }
    return evaluate(t + dt, latest_rate.get());
  }

  // Kick, drift, kick, with one evaluation: velocities by half a step of the kept rate, positions by a step of these,
  // and the other half by the rate there. That is taken of velocities, energies and what else changes as they would be
  // after a step of the kept rates, and kept for the next step [V. Springel, MNRAS 364, 1105 (2005), section 3].
  // With substeps the impulses of slow forces are at the ends of the whole step [M. Tuckerman, B. J. Berne,
  // G. J. Martyna, J. Chem. Phys. 97, 1990 (1992)]. Where f is evaluated velocities have half of the impulse there.
  int kdk_step(double dt) {
    if (has_substeps()) {
      const auto all = values_to_overwrite(kept.get());
      for_all_values([&](std::size_t k, std::size_t i) {
        if (!fields[k].velocity)
          all[k][i] = fields[k].previous_rate[i];
        else if (const double* const slow_rate = slow_rate_of(k))
          all[k][i] = slow_rate[i];
      });
    }
    const int last = options.substeps;
    for (int part = 1; part <= last; ++part) {
      if (part > 1) N_VScale(1.0, home.get(), between.get());
      const substep now{part == 1 ? saved.get() : between.get(), dt / last,
                        part == last ? t + dt : t + part * (dt / last), part == 1 ? 0.5 * dt : 0.0,
                        part == last ? 0.5 * dt : 0.0};
      slow_weight = part == last ? last : 0.0;
      if (const int status = kdk_substep(now); status != 0) return status;
    }
    return 0;
  }
  struct substep {
    N_Vector from;
    double dt, end;           // s
    double opening, closing;  // s: of slow forces, half an impulse over its rate; 0: none
  };
  int kdk_substep(const substep& now) {
    const auto y0 = values(now.from);
    const double dt = now.dt;
    set_arrays([&](std::size_t k, std::size_t i) {
      const auto& v = fields[k].velocity;
      return v ? y0[k][i] + dt * (y0[*v][i] + 0.5 * dt * fields[*v].previous_rate[i])
               : y0[k][i] + dt * fields[k].previous_rate[i];
    });
    if (slow && has_substeps()) {
      // The kept rates have the whole impulse in them.
      if (now.opening > 0.0) add_slow(-now.opening);
      if (now.closing > 0.0) {
        slow();
        add_slow(now.closing);
      }
    }
    if (const int status = evaluate(now.end, latest_rate.get()); status != 0) return status;
    const auto f = values(latest_rate.get());
    const auto before = values_to_overwrite(spare.get());
    for_all_values([&](std::size_t k, std::size_t i) {
      if (!fields[k].velocity) before[k][i] = fields[k].previous_rate[i];
    });
    keep_rates(latest_rate.get());
    // The limit of the next step is asked for at the state of the evaluation, which is corrected then.
    if (now.closing > 0.0) choose_next_kdk(now.end);
    set_arrays([&](std::size_t k, std::size_t i) {
      return fields[k].velocity ? fields[k].data[i] : y0[k][i] + 0.5 * dt * (before[k][i] + f[k][i]);
    });
    return 0;
  }
  void add_slow(double seconds) {
    for_all_values([&](std::size_t k, std::size_t i) {
      if (fields[k].slow_rate != nullptr) fields[k].data[i] += seconds * fields[k].slow_rate[i];
    });
    home_was_changed(home.get());
  }

  int stabilised_stages(double dt) {
    const int stages = stages_for(kind, dt * statistics.radius, options.max_stages);
    if (stages > options.max_stages)
      fail_calculation(
          fmt::format("a step of {} s at t = {:.17g} s, spectral radius {} 1/s, takes more than the {} stages of "
                      "max_stages: raise it or take a smaller dt",
                      dt, t, statistics.radius, options.max_stages));
    statistics.stages = stages;
    const recurrence r = make_recurrence(kind, stages);
    for (std::size_t j = 1; j < r.c.size(); ++j) {
      form_stage(r, j, dt);
      const double c = j + 1 < r.c.size() ? r.c[j] : 1.0;
      if (const int status = evaluate(t + c * dt, latest_rate.get()); status != 0) return status;
    }
    if (adaptive) estimate_error(r.error_factor, dt);
    return 0;
  }

  // Y_j into the particle arrays, from Y_(j-1) there, Y_(j-2) in `spare` (j = 2: Y_0), which takes Y_(j-1).
  void form_stage(const recurrence& r, std::size_t j, double dt) {
    const auto y0 = values(saved.get()), f0 = values(start_rate.get());
    if (j == 1) {
      const double a = r.mu_tilde[1] * dt;
      set_arrays([&](std::size_t k, std::size_t i) { return y0[k][i] + a * f0[k][i]; });
      return;
    }
    const auto f = values(latest_rate.get());
    const auto before = values_to_overwrite(spare.get());
    const double mu = r.mu[j], nu = r.nu[j], rest = 1.0 - mu - nu, a = r.mu_tilde[j] * dt, a0 = r.gamma_tilde[j] * dt;
    set_arrays([&](std::size_t k, std::size_t i) {
      const double y1 = fields[k].data[i], y2 = j == 2 ? y0[k][i] : before[k][i];
      before[k][i] = y1;
      return rest * y0[k][i] + mu * y1 + nu * y2 + (a * f[k][i] + a0 * f0[k][i]);
    });
  }

  // step_error = | K [y_n - y_(n+1) + dt/2 (F_n + F_(n+1))] |_w, the weights those of y_n
  void estimate_error(double factor, double dt) {
    const auto y0 = values(saved.get()), f0 = values(start_rate.get()), f1 = values(latest_rate.get());
    const auto weighted = values_to_overwrite(spare.get());
    weights(saved.get(), spare.get());
    for_all_values([&](std::size_t k, std::size_t i) {
      weighted[k][i] *= factor * (y0[k][i] - fields[k].data[i] + 0.5 * dt * (f0[k][i] + f1[k][i]));
    });
    const auto length = static_cast<double>(N_VGetLength(home.get()));
    step_error = length == 0.0 ? 0.0 : std::sqrt(N_VDotProd(spare.get(), spare.get()) / length);
  }

  // ---- one accepted step -----------------------------------------------------------------------

  double step(double t_stop, const std::string& stop_is) {
    if (!(t_stop > t)) fail_input(fmt::format("the stop time {} s must lie after t = {} s", t_stop, t));
    know_rate();
    plan p = choose(t_stop, stop_is);

    int failures = 0;
    for (;; ++failures) {
      if (failures == most_attempts)
        fail_calculation(
            fmt::format("no step from t = {:.17g} s passed in {} attempts, the last one of {} s with error {} "
                        "of the tolerance: the state there may be unphysical",
                        t, failures, p.dt, step_error));
      const outcome reached = attempt(p.dt);
      if (reached == outcome::accepted) break;
      ++(reached == outcome::rejected ? statistics.rejections : statistics.unevaluable);
      p = {p.dt * failed_factor(reached), "accuracy", false, false};
    }

    const double t_stages = t + p.dt;  // where f was evaluated last
    t = p.reaches_stop ? t_stop : t_stages;
    N_VScale(1.0, latest_rate.get(), start_rate.get());
    rate_known = t == t_stages && latest_is_of_the_end();

    ++statistics.steps;
    ++statistics.limited_by[p.limited_by];
    statistics.last_dt = p.dt;
    statistics.last_error = step_error;
    if (!adaptive) {
      statistics.next_dt = options.dt;
      return t;
    }
    if (is_kdk) {
      if (failures > 0) statistics.next_dt = std::min(stable_step.dt, p.dt);
      return t;
    }
    const double next = p.dt * accepted_factor(failures > 0);
    // A step cut short for an output time says little about the next one.
    statistics.next_dt = p.cut_for_output ? std::max(next, statistics.next_dt) : next;
    if (!p.cut_for_output) previous_error = step_error;
    return t;
  }
};

explicit_integrator::explicit_integrator(MPI_Comm communicator, std::vector<field> fields, std::size_t n, double t,
                                         explicit_options options, rhs_function rhs, limit_function limit,
                                         radius_function radius, slow_function slow)
    : self_(new implementation{.communicator = communicator,
                               .fields = std::move(fields),
                               .n = n,
                               .options = std::move(options),
                               .rhs = std::move(rhs),
                               .limit = std::move(limit),
                               .radius_bound = std::move(radius),
                               .slow = std::move(slow),
                               .t = t}) {
  const auto& o = self_->options;
  if (!self_->adaptive && !(o.dt > 0.0 && std::isfinite(o.dt)))
    fail_input(fmt::format("method '{}' needs a step dt > 0, not {}", o.method, o.dt));
  if (self_->is_kdk && self_->adaptive && !self_->limit) fail_input("method 'kdk' needs a step dt or a limit of steps");
  if (o.substeps < 1) fail_input(fmt::format("substeps must be 1 or more, not {}", o.substeps));
  self_->check_fields();
  self_->build();
}

explicit_integrator::~explicit_integrator() = default;

double explicit_integrator::step(double t_stop, const std::string& stop_is) { return self_->step(t_stop, stop_is); }

double explicit_integrator::time() const { return self_->t; }

void explicit_integrator::resize(std::vector<field> fields, std::size_t n) {
  implementation& s = *self_;
  const bool changed = n != s.n || fields.size() != s.fields.size();
  s.fields = std::move(fields);
  s.n = n;
  s.check_fields();
  if (s.thrown.guard(s.communicator, [&] { return changed ? 1 : 0; }) != 0)
    s.build();
  else
    set_home_arrays(s.home.get(), arrays(s.fields));
  s.rate_known = s.repeats = false;
}

bool explicit_integrator::repeats() const { return self_->repeats; }

void explicit_integrator::choose_steps_anew() {
  self_->statistics.next_dt = self_->previous_error = 0.0;
  if (self_->is_kdk) self_->previous_dt = 0.0;
}

void explicit_integrator::prepare() { self_->know_rate(); }

void explicit_integrator::lend(const std::function<void(std::span<double* const>)>& use) {
  const vector_handle spare(N_VClone(self_->home.get()));
  use(values_to_overwrite(spare.get()));
}

void explicit_integrator::state_changed() {
  home_was_changed(self_->home.get());
  self_->rate_known = self_->repeats = false;
  self_->previous_dt = 0.0;
}

double explicit_integrator::weight_of_slow_forces() const { return self_->slow_weight; }

const explicit_statistics& explicit_integrator::statistics() const { return self_->statistics; }
long long explicit_integrator::copies() const { return copies_made(self_->home.get()); }

explicit_memory explicit_integrator::save() const {
  return {self_->t,           self_->statistics.next_dt,           self_->previous_error,
          self_->previous_dt, self_->rate_known || self_->repeats, self_->stable_step,
          self_->statistics};
}

void explicit_integrator::restore(const explicit_memory& memory) {
  self_->t = memory.t;
  self_->previous_error = memory.previous_error;
  self_->statistics = memory.statistics;
  self_->statistics.next_dt = memory.next_dt;
  state_changed();
  self_->previous_dt = memory.previous_dt;
  self_->stable_step = memory.stable;
  self_->repeats = memory.rate_known;
}

}  // namespace tetsuame::integrators
