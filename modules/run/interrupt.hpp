// Signals that ask a run to stop: SIGINT, SIGTERM, SIGUSR1 (what batch systems send before a time limit), SIGHUP (a
// closed window; not under nohup) and SIGXCPU (ulimit -t). The first one asks for a checkpoint and exit 75; a second
// SIGINT ends the program at once. A reader of its output that goes away does not end it.
#pragma once

#include <string>

namespace tetsuame::run {

// From the first moment of a process on, before MPI and HDF5 are loaded, these signals are noted: what is to be done by
// them is said by one of the two. A program that is no run ends as they say, at once, where one has come.
void watch_signals();
void end_by_signals();
int stop_requested();  // the signal; 0: none came

// What is written to the terminal as soon as a signal comes, after its name; empty: nothing. A step may take long, and
// a launcher may lose patience before the checkpoint stands.
void tell_on_signal(const std::string& text);

std::string signal_name(int signal);

}  // namespace tetsuame::run
