// The cells of a line of a table, and what they say.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tetsuame::tables {

struct cell {
  std::string text;
  bool quoted = false;
};

std::string_view trimmed(std::string_view text);

// separator: ' ' stands for any number of blanks and tabs. None: a quote is not closed.
std::optional<std::vector<cell>> cells_of(std::string_view line, char separator);

// Also infinite and nan; nothing else has no exponent's letter (1.5-3, which might be a date).
std::optional<double> number_of(std::string_view text);

// The separator that a line of numbers has.
char separator_of(std::string_view line);

// Whether the line begins with a number, or with what stands for one that is missing.
bool begins_with_number(std::string_view line);

// What a unit is in SI, and of which dimension: "s", "m", "Pa", "N", "N m", "degrees", "K", "Pa s". None: unknown.
struct unit {
  std::string_view dimension;
  double factor;
};
std::optional<unit> unit_of(std::string_view text);

// "h" and "mm" of the heading "h [mm]" or "h (mm)"; the second is empty where there is none.
struct heading {
  std::string name, unit;
};
heading heading_of(std::string_view text);

}  // namespace tetsuame::tables
