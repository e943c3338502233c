#include <algorithm>
#include <exception>
#include <foundation/agree.hpp>
#include <foundation/waiting.hpp>
#include <limits>
#include <new>
#include <vector>

namespace tetsuame::foundation {

namespace {

std::string broadcast_from(MPI_Comm comm, int root, std::string text) {
  auto n = static_cast<std::uint64_t>(text.size());
  MPI_Bcast(&n, 1, MPI_UINT64_T, root, comm);
  text.resize(n);
  MPI_Bcast(text.data(), static_cast<int>(n), MPI_CHAR, root, comm);
  return text;
}

}  // namespace

int rank_of(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

int size_of(MPI_Comm comm) {
  int size = 1;
  MPI_Comm_size(comm, &size);
  return size;
}

void agree(MPI_Comm comm, const std::string& problem, exit_status status, std::int64_t id) {
  constexpr auto none = std::numeric_limits<std::int64_t>::max();
  const std::int64_t mine = problem.empty() ? none : id;
  std::int64_t lowest = mine;
  MPI_Allreduce(MPI_IN_PLACE, &lowest, 1, MPI_INT64_T, MPI_MIN, comm);
  if (lowest == none) return;
  int first = mine == lowest ? rank_of(comm) : size_of(comm);
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, comm);
  int code = static_cast<int>(status);
  MPI_Bcast(&code, 1, MPI_INT, first, comm);
  throw error(static_cast<exit_status>(code), broadcast_from(comm, first, problem));
}

void on_rank_0(MPI_Comm comm, const std::function<void()>& work) {
  std::string problem;
  auto status = exit_status::file_failed;
  if (rank_of(comm) == 0) {
    try {
      work();
    } catch (const error& e) {
      problem = e.what();
      status = e.status();
    } catch (const std::bad_alloc&) {
      throw;  // ends all ranks
    } catch (const std::exception& e) {
      problem = e.what();
    }
  }
  agree(comm, problem, status);
}

std::string broadcast(MPI_Comm comm, const std::string& text) { return broadcast_from(comm, 0, text); }

void sum_over_ranks(MPI_Comm comm, std::span<exact_sum> sums, std::span<double> results) {
  std::vector<std::int64_t> message;
  for (exact_sum& sum : sums) {
    sum.normalise();
    message.insert(message.end(), sum.raw().begin(), sum.raw().end());
  }
  {
    const collective timed;
    MPI_Allreduce(MPI_IN_PLACE, message.data(), static_cast<int>(message.size()), MPI_INT64_T, MPI_SUM, comm);
  }
  auto next = message.cbegin();
  for (double& result : results) {
    exact_sum total;
    for (std::int64_t& chunk : total.raw()) chunk = *next++;
    result = total.value();
  }
}

}  // namespace tetsuame::foundation
