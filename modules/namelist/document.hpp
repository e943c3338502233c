// A Fortran namelist file taken apart: groups, assignments, values, each with its line. The syntax is that of Fortran
// 2018 (ISO/IEC 1539-1:2018, 13.11) with what gfortran adds: $name … $end, &end, semicolons as separators. Where
// gfortran 12 departs from the standard, the standard is followed: a comment after a comma, or a comma at the beginning
// of a line, adds no null value. Not read: complex numbers, derived types (a%b), substrings (s(2:3)), arrays of more
// than one dimension. All errors are of status bad_input.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tetsuame::namelist {

// More than these is taken for an accident (or an attack), not for an input.
inline constexpr std::size_t maximum_bytes = std::size_t{16} << 20;
inline constexpr std::size_t maximum_items = std::size_t{1} << 18;  // groups, assignments and values together
inline constexpr std::size_t maximum_name = 63;                     // as in Fortran

// Groups that may stand several times in one input, unlike others: what a further one gives of its lists goes behind
// the elements that those before it gave. Where such a group has no lists, it stands once (schema.cpp).
inline constexpr std::array<std::string_view, 8> repeated_groups{"region", "material", "inflow",  "outflow",
                                                                 "layer",  "grain",    "packing", "pair"};

struct value {
  enum class kind {
    null,  // keeps what is there: `,,` or `3*`
    word,  // anything without quotes
    text,  // was in quotes, which are taken off
  };
  kind what = kind::null;
  std::string content;
  std::uint64_t repeat = 1;
  bool counted = false;  // a repeat count was written
  std::size_t line = 0;  // from 1; 0: from --set
};

// a(first), a(first:last:stride); what is left out of a section is empty.
struct subscript {
  std::optional<std::int64_t> first, last;
  std::int64_t stride = 1;
  bool section = false;
};

struct assignment {
  std::string key;  // lower case
  std::optional<subscript> index;
  std::vector<value> values;
  std::size_t line = 0;
  std::string set;  // the argument of --set it came from, else empty
};

struct group {
  std::string name;  // lower case
  std::size_t line = 0;
  std::vector<assignment> assignments;
};

class document {
 public:
  document() = default;
  explicit document(std::string name) : name_(std::move(name)) {}  // without a text: all comes by set()
  // An override "group.key=value" or "group.key(2)=value, value", read after the
  // file's own, of a group that stands several times behind the last. A shell takes quotes away, so a text may stand
  // here without them.
  void set(const std::string& argument);

  const std::vector<group>& groups() const { return groups_; }
  const std::string& name() const { return name_; }
  // "file:line", or "--set group.key=value"
  std::string where(const assignment& from) const;
  std::string where(const assignment& from, const value& at) const;

 private:
  friend document parse_text(std::string_view text, std::string name);
  std::string name_;
  std::vector<group> groups_;
};

// name: how messages call the text, commonly its path. A text without any group is an error.
document parse_text(std::string_view text, std::string name);
// What a file holds, but for one byte more than allowed, which parse_text refuses: a device has no end.
std::string read_file(const std::filesystem::path& path);
inline document parse_file(const std::filesystem::path& path) { return parse_text(read_file(path), path.string()); }

}  // namespace tetsuame::namelist
