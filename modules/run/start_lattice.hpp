// The start lattice of a box.
#pragma once

#include <kernels/lattice.hpp>
#include <random>
#include <run/options.hpp>
#include <run/state.hpp>

namespace tetsuame::run {

namespace detail {

// Where the particle of that ID starts, its row along each axis given: jittered by numbers of its ID alone. A particle
// stays in its own cell of the lattice.
template <int D>
std::array<double, D> start_place(const domain::options& of, const std::array<std::int64_t, D>& row, std::int64_t id,
                                  double dx) {
  std::array<double, D> x;
  for (std::size_t a = 0; a < D; ++a) x[a] = (static_cast<double>(row[a]) + 0.5) * dx;
  if (of.jitter == 0.0) return x;
  std::mt19937_64 random(static_cast<std::uint64_t>(id) + 1);
  for (auto& component : x)  // 53 bits, so that it is the same with every library
    component += (2.0 * static_cast<double>(random() >> 11) * 0x1p-53 - 1.0) * of.jitter * dx;
  return x;
}

}  // namespace detail

// For so many particles, all of whose fields are 0: what a problem does not use has the same bits on any ranks.
template <int D>
void make_room(particles::particles<D>& s, std::size_t number) {
  particles::allocate(s, number, 0, 0, 0);
  particles::for_each_field<D>(s, [&](const particles::field_info& field, const auto& components) {
    if (!particles::travels(field.kind)) return;
    for (auto* a : components) std::fill_n(a->begin(), number, 0.0);
  });
}

// The fluid of the start lattice in this rank's cell, numbered along x first, at rest.
template <int D>
void place_lattice(run::state<D>& box, const domain::options& of) {
  auto& w = box.w;
  auto& s = w.s;
  const auto cell = w.d.cell();
  // Rows that may lie in the cell.
  std::array<std::int64_t, D> first, last, row;
  for (std::size_t a = 0; a < D; ++a) {
    const double n = static_cast<double>(of.particles[a]);
    first[a] = static_cast<std::int64_t>(std::clamp(std::floor(cell.lower[a] / w.dx) - 1.0, 0.0, n));
    last[a] = static_cast<std::int64_t>(std::clamp(std::ceil(cell.upper[a] / w.dx) + 1.0, 0.0, n));
  }
  std::vector<std::array<double, D>> places;
  std::vector<std::int64_t> ids;
  row = first;
  bool some = true;
  for (std::size_t a = 0; a < D; ++a) some = some && first[a] < last[a];
  while (some) {
    std::int64_t id = 0;
    for (std::size_t a = D; a-- > 0;) id = id * of.particles[a] + row[a];
    const auto x = detail::start_place<D>(of, row, id, w.dx);
    if (w.d.within(cell, x)) {
      places.push_back(x);
      ids.push_back(id);
    }
    std::size_t a = 0;
    while (a < D && ++row[a] == last[a]) row[a] = first[a], ++a;
    some = a < D;
  }
  make_room(s, places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    s.id[i] = ids[i];
    s.material[i] = 0;
    for (std::size_t a = 0; a < D; ++a) {
      s.x[a][i] = places[i][a];
      if (s.keeps_start) s.x_start[a][i] = places[i][a];
      s.v[a][i] = 0.0;
    }
  }
}

// Spacing, kernel, decomposition, walls and the fluid of the start lattice. `reach`: m, the least width of the halo
// without the lists' skin.
template <int D>
void set_up(run::state<D>& box, const domain::communicator& ranks, const domain::options& of,
            const walls::options& of_walls, const kernel_options& kernel, double reach) {
  auto& w = box.w;
  w.dx = of.dx();
  w.kernel = kernels::make<D>(kernel.name, kernel.h_over_dx * w.dx);
  w.compute_pairs_in(kernel.single_pairs());
  w.lattice_sum = kernels::lattice_sum<D>(w.kernel, w.dx);
  box.skin = kernel.skin * w.dx;
  domain::box<D> region;
  box.fluid_total = 1;
  for (std::size_t a = 0; a < D; ++a) {
    region.length[a] = of.length[a];
    region.periodic[a] = of.periodic[a];
    box.fluid_total *= of.particles[a];
  }
  w.d = domain::decompose<D>(ranks, region, std::max(reach, w.support()) + box.skin, of.ranks_x);
  box.walls.sides = walls::make_sides<D>(of_walls, region);
  place_lattice(box, of);
}

}  // namespace tetsuame::run
