// The start of two fluids: every particle of the same volume on a lattice, its mass by the column at rest (column.hpp),
// carried along the growing mode.
#pragma once

#include <algorithm>
#include <numbers>
#include <rigid/start.hpp>
#include <run/start.hpp>
#include <run/start_from_file.hpp>
#include <two_fluids/cloud.hpp>
#include <two_fluids/fluids.hpp>
#include <two_fluids/rows.hpp>
#include <two_fluids/start_regions.hpp>

namespace tetsuame::two_fluids {

template <int D>
using point_of = typename fluids<D>::point;

template <int D>
point_of<D> place_of(const fluids<D>& f, std::size_t i) {
  std::array<double, D> x;
  for (std::size_t a = 0; a < D; ++a) x[a] = f.world.w.s.x[a][i];
  return x;
}

// cos k_x x cos k_z z
template <int D>
double wave_at(const fluids<D>& f, const point_of<D>& x) {
  return std::cos(f.p.k_x * x[0]) * std::cos(f.p.k_z * (D == 3 ? x[2 % D] : 0.0));
}

// Of the growing mode with unit amplitude: displacement (m/m) of the particle that rests at x.
template <int D>
point_of<D> mode_at(const fluids<D>& f, const point_of<D>& x) {
  const auto& p = f.p;
  const auto m = theory::at(*p.mode, x[1] - p.interface);
  const double k = p.mode->k, z = D == 3 ? x[2 % D] : 0.0;
  const double cx = std::cos(p.k_x * x[0]), sx = std::sin(p.k_x * x[0]);
  const double cz = std::cos(p.k_z * z), sz = std::sin(p.k_z * z);
  std::array<double, D> u;
  u[0] = m.displacement_x * p.k_x / k * sx * cz;
  u[1] = m.displacement_y * cx * cz;
  if (D == 3) u[2 % D] = m.displacement_x * p.k_z / k * cx * sz;
  return u;
}

// Where the growing mode takes what rests at x, followed along its field in four Runge-Kutta steps: a displacement by
// amplitude times field at once would change volumes in second order, by some 2 % at 0.02 of the height, and start
// with a bang.
template <int D>
point_of<D> carried_along(const fluids<D>& f, const point_of<D>& x) {
  constexpr int steps = 4;
  const double ds = f.o.amplitude / steps;
  const auto beyond = [](std::array<double, D> at, double s, const std::array<double, D>& u) {
    for (std::size_t a = 0; a < D; ++a) at[a] += s * u[a];
    return at;
  };
  auto to = x;
  for (int k = 0; k < steps; ++k) {
    const auto k1 = mode_at(f, to), k2 = mode_at(f, beyond(to, 0.5 * ds, k1)),
               k3 = mode_at(f, beyond(to, 0.5 * ds, k2)), k4 = mode_at(f, beyond(to, ds, k3));
    for (std::size_t a = 0; a < D; ++a) to[a] += ds * (k1[a] + 2.0 * k2[a] + 2.0 * k3[a] + k4[a]) / 6.0;
  }
  return to;
}

template <int D>
bool in_a_drop(const fluids<D>& f, const point_of<D>& x) {
  const auto& o = f.o;
  if (f.many()) {
    std::array<double, 3> at{};
    std::copy(x.begin(), x.end(), at.begin());
    return std::any_of(f.p.places.begin(), f.p.places.end(),
                       [&](const auto& c) { return distance(o.domain, at, c) < o.radius; });
  }
  // In units of the half axes, whose product is that of a round drop.
  double r2 = 0.0, most = 0.0;
  for (std::size_t a = 0; a < D; ++a) {
    const double half = o.radius * std::pow(o.elongation, a == 1 ? 1.0 - 1.0 / D : -1.0 / D);
    const double d = (x[a] - *o.centre[a]) / half;
    r2 += d * d;
    most = std::max(most, std::abs(d));
  }
  if (o.shape == "square")
    return most < 0.5 * (D == 2 ? std::sqrt(std::numbers::pi) : std::cbrt(4.0 / 3.0 * std::numbers::pi));
  return r2 < 1.0;
}

template <int D>
std::int32_t material_at(const fluids<D>& f, const point_of<D>& x) {
  if (f.is_drop()) return in_a_drop(f, x) ? 1 : 0;
  const double height = f.o.start == "coloured" ? *f.o.interface + f.o.amplitude * wave_at(f, x) : f.p.interface;
  return x[1] > height && x[1] < f.p.pond_top ? 1 : 0;
}

// Of several drops, the pressure in the middle of every row as the weight of all that lies above, metal too, and not of
// the column: what makes drops fall is then left, and no more. The column's would come as sound, at several times the
// speed of the fall. `share`: of metal, of every row.
template <int D>
std::vector<double> pressures_below(const fluids<D>& f, const barotropic& upper, const std::vector<double>& share) {
  const auto& lower = f.p.base->lower();
  std::vector<double> pressure(share.size());
  double above = f.o.p_top;  // Pa, at the row's upper edge
  for (std::size_t row = share.size(); row-- > 0;) {
    double weight = 0.0;  // Pa, of half the row, at the pressure in its middle
    for (int k = 0; k < 4; ++k)
      weight = 0.5 * f.world.w.dx * f.o.gravity *
               (share[row] * at_pressure(upper, above + weight).density +
                (1.0 - share[row]) * at_pressure(lower, above + weight).density);
    pressure[row] = above + weight;
    above = pressure[row] + weight;
  }
  return pressure;
}

// Gives the particles of the lattice their materials; of every row of it, both materials at its pressure.
template <int D>
std::vector<std::array<place, 2>> rows_at_rest(fluids<D>& f) {
  auto& s = f.world.w.s;
  const double dx = f.world.w.dx;
  const auto& lower = f.p.base->lower();
  const barotropic drop = curve_of(f, 1);
  const auto& upper = f.is_drop() ? drop : f.p.base->upper();
  const auto number = static_cast<std::size_t>(f.o.domain.particles[1]);
  std::vector<std::int64_t> metal(number, 0);
  for (std::size_t i = 0; i < s.fluid; ++i) {
    s.material[i] = material_at(f, place_of(f, i));
    metal[static_cast<std::size_t>(s.x[1][i] / dx)] += f.is_metal(i) ? 1 : 0;
  }
  std::vector<double> pressure(number);
  if (f.many()) {
    const double in_row = static_cast<double>(f.world.fluid_total) / static_cast<double>(number);
    std::vector<double> share(number);
    for (std::size_t row = number; row-- > 0;) share[row] = static_cast<double>(f.ranks().sum(metal[row])) / in_row;
    pressure = pressures_below(f, upper, share);
  } else {
    for (std::size_t row = 0; row < number; ++row)
      pressure[row] = f.p.base->at((static_cast<double>(row) + 0.5) * dx).pressure;
  }
  std::vector<std::array<place, 2>> rows(number);
  for (std::size_t row = 0; row < number; ++row)
    rows[row] = {at_pressure(lower, pressure[row]), at_pressure(upper, pressure[row])};
  for (std::size_t n = 0; n < 2; ++n) {
    const auto by_density = [n](const auto& row) { return row[n].density; };
    const auto [least, most] = std::ranges::minmax_element(rows, {}, by_density);
    f.density_range[n] = {(*least)[n].density, (*most)[n].density};
  }
  for (std::size_t n = 2; n < f.density_range.size(); ++n)
    f.density_range[n] = {on_curve(f, n, pressure.back()).density, on_curve(f, n, pressure.front()).density};
  return rows;
}

// Rows of one material each, moved and with pressures such that the sums hold them (rows.hpp). Returns their heights,
// m.
template <int D>
std::vector<double> balance(const fluids<D>& f, std::vector<std::array<place, 2>>& rows) {
  const auto& o = f.o;
  const double dx = f.world.w.dx;
  std::vector<row_of_rest> start(rows.size());
  std::vector<double> heights(rows.size());
  const auto upper = [&](std::size_t r) { return (static_cast<double>(r) + 0.5) * dx > f.p.interface; };
  const auto curve = [&](std::size_t r) { return upper(r) ? f.p.base->upper() : f.p.base->lower(); };
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const place& here = rows[r][upper(r) ? 1 : 0];
    start[r] = {(static_cast<double>(r) + 0.5) * dx, here.pressure, here.density};
  }
  const column_of_rows<D> column(f.world.w.kernel, dx, o.domain.length[1], o.open_lid(), o.gravity);
  const auto rest = balanced<D>(column, start, dx, o.gravity,
                                [&](std::size_t r, double p) { return at_pressure(curve(r), p).density; });
  for (std::size_t r = 0; r < rows.size(); ++r) {
    rows[r][upper(r) ? 1 : 0] = at_pressure(curve(r), rest[r].p);
    heights[r] = rest[r].y;
  }
  return heights;
}

