// The parts of the input's reading, a file each: options.cpp, gauge_options.cpp, body_options.cpp.
#pragma once

#include <free_surface/options.hpp>
#include <gauges/options.hpp>

namespace tetsuame::free_surface {

using gauges::along;

void declare_gauges(namelist::schema& schema, gauge_options& o);
void resolve_gauges(const namelist::schema& schema, options& o, parameters& p);

// Bodies of the box's dimension, D. Needs the blocks of water.
template <int D>
void resolve_bodies(const namelist::schema& schema, options& o, parameters& p);

}  // namespace tetsuame::free_surface
