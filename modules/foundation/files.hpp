// Files that a user names, read whole.
#pragma once

#include <string>

namespace tetsuame::foundation {

// Fails, with bad_input and the path, where it is no plain file: a pipe or a device might never answer, and would not
// give the same again.
void expect_plain_file(const std::string& path);

// All bytes of a plain file; bad_input where it cannot be read.
std::string read_plain_file(const std::string& path);

}  // namespace tetsuame::foundation
