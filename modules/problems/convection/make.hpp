// Convection of each dimension: one file each compiles it (programs/convection), since that takes long.
#pragma once

#include <convection/options.hpp>
#include <memory>
#include <run/problem.hpp>

namespace tetsuame::convection {

// Options and parameters outlive the problem.
std::unique_ptr<run::problem> make_2d(const options& o, const parameters& p);
std::unique_ptr<run::problem> make_3d(const options& o, const parameters& p);

}  // namespace tetsuame::convection
