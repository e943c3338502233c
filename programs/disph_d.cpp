// Program D [S0, table 1]: Y by our method, smoothed pressure, no wall support, gradient pattern 1.
#include <gradient/pattern_1.hpp>
#include <hydrostatic/hydrostatic.hpp>
#include <volume/our_method.hpp>

using namespace tetsuame;

struct program_d {
  static constexpr const char* name = "disph_d";
  using volume = tetsuame::volume::our_method;
  using pressure = tetsuame::volume::smoothed;
  using wall = walls::none;
  using gradient = tetsuame::gradient::pattern_1;
};

int main(int argc, char** argv) { return hydrostatic::program<program_d>(argc, argv); }
