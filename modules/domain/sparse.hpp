// Messages to a few ranks whose receivers do not know of them beforehand, without a step whose cost
// grows with the number of ranks: the non-blocking consensus of Hoefler, Siebert & Lumsdaine, "Scalable
// communication protocols for dynamic sparse data exchange", PPoPP (2010).
#pragma once

#include <algorithm>
#include <domain/communicator.hpp>
#include <foundation/waiting.hpp>
#include <vector>

namespace tetsuame::domain {

struct letter {
  int rank = 0;  // where to, or where from
  std::vector<double> values;
};

// Sends every letter to its rank (each rank at most once, this rank among them if need be); returns what came
// here, by rank. All ranks call this together, and two calls that follow each other differ in `tag`: a rank may
// be a call ahead of another.
inline std::vector<letter> sparse_exchange(const communicator& ranks, const std::vector<letter>& out, int tag) {
  std::vector<letter> in;
  std::vector<MPI_Request> sent;
  for (const letter& l : out) {
    if (l.rank == ranks.rank) {
      in.push_back(l);
      continue;
    }
    sent.emplace_back();
    // Synchronous: complete when the receiver has it.
    MPI_Issend(l.values.data(), static_cast<int>(l.values.size()), MPI_DOUBLE, l.rank, tag, ranks.comm, &sent.back());
    ++foundation::sent.letter_messages;
    foundation::sent.letter_bytes += static_cast<std::int64_t>(l.values.size() * sizeof(double));
  }
  if (ranks.size == 1) return in;
  const foundation::collective timed;
  MPI_Request barrier = MPI_REQUEST_NULL;
  bool all_mine_arrived = false;
  for (int everyone_done = 0; everyone_done == 0;) {
    int here = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, tag, ranks.comm, &here, &status);
    if (here != 0) {
      int n = 0;
      MPI_Get_count(&status, MPI_DOUBLE, &n);
      letter l{status.MPI_SOURCE, std::vector<double>(static_cast<std::size_t>(n))};
      MPI_Recv(l.values.data(), n, MPI_DOUBLE, l.rank, tag, ranks.comm, MPI_STATUS_IGNORE);
      in.push_back(std::move(l));
    }
    if (all_mine_arrived) {
      MPI_Test(&barrier, &everyone_done, MPI_STATUS_IGNORE);
      continue;
    }
    int done = 0;
    MPI_Testall(static_cast<int>(sent.size()), sent.data(), &done, MPI_STATUSES_IGNORE);
    if (done == 0) continue;
    all_mine_arrived = true;
    MPI_Ibarrier(ranks.comm, &barrier);
  }
  std::sort(in.begin(), in.end(), [](const letter& a, const letter& b) { return a.rank < b.rank; });
  return in;
}

}  // namespace tetsuame::domain
