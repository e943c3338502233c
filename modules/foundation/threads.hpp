// When a loop is worth threads: entering and leaving a parallel region costs some
// microseconds, and far more where ranks and threads share cores. Results do not depend on it.
#pragma once

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <utility>
#include <vector>

namespace tetsuame::foundation {

inline constexpr std::size_t rows_worth_threads = 1024;    // sums over neighbours
inline constexpr std::size_t values_worth_threads = 8192;  // a few operations each

// f(first, last) for chunks of [0, n). Each thread begins with its equal part, which it had in the loop before and has
// in its cache; one that is done takes chunks of others: cores differ in speed, and equal parts wait for the slowest.
template <class F>
void for_chunks(std::size_t n, std::size_t chunk, bool worth_threads, const F& f) {
  const bool shared = worth_threads && omp_get_max_threads() > 1 && omp_in_parallel() == 0;
  if (!shared) chunk = std::max<std::size_t>(n, 1);
  struct alignas(128) part {
    std::atomic<std::size_t> next{0};  // chunk
  };
  const std::size_t chunks = (n + chunk - 1) / chunk;
  part alone;
  std::vector<part> of_threads(shared ? static_cast<std::size_t>(omp_get_max_threads()) : 0);
  part* const parts = shared ? of_threads.data() : &alone;
#pragma omp parallel if (shared)
  {
    const auto threads = static_cast<std::size_t>(omp_get_num_threads()),
               own = static_cast<std::size_t>(omp_get_thread_num());
    for (std::size_t k = 0; k < threads; ++k) {
      const std::size_t of = (own + k) % threads, begin = chunks * of / threads, end = chunks * (of + 1) / threads;
      // A look first: what is used up is not written to.
      while (begin + parts[of].next.load(std::memory_order_relaxed) < end) {
        const std::size_t taken = begin + parts[of].next.fetch_add(1, std::memory_order_relaxed);
        if (taken >= end) break;
        f(taken * chunk, std::min(n, (taken + 1) * chunk));
      }
    }
  }
}

// Of n values: some sixteen chunks a thread, of whole cache lines.
inline std::size_t chunk_of_values(std::size_t n) {
  const std::size_t each = n / (16 * static_cast<std::size_t>(std::max(omp_get_max_threads(), 1)));
  return std::clamp<std::size_t>(each / 64 * 64, 256, 4096);
}

// f(i) for i in [0, n), each independent of the others.
template <class F>
void for_all(std::size_t n, const F& f) {
  for_chunks(n, chunk_of_values(n), n > values_worth_threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) f(i);
  });
}

// The largest value(i) for i in [0, n), or `least`; what is not a number counts as none.
template <class Value>
double largest_of(std::size_t n, double least, const Value& value) {
  std::atomic<double> largest{least};
  for_chunks(n, chunk_of_values(n), n > values_worth_threads, [&](std::size_t first, std::size_t last) {
    double mine = least;
    for (std::size_t i = first; i < last; ++i) mine = std::max(mine, value(i));
    for (double known = largest; known < mine && !largest.compare_exchange_weak(known, mine);) {
    }
  });
  return largest;
}
// The smallest, or `most`.
template <class Value>
double smallest_of(std::size_t n, double most, const Value& value) {
  return -largest_of(n, -most, [&](std::size_t i) { return -value(i); });
}

// Those i in [0, n) for which chosen(i) holds, ascending.
template <class Index, class F>
std::vector<Index> indices_where(std::size_t n, const F& chosen) {
  const std::size_t chunk = chunk_of_values(n);
  std::vector<std::vector<Index>> of_chunks(n / chunk + 1);
  for_chunks(n, chunk, n > values_worth_threads, [&](std::size_t first, std::size_t last) {
    std::vector<Index> mine;
    for (std::size_t i = first; i < last; ++i)
      if (chosen(i)) mine.push_back(static_cast<Index>(i));
    of_chunks[first / chunk] = std::move(mine);
  });
  std::vector<Index> all;
  for (const auto& some : of_chunks) all.insert(all.end(), some.begin(), some.end());
  return all;
}

}  // namespace tetsuame::foundation
