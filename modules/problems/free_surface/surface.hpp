// The free surface: where it is, and how particles drift to where there are fewer, after each step, without crossing
// it.
//
//   δx_i = -A h l_i |v_i| Δt Σ_j V_j [1 + 0.2 (W_ij/W(Δx))⁴] ∇_i W_ij,   at most ½ |v_i| Δt
//
// the sum of P. N. Sun et al. [Comput. Methods Appl. Mech. Eng. 315, 25 (2017)] with the particle's own speed for their
// largest one [A. Skillen, S. Lind, P. K. Stansby, B. D. Rogers, ibid. 265, 163 (2013)]: still water stays. What it
// lifts makes energy, which l_i = min[1, |v_i|/(0.01 c0)] lets fall as that of the motion does (derived here). Where λ
// is below 0.75 anywhere within the kernel, only the part along the surface is left, (1 - n nᵀ) δx [P. N. Sun et al.,
// Comput. Phys. Commun. 224, 63 (2018)], and nothing where λ is below 0.4: a spray.
//
// Water whose particles stand farther apart than its density says, after an impact or in a spray, is no liquid under
// pressure, and falls together (derived here): where λ is below 0.75, so that the surface is nearer than the support H
// of the kernel, what the density has above that of still water at the depth H falls within the time of sound across H,
//   dρ_i/dt = -l_i² (c0/H) max(ρ_i - ρ(H), 0)
// Nor does it hold tension, by which drops would stick to walls: what the density lacks of ρ0 there comes back at once,
// l_i² of it in each step. Both take elastic energy.
//
// A particle is on the surface [S. Marrone et al., J. Comput. Phys. 229, 3652 (2010)] where λ <= 0.2, or λ < 0.75 and
// no neighbour lies in the cone about n (terms.hpp).
#pragma once

#include <free_surface/sums.hpp>
#include <free_surface/terms.hpp>
#include <free_surface/water.hpp>
#include <walls/bodies.hpp>
#include <walls/mirror.hpp>

