// The force of a wall on what has come nearer to it than the kernel resolves, the same for mirror images and for
// virtual markers (docs/theory/walls.md; why, and how its range and strength were chosen:
// docs/studies/2026-11-22_particles_on_walls.md):
//
//   Dv/Dt ⊃ A (1 - d/b) n  where d < b = 0.3 Δx,   potential  ½ A b (1 - d/b)² per mass,   A = b ω²,  ω = c/(4 Δx)
//
// d: distance from the wall, n: its inward normal, c: the largest speed of sound at the start. Behind the wall, where a
// stage of a step may take a particle, the line goes on. In a corner both walls push. The fastest sound of lattices has
// 0.3 c/Δx (the widest kernels) to 0.9 c/Δx, so that both together are within the margin of the step's limit.
#pragma once

#include <algorithm>
#include <particles/storage.hpp>
#include <vector>

namespace tetsuame::walls {

struct boundary_force {
  double range = 0.0;      // m, b
  double stiffness = 0.0;  // 1/s2, ω² = A/b; 0: none
};

inline boundary_force make_boundary_force(double dx, double sound_speed) {  // m, m/s
  const double omega = 0.25 * sound_speed / dx;
  return {0.3 * dx, omega * omega};
}

// m, b - d of particle i, or zero. Side: a plane wall by its axis, position and inward direction along it.
template <class Side, int D>
double depth_in_range(const boundary_force& f, const Side& wall, const particles::particles<D>& s, std::size_t i) {
  return std::max(0.0, f.range - (s.x[wall.axis][i] - wall.position) * wall.inward);
}

// add(axis, m/s2) for every wall that pushes particle i.
template <class Side, int D, class Add>
void push_off(const boundary_force& f, const std::vector<Side>& sides, const particles::particles<D>& s, std::size_t i,
              Add&& add) {
  for (const auto& wall : sides)
    if (const double depth = depth_in_range(f, wall, s, i); depth > 0.0)
      add(wall.axis, f.stiffness * depth * wall.inward);
}

// J/kg, of particle i at all walls.
template <class Side, int D>
double boundary_potential(const boundary_force& f, const std::vector<Side>& sides, const particles::particles<D>& s,
                          std::size_t i) {
  double sum = 0.0;
  for (const auto& wall : sides) {
    const double depth = depth_in_range(f, wall, s, i);
    sum += 0.5 * f.stiffness * depth * depth;
  }
  return sum;
}

}  // namespace tetsuame::walls
