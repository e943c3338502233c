#include <fcntl.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <filesystem>
#include <foundation/agree.hpp>
#include <functional>
#include <output/checkpoint.hpp>
#include <output/directory.hpp>
#include <output/hash.hpp>
#include <output/shared_file.hpp>
#include <sstream>

namespace tetsuame::output {

namespace {

namespace fs = std::filesystem;

// ---- the index ----------------------------------------------------------------------------
//
// By the index in the user block (the bytes before HDF5's own) this program reads the file: every byte is under a
// checksum that is verified before it is used, and the HDF5 library, which may crash on a damaged file, never sees one.
// The HDF5 structure around it is for h5py, h5dump and the like.
//
//   tetsuame checkpoint 1 <checksum of all that follows in the block>
//   file <bytes> <block bytes> <checksum of all bytes outside of the block and the datasets>
//   <kind> <count> <offset> <bytes> <checksum of the values> <path>        one line a dataset
//   (zeros to the end of the block)

constexpr std::string_view magic = "tetsuame checkpoint 1 ";
constexpr std::size_t body_start = magic.size() + 33;  // after 32 digits and the end of the line
constexpr const char* index_name = "the index at its beginning";
constexpr std::uint64_t smallest_block = 512;                    // which HDF5 wants to be a power of 2
constexpr std::uint64_t largest_block = std::uint64_t{1} << 28;  // no index is longer; a damaged length might be

enum class kind { real, integer, text, blob, ids, field_real, field_integer };
bool is_field(kind k) { return k >= kind::ids; }

// By kind.
constexpr std::array kind_names = {"real", "integer", "text", "blob", "ids", "field_real", "field_integer"};
constexpr std::array elements = {element::real,    element::integer, element::text,   element::real,
                                 element::integer, element::real,    element::integer};

struct indexed {
  kind what = kind::real;
  std::uint64_t count = 0;
  std::string path{};
  std::uint64_t offset = 0, bytes = 0;
  checksum sum{};
};

struct checkpoint_index {
  std::uint64_t file_bytes = 0, block_bytes = 0;
  checksum structure;
  std::vector<indexed> datasets;
};

[[noreturn]] void fail_damaged(const std::string& path, const std::string& what) {
  foundation::fail_file(fmt::format("checkpoint {} is damaged: {}", path, what));
}

std::string body_of(const checkpoint_index& index) {
  auto text = fmt::format("file {} {} {}\n", index.file_bytes, index.block_bytes, hex(index.structure));
  for (const auto& d : index.datasets)
    text += fmt::format("{} {} {} {} {} {}\n", kind_names[static_cast<std::size_t>(d.what)], d.count, d.offset, d.bytes,
                        hex(d.sum), d.path);
  return text;
}

bool parse_line(const std::string& line, indexed& d) {
  std::istringstream in(line);
  std::string name, digits;
  in >> name >> d.count >> d.offset >> d.bytes >> digits;
  if (!in || !parse_hex(digits, d.sum) || in.get() != ' ' || !std::getline(in, d.path)) return false;
  const auto found = std::find(kind_names.begin(), kind_names.end(), name);
  d.what = static_cast<kind>(found - kind_names.begin());
  return found != kind_names.end();
}

bool parse_head(std::istream& in, checkpoint_index& index) {
  std::string word, digits;
  in >> word >> index.file_bytes >> index.block_bytes >> digits;
  return in.get() == '\n' && word == "file" && parse_hex(digits, index.structure);
}

// Also what a checksum cannot vouch for if a file was made by other means.
bool sensible(const checkpoint_index& index, const indexed& d) {
  const bool text = d.what == kind::text;
  return d.bytes == (text ? std::max<std::uint64_t>(1, d.count) : 8 * d.count) && d.count <= index.file_bytes &&
         d.bytes <= index.file_bytes && d.offset <= index.file_bytes - d.bytes &&
         (d.bytes == 0 || d.offset >= index.block_bytes);
}

// The user block that has room for the index.
std::uint64_t block_size_for(const checkpoint_index& index) {
  checkpoint_index widest = index;
  widest.file_bytes = widest.block_bytes = UINT64_MAX;
  for (auto& d : widest.datasets) d.count = d.offset = d.bytes = UINT64_MAX;
  return std::max<std::uint64_t>(smallest_block, std::bit_ceil(body_start + body_of(widest).size()));
}

// Exactly index.block_bytes long.
std::string block_text(const checkpoint_index& index) {
  std::string body = body_of(index);
  body.resize(index.block_bytes - body_start, '\0');
  return fmt::format("{}{}\n", magic, hex(sum_of(body))) + body;
}

// The block's length, from the beginning of the file.
std::uint64_t block_bytes_in(const std::string& path, const std::string& beginning) {
  if (beginning.size() < smallest_block || !beginning.starts_with(magic))
    foundation::fail_file(fmt::format("{} is no checkpoint of this program, or its beginning is lost", path));
  checkpoint_index index;
  std::istringstream in(beginning.substr(body_start));
  if (!parse_head(in, index) || index.block_bytes < smallest_block || index.block_bytes > largest_block ||
      !std::has_single_bit(index.block_bytes))
    fail_damaged(path, index_name);
  return index.block_bytes;
}

// The whole block, its checksum verified.
checkpoint_index read_block(const std::string& path, const std::string& block) {
  checksum told;
  if (!parse_hex(block.substr(magic.size(), 32), told) || block[body_start - 1] != '\n' ||
      sum_of(block.substr(body_start)) != told)
    fail_damaged(path, index_name);
  checkpoint_index index;
  std::istringstream in(block.substr(body_start));
  if (!parse_head(in, index)) fail_damaged(path, index_name);
  for (std::string line; std::getline(in, line) && !line.starts_with('\0');) {
    indexed d;
    if (!parse_line(line, d) || !sensible(index, d)) fail_damaged(path, index_name);
    index.datasets.push_back(d);
  }
  return index;
}

// Of the bytes outside of the block and the datasets; read(from, to, bytes) fetches bytes of the file.
checksum structure_sum(const checkpoint_index& index,
                       const std::function<void(std::uint64_t, char*, std::size_t)>& read) {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> taken = {{0, index.block_bytes}};
  for (const auto& d : index.datasets) taken.push_back({d.offset, d.offset + d.bytes});
  taken.push_back({index.file_bytes, index.file_bytes});
  std::sort(taken.begin(), taken.end());
  constexpr std::size_t piece_bytes = std::size_t{1} << 20;
  checksum sum;
  std::uint64_t word = 0, at = 0;
  std::vector<char> buffer(piece_bytes);
  for (const auto& [from, to] : taken) {
    while (at < from) {
      const auto bytes = std::min<std::uint64_t>(piece_bytes, from - at);
      read(at, buffer.data(), bytes);
      add_bytes(sum, word, buffer.data(), bytes);
      word += (bytes + 7) / 8;
      at += bytes;
    }
    at = std::max(at, to);
  }
  return sum;
}

// Collective: the datasets' checksums become the sums over all ranks.
void sum_over_ranks(MPI_Comm comm, std::vector<indexed>& datasets) {
  std::vector<std::uint64_t> lanes;
  for (const auto& d : datasets) lanes.insert(lanes.end(), {d.sum.a, d.sum.b});
  MPI_Allreduce(MPI_IN_PLACE, lanes.data(), static_cast<int>(lanes.size()), MPI_UINT64_T, MPI_SUM, comm);
  for (std::size_t k = 0; k < datasets.size(); ++k) datasets[k].sum = {lanes[2 * k], lanes[2 * k + 1]};
}

// ---- writing ------------------------------------------------------------------------------

template <class To, class From>
std::vector<To> same_bits(const std::vector<From>& values) {
  std::vector<To> same(values.size());
  std::transform(values.begin(), values.end(), same.begin(), [](From x) { return std::bit_cast<To>(x); });
  return same;
}

dataset dataset_for(const indexed& d) {
  std::vector<std::uint64_t> shape{d.count};
  if (d.what == kind::real || d.what == kind::integer) shape.clear();
  return {d.path, elements[static_cast<std::size_t>(d.what)], shape, {}};
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
      remove_quietly((fs::path(directory) / name).string());
}

// ---- reading ------------------------------------------------------------------------------

// Rank 0: the index and the structure around the datasets, verified. Returns the block.
std::string read_verified_block(const std::string& path) {
  const descriptor file(path, O_RDONLY);
  const auto size = size_of(file, path);
  auto block = beginning_of(path, block_bytes_in(path, beginning_of(path, smallest_block)));

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

// The bits of this rank's rows of a field, or of the whole of anything else. The checksum becomes that of the bytes
// read (of the whole once summed over ranks).
std::vector<std::uint64_t> read_words(std::uint64_t rank, std::uint64_t ranks, const descriptor& file,
                                      const std::string& path, indexed& d) {
  std::uint64_t first = 0, bytes = d.bytes;
  if (is_field(d.what)) {
    first = slab_start(d.count, rank, ranks);
    bytes = 8 * (slab_start(d.count, rank + 1, ranks) - first);
  }
  std::vector<std::uint64_t> words((bytes + 7) / 8);
  read_at(file, path, words.data(), bytes, d.offset + 8 * first);
  d.sum = {};
  if (is_field(d.what) || rank == 0) add_bytes(d.sum, first, words.data(), bytes);
  return words;
}

void hand_out(const indexed& d, const std::vector<std::uint64_t>& words, checkpoint& state) {
  const fs::path path = d.path;  // /reals/NAME, /particles/TABLE/NAME
  const auto name = path.filename().string();
  auto& g = state.globals;
  if (d.what == kind::real)
    g.reals[name] = std::bit_cast<double>(words.at(0));
  else if (d.what == kind::integer)
    g.integers[name] = static_cast<std::int64_t>(words.at(0));
  else if (d.what == kind::text)
    g.texts[name] = std::string(reinterpret_cast<const char*>(words.data()), d.count);
  else if (d.what == kind::blob)
    g.blobs[name] = same_bits<double>(words);
  if (!is_field(d.what)) return;
  auto& table = state.tables[path.parent_path().filename().string()];
  if (d.what == kind::ids)
    table.ids = same_bits<std::int64_t>(words);
  else if (d.what == kind::field_integer)
    table.integers[name] = same_bits<std::int64_t>(words);
  else
    table.reals[name] = same_bits<double>(words);
}

}  // namespace

std::string checkpoint_name(std::int64_t step) { return fmt::format("checkpoint_{:08}.h5", step); }

std::string write_checkpoint(MPI_Comm comm, const std::string& directory, std::int64_t step,
                             const checkpoint_globals& globals, const std::vector<table_view>& tables) {
  auto path = (fs::path(directory) / checkpoint_name(step)).string();
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
    if (!is_field(sources[k].entry.what) && foundation::rank_of(comm) != 0) continue;
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
      if (number > step) remove_quietly((fs::path(directory) / name).string());
  });
}

