// The state of a convecting layer: what is integrated, what lags behind, what was summed last; the lattice of the
// present level.
#pragma once

#include <convection/fields.hpp>
#include <foundation/exact_sum.hpp>
#include <foundation/threads.hpp>
#include <run/start.hpp>

namespace tetsuame::convection {

// What a particle's place and state say alone: temperature of conduction, buoyancy, viscosity, inertia.

// K, the conductive profile; y: m above the bottom.
inline double reference_temperature(const parameters& layer, double y) {
  return layer.T_bottom - layer.fluid.dT * y / layer.fluid.L;
}

// b = α g (T - T_ref) - g q p/K₀, m/s2 upwards, or by an equation of state; q: 0, 1 (separated gravity density [S1
// (64)]), ζ² (conventional density).
inline double buoyancy(const parameters& layer, double y, double T, double p) {
  if (layer.weighed) return layer.weighed->buoyancy(y, T, p, layer.compressibility);
  const auto& f = layer.fluid;
  return f.alpha * f.g * (T - reference_temperature(layer, y)) - f.g * layer.compressibility * p / f.K;
}

// ∂b/∂T, m/(s2 K): what rises cools by it, times T v_y/c_p.
inline double buoyancy_slope(const parameters& layer, double y, double T) {
  return layer.weighed ? layer.weighed->slope(y, T) : layer.fluid.alpha * layer.fluid.g;
}

inline double viscosity(const parameters& layer, double y, double T) {  // m2/s
  return layer.law.varies ? layer.nu * std::exp(layer.reached * layer.law.log(T, y)) : layer.nu;
}

// ξ² where the viscosity is ν.
inline double inertia(const parameters& layer, double nu) {
  return layer.steady ? nu / layer.nu_eff : layer.slowing.xi * layer.slowing.xi;
}

// Of the start of a step.
struct step_start {
  double v_max = 0.0;   // m/s
  double faster = 1.5;  // the largest speed with shifting over that
  // How much faster rates grow than with one viscosity: contrast.
  double viscous_contrast = 1.0, sound_contrast = 1.0;
};

struct lattice {
  std::int64_t level = 0;  // so many finer ones come
  std::array<std::int64_t, 3> particles{};
  double V = 0.0;                       // m^D, of a particle
  double h = 0.0;                       // m
  double beta = 0.0;                    // m2, of the deferred correction
  double W_self = 0.0, per_W_dx = 0.0;  // 1/m^D, m^D
};

template <int D>
struct convection_state {
  run::state<D> world;
  const options& input;
  parameters layer;
  lattice at_start;  // where the particles of this level were

  particles::array& p;           // Pa, beyond that of the conductive state
  particles::vector_field<D> z;  // m/s, velocity of the viscous force, where that is relaxed
  lagged_terms<D> lagged;
  std::optional<lagged_terms<D>> before;         // those of the step before, where they are extrapolated from it
  std::vector<particles::array*> earlier_rates;  // of each component that is integrated, for 'ab2'
  // Where the viscosity varies, of ghosts and images too: ν^½, m/s^½, and ν, which an image has of its particle.
  particles::array* viscosity_root = nullptr;
  particles::array* own_viscosity = nullptr;
  sums<D> last;

  step_start start;
  double displacing = 0.0;  // m/s, the largest speed of a particle with its shift, in the last evaluation
  bool has_before = false;

  convection_state(const options& o, const parameters& p_of_input);

