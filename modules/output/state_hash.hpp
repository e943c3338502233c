// A fingerprint of a state: equal for equal particles, however they lie on ranks,
// threads and in memory. For a particle with ID i of type t and values x_1 … x_k (the
// columns' components in the order given), with m of hash.hpp, in two lanes with
// different constants,
//
//   s_0 = m(i + m(t + A)),   s_j = m(s_{j-1} xor bits(x_j)) + A,   hash = sum s_k mod 2^64
//
// A change of any bits of one value of one particle always changes the hash; two states that differ otherwise
// (particles that swap values, say) share it with a probability of 2^-128.
#pragma once

#include <mpi.h>

#include <output/groups.hpp>
#include <string>
#include <vector>

namespace tetsuame::output {

// Collective. 32 hexadecimal digits, the same on every rank. Names, units and
// descriptions of the columns do not enter.
std::string state_hash(MPI_Comm comm, const std::vector<particle_group>& groups);

}  // namespace tetsuame::output
