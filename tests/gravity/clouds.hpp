// Clouds of particles for the tests of self-gravity, and what the tree and direct summation make of them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <gravity/direct.hpp>
#include <gravity/tree.hpp>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

namespace tetsuame::test {

inline constexpr double G = 6.67430e-11;  // m³/(kg s²)

template <int D>
struct bodies {
  std::array<std::vector<double>, D> x;  // m
  std::vector<double> mass, support;     // kg, m
  std::vector<std::uint64_t> id;

  std::size_t size() const { return mass.size(); }
  void add(const std::array<double, D>& at, double m, double h) {
    for (std::size_t a = 0; a < D; ++a) x[a].push_back(at[a]);
    mass.push_back(m);
    support.push_back(h);
    id.push_back(1000 + 7 * id.size());
  }
  gravity::cloud<D> view() const {
    gravity::cloud<D> c{{}, mass.data(), support.data(), id.data(), size()};
    for (std::size_t a = 0; a < D; ++a) c.x[a] = x[a].data();
    return c;
  }
};

template <int D>
struct result {
  std::array<std::vector<double>, D> acceleration;  // m/s²
  std::vector<double> potential;                    // J/kg

  explicit result(std::size_t n) : potential(n) {
    for (auto& one : acceleration) one.resize(n);
  }
  gravity::field<D> view() {
    gravity::field<D> f{{}, potential.data()};
    for (std::size_t a = 0; a < D; ++a) f.acceleration[a] = acceleration[a].data();
    return f;
  }
  double magnitude(std::size_t i) const {
    double square = 0.0;
    for (const auto& one : acceleration) square += one[i] * one[i];
    return std::sqrt(square);
  }
  bool operator==(const result&) const = default;
};

// Pairs of particles in double numbers.
inline gravity::tree_options precise() {
  gravity::tree_options options;
  options.tolerance = 1e-6;
  return options;
}
template <int D>
result<D> by_tree(const bodies<D>& all, const gravity::tree_options& options = {}) {
  result<D> r(all.size());
  gravity::tree<D> t(options);
  t(all.view(), 0, all.size(), r.view());
  return r;
}
template <int D>
result<D> by_direct(const bodies<D>& all) {
  result<D> r(all.size());
  gravity::direct<D>(all.view(), G, 0, all.size(), r.view());
  return r;
}

// Uniform numbers, the same with every standard library.
class numbers {
 public:
  explicit numbers(std::uint64_t seed) : engine_(seed) {}
  double operator()() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  // A point in the ball of radius 1.
  template <int D>
  std::array<double, D> in_ball() {
    while (true) {
      std::array<double, D> x;
      double r2 = 0.0;
      for (auto& one : x) {
        one = 2.0 * (*this)() - 1.0;
        r2 += one * one;
      }
      if (r2 < 1.0 && r2 > 0.0) return x;
    }
  }

 private:
  std::mt19937_64 engine_;
};

template <int D>
double radius(const std::array<double, D>& x) {
  return std::sqrt(std::inner_product(x.begin(), x.end(), x.begin(), 0.0));
}
template <int D>
std::array<double, D> scaled(std::array<double, D> x, double factor, double offset = 0.0) {
  for (auto& one : x) one = factor * one + offset;
  return x;
}

// A planet of this radius and mass (2-D: mass a metre), at random places.
template <int D>
bodies<D> uniform_ball(std::size_t n, double R = 6e6, double mass = 6e24, double offset = 0.0) {
  numbers any(11);
  bodies<D> all;
  const double h = 2.0 * R * std::pow(4.0 / static_cast<double>(n), 1.0 / D);
  for (std::size_t i = 0; i < n; ++i) all.add(scaled<D>(any.in_ball<D>(), R, offset), mass / static_cast<double>(n), h);
  return all;
}

// Plummer's sphere of scale 1e9 m; supports follow the density.
inline bodies<3> plummer(std::size_t n) {
  numbers any(5);
  bodies<3> all;
  for (std::size_t i = 0; i < n; ++i) {
    const auto to = any.in_ball<3>();
    const double r = 1.0 / std::sqrt(std::pow(0.999 * any() + 1e-9, -2.0 / 3.0) - 1.0);
    const double h = 2.0 * std::pow(4.19 / static_cast<double>(n), 1.0 / 3.0) * std::pow(1.0 + r * r, 5.0 / 6.0);
    all.add(scaled<3>(to, 1e9 * r / radius<3>(to)), 2e30 / static_cast<double>(n), 1e9 * h);
  }
  return all;
}

// A dense core within a light mantle, far from the origin.
inline bodies<3> two_layers(std::size_t n) {
  numbers any(3);
  bodies<3> all;
  for (std::size_t i = 0; i < n; ++i) {
    const bool core = i % 2 == 0;
    auto x = any.in_ball<3>();
    if (!core)
      while (radius<3>(x) < 0.55) x = any.in_ball<3>();
    all.add(scaled<3>(x, core ? 0.55 * 3e6 : 3e6, 4e9), core ? 3e20 : 1e20, core ? 2e5 : 5e5);
  }
  return all;
}

// Clumps within clumps, and one particle at 1e4 radii whose support is as wide.
inline bodies<3> clumps(std::size_t n) {
  numbers any(17);
  bodies<3> all;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    std::array<double, 3> x{};
    double size = 1.0;
    for (std::uint64_t level = 0, part = i; level < 5; ++level, size *= 0.05, part /= 3)
      for (std::size_t a = 0; a < 3; ++a)
        x[a] += size * std::sin(static_cast<double>((part % 3 + 1) * (a + 2) + level));
    const auto own = any.in_ball<3>();
    for (std::size_t a = 0; a < 3; ++a) x[a] += size * own[a];
    all.add(scaled<3>(x, 1e6), 1e18 * (0.1 + any()), 30.0);
  }
  all.add({1e10, -3e9, 2e9}, 1e18, 1e10);
  return all;
}

struct errors {
  double median, most, worst;  // of |a - a_direct|/|a_direct|, of all; most: of 99 %
};
template <int D>
errors compare(const result<D>& found, const result<D>& exact) {
  std::vector<double> e;
  for (std::size_t i = 0; i < exact.potential.size(); ++i) {
    double square = 0.0;
    for (std::size_t a = 0; a < D; ++a) square += std::pow(found.acceleration[a][i] - exact.acceleration[a][i], 2);
    e.push_back(std::sqrt(square) / exact.magnitude(i));
  }
  std::ranges::sort(e);
  return {e[e.size() / 2], e[e.size() * 99 / 100], e.back()};
}

// |Σ m a|/Σ m |a|.
template <int D>
double momentum_error(const bodies<D>& all, const result<D>& found) {
  double force = 0.0;
  std::array<double, D> momentum{};
  for (std::size_t i = 0; i < all.size(); ++i) {
    force += all.mass[i] * found.magnitude(i);
    for (std::size_t a = 0; a < D; ++a) momentum[a] += all.mass[i] * found.acceleration[a][i];
  }
  return radius<D>(momentum) / force;
}

// Particles in another order; `at[i]` is where particle i of the first is now.
template <int D>
bodies<D> permuted(const bodies<D>& all, std::vector<std::size_t>& at) {
  std::vector<std::size_t> order(all.size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937_64(2));
  auto other = all;
  at.resize(all.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    at[order[k]] = k;
    for (std::size_t a = 0; a < D; ++a) other.x[a][k] = all.x[a][order[k]];
    other.mass[k] = all.mass[order[k]];
    other.support[k] = all.support[order[k]];
    other.id[k] = all.id[order[k]];
  }
  return other;
}

}  // namespace tetsuame::test
