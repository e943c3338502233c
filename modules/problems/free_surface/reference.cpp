#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <foundation/error.hpp>
#include <free_surface/reference.hpp>
#include <fstream>
#include <sstream>

namespace tetsuame::free_surface {

namespace {

std::vector<std::string> parts_of(std::string line) {
  if (!line.empty() && line.back() == '\r') line.pop_back();
  std::vector<std::string> parts;
  std::istringstream text(line);
  for (std::string part; std::getline(text, part, ',');) {
    const auto first = part.find_first_not_of(' '), last = part.find_last_not_of(' ');
    parts.push_back(first == std::string::npos ? "" : part.substr(first, last - first + 1));
  }
  return parts;
}

double number_of(const std::string& text, const std::string& place) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    foundation::fail_input(fmt::format("{}: expected a number, found '{}'", place, text));
  return value;
}

}  // namespace

std::optional<std::size_t> table::place(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return {};
  return static_cast<std::size_t>(found - names.begin());
}

table read_table(const std::string& path) {
  std::ifstream file(path);
  if (!file) foundation::fail_input("cannot read " + path);
  table t;
  int number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    if (line.empty() || line.front() == '#') continue;
    const auto parts = parts_of(line);
    if (t.names.empty()) {
      t.names = parts;
      t.columns.resize(parts.size());
      continue;
    }
    const auto place = fmt::format("{}:{}", path, number);
    if (parts.size() != t.names.size())
      foundation::fail_input(fmt::format("{}: expected {} numbers, found {}", place, t.names.size(), parts.size()));
    for (std::size_t k = 0; k < parts.size(); ++k) t.columns[k].push_back(number_of(parts[k], place));
    auto& time = t.columns.front();
    if (time.size() > 1 && !(time[time.size() - 1] > time[time.size() - 2]))
      foundation::fail_input(fmt::format("{}: expected a later time than in the line before", place));
  }
  if (t.columns.size() < 2 || t.columns.front().size() < 2)
    foundation::fail_input(path + ": expected a line of names, and two lines of two numbers at least");
  return t;
}

}  // namespace tetsuame::free_surface
