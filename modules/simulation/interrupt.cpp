#include <csignal>
#include <initializer_list>
#include <simulation/interrupt.hpp>

namespace tetsuame::simulation {

namespace {

volatile std::sig_atomic_t requested = 0;

void request(int signal) {
  requested = 1;
  if (signal == SIGINT) std::signal(SIGINT, SIG_DFL);
}

}  // namespace

void watch_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) std::signal(signal, request);
}

bool stop_requested() { return requested != 0; }

}  // namespace tetsuame::simulation
