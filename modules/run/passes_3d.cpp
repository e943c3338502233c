#include <run/passes.hpp>

TETSUAME_RUN_PASSES(, 3);
