#include <fmt/core.h>

#include <array>
#include <foundation/error.hpp>
#include <output/checkpoint_index.hpp>
#include <sstream>

namespace tetsuame::output {

namespace {

constexpr std::string_view magic = "tetsuame checkpoint 1 ";
constexpr std::size_t body_start = magic.size() + 33;  // after 32 digits and the end of the line
constexpr const char* index_name = "the index at its beginning";
constexpr std::uint64_t largest_block = std::uint64_t{1} << 28;  // no index is longer; a damaged length might be
constexpr std::array kind_names = {"real", "integer", "text", "blob", "ids", "field_real", "field_integer"};

std::string body_of(const checkpoint_index& index) {
  auto text = fmt::format("file {} {} {}\n", index.file_bytes, index.block_bytes, hex(index.structure));
  for (const auto& d : index.datasets)
    text += fmt::format("{} {} {} {} {} {}\n", kind_names[static_cast<std::size_t>(d.kind)], d.count, d.offset, d.bytes,
                        hex(d.sum), d.path);
  return text;
}

bool parse_line(const std::string& line, indexed& d) {
  std::istringstream in(line);
  std::string name, digits;
  in >> name >> d.count >> d.offset >> d.bytes >> digits;
  if (!in || !parse_hex(digits, d.sum) || in.get() != ' ' || !std::getline(in, d.path)) return false;
  const auto found = std::find(kind_names.begin(), kind_names.end(), name);
  d.kind = static_cast<kind>(found - kind_names.begin());
  return found != kind_names.end();
}

bool parse_head(std::istream& in, checkpoint_index& index) {
  std::string line, word, digits;
  if (!std::getline(in, line)) return false;
  std::istringstream head(line);
  head >> word >> index.file_bytes >> index.block_bytes >> digits;
  return head && word == "file" && parse_hex(digits, index.structure);
}

// Also what a checksum cannot vouch for if a file was made by other means.
bool sensible(const checkpoint_index& index, const indexed& d) {
  const bool text = d.kind == kind::text;
  return d.bytes == (text ? std::max<std::uint64_t>(1, d.count) : 8 * d.count) && d.count <= index.file_bytes &&
         d.bytes <= index.file_bytes && d.offset <= index.file_bytes - d.bytes &&
         (d.bytes == 0 || d.offset >= index.block_bytes);
}

}  // namespace

std::uint64_t block_size_for(const checkpoint_index& index) {
  checkpoint_index widest = index;
  widest.file_bytes = widest.block_bytes = UINT64_MAX;
  for (auto& d : widest.datasets) d.count = d.offset = d.bytes = UINT64_MAX;
  return std::max<std::uint64_t>(512, std::bit_ceil(body_start + body_of(widest).size()));
}

std::string block_text(const checkpoint_index& index) {
  std::string body = body_of(index);
  body.resize(index.block_bytes - body_start, '\0');
  return fmt::format("{}{}\n", magic, hex(sum_of(body))) + body;
}

void fail_damaged(const std::string& path, const std::string& what) {
  foundation::fail_file(fmt::format("checkpoint {} is damaged: {}", path, what));
}

std::uint64_t block_bytes_in(const std::string& path, const std::string& beginning) {
  if (beginning.size() < 512 || !beginning.starts_with(magic))
    foundation::fail_file(fmt::format("{} is no checkpoint of this program, or its beginning is lost", path));
  checkpoint_index index;
  std::istringstream in(beginning.substr(body_start));
  if (!parse_head(in, index) || index.block_bytes < 512 || index.block_bytes > largest_block ||
      !std::has_single_bit(index.block_bytes))
    fail_damaged(path, index_name);
  return index.block_bytes;
}

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

void sum_over_ranks(MPI_Comm comm, std::vector<indexed>& datasets) {
  std::vector<std::uint64_t> lanes;
  for (const auto& d : datasets) lanes.insert(lanes.end(), {d.sum.a, d.sum.b});
  MPI_Allreduce(MPI_IN_PLACE, lanes.data(), static_cast<int>(lanes.size()), MPI_UINT64_T, MPI_SUM, comm);
  for (std::size_t k = 0; k < datasets.size(); ++k) datasets[k].sum = {lanes[2 * k], lanes[2 * k + 1]};
}

std::pair<std::string, std::string> names_of(const indexed& d) {
  const auto last = d.path.rfind('/');
  const std::string folder = d.path.substr(0, last);
  return {is_field(d.kind) ? folder.substr(folder.rfind('/') + 1) : "", d.path.substr(last + 1)};
}

}  // namespace tetsuame::output
