// Programs A to F, Y, N and standard SPH: CMake says which of <programs/schemes.hpp> this one is.
#include <liquid/scheme_of.hpp>
#include <problems/program.hpp>
#include <programs/schemes.hpp>

using namespace tetsuame;

int main(int argc, char** argv) { return problems::program(argc, argv, liquid::describe<programs::TETSUAME_SCHEME>()); }
