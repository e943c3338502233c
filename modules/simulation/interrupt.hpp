// Signals that ask a run to stop: SIGINT, SIGTERM, SIGUSR1 (what batch systems send before
// a time limit). The first one asks for a checkpoint and exit 75; a second SIGINT ends the
// program at once.
#pragma once

namespace tetsuame::simulation {

void watch_signals();
bool stop_requested();

}  // namespace tetsuame::simulation
