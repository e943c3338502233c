// Program C [S0, table 1]: Y by our method, smoothed pressure, corrected walls, gradient pattern 1.
#include <gradient/pattern_1.hpp>
#include <hydrostatic/hydrostatic.hpp>
#include <volume/our_method.hpp>

using namespace tetsuame;

struct program_c {
  static constexpr const char* name = "disph_c";
  using volume = tetsuame::volume::our_method;
  using pressure = tetsuame::volume::smoothed;
  using wall = walls::virtual_marker;
  using gradient = tetsuame::gradient::pattern_1;
};

int main(int argc, char** argv) { return hydrostatic::program<program_c>(argc, argv); }
