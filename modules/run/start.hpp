// The start of a box: a lattice. start_from_file.hpp puts what a snapshot says in its place.
#pragma once

#include <algorithm>
#include <cmath>
#include <kernels/lattice.hpp>
#include <random>
#include <run/lists.hpp>
#include <run/options.hpp>

namespace tetsuame::run {

// A lattice with its own spacing along each axis, whose particles are numbered along x first.
template <int D>
struct lattice_block {
  std::array<std::int64_t, D> number;  // particles along each axis
  std::array<double, D> corner{};      // m, of the lowest cell
  std::array<double, D> spacing;       // m
  std::int64_t first_id = 0;

  std::int64_t particles() const {
    std::int64_t all = 1;
    for (const auto n : number) all *= n;
    return all;
  }
};

// Random numbers of a particle, by its ID and a seed alone: 53 bits, so that they are the same with every library.
class random_of_particle {
 public:
  explicit random_of_particle(std::int64_t id, std::int64_t seed = 0)
      : random_(static_cast<std::uint64_t>(id) + 1 + 0x9e3779b97f4a7c15 * static_cast<std::uint64_t>(seed)) {}
  double between_minus_1_and_1() { return 2.0 * static_cast<double>(random_() >> 11) * 0x1p-53 - 1.0; }

 private:
  std::mt19937_64 random_;
};

namespace detail {

// Where the particle of that ID starts, its row along each axis given: jittered, by a part of the spacing, by numbers
// of its ID alone. A particle stays in its own cell of the lattice.
template <int D>
std::array<double, D> start_place(const lattice_block<D>& of, const std::array<std::int64_t, D>& row, std::int64_t id,
                                  double jitter) {
  std::array<double, D> x;
  for (std::size_t a = 0; a < D; ++a) x[a] = of.corner[a] + (static_cast<double>(row[a]) + 0.5) * of.spacing[a];
  if (jitter == 0.0) return x;
  random_of_particle random(id);
  for (std::size_t a = 0; a < D; ++a) x[a] += random.between_minus_1_and_1() * jitter * of.spacing[a];
  return x;
}

// Those of a lattice's particles that start in this rank's cell, and that is_there(place) keeps.
template <int D, class IsThere>
void find_own(const state<D>& box, const lattice_block<D>& of, double jitter, const IsThere& is_there,
              std::vector<std::array<double, D>>& places, std::vector<std::int64_t>& ids) {
  const auto& w = box.w;
  const auto cell = w.d.cell();
  // Rows that may lie in the cell.
  std::array<std::int64_t, D> first, last, row;
  bool some = true;
  for (std::size_t a = 0; a < D; ++a) {
    const double n = static_cast<double>(of.number[a]);
    first[a] =
        static_cast<std::int64_t>(std::clamp(std::floor((cell.lower[a] - of.corner[a]) / of.spacing[a]) - 1.0, 0.0, n));
    last[a] =
        static_cast<std::int64_t>(std::clamp(std::ceil((cell.upper[a] - of.corner[a]) / of.spacing[a]) + 1.0, 0.0, n));
    some = some && first[a] < last[a];
  }
  row = first;
  while (some) {
    std::int64_t id = 0;
    for (std::size_t a = D; a-- > 0;) id = id * of.number[a] + row[a];
    id += of.first_id;
    const auto x = start_place<D>(of, row, id, jitter);
    if (w.d.within(cell, x) && is_there(x)) {
      places.push_back(x);
      ids.push_back(id);
    }
    std::size_t a = 0;
    while (a < D && ++row[a] == last[a]) row[a] = first[a], ++a;
    some = a < D;
  }
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

// The fluid of these lattices in this rank's cell, at rest, without what is_there(place, number of the lattice) leaves
// out, or is_there(place). IDs are those of the whole lattices.
template <int D, class IsThere>
void place_lattices(run::state<D>& box, const std::vector<lattice_block<D>>& lattices, double jitter,
                    const IsThere& is_there) {
  auto& s = box.w.s;
  std::vector<std::array<double, D>> places;
  std::vector<std::int64_t> ids;
  box.fluid_total = 0;
  for (std::size_t n = 0; n < lattices.size(); ++n) {
    const auto is_here = [&](const std::array<double, D>& x) {
      if constexpr (std::is_invocable_v<IsThere, const std::array<double, D>&, std::size_t>)
        return is_there(x, n);
      else
        return is_there(x);
    };
    detail::find_own<D>(box, lattices[n], jitter, is_here, places, ids);
    box.fluid_total += lattices[n].particles();
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

template <int D>
void place_lattices(run::state<D>& box, const std::vector<lattice_block<D>>& lattices, double jitter) {
  place_lattices<D>(box, lattices, jitter, [](const std::array<double, D>&) { return true; });
}

// Spacing, kernel, decomposition and walls, without fluid. `reach`: m, the least width of the halo without the lists'
// skin.
template <int D>
void set_up_empty(run::state<D>& box, const domain::communicator& ranks, const domain::options& of,
                  const walls::options& of_walls, const kernel_options& kernel, double reach) {
  auto& w = box.w;
  w.dx = of.dx();
  w.kernel = kernels::make<D>(kernel.name, kernel.h_over_dx * w.dx);
  w.compute_pairs_in(kernel.single_pairs());
  w.lattice_sum = kernels::lattice_sum<D>(w.kernel, w.dx);
  box.skin = kernel.skin * w.dx;
  box.narrowest = {};
  const auto region = domain::box_of<D>(of);
  w.d = domain::decompose<D>(ranks, region, std::max(reach, w.support()) + box.skin, of.ranks_x);
  box.walls.sides = walls::make_sides<D>(of_walls, region);
}

// The lattice that fills the box.
template <int D>
lattice_block<D> whole_box(const domain::options& of) {
  lattice_block<D> lattice;
  for (std::size_t a = 0; a < D; ++a) {
    lattice.number[a] = of.particles[a];
    lattice.spacing[a] = of.dx();
  }
  return lattice;
}

// And with the fluid of the start lattice.
template <int D>
void set_up(run::state<D>& box, const domain::communicator& ranks, const domain::options& of,
            const walls::options& of_walls, const kernel_options& kernel, double reach) {
  set_up_empty(box, ranks, of, of_walls, kernel, reach);
  place_lattices<D>(box, {whole_box<D>(of)}, of.jitter);
}

}  // namespace tetsuame::run
