// Continuity beside walls of no slip. What stands behind such a wall has the velocity 2 u_wall - v, which friction
// needs; its place, however, moves along the wall with the fluid's image: v_t, -v_n. The sum of continuity with the
// former
//   D ln ρ_i/Dt = Σ_j ΔV_j v_ij·∇_i W_ij
// is not the rate at which the number density changes: beneath a plume that spreads along a floor ρ grows without end.
// Added here is what the other velocity makes of the sum. The same choice, walls' own velocity in the continuity
// equation and an extrapolated one in friction: Adami et al., J. Comput. Phys. 231, 7057 (2012), section 2.
#pragma once

#include <gradient/continuity.hpp>
#include <walls/images.hpp>

namespace tetsuame::walls {

// The owned fluid that has particles behind a wall of no slip for neighbours while lists live. moved: m, until then.
template <int D>
void choose_near_no_slip(const pairs::workspace<D>& w, wall_set<D>& set, double moved) {
  const auto& s = w.s;
  const double reach = w.support() + moved;
  auto near = foundation::indices_where<std::size_t>(s.fluid, [&](std::size_t i) {
    return std::ranges::any_of(
        set.sides, [&](const side<D>& wall) { return wall.no_slip && wall.distance(s.x[wall.axis][i]) < reach; });
  });
  set.near_no_slip = pairs::choose(w.list, std::move(near), s.total());
}

// m/s, of what stands behind walls: the velocity of its place less that of no slip.
template <int D>
void fill_slip(const pairs::workspace<D>& w, const wall_set<D>& set, const auto& slip) {
  const auto& s = w.s;
  foundation::for_all(set.mirrored.size(), [&](std::size_t r) {
    const std::size_t i = s.first_wall() + set.body_particles + r;
    std::array<double, D> v;
    for (std::size_t a = 0; a < D; ++a) v[a] = s.v[a][i];
    for (std::size_t k = set.sides.size(); k-- > 0;)  // back to the fluid's own
      if ((set.mirrored[r] >> k & 1U) != 0) reflect_velocity<D>(set.sides[k], true, v);
    for (std::size_t k = 0; k < set.sides.size(); ++k)
      if ((set.mirrored[r] >> k & 1U) != 0) reflect_velocity<D>(set.sides[k], false, v);
    for (std::size_t a = 0; a < D; ++a) slip[a][i] = v[a] - s.v[a][i];
  });
}

// Adds to dlnrho of the rows near walls of no slip. slip: as above, zero of the fluid and its ghosts. Continuity: the
// form that it corrects.
template <int D, class Continuity>
struct continuity_of_slip : Continuity {
  void end(const auto& i, const auto& a) const {
    if constexpr (std::is_same_v<Continuity, gradient::own_continuity<D>>)
      i.add(this->dlnrho, i(this->dV, D) * a.sum, -1);
    else
      i.add(this->dlnrho, a.sum, -1);
  }
};

// The same for all of them. slip: m/s, zero of the fluid and its ghosts; dV: m^D; dlnrho: 1/s, added to. Collective.
template <int D, class Continuity>
void add_continuity_of_slip(const pairs::workspace<D>& w, const wall_set<D>& set, particles::vector_field<D>& slip,
                            const particles::array& dV, particles::array& dlnrho) {
  fill_slip(w, set, slip);
  w.exchange_walls(slip, {});
  continuity_of_slip<D, Continuity> sum;
  sum.v = slip.read(), sum.dV = dV.data(), sum.dlnrho = dlnrho.data();
  w.sum(set.near_no_slip, sum);
}

}  // namespace tetsuame::walls
