// How the steps of a case are timed, whatever takes them, and what its lists hold.
#pragma once

#include <bench/measure.hpp>
#include <chrono>
#include <cstdint>
#include <foundation/stages.hpp>
#include <functional>
#include <pairs/workspace.hpp>
#include <vector>

namespace tetsuame::bench {

using clock = std::chrono::steady_clock;
inline double since(clock::time_point start) { return std::chrono::duration<double>(clock::now() - start).count(); }
double time_of(auto&& work) {
  const auto start = clock::now();
  work();
  return since(start);
}

// In [-1, 1), of a particle's ID and a salt (SplitMix64's finaliser, by S. Vigna).
inline double scatter(std::int64_t id, std::uint64_t salt) {
  std::uint64_t z = (static_cast<std::uint64_t>(id) + 1) * 0x9e3779b97f4a7c15U + salt * 0xd1342543de82ef95U;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
  z ^= z >> 31;
  return static_cast<double>(z >> 11) * 0x1p-52 - 1.0;
}

// A result for each number of threads, with the machine's load.
std::vector<result> with_threads(const result& found, const std::vector<int>& threads);

struct timed {
  std::function<void()> make_lists, step;
  foundation::stage_times& times;  // the stages of the steps
};
// Rounds, in each of which every number of threads has its turn: new lists, the step that finds them new, ordinary
// steps. What the first step takes more than an ordinary one (what is kept while lists live) is charged to the lists.
// They take turns, so that what else the machine does falls on all of them.
void time_steps(std::vector<result>& all, const request& asked, const timed& work);

// support2(i): m2, of particle i
template <int D, class F>
void count_pairs(result& r, const pairs::workspace<D>& w, F&& support2) {
  std::size_t close = 0;
  std::vector<std::uint32_t> row;
  for (std::size_t i = 0; i < w.s.fluid; ++i)
    for (const std::uint32_t j : w.list.row(i, row)) {
      double r2 = 0.0;
      for (const auto& x : w.s.x) {
        const double d = x[i] - x[j];
        r2 += d * d;
      }
      close += r2 < support2(i) ? 1 : 0;
    }
  r.neighbours = static_cast<double>(close) / static_cast<double>(w.s.fluid);
  r.list_entries = static_cast<double>(w.list.pairs) / static_cast<double>(w.s.fluid);
}

template <int D>
void count_bytes(result& r, const pairs::workspace<D>& w, double heap_before) {
  const double lists = w.list.bytes();
  const auto n = static_cast<double>(w.s.fluid);
  r.list_bytes_per_particle = lists / n;
  r.bytes_per_particle = (heap_bytes() - heap_before - lists) / n;
}

}  // namespace tetsuame::bench
