// The sums over neighbours of flow_3d.cpp.
#include <free_surface/right_hand_side.hpp>

namespace tetsuame::free_surface {

template void sum_over_neighbours(water<3>&, const pairs::row_range&);
template void sum_over_neighbours(water<3>&, const pairs::row_subset&);

}  // namespace tetsuame::free_surface
