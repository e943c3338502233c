// The start: lattice, exact profile, walls.
#pragma once

#include <hydrostatic/profile.hpp>
#include <regions/apply.hpp>
#include <run/lists.hpp>
#include <run/start.hpp>
#include <run/start_from_file.hpp>
#include <walls/images.hpp>

namespace tetsuame::hydrostatic {

template <int D>
struct scene : run::state<D> {
  std::array<std::int64_t, D> lattice{};   // particles along each axis at the start, numbered by ID along the first one
  std::vector<double> p_exact, rho_exact;  // Pa, kg/m3, of the exact solution, by row along y
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

// The row of the lattice in which fluid particle i started: by its ID, or by the place that a snapshot gave it.
template <int D>
std::size_t row_of(const scene<D>& scene, std::size_t i) {
  const auto& s = scene.w.s;
  if (!s.keeps_start) return start_place(scene, s.id[i])[1];
  const auto last = static_cast<double>(scene.lattice[1] - 1);
  return static_cast<std::size_t>(std::clamp(std::floor(s.x_start[1][i] / scene.w.dx), 0.0, last));
}

// m, how far fluid particle i is from its start. Over a periodic border the nearest image counts.
template <int D>
std::array<double, D> displacement(const scene<D>& scene, std::size_t i) {
  const auto& s = scene.w.s;
  const auto& box = scene.w.d.region;
  const auto place = start_place(scene, s.id[i]);
  std::array<double, D> d;
  for (std::size_t a = 0; a < D; ++a) {
    const double start = s.keeps_start ? s.x_start[a][i] : (static_cast<double>(place[a]) + 0.5) * scene.w.dx;
    d[a] = s.x[a][i] - start;
    if (box.periodic[a]) d[a] -= box.length[a] * std::round(d[a] / box.length[a]);
  }
  return d;
}

// Temperatures and velocities of &region. What is warmer is lighter: densities are those at the pressure of the
// profile.
template <int D>
void change_regions(const options& o, scene<D>& scene) {
  auto& w = scene.w;
  auto& s = w.s;
  if (!o.regions.any()) return;
  regions::apply(w.d.ranks, o.regions, s, [&](std::size_t i, const regions::values& v) {
    for (std::size_t a = 0; a < D; ++a) s.v[a][i] = v.velocity[a].value_or(s.v[a][i]);
    if (!v.temperature) return;
    s.T[i] = *v.temperature;
    s.rho[i] = eos::density(w.materials[0], scene.p_exact[start_place(scene, s.id[i])[1]], s.T[i]);
    s.m[i] = s.rho[i] * std::pow(w.dx, D);
  });
}

// The fluid, which stands on the start lattice: masses m = ρ Δx^D of the exact profile at its rows, so that jitter
// changes neither; or as a snapshot has it.
template <int D>
void fill_fluid(const options& o, scene<D>& scene) {
  auto& w = scene.w;
  auto& s = w.s;
  const profile exact(o, w.materials[0]);
  for (std::size_t a = 0; a < D; ++a) scene.lattice[a] = o.domain.particles[a];
  scene.p_exact.clear();
  scene.rho_exact.clear();
  for (std::int64_t row = 0; row < scene.lattice[1]; ++row) {
    scene.p_exact.push_back(exact.pressure((static_cast<double>(row) + 0.5) * w.dx));
    scene.rho_exact.push_back(exact.density(scene.p_exact.back()));
  }
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const auto row = start_place(scene, s.id[i])[1];
    s.rho[i] = scene.rho_exact[row];
    s.T[i] = o.initial.temperature;
    s.m[i] = s.rho[i] * std::pow(w.dx, D);
    s.Y[i] = scene.p_exact[row] * s.m[i] / s.rho[i];
    s.u[i] = 0.0;
    s.eta[i] = o.material.viscosity;
    s.k[i] = o.material.conductivity;
  }
  change_regions(o, scene);
  if (!o.start.is_read()) return;
  const auto [low, high] = std::minmax_element(scene.p_exact.begin(), scene.p_exact.end());
  run::start_from_file(o.start, {.pressures = {*low, *high}, .volume = [&](std::size_t) { return std::pow(w.dx, D); }},
                       scene);
  run::start_here(s);
  for (std::size_t i = 0; i < s.fluid; ++i) {
    s.Y[i] = eos::pressure(w.materials[0], s.rho[i], s.T[i]) * s.m[i] / s.rho[i];
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

// Lists and what stays while they hold: transport coefficients of ghosts and images.
template <int D>
void rebuild(scene<D>& scene, bool as_they_were = false) {
  auto& s = scene.w.s;
  run::rebuild(scene, as_they_were);
  walls::update_ghosts_and_images(scene.w, scene.walls, walls::even({&s.eta, &s.k}));
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
  w.s.keeps_start = !o.start.file.empty() || o.start.settles();
  run::set_up<D>(scene, ranks, o.domain, o.walls, o.kernel, o.halo());
  w.materials = {eos::make(o.material.eos)};
  w.g[1] = -o.g;
  if (o.material.conductivity == 0.0) w.uniform_transport = o.material.viscosity;
  scene.treatment = walls::make(o.walls.treatment);
  scene.walls.how = o.walls;
  fill_fluid(o, scene);
  place_walls(o, scene);
  if (std::holds_alternative<walls::virtual_marker>(scene.treatment) || scene.mirrors())
    scene.walls.force = walls::make_boundary_force(w.dx, fastest_sound(o, scene));
}

}  // namespace tetsuame::hydrostatic
