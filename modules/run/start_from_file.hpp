// A box whose particles are those of a snapshot, in the place of its start lattice.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <eos/eos.hpp>
#include <functional>
#include <limits>
#include <run/lists.hpp>
#include <run/start_file.hpp>

namespace tetsuame::run {

// What of the particles is taken from the file beside their places and temperature, and what they are held against.
struct taken_from_file {
  bool motion = true;                           // velocity, density, mass
  std::int32_t materials = 1;                   // how many there are
  std::array<double, 2> pressures{};            // Pa, the lowest and the highest of the box at rest
  std::function<double(std::size_t)> volume{};  // m^D, of a particle of that material on the start lattice
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
  for (std::int32_t n = 0; n < taken.materials; ++n) {
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

template <int D>
start_box box_of(const state<D>& box) {
  start_box b{D, {}, {}, box.w.dx, box.fluid_total};
  std::copy_n(box.w.d.region.length.begin(), D, b.length.begin());
  std::copy_n(box.w.d.region.periodic.begin(), D, b.periodic.begin());
  return b;
}

}  // namespace detail

// Gives the fluid of this rank, laid out on the start lattice, what the snapshot says of the particles of the same
// numbers. Where they lie, and so which rank is theirs, is another matter: that is for the first lists. A lattice,
// pressures and whatever else is of the exact start stays with the problem. Returns whether the file is of this
// program: IDs are then those of the lattice, or else just numbers.
template <int D>
bool start_from_file(const start_options& o, const taken_from_file& taken, state<D>& box) {
  auto& s = box.w.s;
  std::vector<std::string> fields{"Coordinates", "Temperature"};
  if (taken.motion) fields.insert(fields.end(), {"Velocities", "Density", "Masses"});
  if (taken.materials > 1) fields.emplace_back("Material");
  const start_file file(o, detail::box_of(box), fields);
  const auto x = file.places();
  const auto number = [&](std::size_t i) { return static_cast<std::size_t>(s.id[i]); };
  const auto give = [&](auto& to, const auto& values, std::size_t components, std::size_t a) {
    for (std::size_t i = 0; i < s.fluid; ++i) to[i] = values[components * number(i) + a];
  };
  for (std::size_t a = 0; a < D; ++a) give(s.x[a], x, D, a);
  detail::matter of{file.temperatures(taken.motion), {}, {}, file.materials(taken.materials)};
  give(s.T, of.T, 1, 0);
  give(s.material, of.material, 1, 0);
  if (!taken.motion) {
    file.check_packing(x, std::vector<double>(x.size() / D, std::pow(box.w.dx, D)));
    return file.is_of_this_program();
  }
  {
    const auto v = file.velocities();
    for (std::size_t a = 0; a < D; ++a) give(s.v[a], v, D, a);
  }
  of.rho = file.densities();
  of.m = file.masses();
  detail::check_matter(file, box, taken, of, x);
  give(s.rho, of.rho, 1, 0);
  give(s.m, of.m, 1, 0);
  return file.is_of_this_program();
}

// For particles that start where they now are.
template <int D>
void start_here(particles::particles<D>& s) {
  for (std::size_t a = 0; a < D; ++a) std::copy_n(s.x[a].begin(), s.fluid, s.x_start[a].begin());
}

}  // namespace tetsuame::run