checkpoint read_checkpoint(MPI_Comm comm, const std::string& path) {
  std::string block;
  foundation::on_rank_0(comm, [&] { block = read_verified_block(path); });
  block = foundation::broadcast(comm, block);

  const auto index = read_block(path, block);
  auto found = index.datasets;
  std::vector<std::vector<std::uint64_t>> words;
  std::string problem;
  try {
    const descriptor file(path, O_RDONLY);
    for (auto& d : found)
      words.push_back(read_words(static_cast<std::uint64_t>(foundation::rank_of(comm)),
                                 static_cast<std::uint64_t>(foundation::size_of(comm)), file, path, d));
  } catch (const std::exception& e) {
    problem = e.what();
  }
  foundation::agree(comm, problem);

  sum_over_ranks(comm, found);
  for (std::size_t k = 0; k < found.size(); ++k)
    if (!(found[k].sum == index.datasets[k].sum)) fail_damaged(path, "dataset " + found[k].path);

  checkpoint state;
  for (std::size_t k = 0; k < found.size(); ++k) hand_out(found[k], words[k], state);
  return state;
}

checkpoint_globals read_globals(const std::string& path) {
  const auto index = read_block(path, read_verified_block(path));
  const descriptor file(path, O_RDONLY);
  checkpoint state;
  for (auto d : index.datasets) {
    if (is_field(d.what)) continue;
    const auto told = d.sum;
    const auto words = read_words(0, 1, file, path, d);
    if (!(d.sum == told)) fail_damaged(path, "dataset " + d.path);
    hand_out(d, words, state);
  }
  return state.globals;
}

