// The problem in one, two and three dimensions, each compiled by itself (programs/shock).
#pragma once

#include <march/problem.hpp>
#include <memory>
#include <shocks/options.hpp>

namespace tetsuame::shocks {

std::unique_ptr<march::problem> make_1d(const options& o);
std::unique_ptr<march::problem> make_2d(const options& o);
std::unique_ptr<march::problem> make_3d(const options& o);

}  // namespace tetsuame::shocks
