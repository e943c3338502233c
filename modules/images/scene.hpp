// A box of fluid whose walls are mirror images: start lattice, lists, and what is moved between arrays and files.
#pragma once

#include <images/images.hpp>
#include <kernels/lattice.hpp>
#include <output/snapshot.hpp>
#include <pairs/workspace.hpp>
#include <random>

namespace tetsuame::images {

template <int D>
struct scene {
  pairs::workspace<D> w;
  image_set<D> images;
  double skin = 0.0;  // m
  std::int64_t fluid_total = 0;
};

struct box_options {
  std::array<double, 3> length{};  // m
  std::array<std::int64_t, 3> particles{};
  std::array<bool, 3> periodic{};
  domain::rank_columns ranks_x;
};

// Kernel, decomposition, walls and the fluid of the start lattice in this rank's cell. jitter: each particle is moved
// by up to so many spacings along each axis, by its ID. `halo`: m, the least width.
template <int D>
void set_up(scene<D>& scene, const domain::communicator& ranks, const box_options& box, const options& walls,
            std::string_view kernel, double h_over_dx, double skin_over_dx, double jitter, double halo) {
  auto& w = scene.w;
  auto& s = w.s;
  w.dx = box.length[1] / static_cast<double>(box.particles[1]);
  w.kernel = kernels::make<D>(kernel, h_over_dx * w.dx);
  w.lattice_sum = kernels::lattice_sum<D>(w.kernel, w.dx);
  scene.skin = skin_over_dx * w.dx;
  domain::box<D> region;
  for (std::size_t a = 0; a < D; ++a) {
    region.length[a] = box.length[a];
    region.periodic[a] = box.periodic[a];
  }
  w.d = domain::decompose<D>(ranks, region, std::max(halo, w.support()) + scene.skin, box.ranks_x);
  scene.images.sides = make_sides<D>(walls, region);
  scene.fluid_total = 1;
  for (std::size_t a = 0; a < D; ++a) scene.fluid_total *= box.particles[a];
  std::vector<std::array<double, D>> places;
  std::vector<std::int64_t> ids;
  for (std::int64_t id = 0; id < scene.fluid_total; ++id) {
    std::mt19937_64 random(static_cast<std::uint64_t>(id) + 1);
    std::array<double, D> x;
    std::int64_t rest = id;
    for (std::size_t a = 0; a < D; ++a) {
      // 53 bits, so that it is the same with every library.
      const double shift = jitter > 0.0 ? (2.0 * static_cast<double>(random() >> 11) * 0x1p-53 - 1.0) * jitter : 0.0;
      x[a] = (static_cast<double>(rest % box.particles[a]) + 0.5 + shift) * w.dx;
      rest /= box.particles[a];
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

struct list_lengths {
  double edge, reach;  // m: of the grid's cells; of halos and images
};

// Hands particles to their ranks, sorts them by cell and ID, makes halos, images and lists. as_they_were: lists are
// made from the list positions, with which a restart has the same sums. Ghosts and images have their positions; other
// fields are the caller's to refresh. lengths(): list_lengths, asked when particles are with their ranks;
// make_lists(list_lengths).
template <int D, class Lengths, class MakeLists>
void rebuild_by(scene<D>& scene, bool as_they_were, const Lengths& lengths, const MakeLists& make_lists) {
  auto& w = scene.w;
  auto& s = w.s;
  const foundation::stage timed(w.times, "lists");
  const auto exchange_positions = [&] {
    for (std::size_t a = 0; a < D; ++a)
      std::swap_ranges(s.x[a].begin(), s.x[a].begin() + static_cast<std::ptrdiff_t>(s.fluid), s.x_list[a].begin());
  };
  particles::allocate(s, s.fluid, 0, 0, 0);
  if (as_they_were)
    exchange_positions();
  else
    domain::wrap(w.d.region, s);
  domain::migrate(w.d, s);
  const list_lengths l = lengths();
  const auto cells_of_fluid = cells::make_grid<D>(s.x, s.id, s.fluid, l.edge);
  std::vector<std::size_t> order(cells_of_fluid.members.begin(), cells_of_fluid.members.end());
  particles::reorder(s, 0, std::span<const std::size_t>(order));
  if (!as_they_were)
    for (std::size_t a = 0; a < D; ++a) std::copy_n(s.x[a].begin(), s.fluid, s.x_list[a].begin());
  domain::make_halo<D>(w.d, s, 0, s.fluid, s.fluid, w.d.fluid_halo,
                       [&](std::size_t ghosts) { particles::allocate(s, s.fluid, ghosts, 0, 0); });
  make(scene.images, s, scene.fluid_total, l.reach);
  make_lists(l);
  if (as_they_were) exchange_positions();
}

// Of one support for all.
template <int D>
void rebuild(scene<D>& scene, bool as_they_were) {
  auto& w = scene.w;
  auto& s = w.s;
  const double reach = w.support() + scene.skin;
  rebuild_by(
      scene, as_they_were,
      [&] {
        return list_lengths{cells::cell_edge(reach), reach};
      },
      [&](const list_lengths& l) {
        const auto grid = cells::make_grid<D>(s.x, s.id, s.total(), l.edge);
        cells::make_list<D>(
            w.list, grid, s.fluid, reach, s.null(), [&](std::size_t i) { return cells::position<D>(s.x, i); },
            cells::others{});
      });
}

// m, the largest displacement on this rank since the lists were made.
template <int D>
double moved_since_lists(const scene<D>& scene) {
  return std::sqrt(particles::moved_since_lists(scene.w.s));
}

template <int D>
output::snapshot_header snapshot_header(const scene<D>& scene) {
  output::snapshot_header header;
  header.dimension = D;
  for (std::size_t a = 0; a < D; ++a) {
    header.box_lengths[a] = scene.w.d.region.length[a];
    header.periodic[a] = scene.w.d.region.periodic[a];
  }
  return header;
}

}  // namespace tetsuame::images
