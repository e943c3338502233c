// Particles as the output sees them: named columns of plain arrays, without physics.
#pragma once

#include <mpi.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tetsuame::output {

// One quantity of a group. Each component points to as many values as the group has
// particles on this rank; a vector has one component per dimension of the problem and
// is written with three, the missing ones zero.
struct column {
  std::string name, units, description;
  std::vector<const double*> components;
  bool vector = false;
  bool integer = false;    // written as such
  std::string names = {};  // of what its values number, with ", " between; empty: none
};

// The part of a group that this rank holds. Type, and names and order of the columns,
// are the same on every rank; an ID occurs once in the group over all ranks.
struct particle_group {
  int type = 0;  // 0 fluid, 1 wall: the number in /PartType0
  std::size_t n = 0;
  const std::int64_t* ids = nullptr;
  std::vector<column> columns;
  int dimension = 3;
};

// What the snapshots of every program have.
inline constexpr std::array common_fields{"ParticleIDs", "Coordinates", "Velocities",      "Masses",  "Density",
                                          "Pressure",    "Temperature", "SmoothingLength", "Material"};

// Of the table in groups.cpp, which knows unit and meaning: a name has the same in every program.
struct quantity_info {
  std::string unit;
  bool vector;
};
// In that many dimensions; none that is not in the table.
std::optional<quantity_info> find_quantity(std::string_view name, int dimension);

// Adds a quantity of the table.
// components: one, or one a dimension, each from the group's first particle on.
void add_quantity(particle_group& g, std::string_view name, std::vector<const double*> components);

// `n` particles from `begin` on, with what is the same in all programs; the rest is added by name.
template <class Particles>
particle_group group_of(const Particles& s, int type, std::size_t begin, std::size_t n) {
  particle_group g{type, n, s.id.data() + begin, {}, static_cast<int>(s.x.size())};
  const auto add = [&](const char* name, const auto& vector) {
    std::vector<const double*> components;
    for (const auto& component : vector) components.push_back(component.data() + begin);
    add_quantity(g, name, components);
  };
  add("Coordinates", s.x);
  add("Velocities", s.v);
  return g;
}

// An array made for the occasion: value(i) of n particles. It stays where it is as long as `made`.
template <class Arrays, class Value>
const double* make_array(Arrays& made, std::size_t n, Value&& value) {
  auto& a = made.emplace_back(n);
  for (std::size_t i = 0; i < n; ++i) a[i] = value(i);
  return a.data();
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
