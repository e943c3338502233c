// What is at the start of a test, and the exact solution where there is one.
#pragma once

#include <functional>
#include <riemann/exact.hpp>
#include <shocks/options.hpp>
#include <vector>

namespace tetsuame::shocks {

using point = std::array<double, 3>;

struct state {
  double rho, p;  // kg/m3, Pa
  point v{};      // m/s
  std::int32_t material = 0;
};

// An even lattice of n particles along each axis between two corners, cell-centred.
struct block {
  point low{}, high{};
  std::array<std::int64_t, 3> n{1, 1, 1};
  std::function<bool(const point&)> holds = {};  // none: all of it
};

struct setup {
  std::vector<block> blocks;
  std::function<state(const point&)> start;
  std::function<state(const point&, double t)> exact = {};    // none: no errors
  std::function<bool(const point&, double t)> measured = {};  // where errors are; none: everywhere
  std::vector<std::pair<std::string, double>> numbers = {};   // of the exact solution, for summary.json
};

setup make_setup(const options& o);

}  // namespace tetsuame::shocks
