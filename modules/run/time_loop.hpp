// The time loop: start or restart, steps, history, snapshots, checkpoints, the report.
#pragma once

#include <run/command_line.hpp>
#include <run/options.hpp>
#include <run/problem.hpp>

namespace tetsuame::run {

// Collective. Carries the problem from its start state, or from a checkpoint, to the end, and leaves the output
// directory as docs/user_guide.md describes it. Throws foundation::error with the exit status of a run that did not
// complete.
void carry_out(problem& p, const common_options& o, const command_line& line, const std::string& resolved);

}  // namespace tetsuame::run
