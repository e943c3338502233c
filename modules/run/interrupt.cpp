#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <run/interrupt.hpp>

namespace tetsuame::run {

namespace {

struct known_signal {
  int number;
  const char* name;
};
constexpr std::array watched = {known_signal{SIGINT, "SIGINT"}, known_signal{SIGTERM, "SIGTERM"},
                                known_signal{SIGUSR1, "SIGUSR1"}, known_signal{SIGHUP, "SIGHUP"},
                                known_signal{SIGXCPU, "SIGXCPU"}};

volatile std::sig_atomic_t requested = 0;

// The handler reads one of the two while the other is written.
std::array<std::array<char, 1024>, 2> texts{};
std::atomic<int> told{0};

void say(const char* text) {
  // A message that cannot be written is no reason to fail.
  if (text[0] != '\0' && ::write(STDERR_FILENO, text, std::strlen(text)) < 0) return;
}

void request(int signal) {
  const int code = errno;
  const char* text = texts[static_cast<std::size_t>(told.load())].data();
  if (requested == 0 && text[0] != '\0') {
    say("\n");
    for (const auto& known : watched)
      if (known.number == signal) say(known.name);
    say(text);
  }
  requested = signal;
  if (signal == SIGINT) std::signal(SIGINT, SIG_DFL);
  errno = code;
}

// Whether SIGHUP was to be ignored when the process began, as nohup has it. UCX, which Open MPI 5 loads, takes this
// signal for its own before main() begins; only what stands in .preinit_array is called earlier.
bool no_hangup = false;

[[gnu::no_sanitize("address", "undefined")]] void watch_all() {
  struct sigaction noted;
  std::memset(&noted, 0, sizeof noted);
  noted.sa_handler = request;
  noted.sa_flags = SA_RESTART;
  for (const auto& known : watched)
    if (known.number != SIGHUP || !no_hangup) sigaction(known.number, &noted, nullptr);
}

// The launcher (programs/launcher.cpp) holds the signals back until they can be noted.
[[gnu::no_sanitize("address", "undefined")]] void watch_from_the_beginning(int, char**, char**) {
  struct sigaction found;
  if (sigaction(SIGHUP, nullptr, &found) == 0) no_hangup = found.sa_handler == SIG_IGN;
  watch_all();
  sigset_t all;
  sigemptyset(&all);
  for (const auto& known : watched) sigaddset(&all, known.number);
  sigprocmask(SIG_UNBLOCK, &all, nullptr);
}
[[gnu::used, gnu::section(".preinit_array")]] void (*watch_at_once)(int, char**, char**) = watch_from_the_beginning;

}  // namespace

void watch_signals() {
  watch_all();
  std::signal(SIGPIPE, SIG_IGN);
}

void end_by_signals() {
  for (const auto& known : watched)
    if (known.number != SIGHUP || !no_hangup) std::signal(known.number, SIG_DFL);
  if (requested != 0) std::raise(requested);
}

int stop_requested() { return requested; }

void tell_on_signal(const std::string& text) {
  const int other = 1 - told.load();
  auto& to = texts[static_cast<std::size_t>(other)];
  const std::size_t n = std::min(text.size(), to.size() - 1);
  std::memcpy(to.data(), text.data(), n);
  to[n] = '\0';
  told.store(other);
}

std::string signal_name(int signal) {
  for (const auto& known : watched)
    if (known.number == signal) return known.name;
  return "signal " + std::to_string(signal);
}

}  // namespace tetsuame::run