namespace tetsuame::free_surface {

inline constexpr double of_spray = 0.4, inside = 0.75, alone = 0.2;  // λ

// To all that stands behind walls: images have what their sources have, wall particles of bodies what(wetness, mean at
// their markers).
template <int D, class What>
void behind_walls(const water<D>& f, particles::array& values, const What& what) {
  const auto& w = f.world.w;
  const auto& walls = f.world.walls;
  walls::fill_image_range(walls, w.s, 0, walls.images_of_fluid, walls::even({&values}));
  if (!walls.bodies.any()) return;
  walls::at_bodies<1, 0>(
      w, walls, [&](std::size_t j, std::size_t) { return std::array{values[j]}; },
      [&](std::size_t i, const auto&, double wet, const auto& mean) { values[i] = what(wet, mean[0]); });
  w.exchange_walls({values.data()});
  walls::fill_image_range(walls, w.s, walls.images_of_fluid, walls.source.size(), walls::even({&values}));
}

// Places and volumes of ghosts and images, as of now.
template <int D>
void refresh_places(water<D>& f) {
  auto& w = f.world.w;
  auto& s = w.s;
  foundation::for_all(s.fluid, [&](std::size_t i) { s.dV[i] = s.m[i] / s.rho[i]; });
  const std::array<double*, 1> volumes{s.dV.data()};
  domain::exchange<D>(w.d.ranks, w.d.fluid_halo, std::span<double* const>(volumes), &s.x);
  move_walls(f);
  walls::move_images(f.world.walls, s);
  behind_walls(f, s.dV, [](double wet, double V) { return wet * V; });
}

// Clusters of the fluid of which a member has λ below `inside`, or may have a neighbour that does. Of all others the
// sums that look for the surface would find none.
template <int D>
pairs::remainder clusters_near_surface(const water<D>& f) {
  return clusters_where(f.world.w, true, [&](std::size_t i) { return f.eigenvalue[i] < inside; });
}

// Collective. λ and what shifting goes by; near the surface the outward normal and the least λ about each particle,
// which is 1 elsewhere. Where the surface is near.
template <int D>
pairs::remainder find_arrangement(water<D>& f) {
  auto& w = f.world.w;
  auto& s = w.s;
  const foundation::stage timed(w.times, "surface");
  refresh_places(f);
  const double W = std::visit([&](const auto& k) { return k.value(w.dx); }, w.kernel);
  w.sum(w.fluid(), arrangement<D>{s.dV.data(), 1.0 / W, f.eigenvalue.data(), f.slope.data()});
  w.exchange_fluid({f.eigenvalue.data()});
  // What is dry is no surface.
  behind_walls(f, f.eigenvalue, [](double wet, double lambda) { return wet > 0.0 ? lambda : 1.0; });
  f.eigenvalue[s.null()] = 1.0;
  std::ranges::fill(f.least_near, 1.0);
  auto near = clusters_near_surface(f);
  w.sum(near, outward<D>{s.dV.data(), f.eigenvalue.data(), f.normal.data(), f.least_near.data()});
  return near;
}

// The pressure and tension of water that has lost its concentration, after a step of length dt (s). At a surface under
// tension there is a pressure.
template <int D>
void slacken(water<D>& f, double dt) {
  if (f.has_tension()) return;
  auto& s = f.world.w.s;
  const double support = f.world.w.support(), left = std::exp(-dt * f.p.water.sound / support);
  const double rest = f.o.flow.density, deep = f.p.water.density_beneath(f.gravity() * support);
  foundation::for_all(s.fluid, [&](std::size_t i) {
    if (!(f.eigenvalue[i] < inside) || f.in_zone(i)) return;
    const double l = speed_limiter(f, std::sqrt(f.speed2(i)));
    const double pressed = (1.0 - left) * std::max(s.rho[i] - deep, 0.0), drawn = std::min(s.rho[i] - rest, 0.0);
    s.rho[i] -= l * l * (pressed + drawn);
  });
}

// Drift within a step of length dt (s).
template <int D>
void shift(water<D>& f, double dt) {
  auto& s = f.world.w.s;
  const double size = f.p.shifting * f.p.smoothing_length * dt;
  std::vector<solids::point<D>> before;
  for (const std::uint32_t i : f.beside_bodies) before.push_back(of_solids<D>(f.place(i)));
  foundation::for_all(s.fluid, [&](std::size_t i) {
    if (f.eigenvalue[i] < of_spray || f.in_zone(i)) return;
    const double speed = std::sqrt(f.speed2(i)), of_path = size * speed * speed_limiter(f, speed);
    std::array<double, D> by;
    double across = 0.0, length2 = 0.0;
    for (std::size_t a = 0; a < D; ++a) {
      by[a] = -of_path * f.slope[a][i];
      across += by[a] * f.normal[a][i];
    }
    const bool near = f.least_near[i] < inside;
    for (std::size_t a = 0; a < D; ++a) {
      if (near) by[a] -= across * f.normal[a][i];
      length2 += by[a] * by[a];
    }
    const double most = 0.5 * speed * dt, length = std::sqrt(length2);
    const double part = length > most ? most / length : 1.0;
    for (std::size_t a = 0; a < D; ++a) s.x[a][i] += part * by[a];
  });
  // What is nearer to a body than half a spacing does not drift towards it.
  const double near = 0.5 * f.dx();
  for (std::size_t k = 0; k < before.size(); ++k) {
    const std::uint32_t i = f.beside_bodies[k];
    const auto x = of_solids<D>(f.place(i));
    if (!(f.solid.level(x) < near)) continue;
    const auto surface = f.solid.at(x);
    if (!surface.found || !(surface.distance < near)) continue;
    const double into = std::min(0.0, foundation::dot(x - before[k], surface.normal));
    for (std::size_t a = 0; a < D; ++a) s.x[a][i] -= into * surface.normal[a];
  }
}

// Collective, after a step of length dt (s): what follows from how particles stand.
template <int D>
void arrange(water<D>& f, double dt) {
  find_arrangement(f);
  slacken(f, dt);
  shift(f, dt);
}

// Collective. Of each of this rank's particles whether it is on the surface.
template <int D>
std::vector<bool> find_surface(water<D>& f) {
  const auto near = find_arrangement(f);
  auto& w = f.world.w;
  const auto n = f.normal.read();
  w.sum(near, cone<D>{n, w.s.dV.data(), f.p.smoothing_length, f.covered.data()});
  std::vector<bool> found(w.s.fluid);
  for (std::size_t i = 0; i < found.size(); ++i)
    found[i] = f.eigenvalue[i] <= alone || (f.eigenvalue[i] < inside && f.covered[i] == 0.0);
  return found;
}

}  // namespace tetsuame::free_surface
