#include <liquid/passes.hpp>

TETSUAME_LIQUID_PASSES(, 3);
