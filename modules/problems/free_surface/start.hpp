// The start: blocks of water on the box's lattice, each particle with the density of water at rest, and a mass that
// fills its cell of the lattice.
#pragma once

#include <algorithm>
#include <foundation/agree.hpp>
#include <free_surface/exact.hpp>
#include <free_surface/openings.hpp>
#include <free_surface/united.hpp>
#include <free_surface/water.hpp>
#include <numbers>
#include <rigid/start.hpp>
#include <run/start_from_file.hpp>

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

// kg/m3: of water that its own weight compresses, beneath a surface at the height `top` (m), and of the drop's
// pressure, which ∇²p = -ρ ∇v:∇v gives it beyond that of its surface.
inline double start_density(const options& o, const parameters& p, const point& x, double top) {
  const auto& f = o.flow;
  if (f.start != "drop") return p.water.density_beneath(f.gravity * (top - x[1]));
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

// Blocks, and of them what is_water(place) keeps; and what stands in the zones of inflows, whose first ID it returns.
template <int D, class IsWater>
std::int64_t place_blocks(water<D>& f, const IsWater& is_water) {
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
  const std::size_t blocks = lattices.size();
  const auto inflows = lattices_of_inflows(f, first_id);
  for (const auto& lattice : inflows) f.inflow_places += lattice.particles();
  lattices.insert(lattices.end(), inflows.begin(), inflows.end());
  run::place_lattices<D>(f.world, lattices, f.o.domain.jitter,
                         [&](const std::array<double, D>& x, std::size_t lattice) {
                           point of_water{};
                           std::ranges::copy(x, of_water.begin());
                           return lattice >= blocks || is_water(of_water);
                         });
  if (f.has_openings) f.world.fluid_total = most_numbers;
  return first_id;
}

// What &region says of the places of the blocks; what fails on one rank fails on all.
template <int D>
class cut_by_regions {
 public:
  explicit cut_by_regions(const water<D>& f) : f_(f) {}

  regions::values at(const point& x) {
    try {
      return f_.p.regions.at(x, 0.0, counts_);
    } catch (const foundation::error& e) {
      fault_ = e.what();
      return {};
    }
  }
  bool leaves(const point& x) { return !f_.p.regions.any() || at(x).material.value_or(0) == 0; }
  // Collective, when all places have been asked for.
  void expect_sound() {
    foundation::agree(f_.ranks().comm, fault_, foundation::exit_status::bad_input);
    if (!f_.p.regions.any()) return;
    counts_.resize(f_.p.regions.size(), 0);
    for (auto& count : counts_) count = f_.ranks().sum(count);
    f_.p.regions.expect_used(counts_);
  }

 private:
  const water<D>& f_;
  std::vector<std::int64_t> counts_;
  std::string fault_;
};

// Collective. A snapshot's particles in the place of those of the blocks.
template <int D>
void take_from_file(water<D>& f) {
  auto& s = f.world.w.s;
  const run::start_file file(f.o.common.start, run::start_box_of(f.world.w), {"Coordinates", "Velocities"});
  const auto x = file.places(), v = file.velocities();
  if (f.o.common.start.settles()) file.expect_at_rest(v);
  const double V = std::pow(f.dx(), D), rest = f.p.water.density, far = run::start_file::far_off;
  const std::size_t all = file.particles();
  const auto rho = file.has("Density") ? file.densities() : std::vector<double>(all, rest);
  const bool has_masses = file.has("Masses") || file.has_mass_of_all();
  const auto m = has_masses ? file.masses() : std::vector<double>(all, rest * V);
  std::vector<double> volumes(all);
  for (std::size_t n = 0; n < all; ++n) {
    volumes[n] = m[n] / rho[n];
    if (rho[n] < rest / far || rho[n] > rest * far)
      file.fail_at(n, fmt::format("its Density is {:.6g} kg/m^3, where water has {:.6g}", rho[n], rest));
    if (volumes[n] < V / far || volumes[n] > V * far)
      file.fail_at(n, fmt::format("its mass over its Density is a volume of {:.6g} m^{}, where a particle has {:.6g}",
                                  volumes[n], D, V));
    point at{};
    std::copy_n(x.begin() + static_cast<std::ptrdiff_t>(D * n), D, at.begin());
    if (f.has_bodies && f.solid.solid(of_solids<D>(at))) file.fail_at(n, "it lies in a body of &solids");
  }
  file.check_packing(x, volumes);
  // Spray is alone for a while.
  if (!file.is_of_this_program())
    file.check_neighbours(x, volumes, std::vector<double>(all, f.world.w.support()), true);
  run::lay_out_file<D>(f.world, x);
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const auto n = static_cast<std::size_t>(s.id[i]);
    s.rho[i] = rho[n];
    s.m[i] = m[n];
    for (std::size_t a = 0; a < D; ++a) {
      s.x[a][i] = x[D * n + a];
      s.v[a][i] = v[D * n + a];
    }
  }
}

