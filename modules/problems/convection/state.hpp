// The state of a convecting layer: what is integrated, what lags behind, what was summed last; the lattice of the
// present level.
#pragma once

#include <convection/graded_viscosity.hpp>
#include <convection/options.hpp>
#include <foundation/exact_sum.hpp>
#include <foundation/threads.hpp>
#include <operators/consistent.hpp>
#include <particles/named_fields.hpp>
#include <regions/apply.hpp>
#include <run/start_from_file.hpp>
#include <sources/fields.hpp>

namespace tetsuame::convection {

// What a particle's place and state say alone: temperature of conduction, buoyancy, viscosity, inertia.

// K, what carries no flow: the conductive profile, or heated from a side a constant; y: m above the bottom. Numbers are
// doubles, or several in lanes.
template <class R>
R reference_temperature(const parameters& layer, const R& y) {
  return layer.T_bottom - layer.dT_reference * y / layer.fluid.L;
}

// b = α g (T - T_ref) - g q p/K₀, m/s2 upwards, or by an equation of state; q: 0, 1 (separated gravity density [S1
// (64)]), ζ² (conventional density).
template <class R>
R linear_buoyancy(const parameters& layer, const R& y, const R& T, const R& p) {
  const auto& f = layer.fluid;
  return f.alpha * f.g * (T - reference_temperature(layer, y)) - f.g * layer.compressibility * p / f.K;
}
inline double buoyancy(const parameters& layer, double y, double T, double p) {
  return layer.weighed ? layer.weighed->buoyancy(y, T, p, layer.compressibility) : linear_buoyancy(layer, y, T, p);
}

// ∂b/∂T, m/(s2 K): what rises cools by it, times T v_y/c_p.
inline double buoyancy_slope(const parameters& layer, double y, double T) {
  return layer.weighed ? layer.weighed->slope(y, T) : layer.fluid.alpha * layer.fluid.g;
}

inline double viscosity(const parameters& layer, double y, double T) {  // m2/s
  return layer.law.varies ? layer.nu * std::exp(layer.reached * layer.law.log(T, y)) : layer.nu;
}

// ξ² where the viscosity is ν.
template <class R>
R inertia(const parameters& layer, const R& nu) {
  return layer.steady ? R(nu / layer.nu_eff) : R(layer.slowing.xi * layer.slowing.xi);
}

// Places of the unknowns among the fields of the operators: v, T, p, and z where the viscous response is relaxed.
template <int D>
struct unknown {
  static constexpr std::size_t T = D, p = D + 1, z = D + 2;
  static constexpr int count = D + 2, count_with_z = 2 * D + 2;
};

// What the operators need of an earlier evaluation.
template <int D>
struct lagged_terms {
  static constexpr std::size_t S = operators::symmetric_terms(D), N = angular_terms;
  template <std::size_t K>
  using vector_field = particles::vector_field<K>;

  // Of each unknown: the plain Laplacian P, for the deferred correction and curvature at walls that do not slip; and G,
  // for the noise.
  std::vector<particles::array*> laplacian;
  std::vector<vector_field<D>> gradient;
  vector_field<S> tensor;  // B of the Laplacian
  // Where the viscosity varies, (∇v + ∇vᵀ - ∇·v)·∇ln ν, 1/(m s), for the pressure at walls; and, in 2-D, ν A, m/s2, and
  // a of the isotropic line forces, graded_viscosity.hpp, and ν, m2/s.
  vector_field<D> stress, force;
  vector_field<N> angles;
  particles::array* viscosity = nullptr;

  std::vector<particles::array*> all, of_neighbours;  // of these; what a particle needs of its neighbours too

