// For tests under mpirun: MPI for the whole executable, and problems whose particles are
// known by a global number and spread over the ranks at will.
#pragma once

#include <algorithm>
#include <bit>
#include <boost/test/unit_test.hpp>
#include <cstdint>
#include <vector>

#include "../support/mpi.hpp"

using tetsuame::test::mpi_environment;
BOOST_TEST_GLOBAL_FIXTURE(mpi_environment);

inline int rank_of(MPI_Comm communicator) {
  int rank = 0;
  MPI_Comm_rank(communicator, &rank);
  return rank;
}
inline int ranks_of(MPI_Comm communicator) {
  int ranks = 0;
  MPI_Comm_size(communicator, &ranks);
  return ranks;
}

inline std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }

// Every particle's value by global number, on all ranks.
inline std::vector<double> gathered(MPI_Comm communicator, const std::vector<int>& id, const std::vector<double>& value,
                                    int total) {
  std::vector<double> all(static_cast<std::size_t>(total), 0.0);
  for (std::size_t i = 0; i < id.size(); ++i) all[static_cast<std::size_t>(id[i])] = value[i];
  MPI_Allreduce(MPI_IN_PLACE, all.data(), total, MPI_DOUBLE, MPI_SUM, communicator);
  return all;
}

// The particles of this rank. 0: blocks; 1: dealt out in turn; 2: all on the last rank, in
// reverse, the others empty.
inline std::vector<int> spread(MPI_Comm communicator, int total, int way) {
  const int rank = rank_of(communicator), ranks = ranks_of(communicator);
  std::vector<int> id;
  for (int k = 0; k < total; ++k) {
    const int owner = way == 0 ? k * ranks / total : way == 1 ? k % ranks : ranks - 1;
    if (owner == rank) id.push_back(k);
  }
  if (way == 2) std::reverse(id.begin(), id.end());
  return id;
}
