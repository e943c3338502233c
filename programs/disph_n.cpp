// Program N: volumes from the number density, pressure of the equation of state, mirrored walls, gradient pattern 1.
#include <gradient/pattern_1.hpp>
#include <liquid/scheme_of.hpp>
#include <problems/program.hpp>
#include <volume/number_density.hpp>

using namespace tetsuame;

struct program_n {
  static constexpr const char* name = "disph_n";
  using volume = tetsuame::volume::number_density;
  using pressure = tetsuame::volume::non_smoothed;
  using wall = walls::mirror;
  using gradient = tetsuame::gradient::pattern_1;
};

int main(int argc, char** argv) { return problems::program(argc, argv, liquid::describe<program_n>()); }
