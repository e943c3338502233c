// What stands behind walls where bodies stand in the box: of each wall particle the fluid at its marker, as it goes on
// there (docs/theory/bodies_in_layers.md), and of everything its mirror images in the sides.
#pragma once

#include <two_fluids/fluids.hpp>

namespace tetsuame::two_fluids {

// How fields go on behind the sides. Of no slip, where the side has it.
template <int D>
walls::mirrored_fields rules_at_sides(fluids<D>& f) {
  auto& s = f.world.w.s;
  auto all = walls::velocity(s.v);
  for (auto* p : {&s.p_eos, &s.p})
    for (const auto& rule : walls::hydrostatic(*p, s.rho, f.world.w)) all.push_back(rule);
  return all;
}

// The images of the fluid, what fill_bodies() leaves in wall particles of bodies, and the images of these; rules: of
// the fields that it is about.
template <int D, class Fill>
void fill_behind_walls(const fluids<D>& f, const walls::mirrored_fields& rules, const Fill& fill_bodies) {
  const auto& walls = f.world.walls;
  const auto& w = f.world.w;
  walls::fill_image_range(walls, w.s, 0, walls.images_of_fluid, rules);
  fill_bodies();
  std::vector<double*> arrays;
  for (const auto& rule : rules) arrays.push_back(rule.values->data());
  domain::exchange<D>(w.d.ranks, w.d.wall_halo, std::span<double* const>(arrays));
  walls::fill_image_range(walls, w.s, walls.images_of_fluid, walls.source.size(), rules);
}

// The pressure p (Pa) of the fluid j, at rest from there on to the wall particle i.
template <int D>
double carried_to(const fluids<D>& f, const particles::array& p, std::size_t j, std::size_t i) {
  const auto& s = f.world.w.s;
  const double at_rest = p[j] + s.rho[j] * f.o.gravity * (s.x[1][j] - s.x[1][i]);
  return f.world.w.gravity_varies ? at_rest + s.rho[j] * f.world.w.forced(j, i) : at_rest;
}

// The velocity is odd about the surface, or along it even where it lets slip; pressure holds fluid at rest; density,
// volume, viscosity and temperature are those at the marker. The fluid fills all that bodies leave: a wall particle has
// its whole volume.
template <int D>
void stand_behind_walls(fluids<D>& f) {
  auto& s = f.world.w.s;
  const auto& set = f.world.walls;
  f.sources.write_behind_walls();
  auto rules = walls::velocity(s.v);
  for (const auto& rule : walls::hydrostatic(s.p_eos, s.rho, f.world.w)) rules.push_back(rule);
  for (const auto& rule : walls::even({&s.rho, &s.dV, &s.eta, &s.T})) rules.push_back(rule);
  fill_behind_walls(f, rules, [&] {
    const auto fluid_at = [&](std::size_t j, std::size_t i) {
      std::array<double, D + 5> values;
      for (std::size_t a = 0; a < D; ++a) values[a] = s.v[a][j];
      values[D] = carried_to(f, s.p_eos, j, i);
      values[D + 1] = s.rho[j];
      values[D + 2] = s.dV[j];
      values[D + 3] = s.eta[j];
      values[D + 4] = s.T[j];
      return values;
    };
    walls::at_bodies<D + 5, D>(f.world.w, set, fluid_at, [&](std::size_t i, const auto& of, double, const auto& mean) {
      std::array<double, D> v;
      std::copy_n(mean.begin(), D, v.begin());
      v = walls::reflected_velocity<D>(of, v, set.bodies.no_slip);
      for (std::size_t a = 0; a < D; ++a) s.v[a][i] = v[a];
      s.p_eos[i] = mean[D];
      s.rho[i] = mean[D + 1];
      s.dV[i] = mean[D + 2];
      s.eta[i] = mean[D + 3];
      s.T[i] = mean[D + 4];
    });
  });
}

// And of a smoothed pressure.
template <int D>
void smooth_behind_walls(fluids<D>& f) {
  auto& s = f.world.w.s;
  fill_behind_walls(f, walls::hydrostatic(s.p, s.rho, f.world.w), [&] {
    walls::at_bodies<1, 0>(
        f.world.w, f.world.walls, [&](std::size_t j, std::size_t i) { return std::array{carried_to(f, s.p, j, i)}; },
        [&](std::size_t i, const auto&, double, const auto& mean) { s.p[i] = mean[0]; });
  });
}

// Nothing is dissolved in bodies, and nothing goes there: their mobility is 0.
template <int D>
void dissolve_nothing_in_bodies(fluids<D>& f) {
  const auto& s = f.world.w.s;
  fill_behind_walls(f, walls::even({&f.element, &f.mobility, &f.metal, &f.partition}), [&] {
    for (std::size_t i = s.first_wall(); i < s.first_wall() + s.walls; ++i) {
      f.element[i] = f.mobility[i] = f.metal[i] = 0.0;
      f.partition[i] = 1.0;
    }
  });
}

}  // namespace tetsuame::two_fluids