// The blocks' particles, of IDs below `end`: their density, mass and velocity.
template <int D>
void start_blocks(water<D>& f, cut_by_regions<D>& cut, const united_surface* united, std::int64_t end) {
  auto& s = f.world.w.s;
  const double V = std::pow(f.dx(), D);
  for (std::size_t i = 0; i < s.fluid; ++i) {
    if (s.id[i] >= end) continue;
    const point x = f.place(i);
    const double own = surface_above(f.p, x);
    s.rho[i] = start_density(f.o, f.p, x, united != nullptr ? united->level(x, own) : own);
    auto v = start_velocity(f.o, f.p, x);
    if (f.p.regions.any()) {
      const auto given = cut.at(x);
      if (given.density) s.rho[i] = *given.density;
      if (given.pressure) s.rho[i] = f.p.water.density_at(*given.pressure);
      for (std::size_t a = 0; a < D; ++a) v[a] = given.velocity[a].value_or(v[a]);
    }
    s.m[i] = s.rho[i] * V;
    for (std::size_t a = 0; a < D; ++a) s.v[a][i] = v[a];
  }
}

template <int D>
void set_up(water<D>& f) {
  run::set_up_empty(f.world, domain::communicator::world(), f.o.domain, f.o.walls, f.o.common.kernel, 0.0);
  rigid::set_up_bodies(f, walls::slip_of_bodies(f.o.walls) == "no_slip");
  std::optional<ball> drop;
  if (f.o.flow.start == "drop") drop = drop_of(f.p);
  cut_by_regions<D> cut(f);
  const auto is_solid = [&](const point& x) { return f.has_bodies && f.solid.solid(of_solids<D>(x)); };
  const auto is_water = [&](const point& x) {
    const bool enters = std::ranges::any_of(f.p.openings, [&](const auto& e) { return e.enters && e.holds(x); });
    return !(drop && drop->distance2(x) >= drop->radius * drop->radius) && !is_solid(x) && !enters && cut.leaves(x);
  };
  const std::int64_t first_of_inflows = place_blocks(f, is_water);
  std::optional<united_surface> united;
  if (touch_sideways(f.o, f.p)) united.emplace(f.o, f.p, is_water, is_solid);
  f.world.w.g[1] = -f.gravity();
  f.two_velocities = f.world.walls.bodies.no_slip || (f.has_bodies && f.p.by != scheme::riemann) ||
                     std::ranges::any_of(f.world.walls.sides, [](const auto& side) { return side.no_slip; });
  f.viscous_velocity = f.template vector<D>(f.two_velocities, "ViscousVelocity", "m/s");
  start_blocks(f, cut, united ? &*united : nullptr, first_of_inflows);
  cut.expect_sound();
  if (f.has_openings) {
    fill_inflows(f, first_of_inflows);
    take_into_outflows(f);
  }
  if (f.o.common.start.is_read()) take_from_file(f);
}

}  // namespace tetsuame::free_surface