// Temperature and heat content of the enthalpy law.
template <int D>
void heat_up(fluids<D>& f, std::size_t i) {
  auto& s = f.world.w.s;
  const auto n = f.material_of(i);
  s.T[i] = f.T_start[i] = n == 0 && s.x[1][i] > f.p.pond_top ? f.p.cover_temperature : f.p.temperature[n];
  take_up_heat(f, i);
}

// To where the mode takes particle i, with the mode's velocity if it starts as an eigenmode.
template <int D>
void displace(fluids<D>& f, std::size_t i) {
  auto& s = f.world.w.s;
  const auto x = place_of(f, i), to = carried_along(f, x), u = mode_at(f, to);
  const double rate = f.o.start == "eigenmode" ? f.p.mode->growth_rate : 0.0;
  for (std::size_t a = 0; a < D; ++a) {
    s.x[a][i] = to[a];
    s.v[a][i] = rate * f.o.amplitude * u[a];
  }
  if (!f.carried && !f.weighed) return;
  // As the mode compresses a particle: its pressure is that of the place where it went.
  const auto m = theory::at(*f.p.mode, x[1] - f.p.interface);
  const auto e = eos::evaluate((*f.p.material)[f.material_of(i)], s.rho[i], s.T[i]);
  const double stiffness = f.warms ? s.rho[i] * e.sound_speed * e.sound_speed : e.K_T;
  s.rho[i] *= 1.0 + f.o.amplitude * wave_at(f, x) *
                        (m.pressure / f.stiffness - s.rho[i] * f.o.gravity * m.displacement_y) / stiffness;
}

