#include <fcntl.h>
#include <fmt/core.h>

#include <filesystem>
#include <foundation/error.hpp>
#include <output/agree.hpp>
#include <output/checkpoint.hpp>
#include <output/checkpoint_index.hpp>
#include <output/directory.hpp>
#include <output/file.hpp>

namespace tetsuame::output {

namespace {

// Rank 0: the index and the structure around the datasets, verified. Returns the block.
std::string read_verified_block(const std::string& path) {
  const descriptor file(path, O_RDONLY);
  const auto size = size_of(file, path);
  const auto block = beginning_of(path, block_bytes_in(path, beginning_of(path, 512)));

  const auto index = read_block(path, block);
  if (index.file_bytes != size)
    fail_damaged(path, fmt::format("it has {} bytes where its index says {}", size, index.file_bytes));
  const auto sum =
      structure_sum(index, [&](std::uint64_t at, char* to, std::size_t bytes) { read_at(file, path, to, bytes, at); });
  if (!(sum == index.structure)) fail_damaged(path, "the HDF5 structure around its datasets");
  return block;
}

std::uint64_t slab_start(std::uint64_t rows, std::uint64_t rank, std::uint64_t ranks) {
  return rows / ranks * rank + std::min(rank, rows % ranks);
}

// This rank's rows of a field, or the whole of anything else, with the checksum of the
// bytes read (of the whole once summed over ranks).
part read_part(MPI_Comm comm, const descriptor& file, const std::string& path, const indexed& d) {
  const auto rank = static_cast<std::uint64_t>(rank_of(comm)), ranks = static_cast<std::uint64_t>(size_of(comm));
  part p{d, {}};
  p.entry.sum = {};
  std::uint64_t first = 0, bytes = d.bytes;
  if (is_field(d.kind)) {
    first = slab_start(d.count, rank, ranks);
    bytes = 8 * (slab_start(d.count, rank + 1, ranks) - first);
  }
  p.words.resize((bytes + 7) / 8);
  read_at(file, path, p.words.data(), bytes, d.offset + 8 * first);
  if (is_field(d.kind) || rank == 0) add_bytes(p.entry.sum, first, p.words.data(), bytes);
  return p;
}

void hand_out(const part& p, checkpoint& state) {
  const auto [table_name, name] = names_of(p.entry);
  const kind what = p.entry.kind;
  auto& g = state.globals;
  if (what == kind::text)
    g.texts[name] = std::string(reinterpret_cast<const char*>(p.words.data()), p.entry.count);
  else if (what == kind::integer)
    g.integers[name] = static_cast<std::int64_t>(p.words.at(0));
  else if (what == kind::ids)
    state.tables[table_name].ids = same_bits<std::int64_t>(p.words);
  else if (what == kind::field_integer)
    state.tables[table_name].integers[name] = same_bits<std::int64_t>(p.words);
  else if (what == kind::field_real)
    state.tables[table_name].reals[name] = same_bits<double>(p.words);
  else if (what == kind::real)
    g.reals[name] = std::bit_cast<double>(p.words.at(0));
  else
    g.blobs[name] = same_bits<double>(p.words);
}

}  // namespace

checkpoint read_checkpoint(MPI_Comm comm, const std::string& path) {
  std::string block;
  on_rank_0(comm, [&] { block = read_verified_block(path); });
  block = broadcast(comm, block);

  std::vector<part> parts;
  std::vector<indexed> sums;
  std::string problem;
  checkpoint_index index;
  try {
    index = read_block(path, block);
    const descriptor file(path, O_RDONLY);
    for (const auto& d : index.datasets) parts.push_back(read_part(comm, file, path, d));
  } catch (const std::exception& e) {
    problem = e.what();
  }
  agree(comm, problem);

  for (const auto& p : parts) sums.push_back(p.entry);
  sum_over_ranks(comm, sums);
  for (std::size_t k = 0; k < sums.size(); ++k)
    if (!(sums[k].sum == index.datasets[k].sum)) fail_damaged(path, "dataset " + sums[k].path);

  checkpoint state;
  for (const auto& p : parts) hand_out(p, state);
  return state;
}

latest_checkpoint find_latest(MPI_Comm comm, const std::string& directory) {
  std::string list;
  on_rank_0(comm, [&] {
    for (const auto& [number, name] : numbered_files(directory, "checkpoint_", ".h5")) list = name + "\n" + list;
  });
  list = broadcast(comm, list);

  latest_checkpoint found;
  std::string reasons;
  for (std::size_t at = 0; at < list.size(); at = list.find('\n', at) + 1) {
    const auto name = list.substr(at, list.find('\n', at) - at);
    try {
      found.path = (std::filesystem::path(directory) / name).string();
      found.state = read_checkpoint(comm, found.path);
      return found;
    } catch (const foundation::error& e) {
      found.messages.push_back(fmt::format("{}; trying the one before", e.what()));
      reasons += fmt::format("; {}", e.what());
    }
  }
  if (reasons.empty())
    foundation::fail_file(fmt::format(
        "there is no checkpoint in {}: without --restart, or with --force, the run starts anew", directory));
  foundation::fail_file(fmt::format("no usable checkpoint in {}{}", directory, reasons));
}

}  // namespace tetsuame::output
