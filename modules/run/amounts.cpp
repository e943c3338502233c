#include <fmt/format.h>
#include <mpi.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <foundation/error.hpp>
#include <fstream>
#include <limits>
#include <numbers>
#include <run/amounts.hpp>
#include <utility>

namespace tetsuame::run {

namespace {

// B, for each neighbour: 1 in the list, the rest in what grows with the dimension alike (vectors, ghosts, walls, a
// snapshot). The whole process of program C, with 1e6 particles between two walls, takes 548 B a particle in
// 2-D and 959 B in 3-D, 518 B and 893 B in single precision.
constexpr double bytes_a_neighbour = 2.3;

constexpr double worth_telling = 1e9;  // B

double bytes_in(const std::string& path, const std::string& key, double unit) {
  std::ifstream file(path);
  std::string word;
  double value = 0.0;
  while (word != key && file >> word) continue;
  return file >> value ? value * unit : std::numeric_limits<double>::infinity();
}

// B, what this node can still give: all of its ranks together.
double free_memory() {
  const double used = bytes_in("/sys/fs/cgroup/memory.current", "", 1.0);
  double limit = bytes_in("/sys/fs/cgroup/memory.max", "", 1.0);
  if (std::isfinite(limit) && std::isfinite(used)) limit -= used;
  return std::min(limit, bytes_in("/proc/meminfo", "MemAvailable:", 1024.0));
}

int ranks_on_this_node(MPI_Comm comm) {
  MPI_Comm node = MPI_COMM_NULL;
  MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node);
  int n = 1;
  MPI_Comm_size(node, &n);
  MPI_Comm_free(&node);
  return n;
}

}  // namespace

std::string duration_text(double seconds) {
  if (seconds < 60.0) return fmt::format("{:.3g} s", seconds);
  if (seconds < 3600.0) return fmt::format("{:.3g} min", seconds / 60.0);
  if (seconds < 86400.0) return fmt::format("{:.3g} h", seconds / 3600.0);
  if (seconds < 365.25 * 86400.0) return fmt::format("{:.3g} days", seconds / 86400.0);
  return fmt::format("{:.3g} years", seconds / (365.25 * 86400.0));
}

std::string size_text(double bytes) {
  for (const auto& [unit, name] : {std::pair{1e12, "TB"}, {1e9, "GB"}, {1e6, "MB"}})
    if (bytes >= unit) return fmt::format("{:.3g} {}", bytes / unit, name);
  return fmt::format("{:.3g} kB", bytes / 1e3);
}

double particles_within(double r_over_dx, std::int64_t dimension) {
  const double r = r_over_dx;
  return dimension == 1   ? 2.0 * r
         : dimension == 2 ? std::numbers::pi * r * r
                          : 4.0 / 3.0 * std::numbers::pi * r * r * r;
}

memory_need need_of(double particles, double bytes, const kernel_options& o, std::int64_t dimension) {
  return {particles, bytes + bytes_a_neighbour * particles_within(support_over_dx(o) + o.skin, dimension)};
}

memory_need need_of(double particles, const allocated& each, const kernel_options& o, std::int64_t dimension) {
  constexpr double a_double = sizeof(double), a_number = 4.0;
  const auto D = static_cast<double>(dimension);
  // One that is alone in its cell, as in a thin cloud, has a leaf and a run of each level of the tree of cells.
  const double cells = a_double * D + 2.0 * a_number + D * (2.0 * a_double + a_number);
  constexpr double a_neighbour = 1.0, of_a_step = 100.0;  // in the list; numbers of a snapshot, orders of a sort
  return {particles, each.fields + a_double * each.vectors * each.integrated + cells + of_a_step +
                         a_neighbour * particles_within(support_over_dx(o) + o.skin, dimension)};
}

void check_memory(const domain::communicator& ranks, const std::string& program, const memory_need& need,
                  const std::string& where) {
  const double here = need.total() * ranks_on_this_node(ranks.comm) / ranks.size;
  const double least = ranks.minimum(free_memory() / here);
  const auto text =
      fmt::format("{:.4g} particles x {:.0f} B = {}", need.particles, need.bytes_each, size_text(need.total()));
  if (least < 1.0)
    foundation::fail_input(fmt::format(
        "{}: {} of memory, of which a node here has {} free for its share of {}: take fewer particles, or more nodes; "
        "nothing was written",
        where, text, size_text(least * here), size_text(here)));
  if (need.total() >= worth_telling && ranks.rank == 0)
    std::fputs(fmt::format("{}: {} of memory\n", program, text).c_str(), stderr);
}

double resident_bytes(const domain::communicator& ranks) {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return 1024.0 * static_cast<double>(ranks.sum(used.ru_maxrss));
}

}  // namespace tetsuame::run
