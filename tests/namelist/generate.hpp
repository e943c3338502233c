// Random namelist files for the group &sample, from a seed; the same on every machine.
#pragma once

#include <cstdint>
#include <string>

std::string generate(std::uint64_t seed);