  particles::particles<D>& fluid() { return world.w.s; }
  const particles::particles<D>& fluid() const { return world.w.s; }
  const domain::communicator& ranks() const { return world.w.d.ranks; }
  std::size_t unknowns() const { return lagged.laplacian.size(); }
  double viscosity(std::size_t i) const { return convection::viscosity(layer, fluid().x[1][i], fluid().T[i]); }
};

inline bool keeps_rate(const options& o) { return o.common.time.method == "ab2"; }
// Of all stages of these the rate at the start has the largest weight, -1.1 to -1.9: with what lags extrapolated to the
// middle of the step they keep their second order (docs/theory/convection.md).
inline bool extrapolates(const options& o) { return o.common.time.method == "rkl2" || o.common.time.method == "rkc2"; }

template <int D>
auto declared_in(particles::particles<D>& s, const std::string& prefix) {
  return [&s, prefix](const std::string& name, const std::string& unit) -> particles::array& {
    return particles::declare(s, prefix + name, unit, particles::role::memory);
  };
}

template <int D>
convection_state<D>::convection_state(const options& o, const parameters& p_of_input)
    : input(o),
      layer(p_of_input),
      p(particles::declare(fluid(), "DynamicPressure", "Pa", particles::role::integrated)),
      z(layer.relaxed ? particles::declare_vector<D>(fluid(), "RelaxedVelocity", "m/s", particles::role::integrated)
                      : particles::vector_field<D>()),
      lagged(layer, declared_in(fluid(), "")),
      last(layer) {
  auto& s = fluid();
  if (extrapolates(o)) before.emplace(layer, declared_in(s, "Before"));
  for (std::size_t k = 0; k < D + unknowns() && keeps_rate(o); ++k)
    earlier_rates.push_back(&particles::declare(s, "EarlierRate_" + std::to_string(k), "", particles::role::memory));
  if (layer.law.varies) {
    viscosity_root = &particles::declare(s, "ViscosityRoot", "m/s^(1/2)", particles::role::derived);
    own_viscosity = &particles::declare(s, "OwnViscosity", "m^2/s", particles::role::derived);
  }
  lay(*this, o.convection.levels);
  const auto& length = o.domain.length;
  for (std::size_t i = 0; i < s.fluid; ++i)
    s.T[i] = reference_temperature(layer, s.x[1][i]) +
             o.initial.perturbation * layer.fluid.dT *
                 std::cos(static_cast<double>(o.initial.half_waves) * std::numbers::pi * s.x[0][i] / length[0]) *
                 std::sin(std::numbers::pi * s.x[1][i] / length[1]);
}

// The unknowns, fluid, ghosts and images, in the order of the operators.
template <int D>
std::vector<double*> unknown_arrays(convection_state<D>& state) {
  auto& s = state.fluid();
  std::vector<double*> all;
  for (auto& component : s.v) all.push_back(component.data());
  all.insert(all.end(), {s.T.data(), state.p.data()});
  for (std::size_t a = 0; a < D && state.layer.relaxed; ++a) all.push_back(state.z[a].data());
  return all;
}

// What lags behind and what was known of earlier steps, of the particles that there are: as on a lattice at rest.
template <int D>
void forget(convection_state<D>& state) {
  auto& s = state.fluid();
  for (auto& extra : s.extras) std::fill(extra.values.begin(), extra.values.end(), 0.0);
  state.has_before = false;
  for (std::size_t a = 0, k = 0; a < D; ++a)
    for (std::size_t b = a; b < D; ++b, ++k) std::fill_n(state.lagged.tensor[k].begin(), s.fluid, a == b ? 1.0 : 0.0);
}

// The lattice of a level, at rest, without temperature, and all that goes with its spacing.
template <int D>
void lay(convection_state<D>& state, std::int64_t level) {
  const auto& o = state.input;
  auto of = o.domain;
  of.particles = particles_of_level(o, level);
  auto& w = state.world.w;
  const double dx = of.dx();
  follow(state.layer, dx);
  run::set_up(state.world, domain::communicator::world(), of, o.walls, o.common.kernel, fit_radius * dx);
  forget(state);
  state.at_start = {level, of.particles, std::pow(dx, D), o.common.kernel.h_over_dx * dx,
                    operators::lattice_beta<D>(w.kernel, dx)};
  std::visit(
      [&](const auto& k) {
        state.at_start.W_self = k.self();
        state.at_start.per_W_dx = 1.0 / k.value(dx);
      },
      w.kernel);
}

// In a closed box nothing feels the mean pressure.
template <int D>
void remove_mean(const convection_state<D>& state, double* p) {
  const std::size_t n = state.fluid().fluid;
  foundation::exact_sum sum;
  for (std::size_t i = 0; i < n; ++i) sum.add(p[i]);
  const double mean = state.ranks().exact(sum) / static_cast<double>(state.world.fluid_total);
  for (std::size_t i = 0; i < n; ++i) p[i] -= mean;
}

template <int D>
double fastest_flow(const convection_state<D>& state) {  // m/s, on any rank
  return state.ranks().maximum(run::largest_speed(state.world));
}

}  // namespace tetsuame::convection
