// What stands in bodies: wall particles have what the water at their markers has, and a velocity by which, in the
// default scheme, their pressure makes no energy and takes none (docs/theory/water_and_bodies.md).
#pragma once

#include <free_surface/terms.hpp>
#include <free_surface/water.hpp>
#include <walls/bodies.hpp>
#include <walls/images.hpp>

namespace tetsuame::free_surface {

// m/s, of what of the body is at the particle j: of the image of the body that its wall particle i belongs to.
template <int D>
solids::point<D> velocity_of_body(const water<D>& f, const moving_body<D>& b, std::size_t j, std::size_t i) {
  return b.rate.at(of_solids<D>(f.place(j)) - f.image_at(b.body, of_solids<D>(f.place(i))));
}

// m2/s2: how the acceleration of what of the body is half way between them lets the pressure rise from j to i.
template <int D>
double inertia_to(const water<D>& f, const moving_body<D>& b, std::size_t j, std::size_t i) {
  const auto x_i = of_solids<D>(f.place(i)), x_j = of_solids<D>(f.place(j));
  return -foundation::dot(b.rate.acceleration_at(0.5 * (x_i + x_j) - f.image_at(b.body, x_i)), x_i - x_j);
}

// From sources to their images, as a vector; wall particles of bodies have none.
template <int D>
void mirror_vectors(water<D>& f, const particles::vector_field<D>& values) {
  const auto& walls = f.world.walls;
  const std::size_t first = f.world.w.s.first_wall();
  foundation::for_all(walls.body_particles, [&](std::size_t n) {
    for (std::size_t a = 0; a < D; ++a) values[a][first + n] = 0.0;
  });
  walls::fill_images(walls, f.world.w.s, walls::vector(values));
}

// Collective. To ghosts, and to what stands behind walls.
template <int D>
void share_vectors(water<D>& f, const particles::vector_field<D>& values) {
  const auto fields = values.data();
  domain::exchange<D>(f.world.w.d.ranks, f.world.w.d.fluid_halo, std::span<double* const>(fields));
  mirror_vectors<D>(f, values);
}

// With new lists: the water with wall particles of bodies, or their images, in its lists.
template <int D>
void find_rows_beside(water<D>& f) {
  if (!f.world.walls.bodies.any()) return;
  const auto& w = f.world.w;
  const auto& s = w.s;
  std::vector<std::size_t> rows;
  for (std::size_t r = 0; r < w.list.rows(); ++r) {
    bool near = false;
    w.list.for_each(r, [&](std::uint32_t j, auto...) { near = near || rigid::is_of_body(f.world, j); });
    for (std::size_t i = r * pairs::lanes; near && i < std::min(s.fluid, (r + 1) * pairs::lanes); ++i)
      rows.push_back(i);
  }
  f.rows_near_bodies = pairs::choose(w.list, std::move(rows), s.total());
}

// Collective. Of the water beside bodies the direction in which they press it, that of Σ_w V_w ∇_j W_jw over their wall
// particles; 0 where there are none.
template <int D>
void find_pressed(water<D>& f) {
  auto& w = f.world.w;
  const auto& s = w.s;
  const auto& walls = f.world.walls;
  const std::size_t first = s.first_wall();
  const auto& V = s.dV;
  foundation::for_all(walls.body_particles, [&](std::size_t r) { f.volume_in_bodies[first + r] = V[first + r]; });
  walls::for_each_image(walls, s, walls.images_of_fluid, walls.source.size(),
                        [&](const walls::image& of) { f.volume_in_bodies[of.i] = V[of.j]; });
  w.sum(f.rows_near_bodies, inward<D>{f.volume_in_bodies.data(), f.pressed.data()});
  foundation::for_all(f.rows_near_bodies.rows.size(), [&](std::size_t r) {
    const std::size_t i = f.rows_near_bodies.rows[r];
    const double length = length_of<D>(f.pressed, i);
    for (std::size_t a = 0; a < D; ++a) f.pressed[a][i] = length > 0.0 ? f.pressed[a][i] / length : 0.0;
  });
  share_vectors<D>(f, f.pressed);
}

// m/s, of the wall particle i as its body sees it, where its pressure is p_w (Pa) and the water at its marker has the
// velocity v_m: v_m along the surface, and α across it. By the sums of terms.hpp the water has of each V_w the power
//   -Σ_j V_j (p_w v_j + p_j v_w)·∇_j W_jw
// of which what goes from one place to another along the surface, with m_j of find_pressed(),
//   -Σ_j V_j p_j (v_j - m_j m_j·v_j)·∇_j W_jw
// is nothing when summed over w. The two are equal (derived here) with
//   α = -(P A + ε² G B)/(A² + ε² G²),   P = Σ_j V_j [p_w v_j + p_j (v_m - n n·v_m) - p_j (v_j - m_j m_j·v_j)]·∇_j W_jw
//   A = Σ_j V_j p_j ∂_j,   B = Σ_j V_j n·v_j ∂_j,   G = Σ_j V_j ∂_j,   ∂_j = n·∇_j W_jw
// but for ε, by which water without pressure counts as if it had some. What P has beyond the part across, p_w B, is of
// first order in the velocity, as what viscosity takes is not: it counts by 1 - l² with l of speed_limiter(), in full
// in slow water, and not at all in fast water, whose jets would pay for it. α is beyond what would reverse the
// velocities of the water about it, with which the sound between a particle and the wall may grow, by no more than that
// part of the speed along the wall; not at bodies that move, which it throws about, and by l of it where water creeps,
// slower than a thousandth of sound: of first order in that speed it lets rows at the corner of a body slide by
// themselves (docs/theory/still_water.md).
template <int D>
std::array<double, D> balanced_velocity(const water<D>& f, std::size_t i, const walls::body_place<D>& of) {
  const auto& w = f.world.w;
  const auto& s = w.s;
  const auto* b = f.mover(s.material[i]);
  const solids::point<D> n{of.normal};
  const auto vector = [](const auto& from, std::size_t j) {
    return solids::point<D>::of([&](std::size_t a) { return from[a][j]; });
  };
  const auto v_m = vector(s.v, i);
  const auto along = v_m - foundation::dot(v_m, n) * n, x_w = of_solids<D>(f.place(i));
  const double support = w.support(), slight = 1e-5 * f.o.flow.density * f.p.water.sound * f.p.water.sound;
  const double p_w = s.p[i];
  double A = 0.0, B = 0.0, G = 0.0, P = 0.0, least = 0.0, most = 0.0;
  for (const std::uint32_t j : f.world.walls.bodies.near.row(i - s.first_wall())) {
    const auto apart = of_solids<D>(f.place(j)) - x_w;
    const double away = solids::norm<D>(apart);
    if (!(away < support)) continue;
    auto v_j = vector(s.v, j);
    if (b != nullptr) v_j -= velocity_of_body(f, *b, j, i);
    const auto m_j = vector(f.pressed, j);
    const auto slope = s.dV[j] * std::visit([&](const auto& k) { return k.gradient_over_r(away); }, w.kernel) * apart;
    const double across = foundation::dot(slope, n), outwards = foundation::dot(v_j, n);
    A += s.p[j] * across;
    B += outwards * across;
    G += across;
    P += foundation::dot(p_w * v_j + s.p[j] * (along - v_j + foundation::dot(m_j, v_j) * m_j), slope);
    least = std::min(least, -outwards);
    most = std::max(most, -outwards);
  }
  const double both = A * A + slight * slight * G * G;
  const double l = speed_limiter(f, solids::norm<D>(v_m)), counted = 1.0 - l * l;
  P = p_w * B + counted * (P - p_w * B);
  const double alpha = both > 0.0 ? -(P * A + slight * slight * G * B) / both : 0.0;
  const double more = b == nullptr ? counted * std::min(1.0, 10.0 * l) * solids::norm<D>(along) : 0.0;
  return (along + std::clamp(alpha, least - more, most + more) * n).c;
}

// Wall particles of bodies, by the water at their markers: its pressure with the weight of water from there, as the
// body sees it, its density, and as much of its volume as the marker is wet; its velocity, until it is balanced.
template <int D>
void take_from_markers(water<D>& f) {
  auto& w = f.world.w;
  auto& s = w.s;
  const auto water_at = [&](std::size_t j, std::size_t i) {
    std::array<double, D + 3> values;
    for (std::size_t a = 0; a < D; ++a) values[a] = s.v[a][j];
    values[D] = s.p[j] + s.rho[j] * f.gravity() * (s.x[1][j] - s.x[1][i]);
    if (w.gravity_varies) values[D] += s.rho[j] * w.forced(j, i);
    if (const auto* b = f.mover(s.material[i])) {
      const auto u = velocity_of_body(f, *b, j, i);
      for (std::size_t a = 0; a < D; ++a) values[a] -= u[a];
      values[D] += s.rho[j] * inertia_to(f, *b, j, i);
    }
    values[D + 1] = s.rho[j];
    values[D + 2] = s.dV[j];
    return values;
  };
  walls::at_bodies<D + 3, D>(w, f.world.walls, water_at, [&](std::size_t i, const auto&, double wet, const auto& mean) {
    for (std::size_t a = 0; a < D; ++a) s.v[a][i] = mean[a];
    s.p[i] = mean[D];
    s.rho[i] = mean[D + 1];
    s.dV[i] = wet * mean[D + 2];
  });
}

// Collective. What stands in bodies.
template <int D>
void fill_bodies(water<D>& f) {
  auto& w = f.world.w;
  auto& s = w.s;
  const auto& bodies = f.world.walls.bodies;
  const bool balanced = f.p.by != scheme::riemann;
  take_from_markers(f);
  w.exchange_walls({s.p.data(), s.rho.data(), s.dV.data()});
  if (balanced) find_pressed(f);
  foundation::for_all(bodies.places.size(), [&](std::size_t r) {
    const std::size_t i = s.first_wall() + r;
    const auto& of = bodies.places[r];
    std::array<double, D> at_marker;
    for (std::size_t a = 0; a < D; ++a) at_marker[a] = s.v[a][i];
    const auto v = balanced ? balanced_velocity<D>(f, i, of) : walls::reflected_velocity<D>(of, at_marker, false);
    for (std::size_t a = 0; a < D; ++a) s.v[a][i] = v[a];
    if (f.two_velocities) {
      const auto dragged = walls::reflected_velocity<D>(of, at_marker, bodies.no_slip);
      for (std::size_t a = 0; a < D; ++a) f.viscous_velocity[a][i] = dragged[a];
    }
    if (const auto* b = f.mover(s.material[i])) {
      const auto u = velocity_of_body(f, *b, i, i);
      for (std::size_t a = 0; a < D; ++a) {
        s.v[a][i] += u[a];
        if (f.two_velocities) f.viscous_velocity[a][i] += u[a];
      }
    }
  });
  w.exchange_walls(s.v, {});
  if (f.two_velocities) w.exchange_walls(f.viscous_velocity, {});
}

}  // namespace tetsuame::free_surface
