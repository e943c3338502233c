// Grains in a plane or in space, each compiled by itself for a width of SIMD registers.
#pragma once

#include <granular/options.hpp>
#include <memory>
#include <run/simulation.hpp>

namespace tetsuame::granular {

// The options outlive the simulation.
std::unique_ptr<run::simulation> make_2d(const options& o);
std::unique_ptr<run::simulation> make_3d(const options& o);

}  // namespace tetsuame::granular
