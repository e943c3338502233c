// What a list of passes is refused for.
#pragma once

#include <passes/schedule.hpp>

namespace tetsuame::passes {

// Throws std::logic_error that names pass and field: one that is read and that no pass before has written, or that two
// write, or two give behind walls; a rate that no pass writes, or that is written after its last writer.
void refuse_faults(const std::vector<pass>& passes, const known_fields& known);

}  // namespace tetsuame::passes
