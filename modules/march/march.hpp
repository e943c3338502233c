// The time loop: start or restart, steps, history, snapshots, checkpoints, the report.
#pragma once

#include <march/options.hpp>
#include <march/problem.hpp>
#include <simulation/command_line.hpp>

namespace tetsuame::march {

// Collective. Carries the problem from its start state, or from a checkpoint, to the end, and leaves the output
// directory as docs/user_guide.md describes it. Throws foundation::error with the exit status of a run that did not
// complete.
void run(problem& p, const options& o, const simulation::command_line& line, const std::string& resolved);

}  // namespace tetsuame::march
