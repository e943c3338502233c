#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <limits>
#include <namelist/text.hpp>

namespace tetsuame::namelist {

namespace {

char lower_letter(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

std::optional<double> infinite_or_nan(std::string_view unsigned_word) {
  const std::string word = lower(unsigned_word);
  if (word == "inf" || word == "infinity") return std::numeric_limits<double>::infinity();
  if (word == "nan" || (word.starts_with("nan(") && word.ends_with(')')))
    return std::numeric_limits<double>::quiet_NaN();
  return {};
}

}  // namespace

bool is_letter(char c) { return lower_letter(c) >= 'a' && lower_letter(c) <= 'z'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_name_character(char c) { return is_letter(c) || is_digit(c) || c == '_'; }

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(), lower_letter);
  return result;
}

std::optional<double> to_real(std::string_view word) {
  const bool negative = word.starts_with('-');
  if (negative || word.starts_with('+')) word.remove_prefix(1);
  const double sign = negative ? -1.0 : 1.0;
  if (const auto special = infinite_or_nan(word)) return sign * *special;

  // As C writes it: e for d and q, and for the letter that Fortran may leave out (1.5-3).
  std::string plain;
  for (const char c : lower(word)) {
    const bool is_sign = c == '+' || c == '-';
    if (is_sign && plain.empty()) return {};
    if (is_sign && plain.back() != 'e') plain += 'e';
    plain += c == 'd' || c == 'q' ? 'e' : c;
  }
  if (plain.empty() || plain.find_first_not_of("0123456789.e+-") != std::string::npos) return {};
  char* end = nullptr;
  const double size = std::strtod(plain.c_str(), &end);
  if (end != plain.c_str() + plain.size()) return {};
  return sign * size;
}

std::optional<std::int64_t> to_integer(std::string_view word, bool& out_of_range) {
  out_of_range = false;
  if (word.starts_with('+')) {
    word.remove_prefix(1);
    if (word.starts_with('-')) return {};
  }
  std::int64_t number = 0;
  const auto result = std::from_chars(word.data(), word.data() + word.size(), number);
  if (result.ptr != word.data() + word.size()) return {};
  out_of_range = result.ec == std::errc::result_out_of_range;
  if (result.ec != std::errc()) return {};
  return number;
}

std::optional<bool> to_logical(std::string_view word) {
  // Fortran looks only at the first letter behind an optional point.
  if (word.starts_with('.')) word.remove_prefix(1);
  if (word.empty()) return {};
  if (lower_letter(word[0]) == 't') return true;
  if (lower_letter(word[0]) == 'f') return false;
  return {};
}

std::string format_real(double number) {
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, number);
  return {buffer, result.ptr};
}

std::string quote(std::string_view text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') result += c;
    result += c;
  }
  return result + '\'';
}

std::string not_text(std::string_view bytes, std::string_view expected) {
  const bool hdf5 = bytes.starts_with("\x89HDF\r\n\x1a\n") || bytes.starts_with("tetsuame checkpoint ");
  if (!hdf5 && (bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff")))
    return "is text in UTF-16: save it as UTF-8 or ASCII";
  if (!hdf5 && bytes.find('\0') == std::string_view::npos) return "";
  return fmt::format("is {} file, where {} is expected", hdf5 ? "an HDF5" : "a binary", expected);
}

std::string excerpt(std::string_view text) {
  constexpr std::size_t longest = 40;
  std::string result(text.substr(0, longest));
  for (char& c : result)
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = '?';
  // Do not cut a UTF-8 character in two.
  if (text.size() > longest) {
    while (!result.empty() && (static_cast<unsigned char>(text[result.size()]) & 0xc0) == 0x80) result.pop_back();
    result += "...";
  }
  return result;
}

namespace {

std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

}  // namespace

std::string nearest(std::string_view name, const std::vector<std::string>& names) {
  const std::string wanted = lower(name.substr(0, 2 * 63));
  std::string best;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const std::string& candidate : names)
    if (const std::size_t d = distance(wanted, lower(candidate)); d < least) {
      least = d;
      best = candidate;
    }
  return best;
}

}  // namespace tetsuame::namelist
