// Zoltan's geometric partitioners, for comparison [K. Devine et al., Comput. Sci. Eng. 4 (2), 90 (2002)]:
// recursive coordinate bisection (rcb) and the Hilbert space-filling curve (hsfc), called in one process
// for as many parts as there are virtual ranks.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace tetsuame::virtual_ranks {

// Whether this program is built with Zoltan. Without, partition() is declared only, and no input may ask for it.
constexpr bool with_zoltan = TETSUAME_ZOLTAN;

// The part of each particle. weights: of each particle; empty: all equal. sizes: what part of the weight each
// part should get, up to a common factor. Throws fail_calculation if Zoltan refuses.
template <int D>
std::vector<int> partition(const std::string& method, const std::vector<std::array<double, D>>& x,
                           const std::vector<float>& weights, const std::vector<double>& sizes);

}  // namespace tetsuame::virtual_ranks
