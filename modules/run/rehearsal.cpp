#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <run/command_line.hpp>
#include <run/rehearsal.hpp>
#include <run/restart.hpp>
#include <sstream>

extern char** environ;  // NOLINT(readability-redundant-declaration)

namespace tetsuame::run {

namespace {

namespace fs = std::filesystem;

constexpr double patience = 5.0;                                // s
constexpr std::array<std::int64_t, 4> most{0, 200, 900, 4096};  // particles, by dimension
constexpr std::int64_t fewest_along = 6, most_tries = 4;
constexpr double fewest_by_number = 100.0;

struct temporary_folder {
  fs::path path;
  temporary_folder() {
    auto name = (fs::temp_directory_path() / "tetsuame_plan_XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) path = name;
  }
  ~temporary_folder() {
    std::error_code ignored;
    if (!path.empty()) fs::remove_all(path, ignored);
  }
  temporary_folder(const temporary_folder&) = delete;
  temporary_folder& operator=(const temporary_folder&) = delete;
};

// This process's own program, without what a launcher told it of ranks, with its output in the file. Its exit status.
int run_again(std::vector<std::string> words, const fs::path& output) {
  words.insert(words.begin(), "/proc/self/exe");
  std::vector<char*> arguments;
  for (auto& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    std::vector<std::string> of_launcher;
    for (char** entry = environ; *entry != nullptr; ++entry)
      for (const char* prefix : {"OMPI_", "PMIX_", "PMI_", "PRTE_"})
        if (const std::string name = *entry;
            name.starts_with(prefix) && !name.starts_with("OMPI_MCA_") && !name.starts_with("OMPI_ALLOW"))
          of_launcher.push_back(name.substr(0, name.find('=')));
    for (const auto& name : of_launcher) unsetenv(name.c_str());
    setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
    const int file = open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    dup2(file, STDOUT_FILENO);
    dup2(open("/dev/null", O_WRONLY), STDERR_FILENO);
    execv("/proc/self/exe", arguments.data());
    std::_Exit(127);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status)) return 127;
  return WEXITSTATUS(status);
}

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  std::ostringstream all;
  all << file.rdbuf();
  return all.str();
}

std::vector<std::int64_t> particles_in(const std::string& resolved) {
  std::vector<std::int64_t> along;
  const auto dimension = static_cast<std::int64_t>(number_in(resolved, "&domain dimension"));
  for (const char* axis : {"x", "y", "z"})
    if (static_cast<std::int64_t>(along.size()) < dimension)
      along.push_back(static_cast<std::int64_t>(number_in(resolved, std::string("&domain particles_") + axis)));
  return along;
}

// By how much the particles along each axis are divided: at first so that there are few enough, then other ways.
std::vector<std::int64_t> divisors(const std::vector<std::int64_t>& along) {
  std::vector<std::int64_t> few, many;
  for (std::int64_t d = 1; d <= 1000; ++d) {
    std::int64_t all = 1;
    bool fits = true;
    for (const auto n : along) {
      fits = fits && n % d == 0 && n / d >= fewest_along;
      all *= std::max<std::int64_t>(1, n / d);
    }
    if (fits) (all <= most[along.size()] ? few : many).push_back(d);
  }
  std::ranges::reverse(many);
  few.insert(few.end(), many.begin(), many.end());
  return few;
}

// A run with fewer particles: how many times fewer along an axis, and what says so.
struct attempt {
  double finer;
  std::vector<std::string> settings;
  std::string what;
};

std::vector<attempt> on_lattices(const std::string& resolved) {
  std::vector<attempt> all;
  const auto along = particles_in(resolved);
  if (along.empty()) return all;
  for (const auto divisor : divisors(along)) {
    std::vector<std::int64_t> left;
    attempt one{static_cast<double>(divisor), {}, {}};
    for (std::size_t a = 0; a < along.size(); ++a) {
      left.push_back(along[a] / divisor);
      one.settings.push_back(fmt::format("domain.particles_{}={}", "xyz"[a], left.back()));
    }
    one.what = fmt::format("{} particles", fmt::join(left, " x "));
    all.push_back(std::move(one));
  }
  return all;
}

// Of an input that gives their number as this key.
std::vector<attempt> by_number(const std::string& resolved, const particles_key& key) {
  std::vector<attempt> all;
  const auto given = [&](const char* name) { return number_in(resolved, fmt::format("&{} {}", key.first, name)); };
  const double number = given(key.second.c_str()), dimension = given("dimension");
  if (!(number > 0.0 && dimension > 0.0)) return all;
  for (double divisor = 2.0; all.size() < most_tries; ++divisor) {
    const double left = std::floor(number / std::pow(divisor, dimension));
    if (left < fewest_by_number) break;
    if (left <= static_cast<double>(most[static_cast<std::size_t>(dimension)]))
      all.push_back(
          {divisor, {fmt::format("{}.{}={:.0f}", key.first, key.second, left)}, fmt::format("{:.0f} particles", left)});
  }
  return all;
}

// Of history.csv: step, time and dt are its first columns.
std::vector<rehearsal::interval> course_in(const fs::path& history) {
  std::vector<rehearsal::interval> all;
  std::ifstream file(history);
  std::string line;
  std::getline(file, line);
  double step = 0.0, time = 0.0;
  while (std::getline(file, line)) {
    std::ranges::replace(line, ',', ' ');
    std::istringstream in(line);
    double now = 0.0, t = 0.0;
    if (!(in >> now >> t) || !(now > step)) continue;
    all.push_back({t, (t - time) / (now - step), now - step});
    step = now;
    time = t;
  }
  return all;
}

}  // namespace

