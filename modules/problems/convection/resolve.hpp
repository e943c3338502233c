// How what the input leaves open is chosen, each from what stands above it: private to this module.
#pragma once

#include <convection/options.hpp>

namespace tetsuame::convection {

// The density that gravity weighs, if it is that of an equation of state.
void resolve_gravity(const namelist::schema& schema, const options& o, parameters& p);
// The law of viscosity, and the top's viscosity where a table has it.
void resolve_viscosity(const namelist::schema& schema, options& o, parameters& p);
// Target, slowed sound and inertia, viscous response, and how the viscosity comes to its law.
void resolve_slowing(options& o, parameters& p);

}  // namespace tetsuame::convection
