// The problems of liquids, each compiled by itself for a width of SIMD registers.
#pragma once

#include <cooling/options.hpp>
#include <hydrostatic/options.hpp>
#include <liquid/scheme.hpp>
#include <overturn/options.hpp>
#include <run/problem.hpp>

namespace tetsuame::problems {

// The options, and parameters, outlive the problem.
std::unique_ptr<run::problem> at_rest(const hydrostatic::options& o, const liquid::program& scheme);
// scheme: none: as the input says (overturn/terms.hpp)
std::unique_ptr<run::problem> two_fluids_2d(overturn::problem_kind kind, const overturn::options& o,
                                            const overturn::parameters& p, const liquid::program* scheme);
std::unique_ptr<run::problem> two_fluids_3d(overturn::problem_kind kind, const overturn::options& o,
                                            const overturn::parameters& p, const liquid::program* scheme);
std::unique_ptr<run::problem> conduction(const cooling::options& o);

}  // namespace tetsuame::problems
