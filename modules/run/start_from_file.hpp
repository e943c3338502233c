// A box whose particles are those of a snapshot, in the place of its start lattice: as many as the file has.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <eos/eos.hpp>
#include <functional>
#include <limits>
#include <run/start.hpp>
#include <run/start_file.hpp>

namespace tetsuame::run {

// What of the particles is taken from the file beside their places and temperature, and what they are held against.
struct taken_from_file {
  bool motion = true;                           // velocity, density, mass
  std::vector<std::string> materials{};         // names; none: there is but one
  std::array<double, 2> pressures{};            // Pa, the lowest and the highest of the box at rest
  std::function<double(std::size_t)> volume{};  // m^D, of a particle of that material on the start lattice
  particles::array* concentration = nullptr;    // of an element, where the file has it
  std::int32_t number_of_materials() const { return std::max(1, static_cast<std::int32_t>(materials.size())); }
};

namespace detail {

struct matter {
  std::vector<double> T, rho, m;  // K, kg/m3, kg
  std::vector<std::int32_t> material;
};

// Of all volumes together, which fill the box: what a density carried along drifts by is less than a tenth.
constexpr double misfit = 0.25;

// kg/m3, of a material between the lowest and the highest pressure and temperature.
template <class Box>
std::array<double, 2> densities_of(const start_file& file, const Box& box, std::size_t material,
                                   const std::array<double, 2>& pressures, const std::array<double, 2>& temperatures) {
  std::array range{std::numeric_limits<double>::infinity(), 0.0};
  for (const double p : pressures)
    for (const double T : temperatures) {
      double rho = 0.0;
      try {
        rho = eos::density(box.w.materials[material], p, T);
      } catch (const foundation::error& e) {
        file.fail(fmt::format(": material {} has no density at {:.6g} K, as a particle has, and {:.6g} Pa: {}",
                              material, T, p, e.what()));
      }
      range = {std::min(range[0], rho), std::max(range[1], rho)};
    }
  return range;
}

// Densities against the equation of state; masses over densities against the lattice's volumes, and the box's.
template <int D>
void check_matter(const start_file& file, const state<D>& box, const taken_from_file& taken, const matter& of,
                  const std::vector<double>& places) {
  for (std::int32_t n = 0; n < taken.number_of_materials(); ++n) {
    std::array T{std::numeric_limits<double>::infinity(), 0.0};
    for (std::size_t i = 0; i < of.T.size(); ++i)
      if (of.material[i] == n) T = {std::min(T[0], of.T[i]), std::max(T[1], of.T[i])};
    if (T[1] == 0.0) continue;  // there is none
    const auto which = static_cast<std::size_t>(n);
    const auto rho = densities_of(file, box, which, taken.pressures, T);
    const double V = taken.volume(which);
    for (std::size_t i = 0; i < of.T.size(); ++i) {
      if (of.material[i] != n) continue;
      if (of.rho[i] < rho[0] / start_file::far_off || of.rho[i] > rho[1] * start_file::far_off)
        file.fail_at(i, fmt::format("its Density is {:.6g} kg/m^3, where material {} has {:.6g} to {:.6g} at {:.6g} to "
                                    "{:.6g} Pa and the file's temperatures",
                                    of.rho[i], n, rho[0], rho[1], taken.pressures[0], taken.pressures[1]));
      if (const double ratio = of.m[i] / of.rho[i] / V;
          ratio < 1.0 / start_file::far_off || ratio > start_file::far_off)
        file.fail_at(i, fmt::format("its mass over its Density is a volume of {:.6g} m^{}, where a particle has {:.6g}",
                                    of.m[i] / of.rho[i], D, V));
    }
  }
  std::vector<double> volumes(of.m.size());
  for (std::size_t i = 0; i < volumes.size(); ++i) volumes[i] = of.m[i] / of.rho[i];
  file.check_packing(places, volumes);
  double filled = 0.0, whole = 1.0;
  for (const double V : volumes) filled += V;
  for (std::size_t a = 0; a < D; ++a) whole *= box.w.d.region.length[a];
  if (!(std::abs(filled / whole - 1.0) <= misfit))
    file.fail(fmt::format(": masses over densities fill {:.6g} m^{}, and the box is of {:.6g}", filled, D, whole));
}

}  // namespace detail

template <int D>
start_box start_box_of(const pairs::workspace<D>& w) {
  start_box b;
  b.dimension = D;
  b.dx = w.dx;
  std::copy_n(w.d.region.length.begin(), D, b.length.begin());
  std::copy_n(w.d.region.periodic.begin(), D, b.periodic.begin());
  std::copy_n(w.d.region.open.begin(), D, b.open.begin());
  return b;
}

// The numbers of those particles that lie in this rank's cell, of all places (m) by number.
template <int D>
std::vector<std::int64_t> own_numbers(const domain::decomposition<D>& d, const std::vector<double>& places) {
  const auto cell = d.cell();
  std::vector<std::int64_t> own;
  for (std::size_t n = 0; n < places.size() / D; ++n) {
    std::array<double, D> x;
    std::copy_n(places.begin() + static_cast<std::ptrdiff_t>(D * n), D, x.begin());
    if (d.within(cell, x)) own.push_back(static_cast<std::int64_t>(n));
  }
  return own;
}

// Room for this rank's particles of a file in the place of those of a lattice, with their numbers as IDs.
template <int D>
void lay_out_file(state<D>& box, const std::vector<double>& places) {
  auto& s = box.w.s;
  const auto own = own_numbers<D>(box.w.d, places);
  make_room(s, own.size());
  for (std::size_t i = 0; i < own.size(); ++i) {
    s.id[i] = own[i];
    s.material[i] = 0;
  }
  box.fluid_total = static_cast<std::int64_t>(places.size() / D);
}

// How the file's particles are those of the start lattice.
struct start_read {
  bool is_lattice;  // as many, by this program: IDs are those of the lattice, or else just numbers
  bool laid_anew;   // another number of particles: fields that the problem gave those of the lattice are 0
  bool has_concentrations;
};

// Gives the fluid of this rank what the snapshot says of its particles: those of the start lattice that have the same
// numbers, or, where there are others, new ones. Where they lie, and so which rank is theirs, is another matter: that
// is for the first lists. A lattice, pressures and whatever else is of the exact start stays with the problem.
template <int D>
start_read start_from_file(const start_options& o, const taken_from_file& taken, state<D>& box) {
  auto& s = box.w.s;
  std::vector<std::string> fields{"Coordinates", "Temperature"};
  if (taken.motion) fields.insert(fields.end(), {"Velocities", "Density", "Masses"});
  const std::int32_t materials = taken.number_of_materials();
  if (materials > 1) fields.emplace_back("Material");
  const start_file file(o, start_box_of(box.w), fields);
  const auto x = file.places();
  const std::size_t all = file.particles();
  const bool laid_anew = static_cast<std::int64_t>(all) != box.fluid_total;
  if (laid_anew) lay_out_file(box, x);
  const auto number = [&](std::size_t i) { return static_cast<std::size_t>(s.id[i]); };
  const auto give = [&](auto& to, const auto& values, std::size_t components, std::size_t a) {
    for (std::size_t i = 0; i < s.fluid; ++i) to[i] = values[components * number(i) + a];
  };
  for (std::size_t a = 0; a < D; ++a) give(s.x[a], x, D, a);
  detail::matter of{file.temperatures(taken.motion), {}, {}, file.materials(materials, taken.materials)};
  give(s.T, of.T, 1, 0);
  give(s.material, of.material, 1, 0);
  const bool dissolved = taken.concentration != nullptr && file.has("Concentration");
  if (dissolved) give(*taken.concentration, file.concentrations(), 1, 0);
  const start_read read{!laid_anew && file.is_of_this_program(), laid_anew, dissolved};
  const std::vector<double> reach(all, box.w.support());
  if (!taken.motion) {
    double share = 1.0;  // m^D, of a particle
    for (std::size_t a = 0; a < D; ++a) share *= box.w.d.region.length[a];
    const std::vector<double> volumes(all, share / static_cast<double>(all));
    file.check_packing(x, volumes);
    file.check_neighbours(x, volumes, reach, true);
    return read;
  }
  {
    const auto v = file.velocities();
    if (o.settles()) file.expect_at_rest(v);
    for (std::size_t a = 0; a < D; ++a) give(s.v[a], v, D, a);
  }
  of.rho = file.densities();
  of.m = file.masses();
  detail::check_matter(file, box, taken, of, x);
  std::vector<double> volumes(all);
  for (std::size_t n = 0; n < all; ++n) volumes[n] = of.m[n] / of.rho[n];
  file.check_neighbours(x, volumes, reach, true);
  give(s.rho, of.rho, 1, 0);
  give(s.m, of.m, 1, 0);
  return read;
}

// For particles that start where they now are.
template <int D>
void start_here(particles::particles<D>& s) {
  for (std::size_t a = 0; a < D; ++a) std::copy_n(s.x[a].begin(), s.fluid, s.x_start[a].begin());
}

}  // namespace tetsuame::run
