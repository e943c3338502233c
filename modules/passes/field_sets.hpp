// Sets of fields, for the schedule.
#pragma once

#include <algorithm>
#include <passes/schedule.hpp>
#include <set>

namespace tetsuame::passes {

using field_set = std::set<const field*>;

template <class Some>
bool all_in(const Some& some, const field_set& those) {
  return std::all_of(some.begin(), some.end(), [&](const field* f) { return those.contains(f); });
}
template <class Some>
bool any_in(const Some& some, const field_set& those) {
  return std::any_of(some.begin(), some.end(), [&](const field* f) { return those.contains(f); });
}
template <class Some>
void insert(field_set& into, const Some& some) {
  into.insert(some.begin(), some.end());
}

}  // namespace tetsuame::passes
