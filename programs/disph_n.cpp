#include <liquid/scheme_of.hpp>
#include <problems/program.hpp>
#include <programs/disph_n.hpp>

using namespace tetsuame;

int main(int argc, char** argv) { return problems::program(argc, argv, liquid::describe<programs::program_n>()); }
