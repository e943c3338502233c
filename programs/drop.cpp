// A drop of one fluid that sinks in another: terminal velocity in a box.
#include <overturn/program.hpp>

using namespace tetsuame;

int main(int argc, char** argv) {
  return overturn::program(argc, argv, "drop", overturn::problem_kind::drop, "the terminal velocity of creeping flow");
}
