// A start from a snapshot: of this program or another, of the same box and lattice.
#pragma once

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <output/hdf5_layout.hpp>
#include <run/options.hpp>
#include <run/state.hpp>

namespace tetsuame::run {

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
