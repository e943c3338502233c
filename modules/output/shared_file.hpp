// An HDF5 file that all ranks write together: under a temporary name until finish()
// renames it, so that a file of the final name is always whole.
#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <output/file.hpp>
#include <output/hdf5_layout.hpp>
#include <string>

namespace tetsuame::output {

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
