// Particles as the output sees them: named columns of plain arrays, without physics.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tetsuame::output {

// One quantity of a group. Each component points to as many values as the group has
// particles on this rank; a vector has one component per dimension of the problem and
// is written with three, the missing ones zero.
struct column {
  std::string name, units, description;
  std::vector<const double*> components;
  bool vector = false;
};

// The part of a group that this rank holds. Type, and names and order of the columns,
// are the same on every rank; an ID occurs once in the group over all ranks.
struct particle_group {
  int type = 0;  // 0 fluid, 1 wall: the number in /PartType0
  std::size_t n = 0;
  const std::int64_t* ids = nullptr;
  std::vector<column> columns;
};

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
