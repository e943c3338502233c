// How keys are spoken of and their values written: private to this module.
#pragma once

#include <namelist/schema.hpp>
#include <string>

namespace tetsuame::namelist {

std::string type_name(const key& k);  // "integer", "list of reals", …
std::string limits(const key& k);     // "> 0", "in [0, 1)", "one of 'a', 'b'"; empty: none
std::string expected(const key& k);   // type, unit and limits, for messages
bool in_range(double number, const key_info& info);
// The target's value as in a namelist; empty if there is none or it is not finite.
std::string value_text(const target& bound);

}  // namespace tetsuame::namelist
