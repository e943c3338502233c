// The few collective operations the physics needs, each with a result that does
// not depend on how the particles are spread over the ranks.
#pragma once

#include <mpi.h>

#include <concepts>
#include <cstdint>
#include <foundation/error.hpp>
#include <foundation/exact_sum.hpp>
#include <span>
#include <string>
#include <vector>

namespace tetsuame::domain {

struct communicator {
  MPI_Comm comm = MPI_COMM_WORLD;
  int rank = 0;
  int size = 1;

  static communicator world();

  // NaN on any rank comes out on all, of minimum too.
  double maximum(double value) const;
  void maximum(std::span<double> values) const;  // each by itself, in place
  double minimum(double value) const;
  std::int64_t sum(std::int64_t value) const;
  template <std::floating_point T>
  void sum(T value) const = delete;               // would be cut to an integer; exact() adds terms that are not whole
  void sum(std::span<double> values) const;       // each by itself, in place; its last bits depend on the ranks
  std::vector<double> every(double value) const;  // each rank's, by rank
  // Each rank's values, as many on all, one rank's behind the other's.
  std::vector<double> every(std::span<const double> values) const;
  double exact(foundation::exact_sum sum) const;  // the rounded sum over all ranks' terms
  std::vector<double> exact(std::span<foundation::exact_sum> sums) const;
  std::string broadcast(const std::string& text) const;  // rank 0's text

  // Each rank hands in the fault it saw, keyed by particle ID (no fault: empty text);
  // every rank throws the fault of the lowest ID, or none does.
  void agree_on_fault(std::int64_t id, const std::string& message, foundation::exit_status status) const;
};

}  // namespace tetsuame::domain
