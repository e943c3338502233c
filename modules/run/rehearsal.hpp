// What a run will take of steps, by the same run on fewer particles: how its steps grow and shrink on the way, which
// the first of them do not say (particles that become fast, a shock that slows down).
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace tetsuame::run {

struct command_line;

struct rehearsal {
  struct interval {
    double t, dt, steps;  // s, at its end; s, of its steps; their number
  };
  std::vector<interval> course;
  double finer = 1.0;      // the run's particles along an axis, over those of the rehearsal
  bool completed = false;  // else it was too slow, or failed, behind the last of the course
  std::string what;        // "20 x 20 particles", or why there was none

  // Steps to t_end (s) of the run itself. first_dt: s, its own first step, which is no more than a limit that goes with
  // a higher power of the spacing allows; fixed: s, where the input gives it; 0: else.
  double steps(double first_dt, double fixed, double t_end) const;
};

// The group and the key that say how many particles there are; of &domain, all axes.
using particles_key = std::pair<std::string, std::string>;

// In a process of its own, before MPI has started, with its results in a temporary folder. changes: settings that go
// with it, group.key=value.
rehearsal rehearse(const command_line& line, const std::vector<std::string>& changes, const particles_key& key);

}  // namespace tetsuame::run
