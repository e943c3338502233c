// The start: lattice, exact profile, walls; and the lists, made anew whenever a particle has
// moved far enough.
#pragma once

#include <foundation/threads.hpp>
#include <hydrostatic/options.hpp>
#include <kernels/lattice.hpp>
#include <optional>
#include <pairs/workspace.hpp>
#include <walls/treatments.hpp>

namespace tetsuame::hydrostatic {

template <int D>
struct scene {
  pairs::workspace<D> w;
  walls::any treatment;
  walls::wall_set<D> walls;
  double skin = 0.0;  // m
  std::int64_t fluid_total = 0;
  std::array<std::int64_t, D> lattice{};   // particles along each axis at the start, numbered by ID along the first one
  std::vector<double> p_exact, rho_exact;  // Pa, kg/m3, of the exact solution, by row along y
  bool density_carried = false;            // ρ is part of the state
  bool weight_carried = false;             // Y is
};

// Where the particle of that ID stood at the start: its place on the lattice along each axis.
template <int D>
std::array<std::size_t, D> start_place(const scene<D>& scene, std::int64_t id) {
  std::array<std::size_t, D> place;
  for (std::size_t a = 0; a < D; ++a) {
    place[a] = static_cast<std::size_t>(id % scene.lattice[a]);
    id /= scene.lattice[a];
  }
  return place;
}

// m, how far fluid particle i is from its start. Over a periodic border the nearest image counts.
template <int D>
std::array<double, D> displacement(const scene<D>& scene, std::size_t i) {
  const auto& box = scene.w.d.region;
  const auto place = start_place(scene, scene.w.s.id[i]);
  std::array<double, D> d;
  for (std::size_t a = 0; a < D; ++a) {
    d[a] = scene.w.s.x[a][i] - (static_cast<double>(place[a]) + 0.5) * scene.w.dx;
    if (box.periodic[a]) d[a] -= box.length[a] * std::round(d[a] / box.length[a]);
  }
  return d;
}

// Pressure of the exact solution at the height y: the initial pressure, or the hydrostatic
// dp/dy = -ρ^(p, T) g from the top, by fourth-order Runge–Kutta steps of at most Δx/16.
class profile {
 public:
  profile(const options& o, const eos::any& material) : o_(o), material_(material) {}

  double pressure(double y) const {
    if (o_.initial.profile == "uniform") return o_.initial.pressure;
    const double top = o_.domain.length[1];
    const auto n = static_cast<std::int64_t>(std::ceil(16.0 * std::abs(top - y) / o_.dx()));
    const double dy = n > 0 ? (y - top) / static_cast<double>(n) : 0.0;
    double p = o_.initial.pressure;
    for (std::int64_t k = 0; k < n; ++k) {
      const double k1 = slope(p), k2 = slope(p + 0.5 * dy * k1), k3 = slope(p + 0.5 * dy * k2), k4 = slope(p + dy * k3);
      p += dy * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
    }
    return p;
  }
  double density(double p) const { return eos::density(material_, p, o_.initial.temperature); }

 private:
  double slope(double p) const { return -density(p) * o_.g; }

