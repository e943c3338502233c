#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <eos/table_file.hpp>
#include <foundation/error.hpp>
#include <foundation/files.hpp>
#include <namelist/text.hpp>
#include <optional>
#include <ostream>
#include <tables/cells.hpp>

namespace tetsuame::eos {

namespace {

using namelist::excerpt;

constexpr std::size_t most_nodes = 100'000;  // along an axis

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  constexpr std::string_view blanks = " \t,";
  for (std::size_t at = line.find_first_not_of(blanks); at != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(blanks, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(blanks, end);
  }
  return words;
}

// Also with an exponent of three digits that has pushed out its letter, 1.5-101, as Fortran writes it.
std::optional<double> number_of(std::string_view word) {
  double value = 0.0;
  if (const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
      fault == std::errc() && end == word.data() + word.size())
    return value;
  if (const auto read = tables::number_of(word)) return read;
  const std::size_t sign = word.find_last_of("+-");
  if (sign == std::string_view::npos || sign == 0 || word.size() - sign != 4) return {};
  return tables::number_of(std::string(word.substr(0, sign)) + 'e' + std::string(word.substr(sign)));
}

// The lines of a text, one after the other.
class text_lines {
 public:
  text_lines(std::string_view text, std::string name) : name_(std::move(name)) {
    constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
    if (const auto fault = namelist::not_text(text, "a table in text"); !fault.empty())
      foundation::fail_input(fmt::format("{}: {}", name_, fault));
    if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
    while (!text.empty()) {
      const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
      lines_.push_back(tables::trimmed(text.substr(0, end)));
      text.remove_prefix(std::min(end + (text.substr(end, 2) == "\r\n" ? 2 : 1), text.size()));
    }
  }

  // The next line that is not empty, which then is the one that failures name. None: there is no more.
  std::optional<std::string_view> next() {
    while (at_ < lines_.size() && lines_[at_].empty()) ++at_;
    if (at_ == lines_.size()) return {};
    return lines_[at_++];
  }
  void back() { --at_; }

  // At the line that was read last.
  [[noreturn]] void fail(const std::string& message) const {
    foundation::fail_input(fmt::format("{}:{}: {}", name_, at_, message));
  }
  [[noreturn]] void fail_all(const std::string& message) const {
    foundation::fail_input(fmt::format("{}: {}", name_, message));
  }

  std::vector<double> numbers(std::string_view line) const {
    std::vector<double> all;
    for (const auto word : words_of(line)) {
      const auto number = number_of(word);
      if (!number) fail(fmt::format("expected a number, found '{}'", excerpt(word)));
      all.push_back(*number);
    }
    return all;
  }

 private:
  std::string name_;
  std::vector<std::string_view> lines_;
  std::size_t at_ = 0;  // lines read
};

// Numbers that go over any number of whole lines.
class number_stream {
 public:
  number_stream(text_lines& lines, std::size_t expected, std::string what)
      : lines_(lines), expected_(expected), what_(std::move(what)) {}

  double next() {
    while (at_ == line_.size()) {
      const auto line = lines_.next();
      if (!line) lines_.fail_all(fmt::format("ends after {} of {}", given_, what_text()));
      line_ = lines_.numbers(*line);
      at_ = 0;
    }
    ++given_;
    return line_[at_++];
  }
  // Where the last of them must end its line.
  void end() const {
    if (at_ != line_.size()) lines_.fail(fmt::format("holds {} more than {}", line_.size() - at_, what_text()));
  }
  // Fails at the line of the number that next() gave last.
  [[noreturn]] void fail(const std::string& message) const { lines_.fail(message); }

 private:
  std::string what_text() const { return fmt::format("{} {}", expected_, what_); }
  text_lines& lines_;
  std::vector<double> line_;
  std::size_t at_ = 0, given_ = 0, expected_;
  std::string what_;
};

// An axis, without a first node at 0.
struct read_axis {
  std::vector<double> nodes;
  bool skips_first = false;
};

read_axis take_axis(number_stream& from, std::size_t n, double factor, const char* what, const char* unit) {
  read_axis axis;
  for (std::size_t k = 0; k < n; ++k) {
    const double x = factor * from.next();
    if (!std::isfinite(x)) from.fail(fmt::format("{} {} is not finite", what, k + 1));
    if (k == 0 && x == 0.0) {
      axis.skips_first = true;
      continue;
    }
    const double least = axis.nodes.empty() ? 0.0 : axis.nodes.back();
    if (!(x > least))
      from.fail(fmt::format("{} {} of {}, {:g} {}, does not lie above {:g}", what, k + 1, n, x, unit, least));
    axis.nodes.push_back(x);
  }
  if (axis.nodes.size() < 2) from.fail(fmt::format("has fewer than two {}s above 0", what));
  return axis;
}

// What the nodes hold, where they are kept.
class node_filter {
 public:
  node_filter(const read_axis& rho, const read_axis& T) : rho_(rho), T_(T) {}

