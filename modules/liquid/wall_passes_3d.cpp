#include <liquid/passes.hpp>

TETSUAME_WALL_PASSES(, 3);
