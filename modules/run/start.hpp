// The start of a box: a lattice, and on it what a snapshot says, of this program or another, of the same box and
// lattice.
#pragma once

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <kernels/lattice.hpp>
#include <limits>
#include <output/hdf5_layout.hpp>
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

namespace detail {

// Where the particle of that ID starts, its row along each axis given: jittered, by a part of the spacing, by numbers
// of its ID alone. A particle stays in its own cell of the lattice.
template <int D>
std::array<double, D> start_place(const lattice_block<D>& of, const std::array<std::int64_t, D>& row, std::int64_t id,
                                  double jitter) {
  std::array<double, D> x;
  for (std::size_t a = 0; a < D; ++a) x[a] = of.corner[a] + (static_cast<double>(row[a]) + 0.5) * of.spacing[a];
  if (jitter == 0.0) return x;
  std::mt19937_64 random(static_cast<std::uint64_t>(id) + 1);
  for (std::size_t a = 0; a < D; ++a)  // 53 bits, so that it is the same with every library
    x[a] += (2.0 * static_cast<double>(random() >> 11) * 0x1p-53 - 1.0) * jitter * of.spacing[a];
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

// The fluid of these lattices in this rank's cell, at rest, without what is_there(place) leaves out. IDs are those of
// the whole lattices.
template <int D, class IsThere>
void place_lattices(run::state<D>& box, const std::vector<lattice_block<D>>& lattices, double jitter,
                    const IsThere& is_there) {
  auto& s = box.w.s;
  std::vector<std::array<double, D>> places;
  std::vector<std::int64_t> ids;
  box.fluid_total = 0;
  for (const auto& lattice : lattices) {
    detail::find_own<D>(box, lattice, jitter, is_there, places, ids);
    box.fluid_total += lattice.particles();
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
  domain::box<D> region;
  for (std::size_t a = 0; a < D; ++a) {
    region.length[a] = of.length[a];
    region.periodic[a] = of.periodic[a];
  }
  w.d = domain::decompose<D>(ranks, region, std::max(reach, w.support()) + box.skin, of.ranks_x);
  box.walls.sides = walls::make_sides<D>(of_walls, region);
}

// And with the fluid of the start lattice.
template <int D>
void set_up(run::state<D>& box, const domain::communicator& ranks, const domain::options& of,
            const walls::options& of_walls, const kernel_options& kernel, double reach) {
  set_up_empty(box, ranks, of, of_walls, kernel, reach);
  lattice_block<D> lattice;
  for (std::size_t a = 0; a < D; ++a) {
    lattice.number[a] = of.particles[a];
    lattice.spacing[a] = box.w.dx;
  }
  place_lattices<D>(box, {lattice}, of.jitter);
}

// ---- a snapshot ---------------------------------------------------------------------------

// What of the particles is taken from the file beside their places and temperature.
struct taken_from_file {
  bool motion = true;  // velocity, density, mass
  bool material = false;
};

namespace detail {

// Rows of the file by ID. Fails where it is not of so many particles in so many dimensions, or lacks one of the fields.
inline std::vector<std::size_t> rows_of_file(const start_options& o, int dimension, std::int64_t particles,
                                             const std::vector<std::string>& fields) {
  const auto fail = [&](const std::string& what) { foundation::fail_input(o.place + o.file + what); };
  const auto datasets = output::list_datasets(o.file, "PartType0");
  const auto find = [&](const std::string& name) {
    return std::ranges::find_if(datasets, [&](const auto& d) { return d.name == name; });
  };
  std::vector<std::string> lacking;
  for (const auto& name : fields)
    if (find(name) == datasets.end()) lacking.push_back(name);
  if (find("ParticleIDs") == datasets.end()) lacking.emplace_back("ParticleIDs");
  if (!lacking.empty()) fail(fmt::format(" has no field {}", fmt::join(lacking, ", ")));
  const double of_file = output::read_real_attribute(o.file, "Header", "Dimension");
  if (of_file != dimension) fail(fmt::format(" has {} dimensions, and the box {}", of_file, dimension));

  const auto ids = output::read_reals(o.file, "PartType0/ParticleIDs");
  if (static_cast<std::int64_t>(ids.size()) != particles)
    fail(fmt::format(" holds {} particles, and the box {}", ids.size(), particles));
  for (const auto& name : fields)
    if (const auto& shape = find(name)->shape; shape.empty() || shape[0] != ids.size() ||
                                               (shape.size() > 1 && shape[1] < static_cast<std::uint64_t>(dimension)))
      fail(fmt::format(": field {} is not of {} particles in {} dimensions", name, particles, dimension));
  constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> row(ids.size(), none);
  for (std::size_t k = 0; k < ids.size(); ++k) {
    const auto id = static_cast<std::size_t>(std::clamp(ids[k], 0.0, 1e15));
    if (id >= row.size() || row[id] != none)
      fail(fmt::format(": the particles' IDs are not those of a box of {}", particles));
    row[id] = k;
  }
  return row;
}

}  // namespace detail

// Gives the fluid of this rank, laid out on the start lattice, what the snapshot says of the particles of the same IDs.
// Where they lie, and so which rank is theirs, is another matter: that is for the first lists. A lattice, pressures and
// whatever else is of the exact start stays with the problem.
template <int D>
void start_from_file(const start_options& o, const taken_from_file& taken, state<D>& box) {
  auto& s = box.w.s;
  std::vector<std::string> fields{"Coordinates", "Temperature"};
  if (taken.motion) fields.insert(fields.end(), {"Velocities", "Density", "Masses"});
  if (taken.material) fields.emplace_back("Material");
  const auto row = detail::rows_of_file(o, D, box.fluid_total, fields);
  // All ranks check all particles, so that they fail alike.
  const auto take = [&](const char* name, auto&& allowed, auto&& give) {
    const auto values = output::read_reals(o.file, std::string("PartType0/") + name);
    const std::size_t columns = values.size() / row.size();
    for (std::size_t id = 0; id < row.size(); ++id)
      if (!allowed(&values[columns * row[id]]))
        foundation::fail_input(fmt::format("{}{}: particle {} cannot have these {}", o.place, o.file, id, name));
    for (std::size_t i = 0; i < s.fluid; ++i) give(i, &values[columns * row[static_cast<std::size_t>(s.id[i])]]);
  };
  const auto finite = [](const double* value) { return std::isfinite(*value); };
  const auto positive = [](const double* value) { return *value > 0.0 && std::isfinite(*value); };
  const auto in_the_box = [&](const double* x) {
    bool inside = true;
    for (std::size_t a = 0; a < D; ++a) inside = inside && x[a] >= 0.0 && x[a] <= box.w.d.region.length[a];
    return inside;
  };
  const auto all_finite = [](const double* v) {
    return std::all_of(v, v + D, [](double x) { return std::isfinite(x); });
  };
  take("Coordinates", in_the_box, [&](std::size_t i, const double* x) {
    for (std::size_t a = 0; a < D; ++a) s.x[a][i] = x[a];
  });
  take("Temperature", finite, [&](std::size_t i, const double* T) { s.T[i] = *T; });
  if (taken.material)
    take("Material", finite, [&](std::size_t i, const double* of) { s.material[i] = *of > 0.5 ? 1 : 0; });
  if (!taken.motion) return;
  take("Velocities", all_finite, [&](std::size_t i, const double* v) {
    for (std::size_t a = 0; a < D; ++a) s.v[a][i] = v[a];
  });
  take("Density", positive, [&](std::size_t i, const double* rho) { s.rho[i] = *rho; });
  take("Masses", positive, [&](std::size_t i, const double* m) { s.m[i] = *m; });
}

}  // namespace tetsuame::run
