// What flow_2d.cpp and the tests compute on particles.
#include <free_surface/passes.hpp>

TETSUAME_WATER_PASSES(, 2);
