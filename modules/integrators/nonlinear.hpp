// Systems of nonlinear equations with one unknown a particle, spread over ranks, solved with
// SUNDIALS' KINSOL:
//   anderson        x = g(x) by fixed-point passes with Anderson acceleration (depth m: the
//                   combination of the last m passes whose residual is least)
//                   [H. F. Walker & P. Ni, SIAM J. Numer. Anal. 49, 1715 (2011)]
//   newton_krylov   F(x) = 0 by Newton's method, each linear system J s = -F solved roughly by
//                   restarted GMRES with a diagonal preconditioner on the right and the forcing
//                   terms of S. C. Eisenstat & H. F. Walker, SIAM J. Sci. Comput. 17, 16 (1996)
// Both stop by the residual's largest absolute value over all particles of all ranks, and the
// result has the same bits for any number of ranks and threads and any order of particles.
#pragma once

#include <mpi.h>

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace tetsuame::integrators {

// Callbacks get this rank's values; spans they are given are as long as x. They return 0, > 0
// where x cannot be evaluated (the line search then tries a shorter step; elsewhere it ends the
// solve unconverged), < 0 for a failure that nothing mends; they may throw. Collective: the
// worst value of any rank counts for all.
using fixed_point_map = std::function<int(std::span<const double> x, std::span<double> g)>;
using residual_function = std::function<int(std::span<const double> x, std::span<double> f)>;
// jv = J(x) v
using jacobian_times = std::function<int(std::span<const double> x, std::span<const double> v, std::span<double> jv)>;
// About the diagonal of J(x); no value may vanish.
using jacobian_diagonal = std::function<int(std::span<const double> x, std::span<double> diagonal)>;

struct anderson_options {
  double tolerance = 1e-10;  // of max |g(x) - x|
  int max_iterations = 200;  // passes
  int depth = 5;             // 0: plain fixed point
};

struct newton_options {
  double tolerance = 1e-10;  // of max |F|
  int max_iterations = 50;   // Newton steps
};

struct nonlinear_result {
  bool converged = false;
  int iterations = 0;             // passes or Newton steps
  int evaluations = 0;            // of g or F
  int products = 0;               // of J with a vector
  std::vector<double> residuals;  // max |g(x) - x| or max |F| at every point tried, in order
  std::string reason;             // why not, if not converged
};

// x: the first guess, then the last iterate. When converged, g was evaluated last at just this x,
// and the last of `residuals` is its residual. Rethrows what g threw. Collective.
nonlinear_result anderson(MPI_Comm communicator, std::span<double> x, const fixed_point_map& g,
                          const anderson_options& options = {});

// x as above; when converged max |F(x)| <= tolerance.
nonlinear_result newton_krylov(MPI_Comm communicator, std::span<double> x, const residual_function& f,
                               const jacobian_times& jv, const jacobian_diagonal& diagonal,
                               const newton_options& options = {});

}  // namespace tetsuame::integrators
