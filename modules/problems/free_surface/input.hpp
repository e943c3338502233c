// The parts of the input's reading, a file each: options.cpp, gauge_options.cpp, body_options.cpp,
// opening_options.cpp.
#pragma once

#include <free_surface/options.hpp>
#include <gauges/options.hpp>

namespace tetsuame::free_surface {

using gauges::along;

void declare_gauges(namelist::schema& schema, gauge_options& o);
void resolve_gauges(const namelist::schema& schema, options& o, parameters& p);

void declare_openings(namelist::schema& schema, options& o);
// Needs dx and the kernel; before the blocks' height is that of the water.
void find_openings(const namelist::schema& schema, const options& o, parameters& p);
// What does not go with them; needs bodies.
void check_openings(const namelist::schema& schema, const options& o, const parameters& p);
// m/s, the largest that the input asks of entering water; 0: none enters.
double fastest_inflow(const options& o, const parameters& p);

// Bodies of the box's dimension, D. Needs the blocks of water.
template <int D>
void resolve_bodies(const namelist::schema& schema, options& o, parameters& p);

}  // namespace tetsuame::free_surface
