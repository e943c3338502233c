// When a loop is worth threads: entering and leaving a parallel region costs some
// microseconds, and far more where ranks and threads share cores. Results do not depend on it. Threads take chunks of
// some 50 microseconds as they become free: cores differ in speed, and equal parts would wait for the slowest one.
#pragma once

#include <omp.h>

#include <cstddef>

namespace tetsuame::foundation {

inline constexpr std::size_t rows_worth_threads = 1024;    // sums over neighbours
inline constexpr std::size_t values_worth_threads = 8192;  // a few operations each

// f(i) for i in [0, n), each independent of the others.
template <class F>
void for_all(std::size_t n, const F& f) {
#pragma omp parallel for schedule(dynamic, 1024) if (n > values_worth_threads)
  for (std::size_t i = 0; i < n; ++i) f(i);
}

}  // namespace tetsuame::foundation
