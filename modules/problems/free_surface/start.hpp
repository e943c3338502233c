// The start: blocks of water on the box's lattice, each particle with the density of water at rest, and a mass that
// fills its cell of the lattice.
#pragma once

#include <algorithm>
#include <free_surface/exact.hpp>
#include <free_surface/water.hpp>
#include <numbers>
#include <rigid/start.hpp>

namespace tetsuame::free_surface {

// m, the top of the water above x: of its block, and of those that lie on it.
inline double surface_above(const parameters& p, point x) {
  double top = x[1];
  for (bool found = true; found;) {
    found = false;
    for (const block& b : p.blocks) {
      if (!b.holds(x)) continue;
      top = x[1] = b.high[1];
      found = true;
      break;
    }
  }
  return top;
}

inline standing_wave wave_of(const options& o, const parameters& p) {
  return {2.0 * std::numbers::pi / o.flow.wavelength, p.height, o.flow.gravity, o.flow.amplitude,
          o.flow.surface_tension / o.flow.density};
}

// The circle or sphere within the block.
struct ball {
  point centre;   // m
  double radius;  // m
  double distance2(const point& at) const {
    const double x = at[0] - centre[0], y = at[1] - centre[1], z = at[2] - centre[2];
    return x * x + y * y + z * z;
  }
};
inline ball drop_of(const parameters& p) {
  const block& b = p.blocks.front();
  const auto middle = [&](std::size_t a) { return 0.5 * (b.low[a] + b.high[a]); };
  return {{middle(0), middle(1), middle(2)}, 0.5 * (b.high[0] - b.low[0])};
}

// kg/m3: of water that its own weight compresses, and of the drop's pressure, which ∇²p = -ρ ∇v:∇v gives it beyond that
// of its surface.
inline double start_density(const options& o, const parameters& p, const point& x) {
  const auto& f = o.flow;
  if (f.start != "drop") return p.water.density_beneath(f.gravity * (surface_above(p, x) - x[1]));
  const ball c = drop_of(p);
  const bool flat = o.domain.dimension == 2;
  const double of_surface = f.surface_tension * (flat ? 1.0 : 2.0) / c.radius;
  return p.water.density_at((flat ? 0.5 : 0.25) * f.density * f.strain_rate * f.strain_rate *
                                (c.radius * c.radius - c.distance2(x)) +
                            of_surface);
}

// m/s
inline point start_velocity(const options& o, const parameters& p, const point& x) {
  if (o.flow.start == "standing_wave") {
    const auto v = wave_of(o, p).velocity(x[0], x[1]);
    return {v[0], v[1], 0.0};
  }
  if (o.flow.start != "drop") return {};
  const ball c = drop_of(p);
  const double rate = o.flow.strain_rate, across = o.domain.dimension == 2 ? rate : 0.5 * rate;
  return {-across * (x[0] - c.centre[0]), rate * (x[1] - c.centre[1]), -across * (x[2] - c.centre[2])};
}

// Blocks, and of them what is_water(place) keeps.
template <int D, class IsWater>
void place_blocks(water<D>& f, const IsWater& is_water) {
  std::vector<run::lattice_block<D>> lattices;
  std::int64_t first_id = 0;
  for (const block& b : f.p.blocks) {
    run::lattice_block<D> lattice;
    for (std::size_t a = 0; a < D; ++a) {
      lattice.number[a] = std::llround((b.high[a] - b.low[a]) / f.dx());
      lattice.corner[a] = b.low[a];
      lattice.spacing[a] = f.dx();
    }
    lattice.first_id = first_id;
    first_id += lattice.particles();
    lattices.push_back(lattice);
  }
  run::place_lattices<D>(f.world, lattices, f.o.domain.jitter, [&](const std::array<double, D>& x) {
    point of_water{};
    std::ranges::copy(x, of_water.begin());
    return is_water(of_water);
  });
}

template <int D>
void set_up(water<D>& f) {
  run::set_up_empty(f.world, domain::communicator::world(), f.o.domain, f.o.walls, f.o.common.kernel, 0.0);
  rigid::set_up_bodies(f, walls::slip_of_bodies(f.o.walls) == "no_slip");
  std::optional<ball> drop;
  if (f.o.flow.start == "drop") drop = drop_of(f.p);
  place_blocks(f, [&](const point& x) {
    return !(drop && drop->distance2(x) >= drop->radius * drop->radius) &&
           !(f.has_bodies && f.solid.solid(of_solids<D>(x)));
  });
  f.world.w.g[1] = -f.gravity();
  f.two_velocities = f.world.walls.bodies.no_slip || (f.has_bodies && f.p.by != scheme::riemann) ||
                     std::ranges::any_of(f.world.walls.sides, [](const auto& side) { return side.no_slip; });
  f.viscous_velocity = f.template vector<D>(f.two_velocities, "ViscousVelocity", "m/s");
  auto& s = f.world.w.s;
  const double V = std::pow(f.dx(), D);
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const point x = f.place(i);
    s.rho[i] = start_density(f.o, f.p, x);
    s.m[i] = s.rho[i] * V;
    const auto v = start_velocity(f.o, f.p, x);
    for (std::size_t a = 0; a < D; ++a) s.v[a][i] = v[a];
  }
}

}  // namespace tetsuame::free_surface
