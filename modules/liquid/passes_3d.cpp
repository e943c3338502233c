#include <gradient/pattern_1.hpp>
#include <gradient/pattern_2.hpp>
#include <liquid/passes.hpp>

TETSUAME_LIQUID_PASSES(, 3);
TETSUAME_LIQUID_FORCES(, 3, pattern_1);
TETSUAME_LIQUID_FORCES(, 3, pattern_2);
