// What a run will take, as --plan tells it: by some of its steps, and by the same run on fewer particles.
#pragma once

#include <cstdint>
#include <run/options.hpp>
#include <run/rehearsal.hpp>
#include <string>

namespace tetsuame::run {

// The run, and what was measured of its first steps.
struct plan_of_run {
  int dimension = 0;
  std::int64_t particles = 0;
  int ranks = 1;
  double first_dt = 0.0, last_dt = 0.0;  // s, of the first step and of the last one that was tried
  std::string limit = {};                // what set the step
  double time = 0.0, end = 0.0;          // s, after the steps that were tried; of the run
  std::int64_t step = 0;                 // so many were tried
  std::int64_t asked = 0;                // by the input; 0: it does not say
  bool finished = false;                 // the run has no more than that
  double seconds = 0.0;                  // that all steps but the first took
  long long evaluations = 0;             // of the right-hand side in these
  struct {
    double steps = 0.0, dt = 0.0;  // s
  } settling = {};                 // before the run; no steps: the start does not settle
  double snapshot = 0.0;           // bytes of one
  double memory = 0.0;             // bytes of all ranks
};

std::string text_of(const plan_of_run& plan, const common_options& o, const rehearsal& tried);

}  // namespace tetsuame::run
