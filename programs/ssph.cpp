// Standard SPH, to stand beside DISPH: density by summation, mirrored walls, gradient pattern 1.
#include <gradient/pattern_1.hpp>
#include <liquid/scheme_of.hpp>
#include <problems/program.hpp>
#include <volume/density_sum.hpp>

using namespace tetsuame;

struct standard_sph {
  static constexpr const char* name = "ssph";
  using volume = tetsuame::volume::density_sum;
  using pressure = tetsuame::volume::non_smoothed;
  using wall = walls::mirror;
  using gradient = tetsuame::gradient::pattern_1;
};

int main(int argc, char** argv) { return problems::program(argc, argv, liquid::describe<standard_sph>()); }
