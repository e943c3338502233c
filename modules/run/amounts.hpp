// What a run takes, as text and as numbers that follow from the lattice.
#pragma once

#include <cstdint>
#include <string>

namespace tetsuame::run {

std::string duration_text(double seconds);  // "35 s", "1.2 h", "2.1 days"
std::string size_text(double bytes);        // "675 kB", "1.2 GB"

// Particles of a lattice within r spacings of one of them.
double particles_within(double r_over_dx, std::int64_t dimension);

// The program that a group of an input is for, where it is for no other; empty: several.
std::string program_of_group(const std::string& group);

}  // namespace tetsuame::run