// Equal masses: each layer's own lattice in the place of the box's, the lower one's particles numbered first.
template <int D>
void place_layers(fluids<D>& f) {
  std::vector<run::lattice_block<D>> lattices(2);
  for (const std::size_t n : {0, 1}) {
    const auto& layer = f.p.layers[n];
    std::copy_n(layer.number.begin(), D, lattices[n].number.begin());
    std::copy_n(layer.spacing.begin(), D, lattices[n].spacing.begin());
    lattices[n].corner[1] = layer.low;
  }
  lattices[1].first_id = lattices[0].particles();
  run::place_lattices<D>(f.world, lattices, f.o.domain.jitter);
  auto& s = f.world.w.s;
  for (std::size_t i = 0; i < s.fluid; ++i) s.material[i] = s.id[i] < lattices[1].first_id ? 0 : 1;
}

// What a particle starts with, of a density (kg/m3) and volume (m^D) at rest.
template <int D>
void start_at(fluids<D>& f, std::size_t i, const place& state, double V) {
  auto& s = f.world.w.s;
  s.m[i] = state.density * V;
  s.rho[i] = f.rho_start[i] = state.density;
  s.T[i] = f.T_start[i] = state.temperature;
  s.u[i] = f.dissipated[i] = 0.0;
  if (f.follows) f.support[i] = f.S_0;
  if (f.dissolved) start_element(f, i);
  if (f.o.shear != 0.0) s.v[0][i] = (f.is_metal(i) ? 0.5 : -0.5) * f.o.shear;
}

// As a snapshot has them. A particle's own start is then there; how far the mode has come is measured from the lattice,
// where IDs are those of a lattice.
template <int D>
void take_from_file(fluids<D>& f) {
  auto& w = f.world.w;
  auto& s = w.s;
  const auto& region = w.d.region;
  const double top = f.p.base->at(f.o.domain.length[1]).pressure, floor = f.p.base->at(0.0).pressure;
  const auto volume = [&](std::size_t n) {
    return f.o.masses == "equal_mass" ? f.p.layers[n].volume : std::pow(w.dx, D);
  };
  const auto read = run::start_from_file(f.o.common.start,
                                         {.materials = f.o.names(),
                                          .pressures = {std::min(top, floor), std::max(top, floor)},
                                          .volume = volume,
                                          .concentration = f.dissolved ? &f.element : nullptr},
                                         f.world);
  expect_all_materials(f, f.o.common.start.place + f.o.common.start.file);
  if (read.laid_anew) f.placed = f.world.fluid_total;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    f.rho_start[i] = s.rho[i];
    f.T_start[i] = s.T[i];
    if (read.laid_anew && f.follows) f.support[i] = f.S_0;
    if (f.dissolved && !read.has_concentrations) start_element(f, i);
    if (f.enthalpy) take_up_heat(f, i);
    for (std::size_t a = 0; a < D; ++a) {
      if (!read.is_lattice) s.x_start[a][i] = s.x[a][i];
      if (region.periodic[a])
        s.x_start[a][i] += region.length[a] * std::round((s.x[a][i] - s.x_start[a][i]) / region.length[a]);
    }
  }
}

