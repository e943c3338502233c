// Between values and their text: Fortran's numbers and logicals, the shortest form
// that reads back as the same double, quotes, and the nearest of several names.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tetsuame::namelist {

std::string lower(std::string_view text);
bool is_letter(char c);
bool is_digit(char c);
bool is_name_character(char c);  // letter, digit, underscore

// Empty if the word is no number or logical of that kind. A real may be 1.5, 1.5e-3,
// 1.5d-3, 1.5q-3, 1.5-3, inf, nan: too large is infinite, too small zero. out_of_range
// is set where the word is an integer that has no 64-bit value.
std::optional<double> to_real(std::string_view word);
std::optional<std::int64_t> to_integer(std::string_view word, bool& out_of_range);
std::optional<bool> to_logical(std::string_view word);

std::string format_real(double number);  // shortest, exact; number is finite
std::string quote(std::string_view text);
// Why bytes are no text in ASCII or UTF-8, for a message behind the file's name, with what was expected ("a namelist");
// empty: they may be.
std::string not_text(std::string_view bytes, std::string_view expected);
// For messages: at most 40 bytes, control characters replaced.
std::string excerpt(std::string_view text);

// Least number of letters to insert, delete, replace or swap with a neighbour
// (optimal string alignment distance; case does not count). Empty if names is.
std::string nearest(std::string_view name, const std::vector<std::string>& names);

}  // namespace tetsuame::namelist
