// The index in a checkpoint's user block (the bytes before HDF5's own), by which this
// program reads the file: every byte of the file is under a checksum that is verified
// before it is used, and the HDF5 library, which may crash on a damaged file, never
// sees one. The HDF5 structure around it is for h5py, h5dump and the like.
//
//   tetsuame checkpoint 1 <checksum of all that follows in the block>
//   file <bytes> <block bytes> <checksum of all bytes outside of the block and the datasets>
//   <kind> <count> <offset> <bytes> <checksum of the values> <path>        one line a dataset
//   (zeros to the end of the block)
#pragma once

#include <mpi.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <functional>
#include <output/hash.hpp>
#include <string>
#include <utility>
#include <vector>

namespace tetsuame::output {

enum class kind { real, integer, text, blob, ids, field_real, field_integer };
inline bool is_field(kind k) { return k >= kind::ids; }

struct indexed {
  output::kind kind = kind::real;
  std::uint64_t count = 0;
  std::string path{};
  std::uint64_t offset = 0, bytes = 0;
  checksum sum{};
};

// A dataset with this rank's part of the values.
struct part {
  indexed entry;
  std::vector<std::uint64_t> words;  // the values' bits
};

template <class To, class From>
std::vector<To> same_bits(const std::vector<From>& values) {
  std::vector<To> same(values.size());
  std::transform(values.begin(), values.end(), same.begin(), [](From x) { return std::bit_cast<To>(x); });
  return same;
}

struct checkpoint_index {
  std::uint64_t file_bytes = 0, block_bytes = 0;
  checksum structure;
  std::vector<indexed> datasets;
};

// The user block that has room for the index: a power of 2, as HDF5 wants it.
std::uint64_t block_size_for(const checkpoint_index& index);
// Exactly index.block_bytes long.
std::string block_text(const checkpoint_index& index);
// The block's length, from the first 512 bytes of the file. Throws fail_file "PATH is no
// checkpoint of this program …" or "… is damaged: …".
std::uint64_t block_bytes_in(const std::string& path, const std::string& beginning);
// The whole block, its checksum verified. Throws fail_file.
checkpoint_index read_block(const std::string& path, const std::string& block);

[[noreturn]] void fail_damaged(const std::string& path, const std::string& what);

// The checksum of the bytes outside of the block and the datasets; read(from, to, bytes) fetches bytes of the file.
checksum structure_sum(const checkpoint_index& index,
                       const std::function<void(std::uint64_t, char*, std::size_t)>& read);
// Collective: the datasets' checksums become the sums over all ranks.
void sum_over_ranks(MPI_Comm comm, std::vector<indexed>& datasets);

// "/particles/fluid/rho" -> {"fluid", "rho"}; "/reals/time" -> {"", "time"}
std::pair<std::string, std::string> names_of(const indexed& d);

}  // namespace tetsuame::output
