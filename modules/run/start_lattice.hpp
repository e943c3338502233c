// The start lattice of a box.
#pragma once

#include <kernels/lattice.hpp>
#include <random>
#include <run/options.hpp>
#include <run/state.hpp>

namespace tetsuame::run {

// Kernel, decomposition, walls and the fluid of the start lattice in this rank's cell. jitter: each particle is moved
// by up to so many spacings along each axis, by its ID. `halo`: m, the least width.
template <int D>
void set_up(run::state<D>& box, const domain::communicator& ranks, const box_options& of,
            const walls::options& of_walls, std::string_view kernel, double h_over_dx, double skin_over_dx,
            double jitter, double halo) {
  auto& w = box.w;
  auto& s = w.s;
  w.dx = of.length[1] / static_cast<double>(of.particles[1]);
  w.kernel = kernels::make<D>(kernel, h_over_dx * w.dx);
  w.lattice_sum = kernels::lattice_sum<D>(w.kernel, w.dx);
  box.skin = skin_over_dx * w.dx;
  domain::box<D> region;
  for (std::size_t a = 0; a < D; ++a) {
    region.length[a] = of.length[a];
    region.periodic[a] = of.periodic[a];
  }
  w.d = domain::decompose<D>(ranks, region, std::max(halo, w.support()) + box.skin, of.ranks_x);
  box.walls.sides = walls::make_sides<D>(of_walls, region);
  box.fluid_total = 1;
  for (std::size_t a = 0; a < D; ++a) box.fluid_total *= of.particles[a];
  std::vector<std::array<double, D>> places;
  std::vector<std::int64_t> ids;
  for (std::int64_t id = 0; id < box.fluid_total; ++id) {
    std::mt19937_64 random(static_cast<std::uint64_t>(id) + 1);
    std::array<double, D> x;
    std::int64_t rest = id;
    for (std::size_t a = 0; a < D; ++a) {
      // 53 bits, so that it is the same with every library.
      const double shift = jitter > 0.0 ? (2.0 * static_cast<double>(random() >> 11) * 0x1p-53 - 1.0) * jitter : 0.0;
      x[a] = (static_cast<double>(rest % of.particles[a]) + 0.5 + shift) * w.dx;
      rest /= of.particles[a];
    }
    if (!w.d.within(w.d.cell(), x)) continue;
    places.push_back(x);
    ids.push_back(id);
  }
  particles::allocate(s, places.size(), 0, 0, 0);
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

}  // namespace tetsuame::run
