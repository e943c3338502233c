#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <output/groups.hpp>
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

checksum sum_of(const std::string& text) {
  checksum sum;
  add_bytes(sum, 0, text.data(), text.size());
  return sum;
}

std::string hex(const checksum& sum) { return fmt::format("{:016x}{:016x}", sum.a, sum.b); }

bool parse_hex(const std::string& text, checksum& sum) {
  if (text.size() != 32) return false;
  const char* at = text.data();
  std::from_chars(at, at + 16, sum.a, 16);
  std::from_chars(at + 16, at + 32, sum.b, 16);
  return hex(sum) == text;  // no other spelling: a damaged digit must not pass for a capital one
}

namespace {

constexpr std::uint64_t lane_a = 0x9e3779b97f4a7c15, lane_b = 0xd1b54a32d192ed03;

std::uint64_t particle_hash(const particle_group& group, std::size_t i, std::uint64_t lane) {
  std::uint64_t s = mix(static_cast<std::uint64_t>(group.ids[i]) + mix(static_cast<std::uint64_t>(group.type) + lane));
  for (const auto& column : group.columns)
    for (const double* x : column.components) s = mix(s ^ std::bit_cast<std::uint64_t>(x[i])) + lane;
  return s;
}

}  // namespace

std::string state_hash(MPI_Comm comm, const std::vector<particle_group>& groups) {
  checksum sum;
  for (const auto& group : groups)
    for (std::size_t i = 0; i < group.n; ++i) {
      sum.a += particle_hash(group, i, lane_a);
      sum.b += particle_hash(group, i, lane_b);
    }
  MPI_Allreduce(MPI_IN_PLACE, &sum, 2, MPI_UINT64_T, MPI_SUM, comm);
  return hex(sum);
}

}  // namespace tetsuame::output
