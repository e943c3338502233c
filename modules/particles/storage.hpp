// Sizes, order and null particle of the particle arrays.
#pragma once

#include <algorithm>
#include <cstddef>
#include <foundation/threads.hpp>
#include <foundation/unfilled.hpp>
#include <limits>
#include <particles/particles.hpp>
#include <span>

namespace tetsuame::particles {

// The null particle lies far outside every support and has no volume, so that a
// padded entry of a neighbour list adds exactly zero, and no 0/0, to every sum.
template <int D>
void set_null(particles<D>& s) {
  constexpr double far_away = 1e60;
  const std::size_t n = s.null();
  for_each_field<D>(s, [&](const field_info&, const auto& components) {
    for (auto* a : components) (*a)[n] = 0.0;
  });
  for (auto& component : s.x) component[n] = far_away;
  s.p[n] = s.p_eos[n] = s.rho[n] = s.m[n] = s.eta[n] = s.k[n] = s.T[n] = s.c_V[n] = s.c[n] = 1.0;
  s.id[n] = std::numeric_limits<std::int64_t>::max();
  s.material[n] = 0;
}

// B, of each particle: its number, its material and all fields that are declared.
template <int D>
double bytes_each(const particles<D>& s) {
  double all = sizeof(s.id[0]) + sizeof(s.material[0]);
  for_each_field<D>(s, [&](const field_info&, const auto& components) {
    all += static_cast<double>(components.size() * sizeof(double));
  });
  return all;
}

// Gives every array room for the four blocks and the null particle. Values of the
// blocks that keep their place and size are kept; the null particle is set.
template <int D>
void allocate(particles<D>& s, std::size_t fluid, std::size_t fluid_ghosts, std::size_t walls,
              std::size_t wall_ghosts) {
  const std::size_t old_first_wall = s.first_wall(), old_walls = s.walls;
  s.fluid = fluid;
  s.fluid_ghosts = fluid_ghosts;
  s.walls = walls;
  s.wall_ghosts = wall_ghosts;
  const std::size_t n = s.total() + 1;
  const bool walls_move = walls == old_walls && s.first_wall() != old_first_wall && walls > 0;
  const auto resize = [&](auto& a) {
    // A little to spare, where the library's own growth would double.
    const std::size_t most = walls_move ? std::max(n, std::max(s.first_wall(), old_first_wall) + walls) : n;
    if (a.capacity() < most) a.reserve(most + most / 64);
    if (walls_move) {
      if (a.size() < most) a.resize(most);
      const auto from = a.begin() + static_cast<std::ptrdiff_t>(old_first_wall);
      const auto to = a.begin() + static_cast<std::ptrdiff_t>(s.first_wall());
      if (to > from)
        std::copy_backward(from, from + static_cast<std::ptrdiff_t>(walls), to + static_cast<std::ptrdiff_t>(walls));
      else
        std::copy(from, from + static_cast<std::ptrdiff_t>(walls), to);
    }
    a.resize(n);
  };
  resize(s.id);
  resize(s.material);
  for_each_field<D>(s, [&](const field_info&, const auto& components) {
    for (auto* a : components) resize(*a);
  });
  set_null(s);
}

// Reorders the particles of the block [begin, begin + order.size()): the new k-th
// is the old begin + order[k]. Derived fields are left as they are.
template <int D>
void reorder(particles<D>& s, std::size_t begin, std::span<const std::uint32_t> order) {
  const auto permute = [&](auto& a, auto&& scratch) {
    scratch.resize(order.size());
    foundation::for_all(order.size(), [&](std::size_t k) { scratch[k] = a[begin + order[k]]; });
    foundation::for_all(order.size(), [&](std::size_t k) { a[begin + k] = scratch[k]; });
  };
  permute(s.id, foundation::unfilled<std::int64_t>());
  permute(s.material, foundation::unfilled<std::int32_t>());
  foundation::unfilled<double> buffer;
  for_each_field<D>(s, [&](const field_info& field, const auto& components) {
    if (travels(field.kind))
      for (auto* a : components) permute(*a, buffer);
  });
}

// Exchanges the positions of the fluid for those that its neighbour lists were made from.
template <int D>
void exchange_list_positions(particles<D>& s) {
  for (std::size_t a = 0; a < D; ++a)
    std::swap_ranges(s.x[a].begin(), s.x[a].begin() + static_cast<std::ptrdiff_t>(s.fluid), s.x_list[a].begin());
}

}  // namespace tetsuame::particles
