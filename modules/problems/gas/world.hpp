// Gas with contacts and shocks in a box: the options, the test, the particles with their lists, and an array for every
// quantity that is summed or derived. What is done with them: start.hpp, lists.hpp, state.hpp, rates.hpp, measures.hpp.
#pragma once

#include <eos/caloric.hpp>
#include <gas/setups.hpp>
#include <particles/named_fields.hpp>
#include <run/supports.hpp>
#include <schemes/common.hpp>
#include <variant>

namespace tetsuame::gas {

template <int D>
using kernel_choice = std::variant<kernels::quintic_spline<D>, kernels::wendland_c4<D>>;

// Of all ranks' particles: kg, J, and kg m/s.
template <int D>
struct totals {
  double mass, kinetic, internal, potential, momentum_scale;
  std::array<double, D> momentum;
  double energy() const { return kinetic + internal + potential; }
};

template <int D>
struct world : run::state<D> {
  using run::state<D>::w, run::state<D>::walls, run::state<D>::skin, run::state<D>::fluid_total;
  static constexpr std::size_t G = static_cast<std::size_t>(D) * (D + 2);      // gradients
  static constexpr std::size_t R = 2 + static_cast<std::size_t>(D) * (D + 2);  // m_0, A, B and gradients of A, B

  const options& o;
  const setup test;
  std::vector<eos::caloric> materials = {};                 // left, right; none: gases
  std::vector<double> stiffening = {};                      // K_S' of each
  kernel_choice<D> unit = kernels::quintic_spline<D>(1.0);  // support 1
  double support_over_dx = 0.0, support_over_h = 0.0;
  double speed_scale = 0.0, density_scale = 0.0;

  // Fields that go with the particles.
  particles::array& support = field("Support", "m", "support of the kernel at the start of the step");
  particles::array& list_support = field("ListSupport", "m", "support when the neighbour lists were made");
  particles::array& alpha = field("Alpha", "1", "of the artificial viscosity", particles::role::integrated);
  particles::array& start_volume = field("StartVolume", "m^D", "mass over density at the start");
  particles::array& start_sum = field("StartSum", "1", "sum of StartVolume W at the start");
  particles::array& evolved = field("EvolvedDensity", "kg/m^D", "density by continuity", particles::role::integrated);

  // Of all particles, ghosts and images included. kind: which material
  particles::array S = {}, per_S = {}, weight = {}, slope = {}, correction = {}, dissipation = {};
  particles::array gamma = {}, stiffness = {}, kind = {};
  std::array<particles::array, G> gradient = {};
  std::array<particles::array, R> reproducing = {};
  // Of the particles of this rank
  particles::array y = {}, f = {}, z = {}, divergence = {}, curl = {}, number = {}, number_volume = {};
  particles::array count = {}, count_slope = {}, mass_density = {};
  std::array<particles::array, D> force = {};
  particles::array power = {}, signal = {}, density_rate = {};

  world(const options& o_, setup test_) : o(o_), test(std::move(test_)) {}

  particles::array& field(const char* name, const char* of_unit, const char* about,
                          particles::role role = particles::role::memory) {
    return particles::declare(w.s, name, of_unit, role, about);
  }
  const domain::communicator& ranks() const { return w.d.ranks; }

  const particles::array& told_density() const { return o.shock.density == "mass" ? mass_density : w.s.rho; }
  bool has_alpha() const { return !o.godunov() && !o.evolves_density() && o.shock.switch_of_alpha; }
  // A part of the skin is for supports to grow, the rest for particles to move.
  double room_to_grow() const { return 0.25 * skin; }

  point place(std::size_t i) const {
    point x{};
    for (std::size_t a = 0; a < D; ++a) x[a] = w.s.x[a][i];
    return x;
  }
  const eos::caloric& caloric_of(std::size_t i) const { return materials[w.s.material[i] == test.material_l ? 0 : 1]; }
  // c² = γ (p + p_inf)/ρ = γ (γ - 1)(u - p_inf/ρ)
  double sound_speed(std::size_t i) const {
    if (o.any_eos()) return caloric_of(i).at(w.s.rho[i], w.s.u[i]).c;
    const double thermal = stiffness[i] > 0.0 ? w.s.u[i] - stiffness[i] / w.s.rho[i] : w.s.u[i];
    return std::sqrt(gamma[i] * (gamma[i] - 1.0) * std::max(thermal, 0.0));
  }
};

// gamma and p_infinity; with an equation of state K_S' of the start, and p_infinity follows the state
template <int D>
std::pair<double, double> gas_of(const world<D>& g, std::int32_t material) {
  const auto& q = g.o.shock;
  const bool left = material == g.test.material_l;
  if (g.o.any_eos()) return {g.stiffening[left ? 0 : 1], 0.0};
  const auto& side = left ? q.l : q.r;
  return {*side.gamma, side.p_infinity};
}

// The pair sums of the terms over the neighbours of these rows.
template <int D, class... Terms>
void sum(world<D>& g, const pairs::stretch& rows, const Terms&... terms) {
  const double nearest = 1e-9 * g.support_over_dx * g.w.dx;
  pairs::sum_over<D>(rows, g.w.list, g.w.x(), schemes::distances_only{nearest}, terms...);
}

// f(image, its source, which velocities and slopes along an axis change sign)
template <int D, class F>
void for_each_image(world<D>& g, F&& f) {
  foundation::for_all(g.walls.source.size(), [&](std::size_t r) {
    std::array<double, D> sign;
    sign.fill(1.0);
    walls::for_each_mirror(g.walls, r, [&](const walls::side<D>& wall) { sign[wall.axis] = -sign[wall.axis]; });
    f(g.w.s.first_wall() + r, g.walls.source[r], sign);
  });
}

}  // namespace tetsuame::gas
