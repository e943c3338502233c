// Answers backwards: private to this module.
#pragma once

#include <cstdint>

namespace tetsuame::relaxation {

// The largest n in 1 … 10^9 that is affordable, where affordable(n) is true up to some n and false
// beyond it; 0 if none is.
template <class Test>
std::int64_t largest_that(Test affordable) {
  std::int64_t below = 0, above = 1'000'000'001;
  while (above - below > 1) {
    const std::int64_t middle = below + (above - below) / 2;
    (affordable(middle) ? below : above) = middle;
  }
  return below;
}

}  // namespace tetsuame::relaxation
