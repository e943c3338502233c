// The problem in two and three dimensions, each compiled by itself (programs/flow).
#pragma once

#include <free_surface/options.hpp>
#include <memory>
#include <run/simulation.hpp>

namespace tetsuame::free_surface {

std::unique_ptr<run::simulation> make_2d(const options& o, const parameters& p);
std::unique_ptr<run::simulation> make_3d(const options& o, const parameters& p);

}  // namespace tetsuame::free_surface
