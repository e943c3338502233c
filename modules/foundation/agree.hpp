// One outcome for all ranks: what goes wrong on one rank is thrown on every rank, so
// that none is left waiting in a collective call.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <foundation/error.hpp>
#include <foundation/exact_sum.hpp>
#include <functional>
#include <span>
#include <string>

namespace tetsuame::foundation {

int rank_of(MPI_Comm comm);
int size_of(MPI_Comm comm);

// Collective. Each rank brings its problem, or an empty text. If there is one, every rank throws error with
// the text and status of the lowest ID that has one, and of these the lowest rank.
void agree(MPI_Comm comm, const std::string& problem, exit_status status = exit_status::file_failed,
           std::int64_t id = 0);

// Collective. Runs the work on rank 0 only; what it throws is thrown on every rank.
void on_rank_0(MPI_Comm comm, const std::function<void()>& work);

// Collective. Rank 0's value, on every rank.
std::string broadcast(MPI_Comm comm, const std::string& text);

// Collective. The sums over ranks of every rank's `sums`, each rounded once, in one message: the same bits for any
// number of ranks. results.size() == sums.size(); `sums` are left normalised.
void sum_over_ranks(MPI_Comm comm, std::span<exact_sum> sums, std::span<double> results);

}  // namespace tetsuame::foundation
