// Explicit Runge–Kutta steps y_(n+1) = y_n + dt sum_s b_s f(t_s, Y_s) straight over the
// particle arrays, with SUNDIALS' ARKODE (ERKStep) doing the stages:
//   'euler'              forward Euler, fixed step
//   'order_2'            Ralston (1962), fixed step
//   'order_3'            Bogacki & Shampine (1989), fixed step
//   'order_4'            Zonneveld (1963), fixed step
//   'order_5'            Dormand & Prince (1980), fixed step
//   'adaptive'           the same of order 2 to 5, steps from the embedded error estimate
// Order 2 has a table of its own: ERKStep 6.4 takes every table whose last abscissa is 1 for
// "first same as last", which Heun's is not, and would go on with a rate of the wrong state.
//
// Error control: e = |y - y_embedded|_w <= 1, weights w_i = 1 / (rtol |y_i| + atol), or
// 1 / (rtol scale + atol) for a field with a scale. Next step by the PI controller
//   dt_(n+1) = safety dt_n e_n^(-0.7/k) e_(n-1)^(0.4/k),   k = order of the embedding + 1
// [K. Gustafsson, ACM TOMS 17, 533 (1991); G. Söderlind, Numer. Algorithms 31, 281 (2002)],
// after a rejection dt = safety dt e^(-1/k).
//
// Every attempt starts ARKODE afresh from the particle arrays and the known rate, and the
// controller's history is kept here: ordinary steps, steps after resize() and steps after
// restore() run through the same arithmetic, so all give the same bits. The state and every
// stage are formed in the particle arrays themselves; one copy of the state is kept, to
// which a failed attempt returns.
#pragma once

#include <mpi.h>

#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace tetsuame::integrators {

// One integrated scalar per particle.
struct field {
  std::string name;
  double* data;                     // n values
  double absolute_tolerance = 0.0;  // the field's unit
  double scale = 0.0;               // the field's unit; > 0 replaces |y| in the weight (positions)
};

struct explicit_options {
  std::string method = "euler";
  int order = 3;                                            // of 'adaptive': 2 to 5
  double dt = 0.0;                                          // s; fixed: the step. adaptive: the first one, 0: chosen
  double rtol = 1e-4;                                       // adaptive
  double dt_max = std::numeric_limits<double>::infinity();  // s, adaptive
  double safety = 0.9;                                      // adaptive
  double max_growth = 5.0;                                  // adaptive: dt_(n+1) / dt_n at most
  int max_attempts = 20;                                    // adaptive: at one step
};

// f: when called the particle arrays hold the state at t; writes dy/dt, one array a field in the
// order given, n values each. Must not change the integrated fields. Returns 0, > 0 if the state
// cannot be evaluated but a smaller step may help, < 0 if nothing will; may throw. Collective:
// the worst value of any rank counts for all.
using rhs_function = std::function<int(double t, std::span<double* const> rate)>;

// The largest stable step (s) at the state in the particle arrays and which condition gives it
// ('cfl', 'viscous', …). Called before each adaptive step, after f at the same state, so what f
// left in other arrays may be used. Must give the same on all ranks.
struct step_limit {
  double dt;
  std::string name;
};
using limit_function = std::function<step_limit(double t)>;

struct explicit_statistics {
  long long steps = 0;
  long long attempts = 0;
  long long rejections = 0;   // failed error tests
  long long unevaluable = 0;  // attempts given up because f returned > 0
  long long evaluations = 0;  // of f
  double last_dt = 0.0;       // s
  double next_dt = 0.0;       // s, before limits and output times
  double last_error = 0.0;    // e of the last accepted step
  std::map<std::string, long long>
      limited_by;  // steps by what set dt: 'fixed', 'accuracy', 'output', 'maximum' or a limit's name
};

// All that a restart needs besides the particle arrays.
struct explicit_memory {
  double t = 0.0;
  double next_dt = 0.0;
  double previous_error = 0.0;  // 0: none yet
  explicit_statistics statistics;
};

class explicit_integrator {
 public:
  // fail_input if an option or tolerance is out of range. Collective, as all that follows.
  explicit_integrator(MPI_Comm communicator, std::vector<field> fields, std::size_t n, double t,
                      explicit_options options, rhs_function rhs, limit_function limit = {});
  ~explicit_integrator();
  explicit_integrator(const explicit_integrator&) = delete;
  explicit_integrator& operator=(const explicit_integrator&) = delete;

  // One accepted step, never past t_stop; returns the new time, which is t_stop itself when it
  // was reached. Throws what f threw, or fail_calculation; the particle arrays then hold the
  // state before the step again.
  double step(double t_stop);
  double time() const;
  // Evaluates f at the present state unless it is known from the last step: for callers whose f has
  // a memory (a start value, say) that may move on only then.
  void prepare();

  // The particle arrays moved, were permuted, or have another length on this rank.
  void resize(std::vector<field> fields, std::size_t n);
  // The integrated values were changed in place (positions wrapped, say): f is asked again.
  void state_changed();

  const explicit_statistics& statistics() const;
  long long copies() const;  // of the whole state, since the last change of length

  explicit_memory save() const;
  void restore(const explicit_memory& memory);

 private:
  struct implementation;
  std::unique_ptr<implementation> self_;
};

}  // namespace tetsuame::integrators
