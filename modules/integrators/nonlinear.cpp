#include <fmt/format.h>
#include <kinsol/kinsol.h>
#include <kinsol/kinsol_ls.h>
#include <sunlinsol/sunlinsol_spgmr.h>

#include <algorithm>
#include <cmath>
#include <foundation/error.hpp>
#include <integrators/nonlinear.hpp>
#include <integrators/state_vector.hpp>
#include <limits>
#include <memory>

namespace tetsuame::integrators {

namespace {

using foundation::fail_calculation;

using kinsol_handle = std::unique_ptr<void, freed_by<[](void* memory) { KINFree(&memory); }>>;
using solver_handle = std::unique_ptr<_generic_SUNLinearSolver, freed_by<SUNLinSolFree>>;

// One solve: what the C callbacks reach through KINSOL's user data.
struct problem {
  MPI_Comm communicator;
  std::span<double> x;
  double tolerance;
  const fixed_point_map* map = nullptr;
  const residual_function* residual = nullptr;
  const jacobian_times* product = nullptr;
  const jacobian_diagonal* diagonal = nullptr;

  sundials::Context context{};
  sundials_messages messages{};
  exception_carrier thrown{};
  vector_handle home{}, ones{};
  vector_handle spare{};  // g(x) - x, or about the diagonal of the Jacobian
  kinsol_handle kinsol{};
  nonlinear_result result{};
  bool reached = false;  // the tolerance, at the x where g was evaluated last
  int status = 0;        // the last callback's value that was not 0

  std::span<const double> read(N_Vector v) const { return {values(v)[0], x.size()}; }
  std::span<double> write(N_Vector v) const { return {values_to_overwrite(v)[0], x.size()}; }

