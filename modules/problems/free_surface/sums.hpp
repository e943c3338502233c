// What an evaluation of the water consists of (evaluation.hpp): pressures, what stands behind walls, the sums over
// neighbours, and what makes a state none. What the water does to bodies: loads.hpp; free bodies: free_bodies.hpp.
#pragma once

#include <fmt/format.h>

#include <free_surface/behind_bodies.hpp>
#include <free_surface/riemann_terms.hpp>
#include <free_surface/terms.hpp>
#include <volume/shape.hpp>
#include <walls/images.hpp>

namespace tetsuame::free_surface {

// Images [first, last): their water has its source's density, and a pressure that holds still water.
template <int D>
void fill_images(water<D>& f, std::size_t first, std::size_t last) {
  auto& s = f.world.w.s;
  const auto& walls = f.world.walls;
  walls::fill_image_range(walls, s, first, last, walls::velocity(s.v, false));
  walls::fill_image_range(walls, s, first, last, walls::even({&s.rho, &s.dV}));
  walls::fill_image_range(walls, s, first, last, walls::hydrostatic(s.p, s.rho, f.world.w));
  if (f.two_velocities) walls::fill_image_range(walls, s, first, last, walls::velocity(f.viscous_velocity));
}

// All that stands behind walls.
template <int D>
void mirror(water<D>& f) {
  move_walls(f);
  const auto& walls = f.world.walls;
  walls::move_images(walls, f.world.w.s);
  fill_images(f, 0, walls.images_of_fluid);
  if (!walls.bodies.any()) return;
  f.sources.write_behind_walls();
  fill_bodies(f);
  fill_images(f, walls.images_of_fluid, walls.source.size());
}

// Of particles [first, last) that are no images: what follows from their own state.
template <int D>
void find_own(water<D>& f, std::size_t first, std::size_t last) {
  auto& s = f.world.w.s;
  find_pressures(f.p.water, first, last, s.rho.data(), s.m.data(), s.p.data(), s.dV.data());
  if (f.two_velocities)
    for (std::size_t a = 0; a < D; ++a)
      std::copy(s.v[a].begin() + static_cast<std::ptrdiff_t>(first), s.v[a].begin() + static_cast<std::ptrdiff_t>(last),
                f.viscous_velocity[a].begin() + static_cast<std::ptrdiff_t>(first));
}

// Clusters of the fluid with a member of which this is true; or, with neighbours, which may have a neighbour of which
// it is.
template <int D, class Is>
pairs::remainder clusters_where(const pairs::workspace<D>& w, bool with_neighbours, const Is& is) {
  pairs::remainder near;
  near.of = w.fluid();
  std::vector<char> is_near(near.of.clusters(), 0);
  foundation::for_all(is_near.size(), [&](std::size_t r) {
    const auto m = near.of.cluster(r);
    bool found = false;
    for (std::size_t i = m.first; i < std::min(m.first + pairs::lanes, w.s.fluid); ++i) found = found || is(i);
    if (with_neighbours && !found)
      w.list.for_each(m.first / pairs::lanes, [&](std::uint32_t j, auto...) { found = found || is(j); });
    is_near[r] = found ? 1 : 0;
  });
  for (std::size_t r = 0; r < is_near.size(); ++r)
    if (is_near[r] != 0) near.of_rows.push_back(near.of.cluster(r));
  return near;
}

// Of these terms; with surface tension also where the surface is, in the same pass. What a gauge asks for has no need
// of that.
template <int D, class Rows, class Term>
void sum_motion(water<D>& f, const Rows& rows, const Term& term) {
  auto& w = f.world.w;
  if constexpr (std::is_same_v<Rows, pairs::row_range>)
    if (f.has_tension()) return w.sum(rows, term, inward<D>{w.s.dV.data(), f.inward.data()});
  w.sum(rows, term);
}

template <bool two_velocities, int D, class Rows>
void sum_over_neighbours_of(water<D>& f, const Rows& rows) {
  auto& w = f.world.w;
  auto& s = w.s;
  sums_of_water<D, two_velocities> all{pairs::pointers<D>(s.v),
                                       f.viscous_velocity.read(),
                                       s.p.data(),
                                       s.dV.data(),
                                       s.rho.data(),
                                       f.o.flow.density * f.p.kinematic_viscosity,
                                       f.gravity(),
                                       f.force.data(),
                                       f.density_rate.data()};
  const double c = f.p.water.sound;
  if (f.p.by == scheme::riemann)
    sum_motion(f, rows, riemann_motion<D, two_velocities>{all, c});
  else
    sum_motion(f, rows, motion<D, two_velocities>{all, f.o.flow.delta * f.p.smoothing_length / c, slow * c});
}

template <int D, class Rows>
void sum_over_neighbours(water<D>& f, const Rows& rows) {
  const foundation::stage timed(f.world.w.times, "forces");
  f.two_velocities ? sum_over_neighbours_of<true>(f, rows) : sum_over_neighbours_of<false>(f, rows);
}

// Water that rises above an open top stays between the sides, which have no end, and falls back. What goes farther than
// this comes of a flow that has blown up.
inline constexpr double farthest_above = 10.0;  // of the box's height

// Where bodies move; by then the pressure is about three quarters of ρ c².
inline constexpr double most_compressed = 1.3;

template <int D>
bool is_valid(const water<D>& f, std::size_t i) {
  const auto& s = f.world.w.s;
  if (!f.moving.empty() && s.rho[i] > most_compressed * f.o.flow.density) return false;
  return s.rho[i] > 0.0 && s.x[1][i] < (1.0 + farthest_above) * f.o.domain.length[1];
}

// Who may have pressed a particle: the nearest body that moves.
template <int D>
std::string moved_by(const water<D>& f, std::size_t i) {
  const auto x = of_solids<D>(f.place(i));
  const auto& bodies = f.p.template bodies_in<D>();
  const auto distance = [&](const moving_body<D>& b) { return distance_from(f, b, x); };
  const auto nearest = std::ranges::min_element(f.moving, {}, distance);
  if (nearest == f.moving.end()) return "";
  return fmt::format(
      "; body '{}', {:.3g} m away, moves at {:.3g} m/s: there may be nowhere that the water could give way",
      bodies[nearest->body].name(), distance(*nearest), bodies_speed(f));
}

template <int D>
std::string fault_of(const water<D>& f, std::size_t i) {
  const auto& s = f.world.w.s;
  const bool pressed = !f.moving.empty() && s.rho[i] > most_compressed * f.o.flow.density;
  const char* what = !(s.rho[i] > 0.0) ? "the density is not above 0"
                     : pressed         ? "the water is compressed by more than three tenths"
                                       : "it is more than ten heights of the box above its top";
  return fmt::format("{} (rho = {:.6g} kg/m3, p = {:.6g} Pa; the flow has blown up, or the step is too large{})", what,
                     s.rho[i], s.p[i], moved_by(f, i));
}

}  // namespace tetsuame::free_surface
