// Particles in the order of their IDs over all ranks: rank r gets a contiguous slab of
// rows, so that files do not depend on the number of ranks and each rank writes one
// block per dataset. The range of IDs is cut into equal parts, one a rank (even slabs
// when IDs are dense, as they are here), followed by a local sort.
#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetsuame::output {

struct id_order {
  MPI_Comm comm = MPI_COMM_NULL;
  std::vector<int> send_counts, send_offsets, receive_counts, receive_offsets;
  std::vector<std::size_t> send_from;  // local particle that stands at each place of the send buffer
  std::vector<std::size_t> take;       // received value that belongs in each row of the slab
  std::uint64_t first_row = 0;         // of this rank's slab
  std::uint64_t total_rows = 0;        // over all ranks
  std::vector<std::int64_t> ids;       // of the slab, ascending

  std::size_t rows() const { return take.size(); }
};

// Collective. Throws fail_calculation on every rank if an ID occurs twice.
id_order order_by_id(MPI_Comm comm, std::size_t n, const std::int64_t* ids);

// Collective. Local values in, this rank's slab out.
std::vector<double> arrange(const id_order& order, const double* values);
std::vector<std::int64_t> arrange(const id_order& order, const std::int64_t* values);

}  // namespace tetsuame::output
