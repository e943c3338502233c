#include <algorithm>
#include <cstdint>
#include <foundation/waiting.hpp>
#include <integrators/reduce.hpp>
#include <vector>

namespace tetsuame::integrators {

namespace {

double extremum(MPI_Comm communicator, double value, MPI_Op operation) {
  const foundation::collective timed;
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, operation, communicator);
  return value;
}

}  // namespace

void exact_allreduce(MPI_Comm communicator, std::span<foundation::exact_sum> sums, std::span<double> results) {
  const std::size_t width = foundation::exact_sum{}.raw().size();
  std::vector<std::int64_t> message(width * sums.size());
  for (std::size_t k = 0; k < sums.size(); ++k) {
    sums[k].normalise();
    std::ranges::copy(sums[k].raw(), message.begin() + static_cast<std::ptrdiff_t>(k * width));
  }
  {
    const foundation::collective timed;
    MPI_Allreduce(MPI_IN_PLACE, message.data(), static_cast<int>(message.size()), MPI_INT64_T, MPI_SUM, communicator);
  }
  for (std::size_t k = 0; k < sums.size(); ++k) {
    foundation::exact_sum total;
    std::copy_n(message.begin() + static_cast<std::ptrdiff_t>(k * width), width, total.raw().begin());
    results[k] = total.value();
  }
}

double maximum_allreduce(MPI_Comm communicator, double value) { return extremum(communicator, value, MPI_MAX); }
double minimum_allreduce(MPI_Comm communicator, double value) { return extremum(communicator, value, MPI_MIN); }

int worst_allreduce(MPI_Comm communicator, int status) {
  int extremes[2] = {status, -status};
  const foundation::collective timed;
  MPI_Allreduce(MPI_IN_PLACE, extremes, 2, MPI_INT, MPI_MAX, communicator);
  return extremes[1] > 0 ? -extremes[1] : extremes[0];
}

}  // namespace tetsuame::integrators
