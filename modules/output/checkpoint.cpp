#include <fcntl.h>
#include <fmt/core.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <foundation/agree.hpp>
#include <foundation/error.hpp>
#include <functional>
#include <output/checkpoint.hpp>
#include <output/checkpoint_index.hpp>
#include <output/directory.hpp>
#include <output/file.hpp>
#include <output/order.hpp>
#include <output/shared_file.hpp>

namespace tetsuame::output {

namespace {

// By kind.
constexpr std::array elements{element::real,    element::integer, element::text,   element::real,
                              element::integer, element::real,    element::integer};

dataset dataset_for(const indexed& d) {
  std::vector<std::uint64_t> shape{d.count};
  if (d.kind == kind::real || d.kind == kind::integer) shape.clear();
  return {d.path, elements[static_cast<std::size_t>(d.kind)], shape, {}};
}

// A dataset of the file, and how this rank comes to the bits of its part: of a table, which takes all ranks, or of all
// the rest, which rank 0 alone writes.
struct source {
  indexed entry;
  std::uint64_t first_word;
  std::function<std::vector<std::uint64_t>()> words;
};

std::vector<source> global_sources(const checkpoint_globals& globals) {
  std::vector<source> all;
  const auto add = [&](kind what, std::uint64_t count, const std::string& path, std::vector<std::uint64_t> words) {
    const indexed entry{what, count, path};
    all.push_back({entry, 0, [words = std::move(words)] { return words; }});
  };
  for (const auto& [name, x] : globals.reals) add(kind::real, 1, "/reals/" + name, {std::bit_cast<std::uint64_t>(x)});
  for (const auto& [name, x] : globals.integers)
    add(kind::integer, 1, "/integers/" + name, {static_cast<std::uint64_t>(x)});
  for (const auto& [name, text] : globals.texts) {
    std::vector<std::uint64_t> words(std::max<std::size_t>(1, (text.size() + 7) / 8), 0);
    std::memcpy(words.data(), text.data(), text.size());
    add(kind::text, text.size(), "/texts/" + name, std::move(words));
  }
  for (const auto& [name, values] : globals.blobs)
    add(kind::blob, values.size(), "/blobs/" + name, same_bits<std::uint64_t>(values));
  return all;
}

void add_table(const table_view& t, const id_order& order, std::vector<source>& all) {
  const auto add = [&](kind what, const std::string& name, const auto& values) {
    const indexed entry{what, order.total_rows, "/particles/" + t.name + "/" + name};
    all.push_back({entry, order.first_row, [values] { return same_bits<std::uint64_t>(values()); }});
  };
  add(kind::ids, "ids", [&order] { return order.ids; });
  for (const auto& field : t.reals)
    add(kind::field_real, field.first, [&order, x = field.second] { return arrange(order, x); });
  for (const auto& field : t.integers)
    add(kind::field_integer, field.first, [&order, x = field.second] { return arrange(order, x); });
}

// Everything outside of the datasets is HDF5's own by now, and rank 0 has written it.
void write_index(MPI_Comm comm, shared_file& file, const layout& contents, checkpoint_index& index) {
  index.file_bytes = file.size();
  index.block_bytes = contents.user_block;
  for (std::size_t k = 0; k < index.datasets.size(); ++k) {
    index.datasets[k].offset = contents.datasets[k].offset;
    index.datasets[k].bytes = contents.datasets[k].bytes;
  }
  sum_over_ranks(comm, index.datasets);
  if (foundation::rank_of(comm) != 0) return;
  index.structure =
      structure_sum(index, [&](std::uint64_t at, char* to, std::size_t bytes) { file.read_raw(at, to, bytes); });
  const auto block = block_text(index);
  file.write_raw(0, block.data(), block.size());
}

void keep_two(const std::string& directory, std::int64_t step) {
  auto files = numbered_files(directory, "checkpoint_", ".h5");
  // A later step is of a course that was given up: time only moves forward.
  const auto previous = std::find_if(files.rbegin(), files.rend(), [&](const auto& f) { return f.first < step; });
  for (const auto& [number, name] : files)
    if (number != step && (previous == files.rend() || number != previous->first))
      remove_quietly((std::filesystem::path(directory) / name).string());
}

// Rank 0: the index and the structure around the datasets, verified. Returns the block.
std::string read_verified_block(const std::string& path) {
  const descriptor file(path, O_RDONLY);
  const auto size = size_of(file, path);
  auto block = beginning_of(path, block_bytes_in(path, beginning_of(path, 512)));

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
  const auto rank = static_cast<std::uint64_t>(foundation::rank_of(comm)),
             ranks = static_cast<std::uint64_t>(foundation::size_of(comm));
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

std::string checkpoint_name(std::int64_t step) { return fmt::format("checkpoint_{:08}.h5", step); }

std::string write_checkpoint(MPI_Comm comm, const std::string& directory, std::int64_t step,
                             const checkpoint_globals& globals, const std::vector<table_view>& tables) {
  auto path = (std::filesystem::path(directory) / checkpoint_name(step)).string();
  std::vector<id_order> orders;
  for (const auto& t : tables) orders.push_back(order_by_id(comm, t.n, t.ids));

  auto sources = global_sources(globals);
  for (std::size_t t = 0; t < tables.size(); ++t) add_table(tables[t], orders[t], sources);

  checkpoint_index index;
  for (const auto& s : sources) index.datasets.push_back(s.entry);
  layout contents;
  contents.user_block = block_size_for(index);
  for (const auto& d : index.datasets) contents.datasets.push_back(dataset_for(d));

  shared_file file(comm, path, contents);
  for (std::size_t k = 0; k < sources.size(); ++k) {
    const auto& d = contents.datasets[k];
    const auto words = sources[k].words();
    if (!is_field(sources[k].entry.kind) && foundation::rank_of(comm) != 0) continue;
    const std::uint64_t first_byte = 8 * sources[k].first_word;
    const auto bytes = std::min<std::uint64_t>(8 * words.size(), d.bytes - first_byte);
    file.write(d, first_byte, words.data(), bytes);
    add_bytes(index.datasets[k].sum, sources[k].first_word, words.data(), bytes);
  }
  write_index(comm, file, contents, index);
  file.finish();
  foundation::on_rank_0(comm, [&] { keep_two(directory, step); });
  return path;
}

void forget_checkpoints_after(MPI_Comm comm, const std::string& directory, std::int64_t step) {
  foundation::on_rank_0(comm, [&] {
    for (const auto& [number, name] : numbered_files(directory, "checkpoint_", ".h5"))
      if (number > step) remove_quietly((std::filesystem::path(directory) / name).string());
  });
}

checkpoint read_checkpoint(MPI_Comm comm, const std::string& path) {
  std::string block;
  foundation::on_rank_0(comm, [&] { block = read_verified_block(path); });
  block = foundation::broadcast(comm, block);

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
  foundation::agree(comm, problem);

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
  foundation::on_rank_0(comm, [&] {
    for (const auto& [number, name] : numbered_files(directory, "checkpoint_", ".h5")) list = name + "\n" + list;
  });
  list = foundation::broadcast(comm, list);

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
