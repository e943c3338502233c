// Program B [S0, table 1]: Y by Hosono's iteration, no wall support, gradient pattern 1.
#include <gradient/pattern_1.hpp>
#include <hydrostatic/hydrostatic.hpp>
#include <volume/hosono_iteration.hpp>

using namespace tetsuame;

struct program_b {
  static constexpr const char* name = "disph_b";
  using volume = tetsuame::volume::hosono_iteration;
  using pressure = tetsuame::volume::smoothed;
  using wall = walls::none;
  using gradient = tetsuame::gradient::pattern_1;
};

int main(int argc, char** argv) { return hydrostatic::program<program_b>(argc, argv); }
