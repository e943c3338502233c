#include <fmt/format.h>

#include <foundation/error.hpp>
#include <fstream>
#include <namelist/document.hpp>
#include <namelist/parse.hpp>
#include <system_error>
#include <utility>

namespace tetsuame::namelist {

namespace {

std::string place(const std::string& name, const std::string& set, std::size_t line) {
  return set.empty() ? fmt::format("{}:{}", name, line) : "--set " + set;
}

}  // namespace

std::string document::where(const assignment& from) const { return place(name_, from.set, from.line); }

std::string document::where(const assignment& from, const value& at) const { return place(name_, from.set, at.line); }

void document::set(const std::string& argument) {
  std::string name;
  assignment override = parse_argument(argument, name);
  for (group& g : groups_)
    if (g.name == name) {
      g.assignments.push_back(std::move(override));
      return;
    }
  groups_.push_back({name, 0, {std::move(override)}});
}

document parse_text(std::string_view text, std::string name) {
  document result;
  result.groups_ = parse_groups(text, name);
  result.name_ = std::move(name);
  return result;
}

document parse_file(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    foundation::fail_input(fmt::format("{}: this is a folder, not an input file", name));
  std::ifstream file(path, std::ios::binary);
  if (!file) foundation::fail_input(fmt::format("{}: the input file cannot be opened: is the path right?", name));
  // One byte more than allowed, which parse_text then refuses: a device has no end.
  std::string text;
  char buffer[1 << 14];
  while (text.size() <= maximum_bytes && (file.read(buffer, sizeof buffer) || file.gcount() > 0))
    text.append(buffer, static_cast<std::size_t>(file.gcount()));
  if (file.bad()) foundation::fail_input(fmt::format("{}: the input file cannot be read", name));
  return parse_text(text, name);
}

}  // namespace tetsuame::namelist
