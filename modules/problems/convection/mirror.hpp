// What images hold: the state before each evaluation, what lags behind, of ghosts too, when that moves on.
//
// Walls are mirror images (walls/mirror.hpp). p is even but for the step that the momentum balance asks for,
//   p_g = p_s - 2 d ∂p/∂n,  ∂p/∂n = ρ₀ (ν ∇²u_n [no slip] + [(∇v + ∇vᵀ - ∇·v)·∇ν]_n + b n_y + K_n)
// and of z they ask what they ask of v.
#pragma once

#include <convection/state.hpp>

namespace tetsuame::convection {

template <int D>
void set_viscosity(convection_state<D>& state, std::size_t i, double y) {
  const double nu = viscosity(state.layer, y, state.fluid().T[i]);
  (*state.own_viscosity)[i] = nu;
  (*state.viscosity_root)[i] = std::sqrt(nu);
}

// The values of a source on their way through the walls to its image: the unknowns, their gradients, and plain
// Laplacians, of which walls ask for those of velocities.
template <int D>
struct reflected {
  static constexpr std::size_t K = unknown<D>::count_with_z;
  double y;
  std::array<double, K> f, curvature;
  std::array<std::array<double, D>, K> gradient;
};

// Pa/m, of the pressure at the wall, inwards; y, T: behind it.
template <int D>
double pressure_slope(const convection_state<D>& state, const walls::side<D>& wall, std::size_t source,
                      const reflected<D>& inside, double y, double T) {
  const auto& layer = state.layer;
  const double rho = layer.fluid.rho, T_inside = inside.f[unknown<D>::T], p_inside = inside.f[unknown<D>::p];
  double slope = 0.0;
  if (layer.law.varies)  // normal stress goes on smoothly
    slope += rho * viscosity(layer, inside.y, T_inside) * state.lagged.stress[wall.axis][source] * wall.inward;
  if (wall.no_slip) {
    const std::size_t flow = layer.relaxed ? unknown<D>::z : 0;
    slope += rho * viscosity(layer, inside.y, T_inside) * inside.curvature[flow + wall.axis] * wall.inward;
  }
  if (wall.axis == 1)
    slope +=
        0.5 * rho * wall.inward * (buoyancy(layer, inside.y, T_inside, p_inside) + buoyancy(layer, y, T, p_inside));
  if (state.sources.force()) {
    std::array<double, 3> at_wall{};
    for (std::size_t a = 0; a < D; ++a) at_wall[a] = state.fluid().x[a][source];
    at_wall[wall.axis] = wall.position;
    slope += rho * wall.inward * state.sources.force_at(wall.axis, at_wall, 0.5 * (T_inside + T));
  }
  return slope;
}

// d: m, of the source from the wall; first: place of the velocity, v or z, among the unknowns. Slopes along the wall's
// axis have changed their signs.
template <int D>
void reflect_velocity(const walls::side<D>& wall, double d, std::size_t first, reflected<D>& at) {
  const std::size_t across = first + wall.axis;
  if (!wall.no_slip) {
    at.f[across] = -at.f[across];
    at.curvature[across] = -at.curvature[across];
    for (double& g : at.gradient[across]) g = -g;
    return;
  }
  for (std::size_t a = 0; a < D; ++a) {
    const double curvature = at.curvature[first + a];
    at.f[first + a] = 2.0 * wall.velocity[a] - at.f[first + a] + d * d * curvature;
    for (double& g : at.gradient[first + a]) g = -g;
    at.gradient[first + a][wall.axis] -= 2.0 * d * wall.inward * curvature;
  }
}

template <int D>
void reflect(const convection_state<D>& state, const walls::side<D>& wall, std::size_t source, reflected<D>& at) {
  constexpr std::size_t T = unknown<D>::T, p = unknown<D>::p;
  const double d = wall.distance(state.fluid().x[wall.axis][source]), conductivity = state.layer.conductivity;
  const reflected<D> inside = at;
  if (wall.axis == 1) at.y = 2.0 * wall.position - at.y;
  for (auto& of_unknown : at.gradient) of_unknown[wall.axis] = -of_unknown[wall.axis];
  if (wall.thermal == walls::heat::fixed_temperature) {
    at.f[T] = 2.0 * wall.temperature - at.f[T];
    for (double& g : at.gradient[T]) g = -g;
  } else {
    at.f[T] += 2.0 * d * wall.flux / conductivity;
    at.gradient[T][wall.axis] -= 2.0 * wall.flux / conductivity * wall.inward;
  }
  const double slope = pressure_slope(state, wall, source, inside, at.y, at.f[T]);
  at.f[p] -= 2.0 * d * slope;
  at.gradient[p][wall.axis] += 2.0 * slope * wall.inward;
  reflect_velocity(wall, d, 0, at);
  if (state.layer.relaxed) reflect_velocity(wall, d, unknown<D>::z, at);
}

// The image r: of the unknowns f, and the gradients that the noise is taken with.
template <int D>
void mirror_state(convection_state<D>& state, const std::vector<double*>& f, std::size_t r) {
  const auto& s = state.fluid();
  const std::size_t i = s.first_wall() + r, j = state.world.walls.source[r];
  auto& lagged = state.lagged;
  reflected<D> at{};
  at.y = s.x[1][j];
  for (std::size_t k = 0; k < f.size(); ++k) {
    at.f[k] = f[k][j], at.curvature[k] = (*lagged.laplacian[k])[j];
    for (std::size_t a = 0; a < D; ++a) at.gradient[k][a] = lagged.gradient[k][a][j];
  }
  walls::for_each_mirror(state.world.walls, r, [&](const walls::side<D>& wall) { reflect(state, wall, j, at); });
  for (std::size_t k = 0; k < f.size(); ++k) {
    f[k][i] = at.f[k];
    for (std::size_t a = 0; a < D; ++a) lagged.gradient[k][a][i] = at.gradient[k][a];
  }
  if (!state.layer.law.varies) return;
  set_viscosity(state, i, at.y);
  (*state.own_viscosity)[i] = (*state.own_viscosity)[j];
}

// Of all images.
template <int D>
void mirror_state(convection_state<D>& state) {
  const auto f = unknown_arrays(state);
  foundation::for_all(state.world.walls.source.size(), [&](std::size_t r) { mirror_state(state, f, r); });
}

// The viscous force along a wall is even. Across one that lets slip it goes on smoothly through its value there, ν
// ∇ln ν times the rate of strain; where there is no slip it is taken as even.
template <int D>
void mirror_viscous_terms(convection_state<D>& state, std::size_t r) {
  auto& lagged = state.lagged;
  const std::size_t i = state.fluid().first_wall() + r, j = state.world.walls.source[r];
  const double nu = (*lagged.viscosity)[j];
  for (std::size_t a = 0; a < D; ++a) lagged.force[a][i] = lagged.force[a][j];
  for (std::size_t k = 0; k < angular_terms; ++k) lagged.angles[k][i] = lagged.angles[k][j];
  walls::for_each_mirror(state.world.walls, r, [&](const walls::side<D>& wall) {
    if (!wall.no_slip) {
      double& across = lagged.force[wall.axis][i];
      across = 2.0 * nu * lagged.stress[wall.axis][j] - across;
    }
    for (const std::size_t sine : {1, 3}) lagged.angles[sine][i] = -lagged.angles[sine][i];
  });
}

// Ghosts and images of what lags behind. Plain Laplacians are odd where their field is, but for a velocity that does
// not slip, whose curvature goes on smoothly; gradients of images belong to the state (mirror_state).
template <int D>
void refresh_lagged_terms(convection_state<D>& state) {
  auto& w = state.world.w;
  auto& s = w.s;
  auto& lagged = state.lagged;
  const foundation::stage timed(w.times, "halo");
  std::vector<double*> fields;
  for (auto* a : lagged.of_neighbours) fields.push_back(a->data());
  domain::exchange<D>(w.d.ranks, w.d.fluid_halo, std::span<double* const>(fields));
  foundation::for_all(state.world.walls.source.size(), [&](std::size_t r) {
    const std::size_t i = s.first_wall() + r, j = state.world.walls.source[r];
    std::array<double, unknown<D>::count_with_z> sign;
    sign.fill(1.0);
    walls::for_each_mirror(state.world.walls, r, [&](const walls::side<D>& wall) {
      if (!wall.no_slip)
        for (const std::size_t first : {std::size_t{0}, unknown<D>::z})
          sign[first + wall.axis] = -sign[first + wall.axis];
      if (wall.thermal == walls::heat::fixed_temperature) sign[unknown<D>::T] = -sign[unknown<D>::T];
    });
    for (std::size_t k = 0; k < state.unknowns(); ++k) (*lagged.laplacian[k])[i] = sign[k] * (*lagged.laplacian[k])[j];
    if (lagged.viscosity != nullptr) mirror_viscous_terms(state, r);
  });
}

}  // namespace tetsuame::convection
