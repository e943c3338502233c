// When a loop is worth threads: entering and leaving a parallel region costs some
// microseconds, and far more where ranks and threads share cores. Results do not depend on it.
#pragma once

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <vector>

namespace tetsuame::foundation {

inline constexpr std::size_t rows_worth_threads = 1024;    // sums over neighbours
inline constexpr std::size_t values_worth_threads = 8192;  // a few operations each

// f(i) for i in [0, n), each independent of the others.
template <class F>
void for_all(std::size_t n, const F& f) {
#pragma omp parallel for schedule(static) if (n > values_worth_threads)
  for (std::size_t i = 0; i < n; ++i) f(i);
}

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
  std::vector<part> parts(shared ? static_cast<std::size_t>(omp_get_max_threads()) : 1);
#pragma omp parallel if (shared)
  {
    const auto threads = static_cast<std::size_t>(omp_get_num_threads()),
               own = static_cast<std::size_t>(omp_get_thread_num());
    for (std::size_t k = 0; k < threads; ++k) {
      const std::size_t of = (own + k) % threads, begin = chunks * of / threads, end = chunks * (of + 1) / threads;
      while (true) {
        const std::size_t taken = begin + parts[of].next.fetch_add(1, std::memory_order_relaxed);
        if (taken >= end) break;
        f(taken * chunk, std::min(n, (taken + 1) * chunk));
      }
    }
  }
}

}  // namespace tetsuame::foundation
