// Numbers that depend on a particle's ID alone, their bits, and values of all ranks, for tests with MPI.
#pragma once

#include <algorithm>
#include <bit>
#include <boost/test/unit_test.hpp>
#include <cstdint>
#include <domain/communicator.hpp>
#include <vector>

#include "mpi.hpp"

namespace tetsuame::test {

inline domain::communicator alone() { return {MPI_COMM_SELF, 0, 1}; }
inline std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }

// A number in [-1, 1) of a particle's ID and a salt (SplitMix64's finaliser).
inline double noise(std::int64_t id, std::uint64_t salt) {
  std::uint64_t z = (static_cast<std::uint64_t>(id) + 1) * 0x9e3779b97f4a7c15U + salt * 0xd1342543de82ef95U;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
  z ^= z >> 31;
  return static_cast<double>(z >> 11) * 0x1p-52 - 1.0;
}

// Every rank's values, in rank order.
inline std::vector<double> of_all_ranks(const domain::communicator& ranks, const std::vector<double>& mine) {
  const int n = static_cast<int>(mine.size());
  std::vector<int> counts(static_cast<std::size_t>(ranks.size)), starts(counts.size(), 0);
  MPI_Allgather(&n, 1, MPI_INT, counts.data(), 1, MPI_INT, ranks.comm);
  for (std::size_t r = 1; r < counts.size(); ++r) starts[r] = starts[r - 1] + counts[r - 1];
  std::vector<double> all(static_cast<std::size_t>(starts.back() + counts.back()));
  MPI_Allgatherv(mine.data(), n, MPI_DOUBLE, all.data(), counts.data(), starts.data(), MPI_DOUBLE, ranks.comm);
  return all;
}

inline bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() &&
         std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) { return bits(x) == bits(y); });
}

}  // namespace tetsuame::test

using tetsuame_test_environment = tetsuame::test::mpi_environment;
BOOST_TEST_GLOBAL_FIXTURE(tetsuame_test_environment);
