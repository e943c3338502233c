// When a loop is worth threads: entering and leaving a parallel region costs some
// microseconds, and far more where ranks and threads share cores. Results do not depend on it.
#pragma once

#include <cstddef>

namespace tetsuame::foundation {

inline constexpr std::size_t rows_worth_threads = 1024;    // sums over neighbours
inline constexpr std::size_t values_worth_threads = 8192;  // a few operations each

}  // namespace tetsuame::foundation
