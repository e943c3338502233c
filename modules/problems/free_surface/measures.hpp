// What is measured of the water. Sums are of all ranks' particles, exact, so that they do not depend on these.
#pragma once

#include <free_surface/across.hpp>
#include <free_surface/start.hpp>
#include <free_surface/tension.hpp>

namespace tetsuame::free_surface {

// J; in two dimensions for each metre of depth, as masses are.
struct energies {
  double mass = 0.0;  // kg
  double kinetic = 0.0, potential = 0.0, elastic = 0.0;
  double bodies = 0.0;   // kinetic and potential, of those that move freely, with their springs
  double surface = 0.0;  // of surface tension
  double mechanical() const { return kinetic + potential + elastic + bodies + surface; }
};

// J, of free bodies.
template <int D>
double energy_of_bodies(const water<D>& f) {
  double energy = 0.0;
  for (const auto& b : f.moving) {
    if (!b.free) continue;
    energy += 0.5 * b.free->mass * foundation::dot(b.rate.velocity, b.rate.velocity);
    energy += 0.5 * foundation::dot(b.free->angular_momentum, b.rate.angular);
    energy += b.free->mass * f.gravity() * b.centre_of_mass()[1] + b.free->restrained.energy(b.moved());
  }
  return energy;
}

// J, of springs at the start.
template <int D>
double energy_of_springs_at_start(const water<D>& f) {
  double energy = 0.0;
  for (const auto& b : f.moving)
    if (b.free) energy += b.free->restrained.energy({});
  return energy;
}

template <int D>
energies energies_of(water<D>& f) {
  const auto& s = f.world.w.s;
  foundation::exact_sum mass, kinetic, potential, elastic;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    mass.add(s.m[i]);
    kinetic.add(0.5 * s.m[i] * f.speed2(i));
    potential.add(s.m[i] * f.gravity() * s.x[1][i]);
    elastic.add(s.m[i] * f.p.water.elastic_energy(s.rho[i]));
  }
  const auto& ranks = f.ranks();
  return {ranks.exact(mass),    ranks.exact(kinetic), ranks.exact(potential),
          ranks.exact(elastic), energy_of_bodies(f),  surface_energy(f)};
}

// N s, of the water and of free bodies.
template <int D>
solids::point<D> momentum_of(const water<D>& f) {
  const auto& s = f.world.w.s;
  std::array<foundation::exact_sum, D> sums;
  for (std::size_t i = 0; i < s.fluid; ++i)
    for (std::size_t a = 0; a < D; ++a) sums[a].add(s.m[i] * s.v[a][i]);
  const auto total = f.ranks().exact(std::span(sums));
  auto all = solids::point<D>::of([&](std::size_t a) { return total[a]; });
  for (const auto& b : f.moving)
    if (b.free) all += b.free->mass * b.rate.at(b.centre_of_mass());
  return all;
}

template <int D>
double largest_compression(const water<D>& f) {
  double most = 0.0;
  for (std::size_t i = 0; i < f.world.w.s.fluid; ++i)
    most = std::max(most, std::abs(f.world.w.s.rho[i] / f.o.flow.density - 1.0));
  return f.ranks().maximum(most);
}

// The largest of ρ/ρ_most and ρ_0/ρ on this rank, ρ_most that of still water as deep as the start's.
template <int D>
double density_excess(const water<D>& f) {
  const auto& s = f.world.w.s;
  const double deepest = f.p.water.density_beneath(f.gravity() * f.p.height);
  double most = 0.0;
  for (std::size_t i = 0; i < s.fluid; ++i) most = std::max({most, s.rho[i] / deepest, f.o.flow.density / s.rho[i]});
  return most;
}

// m, the edge of the water's foremost particle.
template <int D>
double front_of(const water<D>& f) {
  double most = 0.0;
  for (std::size_t i = 0; i < f.world.w.s.fluid; ++i) most = std::max(most, f.world.w.s.x[0][i]);
  return f.ranks().maximum(most) + 0.5 * f.dx();
}

// The water's velocity along that of the start, 1 there.
template <int D>
double wave_of_now(const water<D>& f) {
  const auto& s = f.world.w.s;
  const standing_wave wave = wave_of(f.o, f.p);
  foundation::exact_sum along, all;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const auto u = wave.velocity(s.x[0][i], s.x[1][i]);
    along.add(s.m[i] * (s.v[0][i] * u[0] + s.v[1][i] * u[1]));
    all.add(s.m[i] * (u[0] * u[0] + u[1] * u[1]));
  }
  return f.ranks().exact(along) / f.ranks().exact(all);
}

// m, of an ellipse with the particles' second moments: a² = 4 <x²>, of an ellipsoid 5 <x²>.
template <int D>
semi_axes semi_axes_of(const water<D>& f) {
  const auto& s = f.world.w.s;
  std::array<double, 2> axes{};
  for (const std::size_t a : {0, 1}) {
    foundation::exact_sum mass, first, second;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      mass.add(s.m[i]);
      first.add(s.m[i] * s.x[a][i]);
      second.add(s.m[i] * s.x[a][i] * s.x[a][i]);
    }
    const double m = f.ranks().exact(mass), mean = f.ranks().exact(first) / m;
    axes[a] = (D == 2 ? 2.0 : std::sqrt(5.0)) * std::sqrt(std::max(0.0, f.ranks().exact(second) / m - mean * mean));
  }
  return {axes[0], axes[1]};
}

