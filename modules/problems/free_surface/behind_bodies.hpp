// What stands in bodies: wall particles have what the water at their markers has, and a velocity by which, in
// the default scheme, their pressure makes no energy of motion across the surface and takes none
// (docs/theory/water_and_bodies.md).
#pragma once

#include <free_surface/moving.hpp>
#include <walls/bodies.hpp>

namespace tetsuame::free_surface {

// m/s, of what of the body is at the particle i, and how its acceleration there, half way to j, and gravity let the
// pressure rise to i (m2/s2).
template <int D>
solids::point<D> velocity_of_body(const water<D>& f, const moving_body<D>& b, std::size_t i) {
  return b.rate.at(of_solids<D>(f.place(i)));
}
template <int D>
double inertia_to(const water<D>& f, const moving_body<D>& b, std::size_t j, std::size_t i) {
  const auto x_i = of_solids<D>(f.place(i)), x_j = of_solids<D>(f.place(j));
  return -foundation::dot(b.rate.acceleration_at(0.5 * (x_i + x_j)), x_i - x_j);
}

// m/s, of the wall particle i as its body sees it, where its pressure is this (Pa) and the water at its marker has this
// velocity: that along the surface, and α across it. With ∂_j = n·∇_j W_jw the sums of terms.hpp let p_w take from the
// motion across the surface, and v_w give to the densities as elastic energy, for each V_w,
//   p_w B,  B = Σ_j V_j (n·v_j) ∂_j   and   -α A,  A = Σ_j V_j p_j ∂_j
// They are the same (derived here) with
//   α = -B (p_w A + ε² G)/(A² + ε² G²),  G = Σ_j V_j ∂_j
// but for ε, by which water without pressure counts as if it had some. α is not beyond what would reverse the
// velocities of the water about it: with more the sound between a particle and the wall may grow.
template <int D>
std::array<double, D> balanced_velocity(const water<D>& f, std::size_t i, const walls::body_place<D>& of,
                                        const std::array<double, D>& at_marker, double pressure) {
  const auto& w = f.world.w;
  const auto& s = w.s;
  const auto* b = f.mover(s.material[i]);
  const solids::point<D> n{of.normal}, v_m{at_marker};
  const auto x_w = of_solids<D>(f.place(i));
  const double support = w.support(), slight = 1e-5 * f.o.flow.density * f.p.water.sound * f.p.water.sound;
  double A = 0.0, B = 0.0, G = 0.0, least = 0.0, most = 0.0;
  for (const std::uint32_t j : f.world.walls.bodies.near.row(i - s.first_wall())) {
    const auto x_j = of_solids<D>(f.place(j));
    const auto apart = x_j - x_w;
    const double away = solids::norm<D>(apart);
    if (!(away < support)) continue;
    auto v_j = solids::point<D>::of([&](std::size_t a) { return s.v[a][j]; });
    if (b != nullptr) v_j -= velocity_of_body(f, *b, j);
    const double VF = s.dV[j] * std::visit([&](const auto& k) { return k.gradient_over_r(away); }, w.kernel);
    const double across = VF * foundation::dot(n, apart), reversed = -foundation::dot(v_j, n);
    A += s.p[j] * across;
    G += across;
    B -= reversed * across;
    least = std::min(least, reversed);
    most = std::max(most, reversed);
  }
  const double both = A * A + slight * slight * G * G;
  const double alpha = both > 0.0 ? -B * (pressure * A + slight * slight * G) / both : 0.0;
  return (v_m + (std::clamp(alpha, least, most) - foundation::dot(v_m, n)) * n).c;
}

// Wall particles of bodies, by the water at their markers: its pressure with the weight of water from there, as the
// body sees it, its density, and as much of its volume as the marker is wet.
template <int D>
void fill_bodies(water<D>& f) {
  auto& w = f.world.w;
  auto& s = w.s;
  const auto water_at = [&](std::size_t j, std::size_t i) {
    std::array<double, D + 3> values;
    for (std::size_t a = 0; a < D; ++a) values[a] = s.v[a][j];
    values[D] = s.p[j] + s.rho[j] * f.gravity() * (s.x[1][j] - s.x[1][i]);
    if (const auto* b = f.mover(s.material[i])) {
      const auto u = velocity_of_body(f, *b, j);
      for (std::size_t a = 0; a < D; ++a) values[a] -= u[a];
      values[D] += s.rho[j] * inertia_to(f, *b, j, i);
    }
    values[D + 1] = s.rho[j];
    values[D + 2] = s.dV[j];
    return values;
  };
  walls::at_bodies<D + 3, D>(
      w, f.world.walls, water_at, [&](std::size_t i, const auto& of, double wet, const auto& mean) {
        std::array<double, D> source;
        for (std::size_t a = 0; a < D; ++a) source[a] = mean[a];
        const auto v = f.p.by == scheme::riemann ? walls::reflected_velocity<D>(of, source, false)
                                                 : balanced_velocity<D>(f, i, of, source, mean[D]);
        for (std::size_t a = 0; a < D; ++a) s.v[a][i] = v[a];
        if (f.sticks) {
          const auto dragged = walls::reflected_velocity<D>(of, source, f.world.walls.bodies.no_slip);
          for (std::size_t a = 0; a < D; ++a) f.viscous_velocity[a][i] = dragged[a];
        }
        if (const auto* b = f.mover(s.material[i])) {
          const auto u = velocity_of_body(f, *b, i);
          for (std::size_t a = 0; a < D; ++a) {
            s.v[a][i] += u[a];
            if (f.sticks) f.viscous_velocity[a][i] += u[a];
          }
        }
        s.p[i] = mean[D];
        s.rho[i] = mean[D + 1];
        s.dV[i] = wet * mean[D + 2];
      });
  w.exchange_walls(s.v, {s.p.data(), s.rho.data(), s.dV.data()});
  if (f.sticks) w.exchange_walls(f.viscous_velocity, {});
}

}  // namespace tetsuame::free_surface
