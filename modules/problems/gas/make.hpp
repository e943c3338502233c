// The problem in one, two and three dimensions, each compiled by itself (programs/shock). coarser: runs before this
// one, for the order of convergence.
#pragma once

#include <gas/convergence.hpp>

namespace tetsuame::gas {

std::unique_ptr<run::problem> make_1d(const options& o, const std::vector<level>& coarser);
std::unique_ptr<run::problem> make_2d(const options& o, const std::vector<level>& coarser);
std::unique_ptr<run::problem> make_3d(const options& o, const std::vector<level>& coarser);

}  // namespace tetsuame::gas
