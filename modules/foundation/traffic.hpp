// What this process has sent to others, and how often all had to come together: the counts beside the
// time of waiting.hpp. Copies of a rank to itself, over a periodic border, are no traffic.
#pragma once

#include <cstdint>

namespace tetsuame::foundation {

// Since the process began.
struct traffic {
  std::int64_t halo_messages = 0, halo_bytes = 0;      // refreshing ghosts
  std::int64_t letter_messages = 0, letter_bytes = 0;  // migration, and new halos
  std::int64_t collectives = 0;                        // sums, maxima, agreements over all ranks
};
inline traffic sent;

}  // namespace tetsuame::foundation
