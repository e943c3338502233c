// A plate or half space cooling from its top, on fixed particles [S2].
#include <problems/program.hpp>

int main(int argc, char** argv) { return tetsuame::problems::conduction(argc, argv); }
