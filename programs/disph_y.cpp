// Program Y [S2, improved DISPH]: Y by its own evolution equation, smoothed pressure, corrected walls, gradient
// pattern 1.
#include <gradient/pattern_1.hpp>
#include <liquid/scheme_of.hpp>
#include <problems/program.hpp>
#include <volume/y_evolution.hpp>

using namespace tetsuame;

struct program_y {
  static constexpr const char* name = "disph_y";
  using volume = tetsuame::volume::y_evolution;
  using pressure = tetsuame::volume::smoothed;
  using wall = walls::virtual_marker;
  using gradient = tetsuame::gradient::pattern_1;
};

int main(int argc, char** argv) { return problems::program(argc, argv, liquid::describe<program_y>()); }
