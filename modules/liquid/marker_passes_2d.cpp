#include <liquid/passes.hpp>

TETSUAME_MARKER_PASSES(, 2);
