// Progress of a run: one line, redrawn, on a terminal; elsewhere (a file, a batch job)
// a plain line after 10 s, 20 s, 40 s, … and then every ten minutes.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>

namespace tetsuame::output {

struct progress_state {
  std::int64_t step = 0, last_step = 0;  // last_step 0: no limit
  double time = 0.0, t_end = 0.0;        // s; t_end 0: no limit
  double dt = 0.0;                       // s
  double updates = 0.0;                  // of particles
  const char* what = "step";
};

// "step 1200/5000 (24 %)  t = 1.25 s  dt = 1.0e-03 s  2.1e+06 updates/s  3:10 left".
// begin: the state at which `elapsed` (s) was zero; updates a second and the time left go by what is done since.
std::string progress_line(const progress_state& now, const progress_state& begin, double elapsed);

class progress {
 public:
  // speaks: rank 0 only. The stream is redrawn if it is a terminal, to which nothing else should write before finish().
  progress(bool speaks, std::FILE* stream, const progress_state& begin);

  // Every step: reads the clock, and writes only when a line is due.
  void update(const progress_state& now) {
    if (speaks_ && clock::now() >= due_) show(now);
  }
  // The last line; a message may follow.
  void finish(const progress_state& now);

 private:
  using clock = std::chrono::steady_clock;
  void show(const progress_state& now);

  bool speaks_, terminal_;
  std::FILE* stream_;
  progress_state begin_;
  clock::time_point start_, due_;
  clock::duration interval_;
};

}  // namespace tetsuame::output
