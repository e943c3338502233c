// The programs that cases in rig.hpp measure: the very schemes, with the library that the programs are linked with.
#pragma once

#include <liquid/scheme.hpp>
#include <programs/disph_c.hpp>
#include <string>

namespace tetsuame::bench {

// Of that case: program_c, program_f, number_density, or transport, which is program C where viscosity and conductivity
// are each particle's own.
const liquid::program& program_of(const std::string& name);
int passes_of(const std::string& name);  // over the lists in one right-hand side

}  // namespace tetsuame::bench
