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
#include <foundation/agree.hpp>
#include <foundation/error.hpp>
#include <map>
#include <optional>
#include <output/directory.hpp>
#include <output/file.hpp>
#include <output/stored_file.hpp>
#include <system_error>

namespace tetsuame::output {

namespace {

namespace fs = std::filesystem;

constexpr std::array plain_names = {"resolved.nml", "summary.json", "history.csv", "residuals.csv", "series.xdmf",
                                    "walls.xdmf",   "run.log",      "balance.csv", "gauges.csv"};

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

// Makes it and what leads to it. Returns those that were made, the innermost first.
std::vector<std::string> make(const std::string& directory) {
  std::vector<std::string> made;
  std::error_code problem;
  auto path = fs::absolute(directory).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  for (; !fs::exists(path, problem) && path != path.root_path(); path = path.parent_path())
    made.push_back(path.string());
  fs::create_directories(directory, problem);
  if (problem) foundation::fail_file(fmt::format("cannot create directory {}: {}", directory, problem.message()));
  return made;
}

std::string final_name(const std::string& name) {
  return name.ends_with(".tmp") ? name.substr(0, name.size() - 4) : name;
}

// Of a file that has one of our names: did a run write it? Somebody else's table or HDF5 file may be called the same.
bool written_by_a_run(const fs::path& path) {
  const auto name = path.filename().string();
  if (name.ends_with(".tmp") || fs::is_symlink(path)) return true;
  try {
    if (name.ends_with(".csv")) return beginning_of(path.string(), 8) == "step [1]";
    if (number_in(name, "checkpoint_", ".h5")) return beginning_of(path.string(), 19) == "tetsuame checkpoint";
    if (!number_in(name, "snapshot_", ".h5")) return true;
    return !stored_file(path.string()).datasets("/Provenance").empty();
  } catch (const foundation::error&) {
    return false;
  }
}

// Directories that this process holds, and the descriptor of each by the names that it was given.
std::map<std::pair<dev_t, ino_t>, int> held;
std::map<std::string, int> held_by_name;

// Keeps the directory for this process until it ends, however it ends. A file system without locks lets everyone in.
void lock(const std::string& directory) {
  const int opened = ::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (opened < 0) return;
  struct stat about {};
  const bool known = ::fstat(opened, &about) == 0 && held.contains({about.st_dev, about.st_ino});
  if (!known && ::flock(opened, LOCK_EX | LOCK_NB) == 0) {
    held.emplace(std::pair{about.st_dev, about.st_ino}, opened);
    held_by_name[directory] = opened;
    return;
  }
  if (known) held_by_name[directory] = held.at({about.st_dev, about.st_ino});
  const bool taken = !known && errno == EWOULDBLOCK;
  ::close(opened);
  if (taken)
    foundation::fail_input(fmt::format(
        "another run is writing to {}: wait for its end, or name another directory by --output; nothing was written",
        directory));
}

// Returns the directories that were made.
std::vector<std::string> claim(const std::string& directory, directory_mode mode) {
  std::error_code ignored;
  const bool exists = fs::exists(directory, ignored);
  if (exists && !fs::is_directory(directory, ignored))
    foundation::fail_input(fmt::format("output {} is a file: give a directory by --output", directory));
  if (!exists && mode == directory_mode::restart)
    foundation::fail_file(fmt::format("cannot continue in {}: there is no such directory", directory));
  auto made = exists ? std::vector<std::string>() : make(directory);
  lock(directory);
  if (mode == directory_mode::fresh && !names_in(directory).empty())
    foundation::fail_input(fmt::format(
        "output directory {} is not empty: name another by --output, replace its results by --force, or continue "
        "them by --restart latest; nothing was written",
        directory));
  const auto probe = (fs::path(directory) / "run.log.tmp").string();
  create_temporary(probe);  // fails where nothing can be written
  remove_quietly(probe);
  return made;
}

}  // namespace

bool is_our_file(const std::string& name) {
  const auto last = final_name(name);
  return std::find(plain_names.begin(), plain_names.end(), last) != plain_names.end() ||
         number_in(last, "snapshot_", ".h5") || number_in(last, "checkpoint_", ".h5");
}

std::string present_place(const std::string& directory) {
  const auto found = held_by_name.find(directory);
  if (found == held_by_name.end()) return directory;
  std::error_code unknown;
  const auto place = fs::read_symlink("/proc/self/fd/" + std::to_string(found->second), unknown);
  return unknown || fs::equivalent(place, directory, unknown) ? directory : place.string();
}

bool holds_a_run(const std::string& directory) {
  std::error_code ignored;
  if (!fs::is_directory(directory, ignored)) return false;
  const auto names = names_in(directory);
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    return is_our_file(name) && written_by_a_run(fs::path(directory) / name);
  });
}

claimed_directory::claimed_directory(MPI_Comm comm, const std::string& directory, directory_mode mode,
                                     std::vector<std::string> own_names)
    : comm_(comm), directory_(directory), own_names_(std::move(own_names)) {
  let_size_limits_fail_writes();
  foundation::on_rank_0(comm, [&] { made_ = claim(directory, mode); });
}

claimed_directory::~claimed_directory() {
  for (const auto& path : made_)
    if (::rmdir(path.c_str()) != 0) break;
}

void claimed_directory::clear(directory_mode mode, const std::string& kept, const std::vector<std::string>& copies) {
  const auto belongs = [&](const std::string& name) {
    const bool own = std::ranges::count(own_names_, final_name(name)) > 0 ||
                     (mode == directory_mode::force && std::ranges::count(copies, final_name(name)) > 0);
    if (!own && !is_our_file(name)) return false;
    if (mode == directory_mode::restart) return name.ends_with(".tmp");
    return name != kept && (own || written_by_a_run(fs::path(directory_) / name));
  };
  foundation::on_rank_0(comm_, [&] {
    for (const auto& name : names_in(directory_)) {
      const auto path = fs::path(directory_) / name;
      std::error_code problem;
      if (belongs(name)) fs::remove(path, problem);
      if (problem) foundation::fail_file(fmt::format("cannot remove {}: {}", path.string(), problem.message()));
    }
  });
  made_.clear();
}

void open_directory(MPI_Comm comm, const std::string& directory, directory_mode mode,
                    const std::vector<std::string>& own_names) {
  claimed_directory(comm, directory, mode, own_names).clear(mode);
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
