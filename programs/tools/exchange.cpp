// What communication costs here: the programs' own refreshing of ghosts and their own maximum over all
// ranks, timed without any physics. Every rank exchanges with the next and the one before on a ring; of the
// ranks' times the largest counts, of many readings the median and the least.
//
//   mpirun -n R build/programs/exchange      writes one JSON object to standard output
#include <fmt/format.h>
#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <domain/halo.hpp>
#include <nlohmann/json.hpp>

namespace {

using namespace tetsuame;
using json = nlohmann::ordered_json;
using clock = std::chrono::steady_clock;

constexpr std::size_t fields = 6;  // x, y, v_x, v_y, T, rho: what program C refreshes in 2-D

// A ring of halos: the first `n` particles go to the next rank, the last `n` to the one before.
domain::halo<2> ring(const domain::communicator& ranks, std::size_t n) {
  domain::halo<2> h;
  const int next = (ranks.rank + 1) % ranks.size, before = (ranks.rank + ranks.size - 1) % ranks.size;
  const std::size_t sides = next == before ? 1 : 2, owned = 4 * n;
  for (std::size_t side = 0; side < sides; ++side) {
    for (std::size_t k = 0; k < n; ++k) h.sources.push_back(static_cast<std::uint32_t>(side * (owned - n) + k));
    h.to.push_back({side == 0 ? next : before, side * n, n});
    h.from.push_back({side == 0 ? before : next, side * n, n});
  }
  h.shift.assign(sides * n, 0);
  for (auto& by : h.shift_by) by.fill(-0.0);
  h.ghosts_begin = owned;
  h.ghosts = sides * n;
  return h;
}

// s: of the slowest rank. As many readings as a tenth of a second holds, 11 to 1001.
template <class F>
json times_of(const domain::communicator& ranks, const F& once) {
  std::vector<double> all;
  const auto start = clock::now();
  for (int k = 0; k < 5; ++k) once();
  const double first = ranks.maximum(std::chrono::duration<double>(clock::now() - start).count()) / 5.0;
  const int readings = static_cast<int>(std::clamp(0.1 / first, 11.0, 1001.0));
  for (int k = 0; k < readings; ++k) {
    MPI_Barrier(ranks.comm);
    const auto begin = clock::now();
    once();
    all.push_back(std::chrono::duration<double>(clock::now() - begin).count());
  }
  MPI_Allreduce(MPI_IN_PLACE, all.data(), readings, MPI_DOUBLE, MPI_MAX, ranks.comm);
  std::sort(all.begin(), all.end());
  return {{"seconds", all[all.size() / 2]}, {"seconds_least", all.front()}};
}

json measure(const domain::communicator& ranks) {
  json j{{"ranks", ranks.size}, {"fields", fields}, {"exchanges", json::array()}};
  for (const std::size_t n : {1U, 16U, 64U, 256U, 1024U, 4096U, 16384U, 65536U}) {
    if (ranks.size == 1) break;  // nobody to exchange with
    const auto h = ring(ranks, n);
    std::vector<std::vector<double>> values(fields, std::vector<double>(h.ghosts_begin + h.ghosts, ranks.rank));
    std::vector<double*> pointers;
    for (auto& v : values) pointers.push_back(v.data());
    auto row = times_of(ranks, [&] { domain::exchange<2>(ranks, h, std::span<double* const>(pointers)); });
    const double from = values.back()[h.ghosts_begin];
    if (from != h.from.front().rank) foundation::fail_calculation("a ghost does not hold what its owner sent");
    j["exchanges"].push_back({{"particles", h.ghosts}, {"messages", h.to.size()}});
    j["exchanges"].back().update(row);
  }
  j["collective"] = times_of(ranks, [&] { ranks.maximum(ranks.rank); });
  return j;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace tetsuame;
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  const auto ranks = domain::communicator::world();
  int status = 0;
  if (argc > 1) {
    if (ranks.rank == 0) fmt::print(stderr, "exchange: takes no options; start it with mpirun -n R\n");
    status = static_cast<int>(foundation::exit_status::bad_input);
  } else {
    try {
      const auto j = measure(ranks);
      if (ranks.rank == 0) fmt::print("{}\n", j.dump(1));
      if (std::fflush(stdout) != 0) foundation::fail_file("cannot write to the standard output");
    } catch (const foundation::error& e) {
      fmt::print(stderr, "exchange: {}\n", e.what());
      MPI_Abort(ranks.comm, static_cast<int>(e.status()));
    }
  }
  MPI_Finalize();
  return status;
}
