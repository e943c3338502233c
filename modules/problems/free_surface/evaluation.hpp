// The right-hand side as a list of passes:
//   1. pressure and volume of each density; those of what stands behind walls, with the weight of water up to there
//   2. the sums over neighbours (terms.hpp, riemann_terms.hpp); surface tension; free bodies
//   3. rates of x, v, ρ, of the free bodies' state, and of what is counted of forces on bodies; on a beach
//      Dv/Dt = … - γ(x) v
#pragma once

#include <free_surface/budget.hpp>

namespace tetsuame::free_surface {

namespace detail {

// What a density says, of ghosts and behind walls too.
template <int D>
void declare_state(water<D>& f, passes::evaluation<D>& e) {
  auto& s = f.world.w.s;
  e.given({s.m});
  f.sources.declare_pass(e);
  e.each("pressure", {.reads = {s.rho, s.m, s.v}, .writes = {s.p, s.dV, f.viscous_velocity}},
         [&f](std::size_t first, std::size_t last) { find_own(f, first, last); });
  const passes::fields all{s.v, s.rho, s.p, s.dV, f.viscous_velocity};
  e.walls("walls", {.at_neighbours = {all, passes::of_gravity(f.world)}, .gives = all}, [&f] { mirror(f); });
}

// What the sums leave of the surface's tension and of free bodies.
template <int D>
void declare_forces(water<D>& f, std::size_t first_of_bodies) {
  auto& e = f.rates;
  auto& s = f.world.w.s;
  const passes::fields state{s.v, s.rho, s.p, s.dV, f.viscous_velocity};
  e.sum("forces", {.at_neighbours = state, .writes = {f.force, f.density_rate, f.inward}},
        [&f](const pairs::row_range& rows) { sum_over_neighbours(f, rows); });
  if (f.has_tension())
    e.whole("tension", {.reads = {s.dV}, .writes = {f.tension}, .updates = {f.inward}}, [&f] { find_tension(f); });
  if (f.has_free_bodies)
    e.whole("bodies", {.reads = state, .updates = {f.force, f.density_rate}}, [&f, first_of_bodies] {
      f.free_loads = accelerate_free_bodies(f);
      find_rates_of_bodies(f, f.free_loads, f.rates.rates().subspan(first_of_bodies));
    });
}

template <int D>
void declare_rates(water<D>& f, std::size_t first_of_loads) {
  auto& e = f.rates;
  auto& s = f.world.w.s;
  passes::fields read{s.x, s.v, s.m, f.force, f.density_rate, f.tension, passes::of_sources(f.world)};
  if (f.has_openings) {
    e.remembered({f.zone});
    read.add({f.zone});
  }
  e.each("rates", {.reads = read, .rates = {s.x, s.rho}, .accumulates = {s.v}},
         [&f, &e, tense = f.has_tension()](std::size_t i) {
           const auto& w = f.world.w;
           const double drag = f.o.flow.on_beach(w.s.x[0][i]);
           for (std::size_t a = 0; a < D; ++a) {
             e.rate(a)[i] = w.s.v[a][i];
             double& dv = e.rate(D + a)[i];
             dv = f.force[a][i] / w.s.m[i] + w.gravity(a, i);
             if (tense) dv += f.tension[a][i] / w.s.m[i];
             if (drag > 0.0) dv -= drag * w.s.v[a][i];
             if (f.in_zone(i)) dv = 0.0;
           }
           e.rate(2 * D)[i] = f.in_zone(i) ? 0.0 : f.density_rate[i];
         });
  e.whole("rates", {.rates = {s.v}}, [&f, &e, first_of_loads] {
    hold(f, e.rates().subspan(D, D));
    if (!counted_numbers(f).empty()) find_rates_of_loads(f, e.rates().subspan(first_of_loads));
  });
  e.check(
      "rates", {s.rho, s.x, s.p}, [&f](std::size_t i) { return is_valid(f, i); },
      [&f](std::size_t i) { return fault_of(f, i); });
}

}  // namespace detail

template <int D>
void declare(water<D>& f) {
  auto& s = f.world.w.s;
  auto& e = f.rates;
  const double speed = 0.1 * f.p.water.sound;
  f.sources.declare(f.p.sources, f.world);
  e.integrate_motion({0.0, 0.0, speed});
  const std::size_t first_of_bodies = 1 + e.integrate(s.rho, {"rho", 0.0, 0.01 * f.o.flow.density});
  // Of bodies displacements, velocities, angles, spins; for those of a spacing and more.
  constexpr std::size_t angles = moving_body<D>::angles;
  for (std::size_t k = 0; !f.free.empty() && k < f.free.state.size(); ++k) {
    const bool place = k < D, velocity = k >= D && k < 2 * D, angle = k >= 2 * D && k < 2 * D + angles;
    const double scale = place ? f.dx() : velocity ? speed : angle ? 1.0 : speed / f.p.height;
    e.integrate_numbers(f.free.state[k], {fmt::format("body_{}", k), 0.0, scale});
  }
  const std::size_t first_of_loads = 2 * D + 1 + (f.free.empty() ? 0 : f.free.state.size());
  for (auto* numbers : counted_numbers(f))  // steps with error control do not go by them
    e.integrate_numbers(*numbers, {"loads", 0.0, std::numeric_limits<double>::infinity()});
  if (f.has_free_bodies) e.whole("bodies", {}, [&f] { forget_accelerations(f); });
  detail::declare_state(f, e);
  f.sources.account(e, speed * speed);
  detail::declare_forces(f, first_of_bodies);
  detail::declare_rates(f, first_of_loads);
  e.complete(passes::behind_walls::images);

  auto& present = f.present;
  present.remembered_motion();
  present.remembered({s.rho});
  detail::declare_state(f, present);
  present.whole("halo", {.at_neighbours = {s.v, s.rho, s.p, s.dV, f.viscous_velocity}}, [] {});
  present.complete(passes::behind_walls::images);
}

}  // namespace tetsuame::free_surface
