// The problems of liquids, each compiled by itself for a width of SIMD registers.
#pragma once

#include <conduction/options.hpp>
#include <hydrostatic/options.hpp>
#include <liquid/scheme.hpp>
#include <run/simulation.hpp>
#include <two_fluids/options.hpp>

namespace tetsuame::problems {

// The options, and parameters, outlive the problem.
std::unique_ptr<run::simulation> at_rest(const hydrostatic::options& o, const liquid::program& scheme);
// scheme: none: as the input says (two_fluids/terms.hpp)
std::unique_ptr<run::simulation> two_fluids_2d(two_fluids::problem_kind kind, const two_fluids::options& o,
                                               const two_fluids::parameters& p, const liquid::program* scheme);
std::unique_ptr<run::simulation> two_fluids_3d(two_fluids::problem_kind kind, const two_fluids::options& o,
                                               const two_fluids::parameters& p, const liquid::program* scheme);
std::unique_ptr<run::simulation> conduction(const conduction::options& o);

}  // namespace tetsuame::problems
