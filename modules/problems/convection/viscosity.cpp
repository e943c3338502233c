#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <convection/viscosity.hpp>
#include <cstdlib>
#include <foundation/error.hpp>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <utility>

namespace tetsuame::convection {

namespace {

using foundation::fail_input;

// Between values `first` and the next of a list: part s of the way. One value only: nothing depends on it.
struct place {
  std::size_t first, next;
  double s;
};

place find(const std::vector<double>& x, double at) {
  if (x.size() == 1) return {0, 0, 0.0};
  const double beyond = 0.1 * (x.back() - x.front());
  const double held = std::clamp(at, x.front() - beyond, x.back() + beyond);
  const auto after = std::upper_bound(x.begin() + 1, x.end() - 1, held);
  const auto next = static_cast<std::size_t>(after - x.begin());
  return {next - 1, next, (held - x[next - 1]) / (x[next] - x[next - 1])};
}

struct row {
  double T, depth, viscosity;
  std::size_t line;
};

std::vector<std::string> words_of(std::string text) {
  text.resize(std::min(text.find('#'), text.size()));
  std::ranges::replace(text, ',', ' ');
  std::istringstream words(text);
  return {std::istream_iterator<std::string>(words), {}};
}

std::optional<double> number_of(const std::string& word) {
  char* end = nullptr;
  const double value = std::strtod(word.c_str(), &end);
  return end == word.c_str() + word.size() && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

[[noreturn]] void fail_at(const std::string& path, std::size_t line, const std::string& why) {
  fail_input(fmt::format("viscosity table '{}', line {}: {}", path, line, why));
}

std::vector<row> rows_of(const std::string& path) {
  std::ifstream in(path);
  if (!in) fail_input(fmt::format("viscosity table '{}' cannot be opened", path));
  std::vector<row> rows;
  std::size_t line = 0;
  bool named = false;
  for (std::string text; std::getline(in, text);) {
    ++line;
    const auto words = words_of(text);
    if (words.empty()) continue;
    const bool names = rows.empty() && !named && words.front().starts_with("temperature");
    if (names ? words.size() < 3 : words.size() != 3)
      fail_at(path, line,
              fmt::format("three {} are wanted, temperature (K), depth (m), viscosity (Pa s); there are {}",
                          names ? "columns" : "numbers", words.size()));
    named = named || names;
    if (names) continue;
    std::array<double, 3> value{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto number = number_of(words[k]);
      if (!number) fail_at(path, line, fmt::format("'{}' is not a finite number", words[k]));
      value[k] = *number;
    }
    if (!(value[2] > 0.0)) fail_at(path, line, fmt::format("the viscosity must be above 0, not {}", value[2]));
    rows.push_back({value[0], value[1], value[2], line});
  }
  if (rows.empty()) fail_input(fmt::format("viscosity table '{}' has no values", path));
  return rows;
}

}  // namespace

viscosity_table::viscosity_table(std::vector<double> T, std::vector<double> depth,
                                 const std::function<double(double, double)>& viscosity)
    : T_(std::move(T)), depth_(std::move(depth)) {
  log_.reserve(T_.size() * depth_.size());
  for (const double t : T_)
    for (const double z : depth_) log_.push_back(std::log(viscosity(t, z)));
}

viscosity_table viscosity_table::read(const std::string& path) {
  const auto rows = rows_of(path);
  viscosity_table table;
  auto& depths = table.depth_;
  const auto append = [&](std::vector<double>& list, double value, std::size_t line, const char* what, char unit) {
    if (!list.empty() && !(value > list.back()))
      fail_at(path, line, fmt::format("{} must ascend: {} {} comes after {} {}", what, value, unit, list.back(), unit));
    list.push_back(value);
  };
  for (const auto& r : rows) {
    if (r.T != rows.front().T) break;
    append(depths, r.depth, r.line, "depths", 'm');
  }
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const auto& r = rows[n];
    const std::size_t k = n % depths.size();
    if (k == 0) append(table.T_, r.T, r.line, "temperatures", 'K');
    if (r.T != table.T_.back() || r.depth != depths[k])
      fail_at(
          path, r.line,
          fmt::format("the table is not rectangular: {} K, {} m is wanted here, for every temperature has the depths "
                      "of the first",
                      table.T_.back(), depths[k]));
    table.log_.push_back(std::log(r.viscosity));
  }
  if (rows.size() % depths.size() != 0)
    fail_at(path, rows.back().line,
            fmt::format("the table is not rectangular: at {} K there are {} of {} depths", table.T_.back(),
                        rows.size() % depths.size(), depths.size()));
  return table;
}

double viscosity_table::log(double T, double depth) const {
  const auto t = find(T_, T), z = find(depth_, depth);
  const std::size_t n = depth_.size();
  const double low = std::lerp(log_[t.first * n + z.first], log_[t.next * n + z.first], t.s);
  const double high = std::lerp(log_[t.first * n + z.next], log_[t.next * n + z.next], t.s);
  return std::lerp(low, high, z.s);
}

bool viscosity_table::covers(double T, double depth) const {
  const auto within = [](const std::vector<double>& x, double at) {
    return x.size() == 1 || (at >= x.front() && at <= x.back());
  };
  return within(T_, T) && within(depth_, depth);
}

}  // namespace tetsuame::convection
