#include <bit>
#include <output/hash.hpp>
#include <output/state_hash.hpp>

namespace tetsuame::output {

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
  return hex(sum_over_ranks(comm, sum));
}

}  // namespace tetsuame::output
