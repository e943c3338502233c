// What a run will take, from a few of its steps: `PROGRAM INPUT --plan`.
#pragma once

#include <cstdint>
#include <domain/communicator.hpp>
#include <string>

namespace tetsuame::run {

// Of the first steps of a run, which are measured and thrown away.
struct trial {
  std::int64_t particles = 0;  // of all ranks
  int dimension = 2;
  std::int64_t steps = 0, steps_timed = 0;
  double seconds = 0.0;    // of those timed
  double dt = 0.0;         // s, of the last one
  std::string dt_is = {};  // what set it
  double evaluations_per_step = 0.0;
  std::int64_t bytes_of_snapshot = 0;  // of this rank, before compression
};

// The whole run.
struct extent {
  std::int64_t steps = 0;        // 0: as many as t_end takes
  double t = 0.0, t_end = 0.0;   // s: at the end of the trial, and of the run
  double output_interval = 0.0;  // s; 0: snapshots at start and end only
};

// Collective. Lines "name value unit  remark", with a line end each.
std::string plan_text(const domain::communicator& ranks, const trial& of_steps, const extent& whole);

}  // namespace tetsuame::run
