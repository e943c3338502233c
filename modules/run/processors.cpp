#include <fmt/format.h>
#include <omp.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <run/processors.hpp>
#include <vector>

namespace tetsuame::run {

namespace {

// Of the machine that this rank is on.
struct share {
  int ranks = 1, threads = 1, processors = 1;  // threads of all these ranks; what one of them at least may run on
};

share share_here(const domain::communicator& ranks) {
  share here;
  MPI_Comm machine = MPI_COMM_NULL;
  MPI_Comm_split_type(ranks.comm, MPI_COMM_TYPE_SHARED, ranks.rank, MPI_INFO_NULL, &machine);
  MPI_Comm_size(machine, &here.ranks);
  here.threads = omp_get_max_threads();
  MPI_Allreduce(MPI_IN_PLACE, &here.threads, 1, MPI_INT, MPI_SUM, machine);
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0)
    std::fill_n(reinterpret_cast<char*>(&allowed), sizeof allowed, '\xff');
  MPI_Allreduce(MPI_IN_PLACE, &allowed, static_cast<int>(sizeof allowed), MPI_BYTE, MPI_BOR, machine);
  here.processors = std::max(1, CPU_COUNT(&allowed));
  MPI_Comm_free(&machine);
  return here;
}

}  // namespace

std::string crowded_processors(const domain::communicator& ranks) {
  const share here = share_here(ranks);
  const auto crowding = ranks.every(static_cast<double>(here.threads) / here.processors);
  const auto worst = std::ranges::max_element(crowding);
  std::array<int, 3> told{here.ranks, here.threads, here.processors};
  MPI_Bcast(told.data(), 3, MPI_INT, static_cast<int>(worst - crowding.begin()), ranks.comm);
  const auto [of_ranks, threads, processors] = told;
  if (threads <= processors) return "";
  const auto have = fmt::format("{} threads of {} rank{} on {} processor{}, where they wait for each other", threads,
                                of_ranks, of_ranks > 1 ? "s" : "", processors, processors > 1 ? "s" : "");
  return of_ranks > processors ? have + fmt::format(": take at most {} ranks a machine", processors)
                               : have + fmt::format(": set OMP_NUM_THREADS={}", processors / of_ranks);
}

}  // namespace tetsuame::run