  // Declared among the particles' fields, each name with this prefix.
  lagged_terms(const parameters& layer, particles::particles<D>& s, const std::string& prefix, particles::role kind) {
    const auto add = [&](const std::string& name, const std::string& unit) {
      return all.emplace_back(&particles::declare(s, prefix + name, unit, kind));
    };
    const auto add_vector = [&]<std::size_t K>(vector_field<K>& field, const std::string& name,
                                               const std::string& unit) {
      std::array<particles::array*, K> components;
      for (std::size_t k = 0; k < K; ++k) components[k] = add(name + "_" + std::to_string(k), unit);
      field = vector_field<K>(components);
    };
    std::vector<std::string> names;
    for (int a = 0; a < D; ++a) names.push_back("Velocity" + std::to_string(a));
    names.insert(names.end(), {"Temperature", "Pressure"});
    for (int a = 0; a < D && layer.relaxed; ++a) names.push_back("RelaxedVelocity" + std::to_string(a));
    for (const auto& name : names) laplacian.push_back(add("LaplacianOf" + name, ""));
    for (const auto& name : names) add_vector(gradient.emplace_back(), "GradientOf" + name, "");
    if (layer.law.varies) add_vector(stress, "GradedStress", "1/(m s)");
    if (layer.law.varies && graded_viscosity<D>::isotropic) {
      add_vector(force, "ViscousForce", "m/s^2");
      add_vector(angles, "LineWeight", "1");
      viscosity = add("EarlierViscosity", "m^2/s");
    }
    of_neighbours = all;
    add_vector(tensor, "LaplacianWeight", "1");
  }
};

// What one pass over the neighbours leaves, for the fluid.
template <int D>
struct sums {
  template <std::size_t K>
  using vector_field = particles::vector_field<K>;

  lagged_terms<D> latest;                                            // what the next evaluations may lag behind
  vector_field<unknown<D>::count_with_z> laplacian, hyperdiffusion;  // L and Q of each unknown
  vector_field<D> uneven;                                            // 1/m, how unevenly particles stand
  particles::array& W;                                               // Σ W, 1/m^D
  // Where the viscosity varies: its force over ν and that without correction, 1/(m s); ∇ln ν, 1/m; contrast.
  vector_field<D> viscous, plain_viscous, log_slope;
  vector_field<2> contrast;  // of viscosity, of sound

  sums(const sums&) = delete;  // its fields are the state's
  sums& operator=(const sums&) = delete;
  sums(const parameters& layer, particles::particles<D>& s)
      : latest(layer, s, "Latest", particles::role::derived),
        W(particles::declare(s, "SumOfW", "1/m^D", particles::role::derived)) {
    const auto add = [&]<std::size_t K>(vector_field<K>& field, const std::string& name, const std::string& unit) {
      field = particles::declare_vector<K>(s, name, unit, particles::role::derived);
    };
    add(laplacian, "Laplacian", "");
    add(hyperdiffusion, "Noise", "");
    add(uneven, "Unevenness", "1/m");
    if (!layer.law.varies) return;
    add(viscous, "ViscousForceOverViscosity", "1/(m s)");
    add(plain_viscous, "PlainViscousForceOverViscosity", "1/(m s)");
    add(log_slope, "LogSlopeOfViscosity", "1/m");
    add(contrast, "Contrast", "1");
  }
};

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
  std::optional<lagged_terms<D>> before;  // those of the step before, where they are extrapolated from it
  // Where the viscosity varies, of ghosts and images too: ν^½, m/s^½, and ν, which an image has of its particle.
  particles::array* viscosity_root = nullptr;
  particles::array* own_viscosity = nullptr;
  sums<D> last;
  sources::fields<D> sources;

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
convection_state<D>::convection_state(const options& o, const parameters& p_of_input)
    : input(o),
      layer(p_of_input),
      p(particles::declare(fluid(), "DynamicPressure", "Pa", particles::role::integrated)),
      z(layer.relaxed ? particles::declare_vector<D>(fluid(), "RelaxedVelocity", "m/s", particles::role::integrated)
                      : particles::vector_field<D>()),
      lagged(layer, fluid(), "", particles::role::memory),
      last(layer, fluid()) {
  auto& s = fluid();
  if (extrapolates(o)) before.emplace(layer, s, "Before", particles::role::memory);
  if (layer.law.varies) {
    viscosity_root = &particles::declare(s, "ViscosityRoot", "m/s^(1/2)", particles::role::derived);
    own_viscosity = &particles::declare(s, "OwnViscosity", "m^2/s", particles::role::derived);
  }
  lay(*this, o.convection.levels);
  for (std::size_t i = 0; i < s.fluid; ++i) s.T[i] = start_temperature(*this, i);
  if (layer.regions.any()) warm_regions(*this);
  if (!o.common.start.is_read()) return;
  run::start_from_file(o.common.start, {.motion = false}, world);
  forget(*this);
  share_volume(*this);
}

// Of a file with another number of particles than the lattice: they share the box.
template <int D>
void share_volume(convection_state<D>& state) {
  std::int64_t on_lattice = 1;
  for (std::size_t a = 0; a < D; ++a) on_lattice *= state.at_start.particles[a];
  state.at_start.V *= static_cast<double>(on_lattice) / static_cast<double>(state.world.fluid_total);
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