  const options& o_;
  const eos::any& material_;
};

// Fluid of the start lattice in this rank's cell: equal spacing, masses m = ρ Δx^D of the exact profile.
template <int D>
void place_fluid(const options& o, scene<D>& scene) {
  auto& w = scene.w;
  auto& s = w.s;
  const profile exact(o, w.materials[0]);
  auto& cells = scene.lattice;
  scene.fluid_total = 1;
  for (std::size_t a = 0; a < D; ++a) {
    cells[a] = o.domain.particles[a];
    scene.fluid_total *= cells[a];
  }
  scene.p_exact.clear();
  scene.rho_exact.clear();
  for (std::int64_t row = 0; row < cells[1]; ++row) {
    scene.p_exact.push_back(exact.pressure((static_cast<double>(row) + 0.5) * w.dx));
    scene.rho_exact.push_back(exact.density(scene.p_exact.back()));
  }
  // A cell of the slice grid is a box: what it holds along each axis.
  const auto cell = w.d.cell();
  std::array<std::vector<std::int64_t>, D> mine;
  std::size_t count = 1;
  for (std::size_t a = 0; a < D; ++a) {
    for (std::int64_t n = 0; n < cells[a]; ++n)
      if (const double x = (static_cast<double>(n) + 0.5) * w.dx; x >= cell.lower[a] && x < cell.upper[a])
        mine[a].push_back(n);
    count *= mine[a].size();
  }
  particles::allocate(s, count, 0, 0, 0);
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t rest = i;
    std::int64_t stride = 1;
    s.id[i] = 0;
    s.material[i] = 0;
    std::array<std::int64_t, D> at;
    for (std::size_t a = 0; a < D; ++a) {
      at[a] = mine[a][rest % mine[a].size()];
      rest /= mine[a].size();
      s.id[i] += stride * at[a];
      stride *= cells[a];
      s.x[a][i] = (static_cast<double>(at[a]) + 0.5) * w.dx;
      s.v[a][i] = 0.0;
    }
    const auto row = static_cast<std::size_t>(at[1]);
    s.rho[i] = scene.rho_exact[row];
    s.T[i] = o.initial.temperature;
    s.m[i] = s.rho[i] * std::pow(w.dx, D);
    s.Y[i] = scene.p_exact[row] * s.m[i] / s.rho[i];
    s.u[i] = 0.0;
    s.eta[i] = o.material.viscosity;
    s.k[i] = o.material.conductivity;
  }
}

// Wall particles continue the profile where a treatment keeps it.
template <int D>
void place_walls(const options& o, scene<D>& scene) {
  auto& w = scene.w;
  auto& s = w.s;
  const bool has_particles = std::visit([](auto t) { return decltype(t)::has_particles; }, scene.treatment);
  if (!has_particles) return;
  walls::place(w, scene.walls, scene.fluid_total, w.support());
  const bool frozen = std::holds_alternative<walls::frozen>(scene.treatment);
  const profile exact(o, w.materials[0]);
  for (std::size_t i = s.first_wall(); i < s.first_wall() + s.walls; ++i) {
    s.T[i] = o.initial.temperature;
    s.eta[i] = o.material.viscosity;
    s.k[i] = o.material.conductivity;
    s.p[i] = s.p_eos[i] = frozen ? exact.pressure(s.x[1][i]) : o.initial.pressure;
    s.rho[i] = exact.density(s.p[i]);
    s.m[i] = s.rho[i] * std::pow(w.dx, D);
    s.dV[i] = s.m[i] / s.rho[i];
    s.Y[i] = s.p[i] * s.dV[i];
  }
  if (!frozen) return;
  const auto begin = static_cast<std::ptrdiff_t>(s.first_wall()), end = begin + static_cast<std::ptrdiff_t>(s.walls);
  scene.walls.p_given.assign(s.p.begin() + begin, s.p.begin() + end);
  scene.walls.rho_given.assign(s.rho.begin() + begin, s.rho.begin() + end);
}

// Gives the ranks other cells. Walls move at once; the fluid, and all that hangs on it, at the next rebuild, which
// must come before the next evaluation.
template <int D>
void move_cuts(const options& o, scene<D>& scene, const balance::cuts<D>& cuts) {
  scene.w.d.cuts = cuts;
  place_walls(o, scene);
}

// Whether the lists' positions are set to the present ones, or left (a restart swaps the two
// before and after, so that lists are made as they were made).
enum list_positions { set_list_positions, keep_list_positions };

// Sorts the owned fluid, which is in the order of cells and IDs, into layers (workspace::border): within, those whose
// neighbours may have ghosts or walls for neighbours, and those that may themselves.
template <int D>
void order_in_layers(pairs::workspace<D>& w, double reach, std::vector<std::size_t>& order) {
  w.core = w.border = 0;
  if (w.d.ranks.size == 1) return;  // nothing is ever on its way
  auto cell = w.d.cell();
  const auto deeper_than = [&](double depth) {
    auto deep = cell;
    for (std::size_t a = 0; a < D; ++a) {
      deep.lower[a] = std::max(cell.lower[a], 0.0) + depth;
      deep.upper[a] = std::min(cell.upper[a], w.d.region.length[a]) - depth;
    }
    return [&w, deep](std::size_t i) { return w.d.within(deep, cells::position<D>(w.s.x, i)); };
  };
  // A little more than lists reach, against rounding.
  const auto border = std::stable_partition(order.begin(), order.end(), deeper_than(reach * (1.0 + 1e-6)));
  const auto core = std::stable_partition(order.begin(), border, deeper_than(2.0 * reach * (1.0 + 1e-6)));
  w.border = static_cast<std::size_t>(border - order.begin());
  w.core = static_cast<std::size_t>(core - order.begin());
}