  std::size_t densities() const { return rho_.nodes.size() + (rho_.skips_first ? 1 : 0); }
  std::size_t temperatures() const { return T_.nodes.size() + (T_.skips_first ? 1 : 0); }
  bool keeps(std::size_t i, std::size_t j) const { return (i > 0 || !rho_.skips_first) && (j > 0 || !T_.skips_first); }
  std::string place(std::size_t i, std::size_t j) const {
    return fmt::format("at {:g} kg/m^3 and {:g} K", rho_.nodes[i - (rho_.skips_first ? 1 : 0)],
                       T_.nodes[j - (T_.skips_first ? 1 : 0)]);
  }

 private:
  const read_axis &rho_, &T_;
};

std::size_t node_count(double x, const text_lines& lines, const char* what) {
  if (!(x >= 2.0 && x <= static_cast<double>(most_nodes) && x == std::floor(x)))
    lines.fail(fmt::format("expected the number of {}, 2 to {}, found {:g}", what, most_nodes, x));
  return static_cast<std::size_t>(x);
}

// From the line with a date, or with the two numbers.
table_data read_swift(text_lines& lines, std::string title) {
  auto sizes = lines.numbers(*lines.next());
  if (sizes.size() == 1) {
    const auto line = lines.next();
    if (!line) lines.fail_all("ends after the date");
    sizes = lines.numbers(*line);
  }
  if (sizes.size() != 2)
    lines.fail(fmt::format("expected the numbers of densities and of temperatures, found {} numbers", sizes.size()));
  const std::size_t n = node_count(sizes[0], lines, "densities"), m = node_count(sizes[1], lines, "temperatures");
  number_stream densities(lines, n, "densities"), temperatures(lines, m, "temperatures");
  const read_axis rho = take_axis(densities, n, 1.0, "density", "kg/m^3");
  densities.end();
  const read_axis T = take_axis(temperatures, m, 1.0, "temperature", "K");
  temperatures.end();
  table_data table{std::move(title), rho.nodes, T.nodes, {}, {}, {}, {}};
  const node_filter filter(rho, T);
  std::size_t row = 0;
  while (row < n * m) {
    const auto line = lines.next();
    if (!line) lines.fail_all(fmt::format("ends after {} of {} rows of u, p, c, s", row, n * m));
    const auto four = lines.numbers(*line);
    if (four.size() != 4)
      lines.fail(fmt::format("expected u, p, c, s of one density and temperature, row {} of {}, found {} numbers",
                             row + 1, n * m, four.size()));
    const std::size_t i = row % n, j = row / n;
    ++row;
    if (!filter.keeps(i, j)) continue;
    if (!std::isfinite(four[0]) || !std::isfinite(four[1]))
      lines.fail(fmt::format("{}, row {}: u = {:g} J/kg and p = {:g} Pa must be finite", filter.place(i, j), row,
                             four[0], four[1]));
    table.u.push_back(four[0]);
    table.p.push_back(four[1]);
  }
  if (lines.next()) lines.fail(fmt::format("follows the last of {} rows", n * m));
  return table;
}

// The whole number behind "NAME =" in a line. None: there is none.
std::optional<std::size_t> number_behind(std::string_view line, std::string_view name) {
  const std::size_t at = line.find(name);
  if (at == std::string_view::npos) return {};
  std::string_view rest = line.substr(at + name.size());
  rest.remove_prefix(std::min(rest.find_first_not_of(" \t="), rest.size()));
  std::size_t value = 0;
  if (std::from_chars(rest.data(), rest.data() + rest.size(), value).ec != std::errc()) return {};
  return value;
}

// Record 301, from its first number.
table_data read_301(text_lines& lines, std::size_t words, std::string title) {
  number_stream from(lines, words, "numbers of record 301");
  const double first = from.next(), second = from.next();
  const std::size_t n = node_count(first, lines, "densities"), m = node_count(second, lines, "temperatures");
  const std::size_t head = 2 + n + m;
  if (words != head + 2 * n * m && words != head + 3 * n * m)
    lines.fail(
        fmt::format("record 301 of {} densities and {} temperatures has {} numbers, or {} with the free energy, "
                    "and says NWDS = {}",
                    n, m, head + 2 * n * m, head + 3 * n * m, words));
  const read_axis rho = take_axis(from, n, 1e3, "density", "kg/m^3");
  const read_axis T = take_axis(from, m, 1.0, "temperature", "K");
  table_data table{std::move(title), rho.nodes, T.nodes, {}, {}, {}, {}};
  const node_filter filter(rho, T);
  const auto take = [&](double factor, std::vector<double>& into, const char* what) {
    for (std::size_t j = 0; j < m; ++j)
      for (std::size_t i = 0; i < n; ++i) {
        const double x = factor * from.next();
        if (!filter.keeps(i, j)) continue;
        if (!std::isfinite(x)) from.fail(fmt::format("{}: the {} is not finite", filter.place(i, j), what));
        into.push_back(x);
      }
  };
  take(1e9, table.p, "pressure");
  take(1e6, table.u, "energy");
  for (std::size_t k = head + 2 * n * m; k < words; ++k) from.next();
  from.end();
  return table;
}

// From the line behind the first.
table_data read_sesame(text_lines& lines, std::string title) {
  while (const auto line = lines.next()) {
    const auto type = number_behind(*line, "TYPE"), words = number_behind(*line, "NWDS");
    if (!type) continue;  // the numbers of a record passed over
    if (!words) lines.fail(fmt::format("expected a record's NWDS =, found '{}'", excerpt(*line)));
    if (*type == 301) return read_301(lines, *words, std::move(title));
  }
  lines.fail_all("has no record of TYPE = 301, the table of pressure and energy");
}

}  // namespace

table_data parse_table(std::string_view text, const std::string& name) {
  text_lines lines(text, name);
  std::string title;
  while (const auto line = lines.next()) {
    if (line->find("MATID") != std::string_view::npos && line->find("NWDS") != std::string_view::npos)
      return read_sesame(lines, std::string(*line));
    const auto words = words_of(*line);
    if (std::ranges::all_of(words, [](std::string_view word) { return number_of(word).has_value(); })) {
      lines.back();
      return read_swift(lines, title);
    }
    if (title.empty()) title = tables::trimmed(line->substr(std::min(line->find_first_not_of('#'), line->size())));
  }
  lines.fail_all("holds no line of numbers: expected a table in SWIFT's form, or a SESAME one with record 301");
}

table_data read_table(const std::string& path) { return parse_table(foundation::read_plain_file(path), path); }

void write_table(std::ostream& out, const table_data& table) {
  constexpr int head = 12;  // lines, which its readers count
  const std::vector<std::string> about{table.title,
                                       "",
                                       "version_date                                 (YYYYMMDD)",
                                       "num_rho  num_T",
                                       "rho[0]   rho[1]  ...                         (kg/m^3)",
                                       "T[0]     T[1]    ...                         (K)",
                                       "u[0, 0]  p[0, 0]  c[0, 0]  s[0, 0]           (J/kg, Pa, m/s, J/(K kg))",
                                       "u[1, 0]  ...",
                                       "...",
                                       "u[0, 1]  ...",
                                       "The first density and temperature are 0, where nothing is known."};
  for (int k = 0; k < head; ++k)
    fmt::print(out, "# {}\n", static_cast<std::size_t>(k) < about.size() ? about[static_cast<std::size_t>(k)] : "");
  const std::size_t n = table.rho.size();
  fmt::print(out, "20260101\n{} {}\n0", n + 1, table.T.size() + 1);
  for (const double rho : table.rho) fmt::print(out, " {:.15g}", rho);
  fmt::print(out, "\n0");
  for (const double T : table.T) fmt::print(out, " {:.15g}", T);
  fmt::print(out, "\n");
  for (std::size_t j = 0; j <= table.T.size(); ++j)
    for (std::size_t i = 0; i <= n; ++i) {
      if (i == 0 || j == 0) {
        fmt::print(out, "0 0 0 0\n");
        continue;
      }
      const std::size_t k = (j - 1) * n + i - 1;
      fmt::print(out, "{:.12e} {:.12e} {:.6e} {:.6e}\n", table.u[k], table.p[k], table.c[k], table.s[k]);
    }
}

}  // namespace tetsuame::eos
