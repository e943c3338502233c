#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <foundation/error.hpp>
#include <map>
#include <optional>
#include <output/agree.hpp>
#include <output/directory.hpp>
#include <output/file.hpp>
#include <system_error>

namespace tetsuame::output {

namespace {

namespace fs = std::filesystem;

constexpr std::array plain_names = {"resolved.nml", "summary.json", "history.csv", "residuals.csv", "series.xdmf",
                                    "run.log",      "cuts.csv",     "times.csv",   "balance.csv"};

// The digits of PREFIX<digits>SUFFIX, as a number.
std::optional<std::int64_t> number_in(const std::string& name, const std::string& prefix, const std::string& suffix) {
  if (name.size() <= prefix.size() + suffix.size() || !name.starts_with(prefix) || !name.ends_with(suffix)) return {};
  const char* first = name.data() + prefix.size();
  const char* last = name.data() + name.size() - suffix.size();
  if (!std::all_of(first, last, [](char c) { return c >= '0' && c <= '9'; })) return {};
  std::int64_t number = 0;
  if (std::from_chars(first, last, number).ec != std::errc()) return {};
  return number;
}

std::vector<std::string> names_in(const std::string& directory) {
  std::vector<std::string> names;
  std::error_code problem;
  for (fs::directory_iterator it(directory, problem), end; !problem && it != end; it.increment(problem))
    names.push_back(it->path().filename().string());
  if (problem) foundation::fail_file(fmt::format("cannot read directory {}: {}", directory, problem.message()));
  return names;
}

void make(const std::string& directory) {
  std::error_code problem;
  fs::create_directories(directory, problem);
  if (problem) foundation::fail_file(fmt::format("cannot create directory {}: {}", directory, problem.message()));
}

void refuse_unwritable(const std::string& directory) {
  const auto probe = (fs::path(directory) / "run.log.tmp").string();
  { const descriptor file(probe, O_WRONLY | O_CREAT); }
  remove_quietly(probe);
}

void remove_files(const std::string& directory, const std::vector<std::string>& names) {
  for (const auto& name : names) {
    std::error_code problem;
    fs::remove(fs::path(directory) / name, problem);
    if (problem)
      foundation::fail_file(
          fmt::format("cannot remove {}: {}", (fs::path(directory) / name).string(), problem.message()));
  }
}

// Keeps the directory for this process until it ends, however it ends. A file system without locks lets everyone in.
void lock(const std::string& directory) {
  const int opened = ::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (opened < 0) return;
  struct stat about {};
  static std::map<std::pair<dev_t, ino_t>, int> held;
  const bool known = ::fstat(opened, &about) == 0 && held.contains({about.st_dev, about.st_ino});
  if (!known && ::flock(opened, LOCK_EX | LOCK_NB) == 0) {
    held.emplace(std::pair{about.st_dev, about.st_ino}, opened);
    return;
  }
  const bool taken = !known && errno == EWOULDBLOCK;
  ::close(opened);
  if (taken)
    foundation::fail_input(fmt::format(
        "another run is writing to {}: wait for its end, or name another directory by --output; nothing was written",
        directory));
}

void open_on_this_rank(const std::string& directory, directory_mode mode) {
  std::error_code ignored;
  const bool exists = fs::exists(directory, ignored);
  if (exists && !fs::is_directory(directory, ignored))
    foundation::fail_input(fmt::format("output {} is a file: give a directory by --output", directory));
  if (!exists && mode == directory_mode::restart)
    foundation::fail_file(fmt::format("cannot continue in {}: there is no such directory", directory));
  if (!exists) make(directory);
  lock(directory);

  auto names = names_in(directory);
  if (mode == directory_mode::fresh && !names.empty())
    foundation::fail_input(fmt::format(
        "output directory {} is not empty: name another by --output, replace its results by --force, or continue "
        "them by --restart latest; nothing was written",
        directory));
  refuse_unwritable(directory);
  std::erase_if(names, [&](const std::string& name) {
    return !is_our_file(name) || (mode == directory_mode::restart && !name.ends_with(".tmp"));
  });
  remove_files(directory, names);
}

}  // namespace

bool is_our_file(const std::string& name) {
  const auto final_name = name.ends_with(".tmp") ? name.substr(0, name.size() - 4) : name;
  return std::find(plain_names.begin(), plain_names.end(), final_name) != plain_names.end() ||
         number_in(final_name, "snapshot_", ".h5") || number_in(final_name, "checkpoint_", ".h5");
}

void open_directory(MPI_Comm comm, const std::string& directory, directory_mode mode) {
  let_size_limits_fail_writes();
  on_rank_0(comm, [&] { open_on_this_rank(directory, mode); });
}

std::vector<std::pair<std::int64_t, std::string>> numbered_files(const std::string& directory,
                                                                 const std::string& prefix, const std::string& suffix) {
  std::vector<std::pair<std::int64_t, std::string>> files;
  for (const auto& name : names_in(directory))
    if (const auto number = number_in(name, prefix, suffix)) files.push_back({*number, name});
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace tetsuame::output
