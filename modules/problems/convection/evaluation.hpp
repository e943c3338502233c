// The right-hand side as a list of passes: the viscosity where it varies, images of the state (mirror.hpp), one sum
// over neighbours (pass.hpp), rates (rates.hpp).
#pragma once

#include <convection/mirror.hpp>
#include <convection/rates.hpp>
#include <passes/evaluation.hpp>

namespace tetsuame::convection {

// pass.hpp; of each law compiled by itself (programs/convection).
template <int D, int K, bool graded>
void sum_over_neighbours(convection_state<D>& state, const pairs::row_range& rows, bool whole);

// whole(): whether the next evaluation keeps what later ones may lag behind.
template <int D>
void declare(convection_state<D>& state, passes::evaluation<D>& e, std::function<bool()> whole) {
  auto& s = state.fluid();
  const auto& layer = state.layer;
  const auto& f = layer.fluid;
  const double speed = layer.slowing.speed;
  state.sources.declare(layer.sources, state.world, e);
  if (keeps_rate(state.input)) e.keep_rates(passes::evaluation<D>::kept::all);
  const auto integrate = [&](particles::array& field, const std::string& name, double scale) {
    e.integrate(field, {.name = name, .scale = scale});
  };
  constexpr std::array<const char*, 3> axis{"x", "y", "z"};
  for (std::size_t a = 0; a < D; ++a) integrate(s.x[a], axis[a], state.world.w.dx);
  for (std::size_t a = 0; a < D; ++a) integrate(s.v[a], std::string("v") + axis[a], speed);
  integrate(s.T, "T", f.dT);
  integrate(state.p, "p", f.rho * f.alpha * f.dT * f.g * f.L);
  for (std::size_t a = 0; a < D && layer.relaxed; ++a) integrate(state.z[a], std::string("z") + axis[a], speed);
  e.moves();
  passes::fields unknowns{s.v, s.T, state.p}, viscosity, rates{s.x, s.v, s.T, state.p}, found;
  if (layer.relaxed) unknowns.add({state.z}), rates.add({state.z});
  for (auto* lagged : state.lagged.all) e.given({*lagged});
  for (auto* latest : state.last.latest.all) found.add({*latest});
  found.add({state.last.laplacian, state.last.hyperdiffusion, state.last.uneven, state.last.W});
  if (layer.law.varies) {
    viscosity = {*state.viscosity_root, *state.own_viscosity};
    found.add({state.last.viscous, state.last.plain_viscous, state.last.log_slope, state.last.contrast});
    e.each("viscosity", {.reads = {s.x, s.T}, .writes = viscosity},
           [&state, &s](std::size_t i) { set_viscosity(state, i, s.x[1][i]); });
  }
  passes::access images{.at_neighbours = {unknowns, viscosity}, .gives = {unknowns, viscosity}};
  e.walls("walls", images, [&state] { mirror_state(state); });
  e.sum("sums", {.at_neighbours = {unknowns, viscosity}, .writes = found},
        [&state, whole = std::move(whole)](const pairs::row_range& rows) {
          if (state.layer.law.varies)
            sum_over_neighbours<D, unknown<D>::count, true>(state, rows, whole());
          else if (state.layer.relaxed)
            sum_over_neighbours<D, unknown<D>::count_with_z, false>(state, rows, whole());
          else
            sum_over_neighbours<D, unknown<D>::count, false>(state, rows, whole());
        });
  e.whole("rates", {.reads = {found, unknowns, passes::of_sources(state.world)}, .rates = rates},
          [&state, &e] { rates_of_change(state, e.rates()); });
  e.complete(passes::behind_walls::images);
}

}  // namespace tetsuame::convection
