// Metal over silicate: the overturn of a dense layer over a light one.
#include <problems/program.hpp>

using namespace tetsuame;

int main(int argc, char** argv) {
  return problems::two_fluids(argc, argv, "rti", two_fluids::problem_kind::rayleigh_taylor,
                              "the growth rates of linear theory");
}
