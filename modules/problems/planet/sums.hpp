// Sums by mass over the particles of all ranks that which(i) chooses; the same bits on any number of ranks. Collective.
#pragma once

#include <foundation/exact_sum.hpp>
#include <gas/setups.hpp>

namespace tetsuame::planet {

inline constexpr auto all = [](std::size_t) { return true; };
inline auto of_material(const gas::view& w, std::int32_t material) {
  return [&w, material](std::size_t i) { return w.material[i] == material; };
}

// Σ m value(i)
template <class Which, class Value>
double sum_by_mass(const gas::view& w, const Which& which, const Value& value) {
  foundation::exact_sum sum;
  for (std::size_t i = 0; i < w.n; ++i)
    if (which(i)) sum.add(w.m[i] * value(i));
  return w.ranks.exact(sum);
}

template <class Which>
double mass_of(const gas::view& w, const Which& which) {  // kg
  return sum_by_mass(w, which, [](std::size_t) { return 1.0; });
}

template <class Which, class Value>
double mean_by_mass(const gas::view& w, const Which& which, const Value& value) {
  return sum_by_mass(w, which, value) / mass_of(w, which);
}

struct centre_of_mass {
  double mass = 0.0;               // kg
  gas::point place{}, velocity{};  // m, m/s
};
template <class Which>
centre_of_mass centre_of(const gas::view& w, const Which& which) {
  centre_of_mass c{mass_of(w, which)};
  for (std::size_t a = 0; a < 3 && w.x[a] != nullptr; ++a) {
    c.place[a] = sum_by_mass(w, which, [&](std::size_t i) { return w.x[a][i]; }) / c.mass;
    c.velocity[a] = sum_by_mass(w, which, [&](std::size_t i) { return w.v[a][i]; }) / c.mass;
  }
  return c;
}

}  // namespace tetsuame::planet
