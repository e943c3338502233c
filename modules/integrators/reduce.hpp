// Reductions over ranks that have the same bits for any number of ranks: sums through
// foundation::exact_sum, whose chunks are added as integers, and extrema, which are exact anyway.
#pragma once

#include <mpi.h>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <foundation/exact_sum.hpp>
#include <foundation/waiting.hpp>
#include <span>
#include <utility>
#include <vector>

namespace tetsuame::integrators {

// All functions but rethrow are collective over `communicator`.

// results[j] = the sum of term(j, k, i) over k < fields, i < n and all ranks: the same bits for any number of ranks and
// threads and any order of particles. In one message; each is rounded once.
template <class Term>
void exact_sums(MPI_Comm communicator, std::span<double> results, std::size_t fields, std::size_t n, Term term) {
  std::vector<foundation::exact_sum> total(results.size());
#pragma omp parallel if (n > 4096)
  {
    std::vector<foundation::exact_sum> mine(results.size());
    for (std::size_t j = 0; j < mine.size(); ++j)
      for (std::size_t k = 0; k < fields; ++k) {
#pragma omp for schedule(static) nowait
        for (std::size_t i = 0; i < n; ++i) mine[j].add(term(j, k, i));
      }
#pragma omp critical(tetsuame_exact_sums)
    for (std::size_t j = 0; j < mine.size(); ++j) total[j].add(mine[j]);
  }
  std::vector<std::int64_t> message;
  for (auto& sum : total) {
    sum.normalise();
    message.insert(message.end(), sum.raw().begin(), sum.raw().end());
  }
  {
    const foundation::collective timed;
    MPI_Allreduce(MPI_IN_PLACE, message.data(), static_cast<int>(message.size()), MPI_INT64_T, MPI_SUM, communicator);
  }
  auto from = message.begin();
  for (std::size_t j = 0; j < total.size(); ++j) {
    auto& chunks = total[j].raw();
    std::copy_n(from, chunks.size(), chunks.begin());
    from += static_cast<std::ptrdiff_t>(chunks.size());
    results[j] = total[j].value();
  }
}

inline double maximum_allreduce(MPI_Comm communicator, double value) {
  const foundation::collective timed;
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, communicator);
  return value;
}

// The most severe of the ranks' return values of a callback: 0 only if all are 0, else the
// smallest negative one if any is negative, else the largest.
inline int worst_allreduce(MPI_Comm communicator, int status) {
  int extremes[2] = {status, -status};
  const foundation::collective timed;
  MPI_Allreduce(MPI_IN_PLACE, extremes, 2, MPI_INT, MPI_MAX, communicator);
  return extremes[1] > 0 ? -extremes[1] : extremes[0];
}

// The same of call(), which counts as -1 where it throws: what it threw first waits in `thrown`, as C code must not see
// it.
template <class Call>
int worst_of_calls(MPI_Comm communicator, std::exception_ptr& thrown, const Call& call) {
  int status = -1;
  try {
    status = call();
  } catch (...) {
    if (!thrown) thrown = std::current_exception();
  }
  return worst_allreduce(communicator, status);
}
inline void rethrow(std::exception_ptr& thrown) {  // if one waits
  if (thrown) std::rethrow_exception(std::exchange(thrown, nullptr));
}

}  // namespace tetsuame::integrators
