#include <gradient/pattern_1.hpp>
#include <gradient/pattern_2.hpp>
#include <liquid/passes.hpp>

TETSUAME_LIQUID_PASSES(, 2);
TETSUAME_LIQUID_FORCES(, 2, pattern_1);
TETSUAME_LIQUID_FORCES(, 2, pattern_2);
