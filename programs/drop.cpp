// A drop of one fluid that sinks in another: terminal velocity in a box.
#include <problems/program.hpp>

using namespace tetsuame;

int main(int argc, char** argv) {
  return problems::two_fluids(argc, argv, "drop", two_fluids::problem_kind::drop,
                              "the terminal velocity of creeping flow");
}