// Hands particles to their ranks, sorts them by cell and ID, makes halos and lists. The state's
// arrays move: the integrator must be told.
template <int D>
void rebuild(scene<D>& scene, list_positions positions = set_list_positions) {
  auto& w = scene.w;
  auto& s = w.s;
  const foundation::stage timed(w.times, "lists");
  const double reach = w.support() + scene.skin;
  domain::migrate(w.d, s);

  const auto cells_of_fluid = cells::make_grid<D>(s.x, s.id, s.fluid, cells::cell_edge(reach));
  std::vector<std::size_t> order(cells_of_fluid.members.begin(), cells_of_fluid.members.end());
  order_in_layers(w, reach, order);
  particles::reorder(s, 0, std::span<const std::size_t>(order));
  if (positions == set_list_positions) s.x_list = s.x;

  domain::make_halo<D>(w.d, s, 0, s.fluid, s.fluid, w.d.fluid_halo,
                       [&](std::size_t ghosts) { particles::allocate(s, s.fluid, ghosts, s.walls, 0); });
  domain::make_halo<D>(w.d, s, s.first_wall(), s.walls, s.first_wall() + s.walls, w.d.wall_halo,
                       [&](std::size_t ghosts) { particles::allocate(s, s.fluid, s.fluid_ghosts, s.walls, ghosts); });
  w.exchange_fluid({s.m.data(), s.eta.data(), s.k.data()});

  const auto grid = cells::make_grid<D>(s.x, s.id, s.total(), cells::cell_edge(reach));
  cells::make_list<D>(
      w.list, grid, s.fluid, reach, s.null(), [&](std::size_t i) { return cells::position<D>(s.x, i); },
      cells::others{});
  std::visit(
      [&](auto t) {
        if constexpr (decltype(t)::has_markers) walls::detail::prepare_markers(w, scene.walls, grid, scene.skin);
      },
      scene.treatment);
}

// m/s, the largest of the exact profile.
template <int D>
double fastest_sound(const options& o, const scene<D>& scene) {
  double most = 0.0;
  for (const double rho : scene.rho_exact)
    most = std::max(most, eos::evaluate(scene.w.materials[0], rho, o.initial.temperature).sound_speed);
  return most;
}

// Everything up to the first evaluation, lists included.
template <int D>
void set_up(const options& o, const domain::communicator& ranks, scene<D>& scene) {
  auto& w = scene.w;
  w.dx = o.dx();
  w.kernel = kernels::make<D>(o.kernel.name, o.kernel.h_over_dx * w.dx);
  w.lattice_sum = kernels::lattice_sum<D>(w.kernel, w.dx);
  w.materials = {eos::make(o.material.eos)};
  w.g[1] = -o.g;
  if (o.material.conductivity == 0.0) w.uniform_transport = o.material.viscosity;
  scene.skin = o.kernel.skin * w.dx;
  scene.treatment = walls::make(o.walls.treatment);
  scene.walls.how = o.walls;
  domain::box<D> box;
  for (std::size_t a = 0; a < D; ++a) {
    box.length[a] = o.domain.length[a];
    box.periodic[a] = o.domain.periodic[a];
  }
  w.d = domain::decompose<D>(ranks, box, o.halo_width(), o.domain.ranks_x);
  scene.walls.sides = walls::make_sides<D>(o.walls, box);
  place_fluid(o, scene);
  place_walls(o, scene);
  if (std::holds_alternative<walls::virtual_marker>(scene.treatment))
    scene.walls.force = walls::make_boundary_force(w.dx, fastest_sound(o, scene));
}

}  // namespace tetsuame::hydrostatic
