// What the pair forces of a cloud of particles conserve.
#pragma once

#include <boost/test/unit_test.hpp>
#include <limits>

#include "cloud.hpp"

namespace tetsuame {

inline constexpr double epsilon = std::numeric_limits<double>::epsilon();

// Forces sum to zero, and their power with that of the internal energies. Sizes for comparison are sums of absolute
// values.
template <int D>
void check_conservation(const cloud<D>& g, const char* name) {
  BOOST_TEST_CONTEXT(name << " in " << D << "-D") {
    double energy = 0.0, energy_size = 0.0;
    for (std::size_t a = 0; a < D; ++a) {
      double momentum = 0.0, size = 0.0;
      for (std::size_t i = 0; i < g.n; ++i) {
        momentum += g.force[a][i];
        size += std::abs(g.force[a][i]);
        energy += g.force[a][i] * g.v[a][i];
        energy_size += std::abs(g.force[a][i] * g.v[a][i]);
      }
      BOOST_TEST(size > 0.0);
      // 60 forces of 59 terms each, all of them rounded: random signs make this 100 ε at most.
      BOOST_TEST(std::abs(momentum) <= 100.0 * epsilon * size);
    }
    for (std::size_t i = 0; i < g.n; ++i) {
      energy += g.power[i];
      energy_size += std::abs(g.power[i]);
    }
    BOOST_TEST(std::abs(energy) <= 100.0 * epsilon * energy_size);
  }
}

}  // namespace tetsuame
