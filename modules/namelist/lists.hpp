// Groups that may stand several times (document.hpp), read as lists with an element for each.
#pragma once

#include <algorithm>
#include <cmath>
#include <namelist/schema.hpp>

namespace tetsuame::namelist {

// The key of a list of at most so many, any of which may be left out, from the key of one.
inline key_info one_each(key_info of_one, std::size_t most) {
  of_one.maximum_size = most;
  of_one.sparse = of_one.may_be_left_open = true;
  return of_one;
}

// Element n; not given: nothing, or an empty text.
inline std::optional<double> element_of(const std::vector<double>& values, std::size_t n) {
  return n < values.size() && std::isfinite(values[n]) ? std::optional(values[n]) : std::nullopt;
}
inline std::string element_of(const std::vector<std::string>& texts, std::size_t n) {
  return n < texts.size() ? texts[n] : std::string();
}

// How many groups there were, by the longest list.
template <class... Lists>
std::size_t longest(const Lists&... lists) {
  std::size_t most = 0;
  ((most = std::max(most, lists.size())), ...);
  return most;
}

}  // namespace tetsuame::namelist
