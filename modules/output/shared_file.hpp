// What all ranks write together: particles in the order of their IDs, and an HDF5 file that takes them.
#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <output/file.hpp>
#include <output/hdf5_layout.hpp>
#include <string>
#include <vector>

namespace tetsuame::output {

// Rank r gets a contiguous slab of rows, so that files do not depend on the number of ranks and each rank writes one
// block per dataset. The range of IDs is cut into equal parts, one a rank (even slabs when IDs are dense, as they are
// here), followed by a local sort.
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

// Written under a temporary name until finish() renames it, so that a file of the final name is always whole.
class shared_file {
 public:
  // Collective: rank 0 lays out and reserves the file, all open it. The same layout is
  // given on every rank; offsets and bytes are filled in on every rank. Throws fail_file.
  shared_file(MPI_Comm comm, const std::string& path, layout& contents);
  // Without finish(): collective removal of the temporary file, the old one stays.
  ~shared_file();
  shared_file(const shared_file&) = delete;
  shared_file& operator=(const shared_file&) = delete;

  // This rank's part of a dataset, from a byte on. Never throws: what goes wrong is told by finish().
  void write(const dataset& d, std::uint64_t first_byte, const void* data, std::size_t bytes);
  // Anywhere in the file; for the user block.
  void write_raw(std::uint64_t offset, const void* data, std::size_t bytes);
  void read_raw(std::uint64_t offset, void* data, std::size_t bytes);

  std::uint64_t size() const { return size_; }
  // Collective: throws fail_file on every rank if any write failed so far.
  void check();
  // Collective: check, sync to disk, rename. Throws fail_file on every rank.
  void finish();

 private:
  MPI_Comm comm_;
  std::string path_, problem_;
  std::uint64_t size_ = 0;
  descriptor file_;
  bool finished_ = false;
};

}  // namespace tetsuame::output
