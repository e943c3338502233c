// Tables of numbers that a user gives: measured curves, motions, viscosities. One dialect for all of them
// (docs/user_guide.md, "Tables"):
//
//   - text in ASCII or UTF-8, with a byte order mark or without; lines end with LF, CRLF or CR
//   - empty lines, and lines that begin with #, ! or %, are passed over; behind numbers # begins a comment
//   - numbers as in Fortran: +0.2, 1e-3, 1D0; nan, inf, words and empty cells stand where there is no number
//   - between columns semicolons, tabs, commas or blanks: what the first line of numbers has, looked for in that order
//   - cells may be in quotes, single or double; a quote in them is doubled
//   - the first line that does not begin with a number names the columns, a second one is their units
//
// What is no number matters only in a column that is used. All errors are of status bad_input, with file, line and
// column.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tetsuame::tables {

class table {
 public:
  // name: what messages call the text, commonly its path.
  table(std::string_view text, std::string name);
  static table read(const std::string& path);

  const std::string& name() const { return name_; }
  const std::vector<std::string>& headings() const { return headings_; }  // empty: there are none
  std::size_t columns() const { return columns_; }
  std::size_t rows() const { return lines_.size(); }

  // Of the column with that heading. None: there is none.
  std::optional<std::size_t> column(std::string_view heading) const;
  // Of the column with one of these headings, in any case and with a unit in brackets behind it or without.
  std::optional<std::size_t> column_of(std::initializer_list<std::string_view> headings) const;

  // All of a column; fails at the first that is no finite number.
  std::vector<double> numbers(std::size_t column) const;
  // And where a number is not above that of the row before. what: "time", for the message.
  std::vector<double> ascending(std::size_t column, std::string_view what) const;

  // Fails where the column's heading or the row of units says another unit than the one of this factor to SI: "ms"
  // where times are in s. What it does not know it lets pass.
  void expect_unit(std::size_t column, std::string_view dimension, double factor) const;

  [[noreturn]] void fail(const std::string& message) const;                                          // file
  [[noreturn]] void fail_at(std::size_t row, const std::string& message) const;                      // and line
  [[noreturn]] void fail_at(std::size_t row, std::size_t column, const std::string& message) const;  // and column

 private:
  struct line_of_text {
    std::string_view text;
    std::size_t number;  // from 1
  };
  std::vector<line_of_text> lines_of(std::string_view text) const;
  void read_head(const std::vector<line_of_text>& head);
  void read_rows(const std::vector<line_of_text>& rows);
  std::string column_text(std::size_t column) const;

  std::string name_;
  char separator_ = ' ';  // ' ': blanks and tabs
  std::size_t columns_ = 0;
  std::vector<std::string> headings_, units_;
  std::vector<std::size_t> lines_;                // of each row
  std::vector<std::vector<double>> values_;       // by column; nan: no number
  std::vector<std::vector<std::string>> others_;  // by column: what stood there instead, in the order of rows
};

}  // namespace tetsuame::tables