double rehearsal::steps(double first_dt, double fixed, double t_end) const {
  if (course.empty()) return 0.0;
  const double first_rehearsed = course.front().dt;
  const auto longest = [&](double dt) {
    if (fixed > 0.0 && dt >= 0.999 * fixed) return fixed;
    return std::min(dt / finer, first_dt * std::max(1.0, dt / first_rehearsed));
  };
  double all = 0.0;
  for (const auto& s : course) all += s.steps * s.dt / longest(s.dt);
  return completed ? all : all + std::max(0.0, t_end - course.back().t) / longest(course.back().dt);
}

rehearsal rehearse(const command_line& line, const std::vector<std::string>& changes, const particles_key& key) {
  const temporary_folder folder;
  rehearsal r;
  r.what = "the same run with fewer particles could not be tried";
  std::vector<std::string> words{line.input};
  for (const auto& setting : line.set) words.insert(words.end(), {"--set", setting});
  auto checked = words;
  checked.emplace_back("--check");
  if (folder.path.empty() || run_again(checked, folder.path / "resolved") != 0) return r;
  const auto resolved = text_of(folder.path / "resolved");
  const auto ways = key.first == "domain" ? on_lattices(resolved) : by_number(resolved, key);
  for (std::size_t n = 0; n < std::min<std::size_t>(most_tries, ways.size()); ++n) {
    auto smaller = words;
    const auto set = [&](const std::string& setting) { smaller.insert(smaller.end(), {"--set", setting}); };
    for (const auto& setting : ways[n].settings) set(setting);
    for (const auto& change : changes) set(change);
    set("output.interval=0");
    set("output.history_interval=5");
    set(fmt::format("run.wall_clock_limit={}", patience));
    const auto output = folder.path / fmt::format("run_{}", n);
    smaller.insert(smaller.end(), {"--output", output.string()});
    const int status = run_again(smaller, folder.path / "said");
    r.course = course_in(output / "history.csv");
    if (r.course.empty()) continue;
    r.completed = status == 0;
    r.finer = ways[n].finer;
    r.what = ways[n].what;
    break;
  }
  return r;
}

}  // namespace tetsuame::run
