#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <foundation/error.hpp>
#include <foundation/files.hpp>
#include <fstream>
#include <output/hash.hpp>
#include <run/input_files.hpp>
#include <sstream>

namespace tetsuame::run {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view mark = "input_";
constexpr std::uintmax_t largest_copy = std::uintmax_t{64} << 20;  // bytes, of a snapshot to start from

// Of the copy; files of the same name from several folders are numbered.
std::string name_of(const std::string& path, const std::vector<input_file>& others) {
  const std::string own = fs::path(path).filename().string(),
                    bare = own.starts_with(mark) ? own.substr(mark.size()) : own;
  std::string name = fmt::format("{}{}", mark, bare);
  for (int n = 2; std::ranges::find(others, name, &input_file::name) != others.end(); ++n)
    name = fmt::format("{}{}_{}", mark, n, bare);
  return name;
}

bool is_there(const std::string& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

// In pieces: a snapshot may be larger than the memory.
std::string hash_of(const std::string& path) {
  foundation::expect_plain_file(path);
  std::ifstream file(path, std::ios::binary);
  constexpr std::size_t piece = std::size_t{1} << 20;
  static_assert(piece % sizeof(std::uint64_t) == 0);
  std::string bytes(piece, '\0');
  output::checksum sum;
  std::uint64_t word = 0, size = 0;
  while (file) {
    file.read(bytes.data(), static_cast<std::streamsize>(piece));
    const auto got = static_cast<std::size_t>(file.gcount());
    output::add_bytes(sum, word, bytes.data(), got);
    word += piece / sizeof(std::uint64_t);
    size += got;
  }
  if (file.bad() || !file.eof()) foundation::fail_file("cannot read " + path);
  sum.add_word(word, size);
  return output::hex(sum);
}

}  // namespace

std::string input_file::label() const {
  if (!of_start) return name;
  std::string key = where.substr(where.rfind('&') + 1);
  std::ranges::replace(key, ' ', '.');
  return key;
}

std::vector<input_file> find_input_files(const namelist::schema& schema, const std::string& earlier) {
  std::vector<input_file> all;
  std::vector<std::string> given;  // the path of each
  for (const auto& [where, path, what] : schema.files()) {
    if (const auto found = std::ranges::find(given, *path); found != given.end()) {
      *path = all[static_cast<std::size_t>(found - given.begin())].from;
      continue;
    }
    given.push_back(*path);
    input_file f{.where = where, .from = *path, .name = name_of(*path, all)};
    f.of_start = what == namelist::file_of::start;
    const auto copy = (fs::path(earlier) / f.name).string();
    if (!earlier.empty() && !is_there(*path) && is_there(copy)) f.from = *path = copy;
    if (f.of_start && !earlier.empty()) {
      f.copied = is_there(f.from) && fs::is_regular_file(f.from) && fs::file_size(f.from) <= largest_copy;
    } else {
      try {
        foundation::expect_plain_file(f.from);
      } catch (const foundation::error& e) {
        foundation::fail_input(fmt::format("{}: {}", f.where, e.what()));
      }
      f.copied = !f.of_start || fs::file_size(f.from) <= largest_copy;
    }
    if (!f.copied) f.name = fs::path(f.from).filename().string();
    all.push_back(std::move(f));
  }
  return all;
}

std::string resolved_with_copies(const namelist::schema& schema, const std::vector<input_file>& files,
                                 const std::string& first_line) {
  std::vector<std::pair<std::string*, std::string>> paths;
  for (const auto& named : schema.files()) {
    paths.emplace_back(named.path, *named.path);
    const auto of = std::ranges::find(files, *named.path, &input_file::from);
    if (of == files.end()) continue;
    *named.path = of->copied ? of->name : fs::absolute(of->from).lexically_normal().string();
  }
  std::ostringstream text;
  text << first_line << '\n';
  schema.write_resolved(text);
  for (const auto& [option, path] : paths) *option = path;
  return text.str();
}

std::vector<std::string> copies_in(const std::string& folder) {
  const auto path = fs::path(folder) / "resolved.nml";
  std::vector<std::string> names;
  try {
    const auto input = namelist::parse_text(foundation::read_plain_file(path.string()), path.string());
    for (const auto& group : input.groups())
      for (const auto& from : group.assignments)
        for (const auto& value : from.values)
          if (value.content.starts_with(mark) && fs::path(value.content).filename() == value.content)
            names.push_back(value.content);
  } catch (const foundation::error&) {
    return {};  // no run, or not one of ours
  }
  return names;
}

std::map<std::string, std::string> hashes_of(const std::vector<input_file>& files) {
  std::map<std::string, std::string> all;
  for (const auto& f : files)
    if (is_there(f.from)) all[f.label()] = hash_of(f.from);
  return all;
}

void expect_same_files(const std::vector<input_file>& files, const std::map<std::string, std::string>& saved) {
  if (saved.contains("initial.file") && std::ranges::none_of(files, &input_file::of_start))
    foundation::fail_input("the run was begun from a snapshot, and this input gives no &initial file: give that one");
  for (const auto& f : files) {
    if (f.of_start && !is_there(f.from)) continue;
    const auto then = saved.find(f.label());
    if (then == saved.end() && f.of_start)
      foundation::fail_input(fmt::format("{}: the run was not begun from a snapshot: leave {} out", f.where, f.from));
    if (then == saved.end())
      foundation::fail_file(
          fmt::format("the checkpoint has no hash of {}: another version of the program wrote it", f.name));
    if (hash_of(f.from) != then->second)
      foundation::fail_input(
          fmt::format("{}: {} is another file than the one that the run was begun with: give that one, or begin anew "
                      "with this one",
                      f.where, f.from));
  }
}

}  // namespace tetsuame::run
