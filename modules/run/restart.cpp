#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <output/checkpoint.hpp>
#include <run/restart.hpp>
#include <sstream>
#include <utility>
#include <vector>

namespace tetsuame::run {

namespace {

using assignments = std::vector<std::pair<std::string, std::string>>;  // "&group key", value

// Of a resolved input. What a comment says of a key that was left open is its value.
assignments assignments_of(const std::string& resolved) {
  assignments all;
  std::istringstream in(resolved);
  std::string group;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("&")) group = line;
    const auto equals = line.find(" =");
    if (!line.starts_with("  ") || equals == std::string::npos) continue;
    auto value = line.substr(std::min(equals + 3, line.size()));
    if (value.starts_with("! ")) value.erase(0, 2);
    all.emplace_back(group + line.substr(1, equals - 1), value);
  }
  return all;
}

const std::string* value_of(const assignments& of, const std::string& key) {
  const auto found = std::ranges::find(of, key, &assignments::value_type::first);
  return found == of.end() ? nullptr : &found->second;
}

double number_of(const assignments& of, const std::string& key) {
  const auto* value = value_of(of, key);
  return value != nullptr ? std::strtod(value->c_str(), nullptr) : 0.0;
}

std::string place_of(const present_run& is, const std::string& key) {
  const auto found = is.keys.find(key);
  return found == is.keys.end() || found->second.where == "default" ? "default value" : found->second.where;
}

// "&domain ranks_x, balance; &time method, …"
std::string those_that_may(const present_run& is, const assignments& in_order) {
  std::string text, group;
  for (const auto& [key, value] : in_order) {
    const auto found = is.keys.find(key);
    if (found == is.keys.end() || !found->second.may_change) continue;
    const auto blank = key.find(' ');
    const bool first_of_group = key.substr(0, blank) != group;
    group = key.substr(0, blank);
    text += (text.empty() ? "" : first_of_group ? "; " : ", ") + (first_of_group ? key : key.substr(blank + 1));
  }
  return text;
}

std::string text_or_unset(const std::string* value) {
  return value == nullptr ? "(no such key)" : value->empty() ? "(not given)" : *value;
}

}  // namespace

void check_restart(const saved_run& was, const present_run& is) {
  if (was.program != is.program)
    foundation::fail_input("the checkpoint is of program " + was.program + ", not of " + is.program);
  const auto then = assignments_of(was.input), now = assignments_of(is.input);
  std::string changed;  // one that --set gave rather than one that follows from it
  const auto check = [&](const std::string& key) {
    const auto found = is.keys.find(key);
    if (found != is.keys.end() && found->second.may_change) return;
    const auto *a = value_of(then, key), *b = value_of(now, key);
    if (a != nullptr && b != nullptr && *a == *b) return;
    const bool set = place_of(is, key).starts_with("--set");
    if (changed.empty() || (set && !place_of(is, changed).starts_with("--set"))) changed = key;
  };
  for (const auto& [key, value] : now) check(key);
  for (const auto& [key, value] : then) check(key);
  if (changed.empty()) return;
  foundation::fail_input(
      fmt::format("{}: {} = {}, and {} in the checkpoint's run: a restart cannot change it, only {}; leave it as it "
                  "was, or start anew without --restart",
                  place_of(is, changed), changed, text_or_unset(value_of(now, changed)),
                  text_or_unset(value_of(then, changed)), those_that_may(is, now)));
}

void check_end(const saved_run& was, const present_run& is) {
  const auto now = assignments_of(is.input);
  const auto refuse = [&](const char* key, const std::string& stands, const std::string& found) {
    foundation::fail_input(fmt::format("{}: {}: expected no less than {}, where the checkpoint stands, found {}",
                                       place_of(is, key), key, stands, found));
  };
  const auto* own_end = value_of(now, "&time t_end");
  const double steps = number_of(now, "&time steps");
  const bool given = own_end != nullptr && !own_end->empty();
  const double end = given ? number_of(now, "&time t_end") : steps * number_of(now, "&time dt");
  if (was.time > end * (1.0 + 1e-9))
    refuse("&time t_end", fmt::format("{:.6g} s", was.time),
           fmt::format("{:.6g} s{}", end, given ? "" : ", which is steps * dt"));
  if (given && static_cast<double>(was.step) > steps)
    refuse("&time steps", std::to_string(was.step), fmt::format("{:.0f}", steps));
}

double number_in(const std::string& resolved, const std::string& key) {
  return number_of(assignments_of(resolved), key);
}

saved_run read_saved_run(const std::string& restart, const std::string& directory) {
  const auto g = restart == "latest" ? output::newest_globals(directory) : output::read_globals(restart);
  return {g.texts.at("program"), g.texts.at("input"), g.integers.at("step"), g.reals.at("time")};
}

}  // namespace tetsuame::run