// As the water is that much, in one drop.
template <int D>
round_drop round_drop_of(const water<D>& f) {
  const auto& s = f.world.w.s;
  foundation::exact_sum mass;
  for (std::size_t i = 0; i < s.fluid; ++i) mass.add(s.m[i]);
  const double V = f.ranks().exact(mass) / f.o.flow.density;
  return {D, D == 2 ? std::sqrt(V / std::numbers::pi) : std::cbrt(0.75 * V / std::numbers::pi),
          f.o.flow.surface_tension / f.o.flow.density};
}

// Pa, mean of what is nearer to the centre of mass than that (m).
template <int D>
double mean_pressure_within(const water<D>& f, double radius) {
  const auto& s = f.world.w.s;
  point centre{};
  foundation::exact_sum mass;
  for (std::size_t i = 0; i < s.fluid; ++i) mass.add(s.m[i]);
  for (std::size_t a = 0; a < D; ++a) {
    foundation::exact_sum first;
    for (std::size_t i = 0; i < s.fluid; ++i) first.add(s.m[i] * s.x[a][i]);
    centre[a] = f.ranks().exact(first) / f.ranks().exact(mass);
  }
  const ball within{centre, radius};
  foundation::exact_sum V, pV;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    if (within.distance2(f.place(i)) > radius * radius) continue;
    const double mine = s.m[i] / s.rho[i];
    V.add(mine);
    pV.add(mine * f.p.water.pressure(s.rho[i]));
  }
  return f.ranks().exact(pV) / f.ranks().exact(V);
}

// f(x) of a particle and of its images across periodic sides and in the walls nearer to it than `reach` (m), of the
// latter at most one along each axis.
template <int D, class F>
void for_each_view(const water<D>& f, std::size_t i, double reach, F&& at) {
  const auto& sides = f.world.walls.sides;
  for_each_across(f, f.place(i), reach, [&](const point& x) {
    std::uint32_t near = 0;
    for (std::size_t k = 0; k < sides.size(); ++k)
      if (sides[k].distance(x[sides[k].axis]) < reach) near |= 1U << k;
    for (std::uint32_t chosen = near;; chosen = (chosen - 1) & near) {
      std::array<int, D> mirrors{};
      point image = x;
      for (std::size_t k = 0; k < sides.size(); ++k)
        if ((chosen >> k & 1U) != 0) {
          ++mirrors[sides[k].axis];
          image[sides[k].axis] = 2.0 * sides[k].position - image[sides[k].axis];
        }
      if (std::ranges::all_of(mirrors, [](int m) { return m <= 1; })) at(image);
      if (chosen == 0) return;
    }
  });
}

// m, the depth of the water above the place (x, z): its volume beneath a hat two spacings wide to either side.
template <int D>
double depth_at(const water<D>& f, const point& place) {
  const auto& s = f.world.w.s;
  const double width = 2.0 * f.dx();
  foundation::exact_sum depth;
  for (std::size_t i = 0; i < s.fluid; ++i)
    for_each_view(f, i, width, [&](const point& x) {
      double share = s.m[i] / s.rho[i];
      for (std::size_t a = 0; a < D; a += 2) share *= std::max(0.0, 1.0 - std::abs(x[a] - place[a]) / width) / width;
      if (x[1] == s.x[1][i]) depth.add(share);  // no images below the floor or above the lid
    });
  return f.ranks().exact(depth);
}

// m3/s, in two dimensions m2/s: of the water along x through the section at x, smeared two spacings to either side.
template <int D>
double discharge_at(const water<D>& f, double x) {
  const auto& s = f.world.w.s;
  const double width = 2.0 * f.dx();
  foundation::exact_sum flux;
  for (std::size_t i = 0; i < s.fluid; ++i)
    for_each_view(f, i, width, [&](const point& at) {
      if (at[1] != s.x[1][i] || (D == 3 && at[2] != s.x[2][i])) return;
      const bool mirrored = !f.o.domain.periodic[0] && at[0] != s.x[0][i];
      const double share = std::max(0.0, 1.0 - std::abs(at[0] - x) / width) / width;
      flux.add(s.m[i] / s.rho[i] * (mirrored ? -1.0 : 1.0) * s.v[0][i] * share);
    });
  return f.ranks().exact(flux);
}

// ---- still water --------------------------------------------------------------------------------------

// Whether the water starts at rest under a level surface, wall to wall.
inline bool is_still(const options& o, const parameters& p) {
  if (o.flow.start != "rest" || p.blocks.size() != 1 || !p.openings.empty() || !(o.flow.gravity > 0.0)) return false;
  const block& b = p.blocks.front();
  for (std::size_t a = 0; a < o.domain.axes(); ++a)
    if (b.low[a] > 0.0 || (a != 1 && b.high[a] < o.domain.length[a] * (1.0 - 1e-9))) return false;
  return true;
}

// Of still water: the largest error of the pressure deeper than 2h, over ρ0 g H, beside that of water compressed by its
// own weight.
template <int D>
double hydrostatic_error(const water<D>& f) {
  const auto& s = f.world.w.s;
  const double top = f.p.height, weight = f.o.flow.density * f.gravity();
  double most = 0.0;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const double depth = top - s.x[1][i];
    if (depth > 2.0 * f.p.smoothing_length)
      most = std::max(most, std::abs(f.p.water.pressure(s.rho[i]) -
                                     f.p.water.pressure(f.p.water.density_beneath(f.gravity() * depth))));
  }
  return f.ranks().maximum(most) / (weight * top);
}

}  // namespace tetsuame::free_surface
