// What ghosts and images hold: the state before each evaluation, what lags behind when that moves on.
//
// Walls are mirror images (walls/mirror.hpp). p is even but for the step that the momentum balance asks for,
//   p_g = p_s - 2 d ∂p/∂n,  ∂p/∂n = ρ₀ (ν ∇²u_n [no slip] + [(∇v + ∇vᵀ - ∇·v)·∇ν]_n + b n_y)
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

// The values of a source on their way through the walls to its image.
template <int D>
struct reflected {
  using vector = std::array<double, D>;
  struct velocity {
    vector u, curvature;
    std::array<vector, D> gradient;
  };
  double y, T, p;
  vector gradient_T, gradient_p;
  velocity v, z;  // z: where the viscous response is relaxed
};

// Pa/m, of the pressure at the wall, inwards; y, T: behind it.
template <int D>
double pressure_slope(const convection_state<D>& state, const walls::side<D>& wall, std::size_t source,
                      const reflected<D>& inside, double y, double T) {
  const auto& layer = state.layer;
  const double rho = layer.fluid.rho;
  double slope = 0.0;
  if (layer.law.varies)  // normal stress goes on smoothly
    slope += rho * viscosity(layer, inside.y, inside.T) * state.lagged.stress[wall.axis][source] * wall.inward;
  if (wall.no_slip) {
    const auto& flow = layer.relaxed ? inside.z : inside.v;
    slope += rho * viscosity(layer, inside.y, inside.T) * flow.curvature[wall.axis] * wall.inward;
  }
  if (wall.axis == 1)
    slope +=
        0.5 * rho * wall.inward * (buoyancy(layer, inside.y, inside.T, inside.p) + buoyancy(layer, y, T, inside.p));
  return slope;
}

// d: m, of the source from the wall.
template <int D>
void reflect_velocity(const walls::side<D>& wall, double d, typename reflected<D>::velocity& flow) {
  for (auto& of_component : flow.gradient) of_component[wall.axis] = -of_component[wall.axis];
  if (!wall.no_slip) {
    flow.u[wall.axis] = -flow.u[wall.axis];
    flow.curvature[wall.axis] = -flow.curvature[wall.axis];
    for (double& g : flow.gradient[wall.axis]) g = -g;
    return;
  }
  for (std::size_t a = 0; a < D; ++a) {
    flow.u[a] = 2.0 * wall.velocity[a] - flow.u[a] + d * d * flow.curvature[a];
    for (double& g : flow.gradient[a]) g = -g;
    flow.gradient[a][wall.axis] -= 2.0 * d * wall.inward * flow.curvature[a];
  }
}

template <int D>
void reflect(const convection_state<D>& state, const walls::side<D>& wall, std::size_t source, reflected<D>& at) {
  const double d = wall.distance(state.fluid().x[wall.axis][source]), conductivity = state.layer.conductivity;
  const reflected<D> inside = at;
  if (wall.axis == 1) at.y = 2.0 * wall.position - at.y;
  at.gradient_T[wall.axis] = -at.gradient_T[wall.axis];
  at.gradient_p[wall.axis] = -at.gradient_p[wall.axis];
  if (wall.thermal == walls::heat::fixed_temperature) {
    at.T = 2.0 * wall.temperature - at.T;
    for (double& g : at.gradient_T) g = -g;
  } else {
    at.T += 2.0 * d * wall.flux / conductivity;
    at.gradient_T[wall.axis] -= 2.0 * wall.flux / conductivity * wall.inward;
  }
  const double slope = pressure_slope(state, wall, source, inside, at.y, at.T);
  at.p -= 2.0 * d * slope;
  at.gradient_p[wall.axis] += 2.0 * slope * wall.inward;
  reflect_velocity(wall, d, at.v);
  if (state.layer.relaxed) reflect_velocity(wall, d, at.z);
}

// The image r: of the state, and the gradients that the noise is taken with.
template <int D>
void mirror_state(convection_state<D>& state, std::size_t r) {
  auto& s = state.fluid();
  const std::size_t i = s.first_wall() + r, j = state.world.walls.source[r];
  const auto& laplacian = state.lagged.laplacian;
  const auto& gradient = state.lagged.gradient;
  const bool relaxed = state.layer.relaxed;
  reflected<D> at{};
  at.y = s.x[1][j], at.T = s.T[j], at.p = state.p[j];
  for (std::size_t a = 0; a < D; ++a) {
    at.gradient_T[a] = gradient[unknown<D>::T][a][j], at.gradient_p[a] = gradient[unknown<D>::p][a][j];
    at.v.u[a] = s.v[a][j], at.v.curvature[a] = (*laplacian[a])[j];
    for (std::size_t b = 0; b < D; ++b) at.v.gradient[a][b] = gradient[a][b][j];
    if (!relaxed) continue;
    at.z.u[a] = state.z[a][j], at.z.curvature[a] = (*laplacian[unknown<D>::z + a])[j];
    for (std::size_t b = 0; b < D; ++b) at.z.gradient[a][b] = gradient[unknown<D>::z + a][b][j];
  }
  walls::for_each_mirror(state.world.walls, r, [&](const walls::side<D>& wall) { reflect(state, wall, j, at); });
  s.T[i] = at.T, state.p[i] = at.p;
  for (std::size_t a = 0; a < D; ++a) {
    gradient[unknown<D>::T][a][i] = at.gradient_T[a], gradient[unknown<D>::p][a][i] = at.gradient_p[a];
    s.v[a][i] = at.v.u[a];
    for (std::size_t b = 0; b < D; ++b) gradient[a][b][i] = at.v.gradient[a][b];
    if (!relaxed) continue;
    state.z[a][i] = at.z.u[a];
    for (std::size_t b = 0; b < D; ++b) gradient[unknown<D>::z + a][b][i] = at.z.gradient[a][b];
  }
  if (!state.layer.law.varies) return;
  set_viscosity(state, i, at.y);
  (*state.own_viscosity)[i] = (*state.own_viscosity)[j];
}

// The state sets out to the ghosts; it is there, and that of images, after end_state(). What the images lag behind is
// in their lagged terms.
template <int D>
void begin_state(convection_state<D>& state) {
  auto& w = state.world.w;
  auto& s = w.s;
  const foundation::stage timed(w.times, "halo");
  const bool varies = state.layer.law.varies;
  if (varies) foundation::for_all(s.fluid, [&](std::size_t i) { set_viscosity(state, i, s.x[1][i]); });
  domain::begin_exchange<D>(w.d.ranks, w.d.fluid_halo, unknown_arrays(state), &s.x);
}

template <int D>
void end_state(convection_state<D>& state) {
  auto& w = state.world.w;
  auto& s = w.s;
  const foundation::stage timed(w.times, "halo");
  const bool varies = state.layer.law.varies;
  w.end_fluid();
  walls::move_images(state.world.walls, s);
  if (varies)
    foundation::for_all(s.fluid_ghosts, [&](std::size_t g) { set_viscosity(state, s.fluid + g, s.x[1][s.fluid + g]); });
  foundation::for_all(state.world.walls.source.size(), [&](std::size_t r) { mirror_state(state, r); });
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