namespace {

[[noreturn]] void fail_without_checkpoint(const std::string& directory, const std::string& reasons) {
  if (reasons.empty())
    foundation::fail_file(fmt::format(
        "there is no checkpoint in {}: without --restart, or with --force, the run starts anew", directory));
  foundation::fail_file(fmt::format("no usable checkpoint in {}{}", directory, reasons));
}

}  // namespace

checkpoint_globals newest_globals(const std::string& directory) {
  std::string reasons;
  const auto files = numbered_files(directory, "checkpoint_", ".h5");
  for (auto file = files.rbegin(); file != files.rend(); ++file) try {
      return read_globals((fs::path(directory) / file->second).string());
    } catch (const foundation::error& e) {
      reasons += fmt::format("; {}", e.what());
    }
  fail_without_checkpoint(directory, reasons);
}

latest_checkpoint find_latest(MPI_Comm comm, const std::string& directory) {
  std::string list;
  foundation::on_rank_0(comm, [&] {
    for (const auto& [number, name] : numbered_files(directory, "checkpoint_", ".h5")) list = name + "\n" + list;
  });
  std::istringstream names(foundation::broadcast(comm, list));

  latest_checkpoint found;
  std::string reasons;
  for (std::string name; std::getline(names, name);) {
    try {
      found.path = (fs::path(directory) / name).string();
      found.state = read_checkpoint(comm, found.path);
      return found;
    } catch (const foundation::error& e) {
      found.messages.push_back(fmt::format("{}; trying the one before", e.what()));
      reasons += fmt::format("; {}", e.what());
    }
  }
  fail_without_checkpoint(directory, reasons);
}

}  // namespace tetsuame::output
