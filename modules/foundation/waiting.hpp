// What this process has sent to others, how often all had to come together, and how long it has stood in MPI calls
// until others came: time that says nothing about its own load. MPI is called from the main thread alone.
#pragma once

#include <chrono>
#include <cstdint>

namespace tetsuame::foundation {

// Since the process began. Copies of a rank to itself, over a periodic border, are no traffic.
struct traffic {
  std::int64_t halo_messages = 0, halo_bytes = 0;            // refreshing ghosts
  std::int64_t migration_messages = 0, migration_bytes = 0;  // migration, and new halos
  std::int64_t collectives = 0;                              // sums, maxima, agreements over all ranks
};
inline traffic sent;

inline double waited_seconds = 0.0;  // s, since the process began

// Seconds since it was made, and those of them that this rank did not wait for others.
class stopwatch {
 public:
  double elapsed() const { return std::chrono::duration<double>(clock::now() - since_).count(); }
  double busy() const { return elapsed() - (waited_seconds - waited_); }

 private:
  using clock = std::chrono::steady_clock;
  clock::time_point since_ = clock::now();
  double waited_ = waited_seconds;
};

// Counts as long as this lives; not to be nested.
class waiting {
 public:
  waiting() = default;
  ~waiting() { waited_seconds += watch_.elapsed(); }
  waiting(const waiting&) = delete;
  waiting& operator=(const waiting&) = delete;

 private:
  stopwatch watch_;
};

// The same in an operation of all ranks, which counts as one.
class collective : public waiting {
 public:
  collective() { ++sent.collectives; }
};

}  // namespace tetsuame::foundation
