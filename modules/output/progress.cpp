#include <fmt/core.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <output/progress.hpp>

namespace tetsuame::output {

namespace {

using namespace std::chrono_literals;
constexpr auto redraw_interval = 100ms, first_plain_interval = 10000ms, longest_plain_interval = 600000ms;

std::string duration_text(double seconds) {
  if (!(seconds < 3.6e6)) return "a long time";
  const auto s = static_cast<long>(std::round(seconds));
  return s >= 3600 ? fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
                   : fmt::format("{}:{:02}", s / 60, s % 60);
}

// How much of the run lies behind `now`: the limit that is reached first counts.
double fraction_done(const progress_state& now, const progress_state& from) {
  double done = 0.0;
  if (now.last_step > from.step)
    done = static_cast<double>(now.step - from.step) / static_cast<double>(now.last_step - from.step);
  if (now.t_end > from.time) done = std::max(done, (now.time - from.time) / (now.t_end - from.time));
  return std::min(done, 1.0);
}

std::string cut_to_terminal(std::string line, std::FILE* stream) {
  winsize size{};
  // A line that wraps could not be redrawn.
  if (ioctl(fileno(stream), TIOCGWINSZ, &size) == 0 && size.ws_col > 1 && line.size() >= size.ws_col)
    line.resize(size.ws_col - 1U);
  return line;
}

}  // namespace

std::string progress_line(const progress_state& now, const progress_state& begin, double elapsed) {
  auto line = fmt::format("{} {}", now.what, now.step);
  if (now.last_step > 0) line += fmt::format("/{}", now.last_step);
  if (now.last_step > 0 || now.t_end > 0.0)
    line += fmt::format(" ({:.0f} %)", std::floor(100.0 * fraction_done(now, progress_state{})));
  line += fmt::format("  t = {:.5g} s  dt = {:.2g} s", now.time, now.dt);
  if (elapsed > 0.0) line += fmt::format("  {:.2g} updates/s", (now.updates - begin.updates) / elapsed);
  const double done = fraction_done(now, begin);
  if (done > 0.0) line += fmt::format("  {} left", duration_text(elapsed * (1.0 - done) / done));
  return line;
}

progress::progress(bool speaks, std::FILE* stream, const progress_state& begin)
    : speaks_(speaks),
      terminal_(isatty(fileno(stream)) == 1),
      stream_(stream),
      begin_(begin),
      start_(clock::now()),
      interval_(terminal_ ? redraw_interval : first_plain_interval) {
  due_ = start_ + interval_;
}

void progress::show(const progress_state& now) {
  const auto clock_now = clock::now();
  const auto line = progress_line(now, begin_, std::chrono::duration<double>(clock_now - start_).count());
  // Not fmt::print, which throws when the stream cannot be written: that must not end the run.
  const auto text = terminal_ ? fmt::format("\r{}\x1b[K", cut_to_terminal(line, stream_)) : line + "\n";
  std::fputs(text.c_str(), stream_);
  std::fflush(stream_);
  due_ = clock_now + interval_;
  if (!terminal_) interval_ = std::min<clock::duration>(2 * interval_, longest_plain_interval);
}

void progress::finish(const progress_state& now) {
  if (!speaks_) return;
  show(now);
  if (terminal_) std::fputc('\n', stream_);
  std::fflush(stream_);
}

}  // namespace tetsuame::output
