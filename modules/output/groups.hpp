// Particles as the output sees them: named columns of plain arrays, without physics.
#pragma once

#include <mpi.h>

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

// A fingerprint of a state: equal for equal particles, however they lie on ranks,
// threads and in memory. For a particle with ID i of type t and values x_1 … x_k (the
// columns' components in the order given), with m of hash.hpp, in two lanes with
// different constants,
//
//   s_0 = m(i + m(t + A)),   s_j = m(s_{j-1} xor bits(x_j)) + A,   hash = sum s_k mod 2^64
//
// A change of any bits of one value of one particle always changes the hash; two states that differ otherwise
// (particles that swap values, say) share it with a probability of 2^-128.
//
// Collective. 32 hexadecimal digits, the same on every rank. Names, units and
// descriptions of the columns do not enter.
std::string state_hash(MPI_Comm comm, const std::vector<particle_group>& groups);

}  // namespace tetsuame::output
