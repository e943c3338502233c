// A viscosity that varies.
#include <convection/pass.hpp>

namespace tetsuame::convection {

template void sum_over_neighbours<2, unknown<2>::count, true>(convection_state<2>&, const pairs::row_range&, bool);
template void sum_over_neighbours<3, unknown<3>::count, true>(convection_state<3>&, const pairs::row_range&, bool);

}  // namespace tetsuame::convection
