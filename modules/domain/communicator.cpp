#include <bit>
#include <cmath>
#include <domain/communicator.hpp>
#include <foundation/agree.hpp>
#include <foundation/waiting.hpp>
#include <limits>

namespace tetsuame::domain {

namespace {

// What MPI_MAX makes of NaN is undefined. Integers in the order of the numbers: a double's bits, those of negative
// numbers counted downwards (IEEE 754), and NaN above all of them.
constexpr auto highest_key = std::numeric_limits<std::int64_t>::max();

std::int64_t key_of(double value) {
  if (std::isnan(value)) return highest_key;
  const auto bits = std::bit_cast<std::int64_t>(value);
  return bits < 0 ? bits ^ highest_key : bits;
}

double value_of(std::int64_t key) {
  if (key == highest_key) return std::numeric_limits<double>::quiet_NaN();
  return std::bit_cast<double>(key < 0 ? key ^ highest_key : key);
}

}  // namespace

communicator communicator::world() {
  communicator world;
  MPI_Comm_rank(world.comm, &world.rank);
  MPI_Comm_size(world.comm, &world.size);
  return world;
}

double communicator::maximum(double value) const {
  maximum(std::span<double>(&value, 1));
  return value;
}

void communicator::maximum(std::span<double> values) const {
  std::vector<std::int64_t> keys;
  for (const double value : values) keys.push_back(key_of(value));
  const foundation::collective timed;
  MPI_Allreduce(MPI_IN_PLACE, keys.data(), static_cast<int>(keys.size()), MPI_INT64_T, MPI_MAX, comm);
  for (std::size_t n = 0; n < keys.size(); ++n) values[n] = value_of(keys[n]);
}

double communicator::minimum(double value) const {
  const double least = -maximum(-value);
  return std::isnan(least) ? std::abs(least) : least;
}

std::int64_t communicator::sum(std::int64_t value) const {
  const foundation::collective timed;
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_INT64_T, MPI_SUM, comm);
  return value;
}

void communicator::sum(std::span<double> values) const {
  const foundation::collective timed;
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, comm);
}

std::vector<double> communicator::every(double value) const { return every(std::span<const double>(&value, 1)); }

std::vector<double> communicator::every(std::span<const double> values) const {
  std::vector<double> all(static_cast<std::size_t>(size) * values.size());
  const auto n = static_cast<int>(values.size());
  const foundation::collective timed;
  MPI_Allgather(values.data(), n, MPI_DOUBLE, all.data(), n, MPI_DOUBLE, comm);
  return all;
}

double communicator::exact(foundation::exact_sum sum) const {
  double result = 0.0;
  foundation::sum_over_ranks(comm, {&sum, 1}, {&result, 1});
  return result;
}

std::vector<double> communicator::exact(std::span<foundation::exact_sum> sums) const {
  std::vector<double> results(sums.size());
  foundation::sum_over_ranks(comm, sums, results);
  return results;
}

std::string communicator::broadcast(const std::string& text) const { return foundation::broadcast(comm, text); }

void communicator::agree_on_fault(std::int64_t id, const std::string& message, foundation::exit_status status) const {
  const foundation::collective timed;
  foundation::agree(comm, message, status, id);
}

}  // namespace tetsuame::domain
