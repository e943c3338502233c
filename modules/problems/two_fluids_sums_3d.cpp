#include <liquid/passes.hpp>
#include <two_fluids/passes.hpp>

TETSUAME_TWO_FLUIDS_SUMS(, 3);
