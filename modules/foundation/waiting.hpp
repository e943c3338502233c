// How long this process has stood in MPI calls until others came: time that says nothing about its own
// load. MPI is called from the main thread alone.
#pragma once

#include <chrono>
#include <foundation/traffic.hpp>

namespace tetsuame::foundation {

inline double waited_seconds = 0.0;  // s, since the process began

// Counts as long as this lives; not to be nested.
class waiting {
 public:
  waiting() = default;
  ~waiting() { waited_seconds += std::chrono::duration<double>(clock::now() - since_).count(); }
  waiting(const waiting&) = delete;
  waiting& operator=(const waiting&) = delete;

 private:
  using clock = std::chrono::steady_clock;
  clock::time_point since_ = clock::now();
};

// The same in an operation of all ranks, which counts as one.
class collective : public waiting {
 public:
  collective() { ++sent.collectives; }
};

// Seconds since it was made, and those of them that this rank did not wait for others.
class stopwatch {
 public:
  double elapsed() const { return std::chrono::duration<double>(clock::now() - since_).count(); }
  double busy() const { return elapsed() - (foundation::waited_seconds - waited_); }

 private:
  using clock = std::chrono::steady_clock;
  clock::time_point since_ = clock::now();
  double waited_ = foundation::waited_seconds;
};

}  // namespace tetsuame::foundation
