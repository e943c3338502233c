// A snapshot's columns out of plain arrays.
#pragma once

#include <output/groups.hpp>
#include <string>
#include <utility>

namespace tetsuame::output {

// components: arrays, one a dimension.
template <class Arrays>
column vector_column(std::string name, std::string units, std::string description, const Arrays& components) {
  column c{std::move(name), std::move(units), std::move(description), {}, true};
  for (const auto& component : components) c.components.push_back(component.data());
  return c;
}

// What every snapshot of particles begins with.
template <class Particles>
particle_group fluid_in_motion(const Particles& s) {
  return {0,
          s.fluid,
          s.id.data(),
          {vector_column("Coordinates", "m", "position", s.x), vector_column("Velocities", "m/s", "velocity", s.v)}};
}

}  // namespace tetsuame::output
