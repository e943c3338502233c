// Explicit steps straight over the particle arrays. Runge–Kutta steps
// y_(n+1) = y_n + dt sum_s b_s f(t_s, Y_s), SUNDIALS' ARKODE (ERKStep) doing the stages:
//   'order_2'            Ralston (1962), fixed step
//   'order_3'            Bogacki & Shampine (1989), fixed step
//   'order_4'            Zonneveld (1963), fixed step
//   'order_5'            Dormand & Prince (1980), fixed step
//   'ssp_rk3'            Shu & Osher (1988), fixed step: stable for sound up to c dt/dx of 0.8
//   'rk4'                the classical one of Kutta (1901), fixed step: up to 1.4
//   'adaptive'           those of order 2 to 5, steps from the embedded error estimate
// and steps formed here:
//   'euler'              forward Euler, fixed step: beside the particle arrays one state and one rate
//   'ab2'                Adams & Bashforth, fixed step, one evaluation a step
//   'kdk'                kick, drift, kick, fixed or stable steps; slow forces act at the ends of several substeps
//   'rkl2', 'rkc2'       stabilised for diffusion (stabilised.hpp); steps from an error estimate, or fixed
// Order 2 has a table of its own: ERKStep 6.4 takes every table whose last abscissa is 1 for
// "first same as last", which Heun's is not, and would go on with a rate of the wrong state.
//
// 'ab2': y_(n+1) = y_n + dt [(1 + r/2) f_n - (r/2) f_(n-1)], r = dt_n / dt_(n-1); where there is no
// earlier rate, or r > 1.5 would amplify its errors, one step of 'order_2'.
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
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tetsuame::integrators {

// One integrated scalar per particle; or of something else, of which each rank has some.
struct field {
  std::string name;
  double* data;                            // n values
  double absolute_tolerance = 0.0;         // the field's unit
  double scale = 0.0;                      // the field's unit; > 0 replaces |y| in the weight (positions)
  double common = 0.0, common_rate = 0.0;  // of all values, and of their rates: by what is beyond them steps are judged
  // 'ab2': n values, df/dt of the step before; 'kdk': of all but positions, that of the last evaluation. Kept and moved
  // by the caller.
  double* previous_rate = nullptr;
  std::optional<std::size_t> number = {};    // of values, where they are not one a particle
  std::optional<std::size_t> velocity = {};  // 'kdk': a position; which of the fields is its rate
  double* slow_rate = nullptr;  // 'kdk': n values, the part of slow forces, as slow_function found it last; null: none
};

struct explicit_options {
  std::string method = "euler";
  int order = 3;                // of 'adaptive': 2 to 5
  double dt = 0.0;              // s; fixed: the step. adaptive: the first one, 0: chosen
  std::string dt_is = "fixed";  // what set a fixed step, for the statistics
  double rtol = 1e-4;           // adaptive
  bool error_control = true;  // of 'rkl2', 'rkc2', whose steps are else dt; of 'kdk' the largest stable steps, else dt
  int max_stages = 200;       // of 'rkl2', 'rkc2': 3 or more
  int substeps = 1;           // of 'kdk': of the fast forces in a step, at whose ends the slow ones act
};

// f: when called the particle arrays hold the state at t; writes dy/dt, one array a field in the
// order given, n values each. Must not change the integrated fields. Returns 0, > 0 if the state
// cannot be evaluated but a smaller step may help, < 0 if nothing will; may throw. Collective:
// the worst value of any rank counts for all.
using rhs_function = std::function<int(double t, std::span<double* const> rate)>;

// The largest stable step (s) at the state in the particle arrays and which condition gives it ('cfl', 'viscous', …),
// the same on all ranks. Called before each adaptive step, after f at the same state.
struct step_limit {
  double dt;
  std::string name;
};
using limit_function = std::function<step_limit(double t)>;

// 'kdk': writes field::slow_rate at the positions in the particle arrays, on which alone it depends. So does f, of
// which weight_of_slow_forces() times these are a part.
using slow_function = std::function<void()>;

// 'rkl2', 'rkc2': an upper bound (1/s, >= 0) of the spectral radius of df/dy, called like limit_function.
using radius_function = std::function<double(double t)>;

struct explicit_statistics {
  long long steps = 0;
  long long attempts = 0;
  long long rejections = 0;   // failed error tests
  long long unevaluable = 0;  // attempts given up because f returned > 0
  long long evaluations = 0;  // of f
  double last_dt = 0.0;       // s
  double next_dt = 0.0;       // s, before limits and output times
  double last_error = 0.0;    // e of the last accepted step
  int stages = 0;             // 'rkl2', 'rkc2': of the last attempt
  double radius = 0.0;        // 1/s, the spectral radius used
  // steps by what set dt: 'fixed', 'accuracy', 'stages', or the name of a limit or a stop
  std::map<std::string, long long> limited_by;
};

// All that a restart needs besides the particle arrays (of 'ab2' and 'kdk', the earlier rates too).
struct explicit_memory {
  double t = 0.0;
  double next_dt = 0.0;
  double previous_error = 0.0;  // 0: none yet
  double previous_dt = 0.0;     // of 'ab2', 'kdk'; 0: none. The next step is then of 'order_2', or evaluates f anew
  bool rate_known = false;      // at the state: it has been evaluated and counted
  step_limit stable{0.0, {}};   // of 'kdk': as it was where f was evaluated last
  explicit_statistics statistics{};
};

class explicit_integrator {
 public:
  // fail_input for an unknown method, a fixed step that is not above 0, or a field without what the method needs.
  // Collective, as all that follows.
  explicit_integrator(MPI_Comm communicator, std::vector<field> fields, std::size_t n, double t,
                      explicit_options options, rhs_function rhs, limit_function limit = {},
                      radius_function radius = {}, slow_function slow = {});
  ~explicit_integrator();
  explicit_integrator(const explicit_integrator&) = delete;
  explicit_integrator& operator=(const explicit_integrator&) = delete;

  // One accepted step, never past t_stop, which stop_is names for the statistics; returns the new time, which is
  // t_stop itself when it was reached. Throws what f threw, or fail_calculation; the particle arrays then hold the
  // state before the step again.
  double step(double t_stop, const std::string& stop_is = "output");
  double time() const;
  // Evaluates f at the present state unless it is known from the last step: for an f with a memory that may move on
  // then.
  void prepare();

  // After restore(): whether that evaluates again what had been evaluated, and counted, when the memory was saved.
  bool repeats() const;
  // After restore(): the next step is as long as the first one of a start from here.
  void choose_steps_anew();

  // Gives arrays as f writes them to who wants rates between steps: memory that only steps need.
  void lend(const std::function<void(std::span<double* const>)>& use);

  // The particle arrays moved, were permuted, or have another length on this rank.
  void resize(std::vector<field> fields, std::size_t n);
  // The integrated values were changed in place (positions wrapped, say): f is asked again, and
  // 'ab2' starts anew.
  void state_changed();

  // While f is evaluated, of 'kdk': by how much it is to take the rates of slow forces. With k substeps a step, k at
  // the step's ends and 0 between: the impulses are those of the whole step. Otherwise 1.
  double weight_of_slow_forces() const;

  const explicit_statistics& statistics() const;
  long long copies() const;  // of the whole state, since the last change of length

  explicit_memory save() const;
  void restore(const explicit_memory& memory);

 private:
  struct implementation;
  std::unique_ptr<implementation> self_;
};

}  // namespace tetsuame::integrators
