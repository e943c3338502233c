// Reductions over ranks that have the same bits for any number of ranks: sums through
// foundation::exact_sum, whose chunks are added as integers, and extrema, which are exact anyway.
#pragma once

#include <mpi.h>

#include <foundation/exact_sum.hpp>
#include <span>

namespace tetsuame::integrators {

// All functions are collective over `communicator`.

// The sums over ranks of every rank's `sums`, each rounded once, in one message; results.size() == sums.size(). `sums`
// are left normalised. Errors of MPI are MPI's own.
void exact_allreduce(MPI_Comm communicator, std::span<foundation::exact_sum> sums, std::span<double> results);

double maximum_allreduce(MPI_Comm communicator, double value);
double minimum_allreduce(MPI_Comm communicator, double value);

// The most severe of the ranks' return values of a callback: 0 only if all are 0, else the
// smallest negative one if any is negative, else the largest.
int worst_allreduce(MPI_Comm communicator, int status);

}  // namespace tetsuame::integrators
