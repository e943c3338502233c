// Main programs: they read the input, choose the problem that it names, and run it.
#pragma once

#include <liquid/passes.hpp>
#include <liquid/scheme.hpp>
#include <two_fluids/options.hpp>

namespace tetsuame::problems {

// A scheme on any liquid problem that it can run: group &rti, &drop or &conduction, or else a box at rest.
int program(int argc, char** argv, const liquid::program& scheme);

// Two fluids by the scheme that the input describes. theory_is: what --theory prints, for the help.
int two_fluids(int argc, char** argv, const char* name, two_fluids::problem_kind kind, const std::string& theory_is);

// A body that cools, by the operator that the input names.
int conduction(int argc, char** argv);

}  // namespace tetsuame::problems
