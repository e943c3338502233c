#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <output/hash.hpp>

namespace tetsuame::output {

void add_bytes(checksum& sum, std::uint64_t first_word, const void* data, std::size_t bytes) {
  const auto* from = static_cast<const char*>(data);
  for (std::size_t at = 0; at < bytes; at += sizeof(std::uint64_t)) {
    std::uint64_t word = 0;
    std::memcpy(&word, from + at, std::min(sizeof word, bytes - at));
    sum.add_word(first_word + at / sizeof word, word);
  }
}

checksum sum_over_ranks(MPI_Comm comm, checksum local) {
  std::uint64_t lanes[2] = {local.a, local.b};
  MPI_Allreduce(MPI_IN_PLACE, lanes, 2, MPI_UINT64_T, MPI_SUM, comm);
  return {lanes[0], lanes[1]};
}

std::string hex(const checksum& sum) { return fmt::format("{:016x}{:016x}", sum.a, sum.b); }

bool parse_hex(const std::string& text, checksum& sum) {
  if (text.size() != 32) return false;
  const char* at = text.data();
  std::from_chars(at, at + 16, sum.a, 16);
  std::from_chars(at + 16, at + 32, sum.b, 16);
  return hex(sum) == text;  // no other spelling: a damaged digit must not pass for a capital one
}

}  // namespace tetsuame::output
