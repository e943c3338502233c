// The reader behind document: private to this module.
#pragma once

#include <namelist/document.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace tetsuame::namelist {

// A file has comments, terminators and further keys; the argument of --set is one
// assignment, in which only blanks and commas separate, so that a path needs no quotes.
enum class syntax { file, argument };

std::vector<group> parse_groups(std::string_view text, const std::string& name);
// argument: GROUP.KEY[(…)]=VALUES; group_name is an output.
assignment parse_argument(const std::string& argument, std::string& group_name);

}  // namespace tetsuame::namelist
