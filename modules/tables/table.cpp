#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <foundation/error.hpp>
#include <foundation/files.hpp>
#include <limits>
#include <namelist/text.hpp>
#include <tables/cells.hpp>
#include <tables/table.hpp>
#include <utility>

namespace tetsuame::tables {

using namelist::excerpt;

table table::read(const std::string& path) { return {foundation::read_plain_file(path), path}; }

table::table(std::string_view text, std::string name) : name_(std::move(name)) {
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
  if (const auto fault = namelist::not_text(text, "a table in text"); !fault.empty()) fail(fault);
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  const auto lines = lines_of(text);
  const auto first =
      std::ranges::find_if(lines, [](const line_of_text& line) { return begins_with_number(line.text); });
  if (first == lines.end()) fail("holds no line of numbers");
  separator_ = separator_of(first->text.substr(0, first->text.find('#')));
  read_head({lines.begin(), first});
  read_rows({first, lines.end()});
}

// Those that are neither empty nor comments.
std::vector<table::line_of_text> table::lines_of(std::string_view text) const {
  std::vector<line_of_text> all;
  std::size_t number = 1;
  for (std::size_t at = 0; at < text.size(); ++number) {
    const std::size_t end = std::min(text.find_first_of("\r\n", at), text.size());
    const auto line = trimmed(text.substr(at, end - at));
    // Also a line of empty cells, as spreadsheets leave them behind.
    const bool empty = line.find_first_not_of(" \t,;\"") == std::string_view::npos;
    if (!empty && std::string_view("#!%").find(line.front()) == std::string_view::npos) all.push_back({line, number});
    at = end + (text.substr(end, 2) == "\r\n" ? 2 : 1);
  }
  return all;
}

namespace {

// A separator behind the last column is none between columns.
void drop_last_empty(std::vector<cell>& cells, std::size_t expected) {
  if (cells.size() == expected + 1 && cells.back().text.empty() && !cells.back().quoted) cells.pop_back();
}

}  // namespace

void table::read_head(const std::vector<line_of_text>& head) {
  for (std::size_t k = 0; k < head.size(); ++k) {
    auto cells = cells_of(head[k].text, separator_);
    const auto place = fmt::format("{}:{}: ", name_, head[k].number);
    if (!cells) foundation::fail_input(place + "a quote is not closed");
    if (k == 2) foundation::fail_input(fmt::format("{}expected numbers, found '{}'", place, excerpt(head[k].text)));
    drop_last_empty(*cells, k == 0 ? cells->size() - 1 : headings_.size());
    for (const auto& c : *cells) (k == 0 ? headings_ : units_).push_back(c.text);
    if (k == 1 && units_.size() != headings_.size())
      foundation::fail_input(fmt::format("{}expected numbers, or the units of {} columns, found '{}'", place,
                                         headings_.size(), excerpt(head[k].text)));
  }
  for (std::size_t k = 0; k < headings_.size(); ++k)
    for (std::size_t n = 0; n < k; ++n)
      if (headings_[k] == headings_[n] && !headings_[k].empty())
        foundation::fail_input(fmt::format("{}:{}: columns {} and {} have the same name, '{}'", name_,
                                           head.front().number, n + 1, k + 1, excerpt(headings_[k])));
}

void table::read_rows(const std::vector<line_of_text>& rows) {
  columns_ = headings_.size();
  for (const auto& row : rows) {
    const auto text = row.text.substr(0, row.text.find('#'));
    const auto place = fmt::format("{}:{}: ", name_, row.number);
    auto cells = cells_of(text, separator_);
    if (!cells) foundation::fail_input(place + "a quote is not closed");
    drop_last_empty(*cells, columns_ == 0 ? cells->size() - 1 : columns_);
    // Lines may be aligned by blanks and tabs alike, whatever the others have.
    if (cells->size() != columns_ && text.find_first_of(",;") == std::string_view::npos) cells = cells_of(text, ' ');
    if (columns_ == 0) columns_ = cells->size();
    if (cells->size() != columns_)
      foundation::fail_input(fmt::format("{}expected {} columns with {} between, {}, found {}: '{}'", place, columns_,
                                         separator_ == ' '    ? "blanks"
                                         : separator_ == '\t' ? "tabs"
                                         : separator_ == ','  ? "commas"
                                                              : "semicolons",
                                         headings_.empty()
                                             ? "as in the lines before"
                                             : "one a heading (a heading with a blank in it stands in quotes)",
                                         cells->size(), excerpt(row.text)));
    lines_.push_back(row.number);
    values_.resize(columns_);
    others_.resize(columns_);
    for (std::size_t k = 0; k < columns_; ++k) {
      const auto number = number_of((*cells)[k].text);
      const bool finite = number && std::isfinite(*number);
      values_[k].push_back(finite ? *number : std::numeric_limits<double>::quiet_NaN());
      if (!finite) others_[k].push_back((*cells)[k].text);
    }
  }
}

std::optional<std::size_t> table::column(std::string_view heading) const {
  const auto found = std::ranges::find(headings_, heading);
  if (found == headings_.end()) return {};
  return static_cast<std::size_t>(found - headings_.begin());
}

std::optional<std::size_t> table::column_of(std::initializer_list<std::string_view> names) const {
  std::optional<std::size_t> found;
  for (std::size_t k = 0; k < headings_.size(); ++k) {
    const auto name = namelist::lower(heading_of(headings_[k]).name);
    if (std::ranges::find(names, name) == names.end()) continue;
    if (found) fail(fmt::format("columns {} and {} are both '{}'", *found + 1, k + 1, excerpt(name)));
    found = k;
  }
  return found;
}

std::vector<double> table::numbers(std::size_t column) const {
  const auto& values = values_.at(column);
  const auto none = std::ranges::find_if(values, [](double x) { return std::isnan(x); });
  if (none == values.end()) return values;
  const std::string& other = others_[column].front();
  const auto row = static_cast<std::size_t>(none - values.begin());
  if (other.empty()) fail_at(row, column, "expected a number, found nothing");
  const bool comma = other.find(',') != std::string::npos && separator_ != ',';
  fail_at(row, column,
          fmt::format("expected a finite number, found '{}'{}", excerpt(other),
                      comma ? ": decimals stand behind a point" : ""));
}

std::vector<double> table::ascending(std::size_t column, std::string_view what) const {
  auto values = numbers(column);
  for (std::size_t n = 1; n < values.size(); ++n)
    if (!(values[n] > values[n - 1]))
      fail_at(n, column,
              fmt::format("{} {} does not lie behind that of the row before, {}", what, values[n], values[n - 1]));
  return values;
}

void table::expect_unit(std::size_t column, std::string_view dimension, double factor) const {
  std::string told = column < units_.size() ? units_[column] : "";
  if (told.size() > 2 && ((told.front() == '[' && told.back() == ']') || (told.front() == '(' && told.back() == ')')))
    told = trimmed(std::string_view(told).substr(1, told.size() - 2));
  if (told.empty() && column < headings_.size()) told = heading_of(headings_[column]).unit;
  const auto is = unit_of(told);
  if (!is) return;
  if (is->dimension == dimension && std::abs(is->factor - factor) <= 1e-9 * factor) return;
  fail(fmt::format("{} is in {}, and is read in units of {} {}", column_text(column), told, factor, dimension));
}

std::string table::column_text(std::size_t column) const {
  if (column >= headings_.size() || headings_[column].empty()) return fmt::format("column {}", column + 1);
  return fmt::format("column {} ('{}')", column + 1, excerpt(headings_[column]));
}

void table::fail(const std::string& message) const { foundation::fail_input(fmt::format("{}: {}", name_, message)); }

void table::fail_at(std::size_t row, const std::string& message) const {
  foundation::fail_input(fmt::format("{}:{}: {}", name_, lines_.at(row), message));
}

void table::fail_at(std::size_t row, std::size_t column, const std::string& message) const {
  fail_at(row, fmt::format("{}: {}", column_text(column), message));
}

}  // namespace tetsuame::tables
