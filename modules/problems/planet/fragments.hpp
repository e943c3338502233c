// The impactor's metal after an impact: into how many pieces it breaks, how deep it lies, how much of it is mixed with
// rock.
#pragma once

#include <gas/setups.hpp>

namespace tetsuame::planet {

// Pieces are found as friends of friends [M. Davis et al., Astrophys. J. 292, 371 (1985)]: particles of metal hang
// together if they are nearer than 1.5 spacings, the mean of both, (m/ρ)^(1/3) each and at most twice the mean of all
// metal. Metal of the impactor has merged if half of its piece or more is metal of the target; it is mixed if
// within 1.5 spacings of it there are no fewer particles of rock than of metal, it among them.
struct metal_of_impactor {
  double pieces = 0.0;                              // that have not merged
  double largest = 0.0, merged = 0.0, mixed = 0.0;  // mass over that of all metal of the impactor
  double distance = 0.0;  // m, mean by mass from the centre of the target's metal; 0 without such
};
// Particles with these IDs or higher are the impactor's. Collective; the result does not depend on the number of ranks.
metal_of_impactor find_metal_of_impactor(const gas::view& all, std::int64_t first_of_impactor, std::int32_t metal);

}  // namespace tetsuame::planet