  int guard(const std::function<int()>& call) {
    const int worst = thrown.guard(communicator, call);
    if (worst != 0) status = worst;
    return worst;
  }
  // Its largest absolute value; infinite where one is not a number.
  double note_residual(N_Vector residual_vector) {
    result.residuals.push_back(N_VMaxNorm(residual_vector));
    return result.residuals.back();
  }
};

problem& problem_of(void* data) { return *static_cast<problem*>(data); }

// KINSOL looks at the step between iterates, which acceleration can make small far from the
// solution, so the residual is looked at here; KINSOL is stopped by a failure it reports back.
int call_map(N_Vector x, N_Vector g, void* data) {
  problem& p = problem_of(data);
  const auto from = p.read(x);
  const auto to = p.write(g);
  ++p.result.evaluations;
  if (p.guard([&] { return (*p.map)(from, to); }) != 0) return -1;
  N_VLinearSum(1.0, g, -1.0, x, p.spare.get());
  const double residual = p.note_residual(p.spare.get());
  p.reached = residual <= p.tolerance;
  return p.reached || !std::isfinite(residual) ? -1 : 0;
}

int call_residual(N_Vector x, N_Vector f, void* data) {
  problem& p = problem_of(data);
  const auto from = p.read(x);
  const auto to = p.write(f);
  ++p.result.evaluations;
  if (const int status = p.guard([&] { return (*p.residual)(from, to); }); status != 0) return status;
  return std::isfinite(p.note_residual(f)) ? 0 : 1;
}

int call_product(N_Vector v, N_Vector jv, N_Vector x, int*, void* data) {
  problem& p = problem_of(data);
  const auto at = p.read(x), direction = p.read(v);
  const auto to = p.write(jv);
  ++p.result.products;
  return p.guard([&] { return (*p.product)(at, direction, to); });
}

int set_up_diagonal(N_Vector x, N_Vector, N_Vector, N_Vector, void* data) {
  problem& p = problem_of(data);
  const auto at = p.read(x);
  const auto to = p.write(p.spare.get());
  return p.guard([&] { return (*p.diagonal)(at, to); });
}

int apply_diagonal(N_Vector, N_Vector, N_Vector, N_Vector, N_Vector v, void* data) {
  N_VDiv(v, problem_of(data).spare.get(), v);
  return 0;
}

void set_up(problem& p) {
  p.home = make_state_vector(p.context, p.communicator, {{p.x.data(), p.x.size()}});
  p.ones.reset(N_VClone(p.home.get()));
  p.spare.reset(N_VClone(p.home.get()));
  N_VConst(1.0, p.ones.get());
  p.kinsol.reset(KINCreate(p.context));
  void* k = p.kinsol.get();
  if (k == nullptr || !TETSUAME_KEEP_MESSAGES(KINSetErrHandlerFn, k, p.context, p.messages) ||
      KINSetUserData(k, &p) != KIN_SUCCESS)
    fail_calculation("KINSOL could not be created: is there enough memory?");
}

void require(problem& p, bool done) {
  if (!done) fail_calculation("KINSOL could not be set up: " + p.messages.last);
}

void finish(problem& p, int flag) {
  p.thrown.rethrow();
  if (p.status < 0 && !p.result.converged)
    fail_calculation("the equations could not be evaluated (on this or another rank, which says why)");
  long iterations = 0;
  KINGetNumNonlinSolvIters(p.kinsol.get(), &iterations);
  p.result.iterations = static_cast<int>(iterations);
  if (p.result.converged) return;
  const double last = p.result.residuals.empty() ? HUGE_VAL : p.result.residuals.back();
  const std::string told = p.messages.last.empty() ? "" : " (" + p.messages.last + ")";
  if (p.status > 0)
    p.result.reason = "the equations could not be evaluated at an iterate" + told;
  else if (!std::isfinite(last))
    p.result.reason = fmt::format("a residual is not finite after {} evaluations", p.result.evaluations);
  else if (flag == KIN_MAXITER_REACHED)
    p.result.reason = fmt::format("the residual is {} after {} iterations", last, p.result.iterations);
  else
    p.result.reason = fmt::format("no progress: the residual is {} after {} iterations, code {}{}", last,
                                  p.result.iterations, flag, told);
}

}  // namespace

nonlinear_result anderson(MPI_Comm communicator, std::span<double> x, const fixed_point_map& g,
                          const anderson_options& options) {
  problem p{.communicator = communicator, .x = x, .tolerance = options.tolerance, .map = &g};
  set_up(p);
  void* k = p.kinsol.get();
  // The depth must be known before KINInit allocates.
  require(p, KINSetMAA(k, options.depth) == KIN_SUCCESS && KINSetOrthAA(k, KIN_ORTH_CGS2) == KIN_SUCCESS &&
                 KINSetNumMaxIters(k, options.max_iterations) == KIN_SUCCESS &&
                 KINSetFuncNormTol(k, std::numeric_limits<double>::min()) == KIN_SUCCESS);
  require(p, KINInit(k, call_map, p.home.get()) == KIN_SUCCESS);

  const int flag = KINSol(k, p.home.get(), KIN_FP, p.ones.get(), p.ones.get());
  p.result.converged = p.reached;
  finish(p, flag);
  return p.result;
}

nonlinear_result newton_krylov(MPI_Comm communicator, std::span<double> x, const residual_function& f,
                               const jacobian_times& jv, const jacobian_diagonal& diagonal,
                               const newton_options& options) {
  constexpr int krylov_dimension = 20, krylov_restarts = 5;  // GMRES vectors before a restart
  constexpr double largest_step = 10.0;                      // root mean square over x of one Newton step at most
  problem p{.communicator = communicator,
            .x = x,
            .tolerance = options.tolerance,
            .residual = &f,
            .product = &jv,
            .diagonal = &diagonal};
  set_up(p);
  void* k = p.kinsol.get();
  const auto unknowns = static_cast<double>(N_VGetLength(p.home.get()));
  require(p, KINSetNumMaxIters(k, options.max_iterations) == KIN_SUCCESS &&
                 KINSetFuncNormTol(k, options.tolerance) == KIN_SUCCESS &&
                 KINSetScaledStepTol(k, std::numeric_limits<double>::epsilon()) == KIN_SUCCESS &&
                 // KINSOL measures a step by its 2-norm
                 KINSetMaxNewtonStep(k, largest_step * std::sqrt(std::max(unknowns, 1.0))) == KIN_SUCCESS &&
                 KINInit(k, call_residual, p.home.get()) == KIN_SUCCESS);
  const solver_handle solver(SUNLinSol_SPGMR(p.home.get(), SUN_PREC_RIGHT, krylov_dimension, p.context));
  require(p, solver != nullptr && SUNLinSol_SPGMRSetMaxRestarts(solver.get(), krylov_restarts) == 0 &&
                 // classical Gram–Schmidt: one message instead of one a vector
                 SUNLinSol_SPGMRSetGSType(solver.get(), SUN_CLASSICAL_GS) == 0 &&
                 KINSetLinearSolver(k, solver.get(), nullptr) == KIN_SUCCESS &&
                 KINSetJacTimesVecFn(k, call_product) == KIN_SUCCESS);
  require(p, KINSetPreconditioner(k, set_up_diagonal, apply_diagonal) == KIN_SUCCESS &&
                 KINSetMaxSetupCalls(k, 1) == KIN_SUCCESS);

  const int flag = KINSol(k, p.home.get(), KIN_LINESEARCH, p.ones.get(), p.ones.get());
  p.result.converged = flag == KIN_SUCCESS || flag == KIN_INITIAL_GUESS_OK;
  finish(p, flag);
  return p.result;
}

}  // namespace tetsuame::integrators
