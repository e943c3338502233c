#include <integrators/explicit_integrator.hpp>
// arkode_butcher.h needs FILE declared
#include <cstdio>

#include <arkode/arkode_butcher_erk.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <foundation/error.hpp>
#include <integrators/reduce.hpp>
#include <integrators/stabilised.hpp>
#include <limits>
#include <new>
#include <optional>
#include <utility>

namespace tetsuame::integrators {

namespace {

using foundation::fail_calculation;
using foundation::fail_input;

// Of the error control. The growth is that of dt from one step to the next.
constexpr double safety = 0.9, most_growth = 5.0;
constexpr int most_attempts = 20;          // at one step
constexpr std::size_t block_length = 512;  // values: what is summed in one local buffer

struct release_table {
  void operator()(ARKodeButcherTable table) const { ARKodeButcherTable_Free(table); }
};
using table_handle = std::unique_ptr<ARKodeButcherTableMem, release_table>;

table_handle euler_table() {
  double c[] = {0.0}, a[] = {0.0}, b[] = {1.0};
  return table_handle(ARKodeButcherTable_Create(1, 1, 0, c, a, b, nullptr));
}

// A. Ralston, Math. Comp. 16, 431 (1962): of the two-stage methods of order 2 the one with the
// smallest bound on the error; forward Euler is embedded.
table_handle ralston_table() {
  double c[] = {0.0, 2.0 / 3.0}, a[] = {0.0, 0.0, 2.0 / 3.0, 0.0}, b[] = {0.25, 0.75}, d[] = {1.0, 0.0};
  return table_handle(ARKodeButcherTable_Create(2, 2, 1, c, a, b, d));
}

// C.-W. Shu, S. Osher, J. Comput. Phys. 77, 439 (1988), (2.18)
table_handle ssp_rk3_table() {
  double c[] = {0.0, 1.0, 0.5}, a[] = {0, 0, 0, 1.0, 0, 0, 0.25, 0.25, 0}, b[] = {1.0 / 6, 1.0 / 6, 2.0 / 3};
  return table_handle(ARKodeButcherTable_Create(3, 3, 0, c, a, b, nullptr));
}

// W. Kutta, Z. Math. Phys. 46, 435 (1901)
table_handle rk4_table() {
  double c[] = {0.0, 0.5, 0.5, 1.0}, b[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
  double a[] = {0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1.0, 0};
  return table_handle(ARKodeButcherTable_Create(4, 4, 0, c, a, b, nullptr));
}

bool stabilised(const std::string& method) { return method == "rkl2" || method == "rkc2"; }

table_handle load(ARKODE_ERKTableID id) { return table_handle(ARKodeButcherTable_LoadERK(id)); }

// None: the method is of another kind.
table_handle table_of(const explicit_options& o) {
  const auto none = [] { return table_handle(); };
  const std::map<std::string, table_handle (*)()> known = {
      {"euler", euler_table},
      {"order_2", ralston_table},
      {"order_3", [] { return load(ARKODE_BOGACKI_SHAMPINE_4_2_3); }},
      {"order_4", [] { return load(ARKODE_ZONNEVELD_5_3_4); }},
      {"order_5", [] { return load(ARKODE_DORMAND_PRINCE_7_4_5); }},
      {"ssp_rk3", ssp_rk3_table},
      {"rk4", rk4_table},
      {"ab2", none},
      {"rkl2", none},
      {"rkc2", none}};
  const bool adaptive = o.method == "adaptive";
  if (adaptive && (o.order < 2 || o.order > 5))
    fail_input(fmt::format("order {} of the adaptive method is not available: give 2, 3, 4 or 5", o.order));
  const auto found = known.find(adaptive ? fmt::format("order_{}", o.order) : o.method);
  if (found == known.end())
    fail_input(
        fmt::format("time integration method '{}' is unknown: give 'euler', 'order_2', 'order_3', 'order_4', "
                    "'order_5', 'ssp_rk3', 'rk4', 'ab2', 'rkl2', 'rkc2' or 'adaptive'",
                    o.method));
  return found->second();
}

void check(const explicit_options& o, bool adaptive) {
  if (stabilised(o.method) && o.max_stages < 3)
    fail_input(fmt::format("max_stages must be >= 3, not {}", o.max_stages));
  if ((adaptive || stabilised(o.method)) && !(o.rtol > 0.0 && o.rtol < 1.0))
    fail_input(fmt::format("rtol must lie between 0 and 1, not {}", o.rtol));
  if (!adaptive && (!(o.dt > 0.0) || !std::isfinite(o.dt)))
    fail_input(fmt::format("method '{}' needs a step dt > 0, not {}", o.method, o.dt));
  if (!(o.dt >= 0.0) || !std::isfinite(o.dt)) fail_input(fmt::format("the first step dt must be >= 0, not {}", o.dt));
}

// weighed: by the error control
void check(const std::vector<field>& fields, bool weighed, bool keeps_rate, std::size_t n) {
  for (const field& f : fields) {
    if (keeps_rate && n > 0 && f.previous_rate == nullptr)
      fail_input(fmt::format("method 'ab2' needs an array for the earlier rate of {}", f.name));
    if (!(f.absolute_tolerance >= 0.0) || !(f.scale >= 0.0))
      fail_input(fmt::format("tolerance and scale of {} must be >= 0", f.name));
    if (weighed && f.absolute_tolerance == 0.0 && f.scale == 0.0)
      fail_input(fmt::format(
          "{} needs an absolute tolerance or a scale: where it vanishes a relative one means nothing", f.name));
  }
}

// One array a field, each from the beginning of a cache line on; its values are what was there.
class arrays {
 public:
  arrays(std::size_t fields, std::size_t n) : of_(fields) {
    const std::size_t stride = (n + 7) / 8 * 8;
    memory_.reset(new (line) double[fields * stride]);
    for (std::size_t k = 0; k < fields; ++k) of_[k] = memory_.get() + k * stride;
  }
  double* operator[](std::size_t k) const { return of_[k]; }
  std::span<double* const> all() const { return of_; }

 private:
  static constexpr std::align_val_t line{64};
  struct release {
    void operator()(double* p) const { ::operator delete[](p, line); }
  };
  std::unique_ptr<double[], release> memory_;
  std::vector<double*> of_;
};

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

  bool is_stabilised = stabilised(options.method), is_ab2 = options.method == "ab2";
  bool adaptive = options.method == "adaptive" || (is_stabilised && options.error_control);
  stabilised_method kind = options.method == "rkc2" ? stabilised_method::rkc2 : stabilised_method::rkl2;
  table_handle table = table_of(options);
  // The last stage is the new state.
  bool same_as_last = table && table->stages > 1 &&
                      std::equal(table->b, table->b + table->stages, table->A[table->stages - 1]);
  // Of 'rk4' only the next step needs the rate at the end of this one, if it comes to that.
  bool knows_end = options.method != "rk4";

  double t;
  double previous_error = 0.0;
  double previous_dt = 0.0;  // explicit_memory
  explicit_statistics statistics{};

  std::exception_ptr thrown{};
  std::vector<arrays> rates{};     // [0]: f(t, y) if rate_known; then of the stages
  std::size_t latest = 1;          // of the rates, that at the end of a step
  std::optional<arrays> saved{};   // the state at the start of the step
  std::optional<arrays> before{};  // 'rkl2', 'rkc2': that of stage j - 2
  double all_values = 0.0;         // of all fields and ranks
  bool rate_known = false;
  int rhs_status = 0;       // the last value of f that was not 0
  double step_error = 0.0;  // e of the last attempt

  // For so many particles.
  void build() {
    const std::size_t stages = table ? static_cast<std::size_t>(table->stages) : 2;
    latest = same_as_last ? stages - 1 : std::min<std::size_t>(1, stages - 1);
    rates.clear();
    for (std::size_t s = 0; s < stages; ++s) rates.emplace_back(fields.size(), n);
    saved.emplace(fields.size(), n);
    if (is_stabilised) before.emplace(fields.size(), n);
    auto particles = static_cast<long long>(n);
    MPI_Allreduce(MPI_IN_PLACE, &particles, 1, MPI_LONG_LONG, MPI_SUM, communicator);
    all_values = static_cast<double>(particles) * static_cast<double>(fields.size());
    rate_known = false;
  }

  int evaluate(double at, const arrays& rate) {
    ++statistics.evaluations;
    const int status = worst_of_calls(communicator, thrown, [&] { return rhs(at, rate.all()); });
    if (status != 0) rhs_status = status;
    return status;
  }

  // operation(k, begin, end) on pieces of field k; a thread gets the same particles of every field.
  template <class Operation>
  void over_blocks(Operation operation) const {
    const std::size_t blocks = (n + block_length - 1) / block_length;
#pragma omp parallel for schedule(static) if (blocks > 8)
    for (std::size_t b = 0; b < blocks; ++b)
      for (std::size_t k = 0; k < fields.size(); ++k)
        operation(k, b * block_length, std::min(n, (b + 1) * block_length));
  }

  // array k of the particles at i = value(k, i), which may read what it replaces
  template <class Value>
  void set_arrays(Value value) const {
    over_blocks([&](std::size_t k, std::size_t begin, std::size_t end) {
      double* y = fields[k].data;
#pragma omp simd
      for (std::size_t i = begin; i < end; ++i) y[i] = value(k, i);
    });
  }

  // sqrt( sum_i value_i^2 / N ), N: all values of all ranks
  template <class Value>
  double root_mean_square(Value value) const {
    double sum = 0.0;
    exact_sums(communicator, {&sum, 1}, fields.size(), n, [&](std::size_t, std::size_t k, std::size_t i) {
      const double x = value(k, i);
      return x * x;
    });
    return all_values == 0.0 ? 0.0 : std::sqrt(sum / all_values);
  }

  double weight(std::size_t k, double y) const {
    const field& f = fields[k];
    return 1.0 / (options.rtol * (f.scale > 0.0 ? f.scale : std::fabs(y)) + f.absolute_tolerance);
  }

  void raise_rhs_failure() {
    rethrow(thrown);
    if (rhs_status < 0)
      fail_calculation(
          fmt::format("the rates of change could not be evaluated in the step from t = {:.17g} s (on this or "
                      "another rank, which says why)",
                      t));
  }

  void know_rate() {
    if (rate_known) return;
    rhs_status = 0;
    if (evaluate(t, rates[0]) != 0) {
      raise_rhs_failure();
      fail_calculation(
          fmt::format("the rates of change could not be evaluated at t = {:.17g} s, the start of a step", t));
    }
    rate_known = true;
  }

  // ---- the length of a step -----------------------------------------------------------------

  // A change of one percent of the state, or of one tolerance, whichever allows more.
  // [E. Hairer, S. P. Nørsett, G. Wanner, Solving ODEs I, II.4, first guess]
  double first_dt(double t_stop) const {
    if (options.dt > 0.0) return options.dt;
    const double state = root_mean_square([&](std::size_t k, std::size_t i) {
      const double y = fields[k].data[i], scale = fields[k].scale;
      return (scale > 0.0 ? scale : y) * weight(k, y);
    });
    const double rate =
        root_mean_square([&](std::size_t k, std::size_t i) { return rates[0][k][i] * weight(k, fields[k].data[i]); });
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

  plan choose(double t_stop, const std::string& stop_is) {
    if (is_stabilised) know_radius();
    if (!adaptive) return choose_fixed(t_stop, stop_is);
    if (statistics.next_dt == 0.0) statistics.next_dt = first_dt(t_stop);
    plan p{statistics.next_dt, "accuracy", false, false};
    if (limit) {
      const step_limit stable = limit(t);
      if (!(stable.dt > 0.0))
        fail_calculation(
            fmt::format("the stable step by '{}' at t = {:.17g} s is {}, not > 0", stable.name, t, stable.dt));
      if (stable.dt < p.dt) p = {stable.dt, stable.name, false, false};
    }
    if (is_stabilised)
      if (const double dt = largest_stabilised_dt(); dt < p.dt) p = {dt, "stages", false, false};
    cut_for_stop(t_stop, stop_is, p);
    return p;
  }

  void know_radius() {
    statistics.radius = radius_bound(t);
    if (!(statistics.radius >= 0.0) || !std::isfinite(statistics.radius))
      fail_calculation(fmt::format("the spectral radius at t = {:.17g} s is {} 1/s, not a finite number >= 0", t,
                                   statistics.radius));
  }

  double largest_stabilised_dt() const {
    // A little below the limit, so that rounding of dt * radius does not ask for a stage more.
    const double largest = stability_limit(kind, largest_stages(kind, options.max_stages)) * (1.0 - 1e-12);
    return statistics.radius > 0.0 ? largest / statistics.radius : std::numeric_limits<double>::infinity();
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

  // ---- the step -----------------------------------------------------------------------------

  // Into the particle arrays dt times the weighed rates and the state at the start of the step, added in this order.
  void form(const double* weights, int stages, double dt) const {
    std::vector<double> factor;
    std::vector<const arrays*> from;
    for (int j = 0; j < stages; ++j)
      if (weights[j] != 0.0) {
        factor.push_back(dt * weights[j]);
        from.push_back(&rates[static_cast<std::size_t>(j)]);
      }
    over_blocks([&](std::size_t k, std::size_t begin, std::size_t end) {
      double buffer[block_length];
      const std::size_t length = end - begin;
      std::fill_n(buffer, length, -0.0);  // which leaves every bit of what is added to it
      for (std::size_t j = 0; j < from.size(); ++j) {
        const double c = factor[j], *x = (*from[j])[k] + begin;
#pragma omp simd
        for (std::size_t i = 0; i < length; ++i) buffer[i] += c * x[i];
      }
      const double* y0 = (*saved)[k] + begin;
      double* y = fields[k].data + begin;
#pragma omp simd
      for (std::size_t i = 0; i < length; ++i) y[i] = buffer[i] + y0[i];
    });
  }

  // step_error = | dt sum_j (b_j - d_j) f_j |_w, d: the embedded method, the weights those of y_n
  void estimate_error(double dt) {
    const auto& y0 = *saved;
    const double digits =
        root_mean_square([&](std::size_t k, std::size_t i) { return y0[k][i] * weight(k, y0[k][i]); });
    if (digits * std::numeric_limits<double>::epsilon() > 1.0)
      fail_calculation(
          fmt::format("rtol = {} asks for more digits than a double has at t = {:.17g} s: raise it", options.rtol, t));
    step_error = root_mean_square([&](std::size_t k, std::size_t i) {
      double error = 0.0;
      for (std::size_t j = 0; j < rates.size(); ++j) error += dt * (table->b[j] - table->d[j]) * rates[j][k][i];
      return error * weight(k, y0[k][i]);
    });
  }

  // The stages and the rate at the end of the step; the value of f that was not 0, or 0.
  int runge_kutta_step(double dt) {
    for (int s = 1; s < table->stages; ++s) {
      form(table->A[s], s, dt);
      const int status = evaluate(t + table->c[s] * dt, rates[static_cast<std::size_t>(s)]);
      if (status != 0) return status;
    }
    if (!same_as_last) form(table->b, table->stages, dt);
    if (adaptive) estimate_error(dt);
    if (same_as_last || !knows_end || !(step_error <= 1.0)) return 0;
    if (latest == 0) rate_known = false;
    return evaluate(t + dt, rates[latest]);
  }

  // Y_j into the particle arrays, from Y_(j-1) there, Y_(j-2) in `before` (j = 2: Y_0), which takes Y_(j-1).
  void form_stage(const recurrence& r, std::size_t j, double dt) const {
    const auto &y0 = *saved, &f0 = rates[0], &f = rates[1];
    if (j == 1) {
      const double a = r.mu_tilde[1] * dt;
      set_arrays([&](std::size_t k, std::size_t i) { return y0[k][i] + a * f0[k][i]; });
      return;
    }
    const double mu = r.mu[j], nu = r.nu[j], rest = 1.0 - mu - nu, a = r.mu_tilde[j] * dt, a0 = r.gamma_tilde[j] * dt;
    set_arrays([&](std::size_t k, std::size_t i) {
      const double y1 = fields[k].data[i], y2 = j == 2 ? y0[k][i] : (*before)[k][i];
      (*before)[k][i] = y1;
      return rest * y0[k][i] + mu * y1 + nu * y2 + (a * f[k][i] + a0 * f0[k][i]);
    });
  }

  // The same of 'rkl2' or 'rkc2'.
  int stabilised_step(double dt) {
    const double z = dt * statistics.radius;
    const int stages = stages_for(kind, z, options.max_stages);
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
      if (const int status = evaluate(t + c * dt, rates[1]); status != 0) return status;
    }
    // | K [y_n - y_(n+1) + dt/2 (F_n + F_(n+1))] |_w, the weights those of y_n
    if (adaptive)
      step_error = root_mean_square([&](std::size_t k, std::size_t i) {
        const double y0 = (*saved)[k][i], y1 = fields[k].data[i];
        return weight(k, y0) * (r.error_factor * (y0 - y1 + 0.5 * dt * (rates[0][k][i] + rates[1][k][i])));
      });
    return 0;
  }

  int ab2_step(double dt) {
    const auto &y0 = *saved, &f0 = rates[0], &f1 = rates[1];
    const double ratio = previous_dt > 0.0 ? dt / previous_dt : 0.0;
    if (ratio > 0.0 && ratio <= 1.5) {
      const double now = dt * (1.0 + 0.5 * ratio), earlier = dt * 0.5 * ratio;
      set_arrays([&](std::size_t k, std::size_t i) {
        return y0[k][i] + (now * f0[k][i] - earlier * fields[k].previous_rate[i]);
      });
    } else {
      set_arrays([&](std::size_t k, std::size_t i) { return y0[k][i] + dt * (2.0 / 3.0) * f0[k][i]; });
      if (const int status = evaluate(t + dt * (2.0 / 3.0), f1); status != 0) return status;
      set_arrays([&](std::size_t k, std::size_t i) { return y0[k][i] + dt * (0.25 * f0[k][i] + 0.75 * f1[k][i]); });
    }
    return evaluate(t + dt, f1);
  }

  void return_to_saved() const {
    set_arrays([&](std::size_t k, std::size_t i) { return (*saved)[k][i]; });
  }

  outcome attempt(double dt) {
    if (!(t + dt > t))
      fail_calculation(fmt::format("the step of {} s at t = {:.17g} s no longer advances the time", dt, t));
    ++statistics.attempts;
    rhs_status = 0;
    step_error = 0.0;
    over_blocks([&](std::size_t k, std::size_t begin, std::size_t end) {
      std::copy(fields[k].data + begin, fields[k].data + end, (*saved)[k] + begin);
    });
    int status = 0;
    try {
      status = table ? runge_kutta_step(dt) : is_ab2 ? ab2_step(dt) : stabilised_step(dt);
    } catch (...) {
      return_to_saved();
      throw;
    }
    if (status == 0 && (!adaptive || step_error <= 1.0)) {
      if (is_ab2) {
        for (std::size_t k = 0; k < fields.size(); ++k) std::copy_n(rates[0][k], n, fields[k].previous_rate);
        previous_dt = dt;
      }
      return outcome::accepted;
    }
    return_to_saved();
    if (status == 0) return outcome::rejected;
    raise_rhs_failure();
    if (!adaptive)
      fail_calculation(
          fmt::format("the rates of change could not be evaluated in the fixed step of {} s from t = {:.17g} s: "
                      "try a smaller dt or method = 'adaptive'",
                      dt, t));
    return outcome::unevaluable;
  }
};

explicit_integrator::explicit_integrator(MPI_Comm communicator, std::vector<field> fields, std::size_t n, double t,
                                         explicit_options options, rhs_function rhs, limit_function limit,
                                         radius_function radius)
    : self_(new implementation{.communicator = communicator,
                               .fields = std::move(fields),
                               .n = n,
                               .options = std::move(options),
                               .rhs = std::move(rhs),
                               .limit = std::move(limit),
                               .radius_bound = std::move(radius),
                               .t = t}) {
  check(self_->options, self_->adaptive);
  if (self_->is_stabilised && !self_->radius_bound)
    fail_input(fmt::format("method '{}' needs a bound of the spectral radius", self_->options.method));
  check(self_->fields, self_->adaptive, self_->is_ab2, n);
  self_->build();
}

explicit_integrator::~explicit_integrator() = default;

double explicit_integrator::step(double t_stop, const std::string& stop_is) {
  implementation& s = *self_;
  if (!(t_stop > s.t)) fail_input(fmt::format("the stop time {} s must lie after t = {} s", t_stop, s.t));
  s.know_rate();
  implementation::plan p = s.choose(t_stop, stop_is);

  int failures = 0;
  for (;; ++failures) {
    if (failures == most_attempts)
      fail_calculation(
          fmt::format("no step from t = {:.17g} s passed in {} attempts, the last one of {} s with error {} "
                      "of the tolerance: the state there may be unphysical",
                      s.t, failures, p.dt, s.step_error));
    const auto outcome = s.attempt(p.dt);
    if (outcome == implementation::outcome::accepted) break;
    ++(outcome == implementation::outcome::rejected ? s.statistics.rejections : s.statistics.unevaluable);
    p = {p.dt * s.failed_factor(outcome), "accuracy", false, false};
  }

  const double t_stages = s.t + p.dt;  // where f was evaluated last
  s.t = p.reaches_stop ? t_stop : t_stages;
  std::swap(s.rates[0], s.rates[s.latest]);
  s.rate_known = s.t == t_stages && s.knows_end;

  explicit_statistics& statistics = s.statistics;
  ++statistics.steps;
  ++statistics.limited_by[p.limited_by];
  statistics.last_dt = p.dt;
  statistics.last_error = s.step_error;
  if (!s.adaptive) {
    statistics.next_dt = s.options.dt;
    return s.t;
  }
  const double next = p.dt * s.accepted_factor(failures > 0);
  // A step cut short for an output time says little about the next one.
  statistics.next_dt = p.cut_for_output ? std::max(next, statistics.next_dt) : next;
  if (!p.cut_for_output) s.previous_error = s.step_error;
  return s.t;
}

double explicit_integrator::time() const { return self_->t; }

void explicit_integrator::resize(std::vector<field> fields, std::size_t n) {
  implementation& s = *self_;
  const bool changed = n != s.n || fields.size() != s.fields.size();
  check(fields, s.adaptive, s.is_ab2, n);
  s.fields = std::move(fields);
  s.n = n;
  if (worst_allreduce(s.communicator, changed ? 1 : 0) != 0) s.build();
  s.rate_known = false;
}

void explicit_integrator::prepare() { self_->know_rate(); }

void explicit_integrator::state_changed() {
  self_->rate_known = false;
  self_->previous_dt = 0.0;
}

const explicit_statistics& explicit_integrator::statistics() const { return self_->statistics; }

explicit_memory explicit_integrator::save() const {
  return {self_->t, self_->statistics.next_dt, self_->previous_error, self_->previous_dt, self_->statistics};
}

void explicit_integrator::restore(const explicit_memory& memory) {
  self_->t = memory.t;
  self_->previous_error = memory.previous_error;
  self_->statistics = memory.statistics;
  self_->statistics.next_dt = memory.next_dt;
  state_changed();
  self_->previous_dt = memory.previous_dt;
}

}  // namespace tetsuame::integrators
