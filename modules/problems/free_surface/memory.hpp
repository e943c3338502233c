// What a run of water takes of memory, before anything is laid out.
#pragma once

#include <free_surface/options.hpp>
#include <run/amounts.hpp>

namespace tetsuame::free_surface {

// As the water stands at the start, counted at places spread over the box.
struct particle_numbers {
  double fluid = 0.0, in_bodies = 0.0;
  double images = 0.0;  // of either, near the sides
};
particle_numbers numbers_at_start(const options& o, const parameters& p);

run::memory_need need_of(const options& o, const parameters& p);

}  // namespace tetsuame::free_surface
