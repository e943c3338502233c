// The start: blocks of water on the box's lattice, each particle with the density of water at rest, and a mass that
// fills its cell of the lattice.
#pragma once

#include <algorithm>
#include <free_surface/exact.hpp>
#include <free_surface/moving.hpp>
#include <numbers>

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

// Wall particles of the bodies, and their markers.
template <int D>
void set_up_bodies(water<D>& f) {
  const auto& bodies = f.p.template bodies_in<D>();
  if (bodies.empty()) return;
  const auto& w = f.world.w;
  auto& walls = f.world.walls.bodies;
  walls.no_slip = f.o.walls.slip == "no_slip";
  walls.numbers = 1;
  for (std::size_t a = 0; a < D; ++a) walls.numbers *= f.o.domain.particles[a];
  set_up_moving(f);
  f.asks_loads = !f.p.force.empty() || !f.free.empty();
  f.solid = solid_with(f, [](const auto& b) { return b.now; });
  std::vector<solids::body<D>> resting;
  std::vector<std::size_t> number;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (f.mover_of[b] == moving_body<D>::none) {
      resting.push_back(bodies[b]);
      number.push_back(b);
    }
  number.push_back(bodies.size());  // the tank, whose wall particles lie outside the box
  f.solid_at_rest = solid_of<D>(f.o, resting);
  resting.push_back(tank_of<D>(f.o));
  const solids::lattice<D> box{of_solids<D>(f.o.domain.length), f.dx()};
  const auto cell = w.d.cell();
  const auto made = solids::fill_with_wall_particles<D>(resting, box, w.support(), {cell.lower, cell.upper});
  // On the surface itself both are 0.
  const auto odd = [&](std::size_t n) { return made.height[n] > 0.0 ? made.depth[n] / made.height[n] : 1.0; };
  for (std::size_t n = 0; n < made.x.size(); ++n)
    walls.places.push_back({made.x[n].c, made.marker[n].c, made.normal[n].c, made.height[n], odd(n), made.place[n],
                            static_cast<std::int32_t>(number[made.body[n]])});
  f.resting = walls.places.size();
}

// With new lists.
template <int D>
void find_beside_bodies(water<D>& f) {
  f.beside_bodies.clear();
  if (!f.world.walls.bodies.any()) return;
  // Particles move half of the skin about where lists found them, and so may bodies.
  const double near = (f.moving.empty() ? 1.5 : 2.0) * f.world.skin;
  for (std::size_t i = 0; i < f.world.w.s.fluid; ++i)
    if (f.solid.level(of_solids<D>(f.place(i))) < near) f.beside_bodies.push_back(static_cast<std::uint32_t>(i));
}

// What a particle has risen by (m) when it is put back is taken out of its velocity u (m/s) relative to the body, first
// of that along the normal: putting back makes no energy. A particle slower than this is left at rest.
template <int D>
void pay_for_rise(double g, double risen, const solids::point<D>& normal, solids::point<D>& u) {
  const double due = 2.0 * g * std::max(0.0, risen);
  const double across = foundation::dot(u, normal);
  const double left = across * across - due;
  const auto along = u - across * normal;
  if (left >= 0.0) {
    u = along + std::copysign(std::sqrt(left), across) * normal;
    return;
  }
  const double along2 = foundation::dot(along, along);
  u = along2 + left > 0.0 ? std::sqrt((along2 + left) / along2) * along : foundation::zero<double, D>();
}

// The last guard, as walls::reflect() is at plane sides: how many of this rank's particles had entered a body. Their
// velocity towards it is reversed, as the body sees it.
template <int D>
std::int64_t put_out_of_bodies(water<D>& f) {
  auto& s = f.world.w.s;
  std::int64_t crossings = 0;
  if (!f.moving.empty()) f.solid = solid_with(f, [](const auto& b) { return b.now; });
  for (const std::uint32_t i : f.beside_bodies) {
    const auto x = of_solids<D>(f.place(i));
    if (!f.solid.solid(x)) continue;
    const auto surface = f.solid.at(x);
    if (!surface.found) continue;
    const auto* b = mover_at(f, surface.nearest);
    const auto of_wall = b != nullptr ? b->rate.at(surface.nearest) : foundation::zero<double, D>();
    const auto back = surface.nearest - surface.distance * surface.normal;
    auto u = solids::point<D>::of([&](std::size_t a) { return s.v[a][i] - of_wall[a]; });
    if (const double towards = foundation::dot(u, surface.normal); towards < 0.0) u -= 2.0 * towards * surface.normal;
    pay_for_rise<D>(f.gravity(), back[1] - x[1], surface.normal, u);
    for (std::size_t a = 0; a < D; ++a) {
      s.x[a][i] = back[a];
      s.v[a][i] = of_wall[a] + u[a];
    }
    ++crossings;
  }
  return crossings;
}

template <int D>
void set_up(water<D>& f) {
  run::set_up_empty(f.world, domain::communicator::world(), f.o.domain, f.o.walls, f.o.common.kernel, 0.0);
  set_up_bodies(f);
  const bool has_bodies = f.world.walls.bodies.any();
  std::optional<ball> drop;
  if (f.o.flow.start == "drop") drop = drop_of(f.p);
  place_blocks(f, [&](const point& x) {
    return !(drop && drop->distance2(x) >= drop->radius * drop->radius) &&
           !(has_bodies && f.solid.solid(of_solids<D>(x)));
  });
  f.world.w.g[1] = -f.gravity();
  f.sticks = f.world.walls.bodies.no_slip ||
             std::ranges::any_of(f.world.walls.sides, [](const auto& side) { return side.no_slip; });
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