template <int D>
void place_fluid(fluids<D>& f) {
  auto& w = f.world.w;
  auto& s = w.s;
  if (f.o.masses == "equal_mass") {
    place_layers(f);
    const double top = f.o.domain.length[1], below = f.p.interface * (1.0 - 1e-12);
    f.density_range = {{f.p.base->at(below).density, f.p.base->at(0.0).density},
                       {f.p.base->at(top).density, f.p.base->at(f.p.interface).density}};
    for (std::size_t i = 0; i < s.fluid; ++i)
      start_at(f, i, f.p.base->at(s.x[1][i]), f.p.layers[f.material_of(i)].volume);
  } else {
    auto rows = rows_at_rest(f);
    const auto heights = f.o.scheme.rows == "balanced" ? balance(f, rows) : std::vector<double>{};
    for (std::size_t i = 0; i < s.fluid; ++i) {
      const auto row = static_cast<std::size_t>(s.x[1][i] / w.dx);
      if (!heights.empty()) s.x[1][i] = s.x_start[1][i] += heights[row] - (static_cast<double>(row) + 0.5) * w.dx;
      start_at(f, i, rows[row][f.material_of(i)], std::pow(w.dx, D));
      if (f.enthalpy) heat_up(f, i);
      if (f.p.mode && f.o.start != "coloured") displace(f, i);
    }
    if (f.p.regions.any()) shape_by_regions(f);
  }
  if (f.o.common.start.is_read()) take_from_file(f);
}

// Where particles stand behind the walls: their places, and something to begin with of what every evaluation sets.
template <int D>
void place_walls(fluids<D>& f) {
  auto& w = f.world.w;
  auto& s = w.s;
  if (f.has_bodies) return rigid::hand_over_walls(f.bodies);
  if (!std::visit([](auto t) { return decltype(t)::has_particles; }, f.world.treatment)) return;
  walls::place(w, f.world.walls, f.world.fluid_total, w.support());
  const double rho = on_curve(f, 0, f.o.p_top).density;
  for (std::size_t i = s.first_wall(); i < s.first_wall() + s.walls; ++i) {
    s.T[i] = f.o.temperature;
    s.eta[i] = f.o.material[0].viscosity;
    s.k[i] = f.o.conductivity_of(0);
    s.rho[i] = rho;
    s.dV[i] = std::pow(w.dx, D);
    s.m[i] = rho * s.dV[i];
  }
}

// Bodies, and fluid on the lattice but for what they cover.
template <int D>
void place_lattice(fluids<D>& f) {
  const auto& o = f.o;
  const auto lattice = run::whole_box<D>(o.domain);
  rigid::set_up_bodies(f.bodies, walls::slip_of_bodies(o.walls) == "no_slip");
  run::place_lattices<D>(f.world, {lattice}, o.domain.jitter,
                         [&](const std::array<double, D>& x) { return !f.has_bodies || !f.bodies.solid.solid({x}); });
}

// Walls, lattice and arrays.
template <int D>
void set_up(fluids<D>& f) {
  const auto& o = f.o;
  auto& w = f.world.w;
  run::set_up_empty(f.world, domain::communicator::world(), o.domain, o.walls, o.common.kernel, 0.0);
  place_lattice(f);
  f.placed = f.ranks().sum(static_cast<std::int64_t>(w.s.fluid));
  w.materials = *f.p.material;
  w.g[1] = -o.gravity;
  if (o.by_program) {
    f.world.treatment = walls::make(o.walls.treatment);
    f.world.walls.how = o.walls;
    if (!o.conducts() && !o.viscosities_differ()) w.uniform_transport = o.material[0].viscosity;
  }
  f.h = o.common.kernel.h_over_dx * w.dx;
  f.S_0 = w.support();
  f.unit = kernels::make<D>(o.common.kernel.name, 1.0 / kernels::find(o.common.kernel.name).support_over_h);
}

// p_r: the weight of a column of the lightest density.
template <int D>
void find_reference(fluids<D>& f) {
  if (f.o.scheme.reference_pressure != "lightest") return;
  double lightest = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < f.o.material.size(); ++n)
    lightest = std::min(lightest, on_curve(f, n, f.o.p_top).density);
  f.reference_slope = -f.o.gravity * lightest;
  f.reference_floor = -f.reference_slope * f.o.domain.length[1];
}

}  // namespace tetsuame::two_fluids
