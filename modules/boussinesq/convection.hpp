// Thermal convection of a weakly compressible Boussinesq fluid, sound slowed by ζ and inertia raised by ξ [S1]:
//
//   ξ² dv/dt = -G(p)/ρ₀ + ν L(v) [or the divergence of ν (∇v + ∇vᵀ + ∇·v)] + b ŷ + ξ² [(w + a v)·G(v) + ε h |w| Q(v)]
//   dp/dt    = -ρ₀ (c₀/ζ)² D(v) + (w + e v)·G(p) + δ h c_eff Q(p)
//   dT/dt    = κ L(T) + w·G(T) + ε h |w| Q(T) + H/c_p       dx/dt = v + w
//              [+ 2 ν e:e/c_p, e the rate of strain] [- α g v_y T/c_p]
//   b = α g (T - T_ref) - g q p/K₀,   T_ref the conductive profile
//
// G, D = tr G, L: operators/consistent.hpp; volumes are Δx^d throughout. p is the part of the pressure beyond that
// which carries T_ref. Choices:
//   e = 1  the rate of p at a place: the steady state then does not know the speed of sound; e = 0: along the flow
//   a = 1  (target steady) the rate of v at a place: inertia vanishes in the steady state, as at Pr = ∞, whatever ξ.
//          Then ξ may differ from place to place, and follows the viscosity: ξ² = ν/ν_eff with one ν_eff. And the
//          viscous force may be that of a velocity z that relaxes to v (viscous_response; a Jeffreys fluid), at a place
//            ∂z/∂t = θ ∂v/∂t + (v - z)/λ      dz/dt = ∂z/∂t + (w + v)·G(z) + ε h |w| Q(z)
//          z = v where the flow is steady. Shear then travels in waves, s² + s (1/λ + θ ν_eff k²) + ν_eff k²/λ = 0, and
//          only θ ν_eff binds the step. Walls ask of z what they ask of v
//   q      0, 1 (separated gravity density), ζ² (conventional density)
// or b from any equation of state, gravity_density.hpp; α g is then ∂b/∂T.
// w spreads the particles evenly: w = -C h v_max Σ V F r [1 + 0.2 (W/W(Δx))⁴], |w| <= v_max/2 [after Lind et al., J.
// Comput. Phys. 231, 1499 (2012)]; fields are moved back along their gradients. Q(f) = Σ V F [2 (f_i - f_j) -
// (G_i + G_j)·r] [after Antuono et al., Comput. Phys. Commun. 181, 532 (2010)].
//
// Walls are mirror images (images/images.hpp); p is even but for the step that the momentum balance asks for,
// p_g = p_s - 2 d ∂p/∂n, ∂p/∂n = ρ₀ (ν ∇²u_n [no slip] + [(∇v + ∇vᵀ)·∇ν]_n + b n_y).
//
// Levels: the run may start with coarser lattices; each one's steady flow is interpolated to the next.
//
// The deferred correction, the tensor B, w's sum, Q's gradients and no-slip curvatures lag behind (lagging): they are
// those of the state at the start of the step; of the evaluation before; or M_n + (M_n - M_(n-1))/2, the middle of the
// step. The rate at the start of a step is evaluated once more with the latter, for of all stages of 'rkl2' and 'rkc2'
// it has the largest weight, -1.1 to -1.9.
#pragma once

#include <boussinesq/contrast.hpp>
#include <boussinesq/graded_viscosity.hpp>
#include <boussinesq/interpolation.hpp>
#include <boussinesq/measures.hpp>
#include <boussinesq/options.hpp>
#include <boussinesq/steady.hpp>
#include <boussinesq/terms.hpp>
#include <march/problem.hpp>
#include <operators/consistent.hpp>
#include <output/columns.hpp>
#include <simulation/state.hpp>

namespace tetsuame::boussinesq {

template <int D>
class convection : public march::problem {
 public:
  convection(const options& o, const parameters& p)
      : o_(o), p_(p), fields_(p.relaxed ? most_fields : plain_fields), samples_(measures.size()) {
    using particles::role;
    auto& s = world_.w.s;
    const auto add = [&](std::string name, std::string unit, role kind) {
      s.extras.push_back({std::move(name), std::move(unit), "", kind, {}});
      return s.extras.size() - 1;
    };
    pressure_ = add("DynamicPressure", "Pa", role::integrated);
    z_ = s.extras.size();
    for (std::size_t k = 0; k < D && p_.relaxed; ++k)
      add("RelaxedVelocity_" + std::to_string(k), "m/s", role::integrated);
    lap_ = add("Laplacian_0", "", role::memory);
    for (std::size_t k = 1; k < fields_; ++k) add("Laplacian_" + std::to_string(k), "", role::memory);
    grad_ = add("Gradient_0", "", role::memory);
    for (std::size_t k = 1; k < fields_ * D; ++k) add("Gradient_" + std::to_string(k), "", role::memory);
    root_ = add("ViscosityRoot", "m/s^(1/2)", role::derived);
    own_viscosity_ = add("OwnViscosity", "m^2/s", role::derived);
    stress_ = add("GradedStress_0", "1/(m s)", role::memory);
    for (std::size_t k = 1; k < D; ++k) add("GradedStress_" + std::to_string(k), "1/(m s)", role::memory);
    tensor_ = add("LaplacianWeight_0", "1", role::memory);
    for (std::size_t k = 1; k < S; ++k) add("LaplacianWeight_" + std::to_string(k), "1", role::memory);
    force_ = s.extras.size();
    for (std::size_t k = 0; k < D && isotropic(); ++k) add("ViscousForce_" + std::to_string(k), "m/s^2", role::memory);
    angles_ = s.extras.size();
    for (std::size_t k = 0; k < N && isotropic(); ++k) add("LineWeight_" + std::to_string(k), "1", role::memory);
    if (isotropic()) add("EarlierViscosity", "m^2/s", role::memory);
    before_ = s.extras.size();
    if (extrapolates())
      for (std::size_t k = 0; k < fields_ * (1 + D) + S + D + (isotropic() ? D + N + 1 : 0); ++k)
        add("Before_" + std::to_string(k), "", role::memory);
    earlier_ = s.extras.size();
    if (keeps_rate())
      for (std::size_t k = 0; k < D + fields_; ++k) add("EarlierRate_" + std::to_string(k), "", role::memory);

    lay(o.convection.levels);
    const auto& length = o.physics.domain.length;
    for (std::size_t i = 0; i < s.fluid; ++i)
      s.T[i] = reference(s.x[1][i]) +
               o.initial.perturbation * p_.fluid.dT *
                   std::cos(static_cast<double>(o.initial.half_waves) * std::numbers::pi * s.x[0][i] / length[0]) *
                   std::sin(std::numbers::pi * s.x[1][i] / length[1]);
  }

  const domain::communicator& ranks() const override { return world_.w.d.ranks; }
  std::size_t local_particles() const override { return world_.w.s.fluid; }
  std::size_t simd_lanes() const override { return pairs::lanes; }
  output::snapshot_header header() const override { return images::snapshot_header(world_); }
  std::vector<std::string> about() const override { return p_.lines; }

  std::vector<integrators::field> fields() override {
    auto& s = world_.w.s;
    constexpr std::array<const char*, 3> axis{"x", "y", "z"};
    const double speed = p_.slowing.speed,
                 pressure = p_.fluid.rho * p_.fluid.alpha * p_.fluid.dT * p_.fluid.g * p_.fluid.L;
    std::vector<integrators::field> all;
    for (std::size_t a = 0; a < D; ++a) all.push_back({axis[a], s.x[a].data(), 0.0, world_.w.dx});
    for (std::size_t a = 0; a < D; ++a) all.push_back({std::string("v") + axis[a], s.v[a].data(), 0.0, speed});
    all.push_back({"T", s.T.data(), 0.0, p_.fluid.dT});
    all.push_back({"p", pressure_of().data(), 0.0, pressure});
    for (std::size_t a = 0; a < D && p_.relaxed; ++a)
      all.push_back({std::string("z") + axis[a], relaxed_velocity(a).data(), 0.0, speed});
    if (keeps_rate())
      for (std::size_t k = 0; k < all.size(); ++k) all[k].previous_rate = s.extras[earlier_ + k].values.data();
    return all;
  }

  // ---- right-hand side --------------------------------------------------------------------

  void evaluate(std::span<double* const> rate) override {
    refresh_state();
    sum_over_neighbours();
    combine(rate);
    world_.w.agree();
    keep_mean_pressure(rate[2 * D + 1]);
  }

  integrators::step_limit largest_step() override {
    const double dx = world_.w.dx, fastest = std::max(largest_viscosity(), p_.fluid.kappa);
    const double sound = *o_.march.time.cfl * dx / std::hypot(p_.c_eff, p_.shear_speed);
    const double diffusion = *o_.march.time.diffusive * dx * dx / fastest;
    return sound < diffusion ? integrators::step_limit{sound, "sound"}
                             : integrators::step_limit{diffusion, "diffusion"};
  }
  double diffusion_radius() override {
    const double dx = world_.w.dx;
    return 4.0 * D * std::max(viscous_contrast_ * largest_viscosity(), p_.fluid.kappa) / (dx * dx);
  }
  // The fixed step of 'rk4' is bound by what lags behind; to its limit of stability there are factors of 2.7 (damping)
  // and 3.8 (sound) with one viscosity, found from the eigenvalues of the rates.
  double longest_step() override {
    if (!p_.steady || !varies()) return std::numeric_limits<double>::infinity();
    const auto& method = o_.march.time.method;
    const double margin = method == "rk4" ? std::hypot(viscous_contrast_ / 2.7, sound_contrast_ / 3.8)
                          : method == "rkl2" || method == "rkc2" ? sound_contrast_
                                                                 : std::max(viscous_contrast_, sound_contrast_);
    return margin > 1.0 ? largest_step().dt / margin : std::numeric_limits<double>::infinity();
  }

  void expect_memory(bool expected) override { whole_ = expected; }
  void keep_memory() override {
    take_memory();
    v_max_ = fastest();
    faster_ = v_max_ > 0.0 ? std::max(1.0, ranks().maximum(displacing_) / v_max_) : 1.5;
    if (p_.steady && varies()) {  // else inertia does not go with ν
      const auto largest = [&](const particles::array& a) {
        double most = 1.0;
        for (std::size_t i = 0; i < world_.w.s.fluid; ++i) most = std::max(most, a[i]);
        return ranks().maximum(most);
      };
      viscous_contrast_ = largest(viscous_stiffer_);
      sound_contrast_ = std::sqrt(largest(coupled_));
    }
  }
  bool asks_again() const override { return extrapolates() || lacks_rate_; }
  bool keeps_rate() const { return o_.march.time.method == "ab2"; }
  bool extrapolates() const { return o_.march.time.method == "rkl2" || o_.march.time.method == "rkc2"; }
  // Of what the last evaluation summed; extrapolated: by half a step, as long as the one before.
  void take_memory() {
    auto& s = world_.w.s;
    const bool extrapolated = extrapolates();
    const double onwards = has_before_ ? 0.5 : 0.0;
    foundation::for_all(s.fluid, [&](std::size_t i) {
      std::size_t before = before_;
      const auto keep = [&](std::size_t k, double now) {
        s.extras[k].values[i] = now;
        if (!extrapolated) return;
        double& earlier = s.extras[before++].values[i];
        s.extras[k].values[i] += onwards * (now - earlier);
        earlier = now;
      };
      for (std::size_t k = 0; k < fields_; ++k) keep(lap_ + k, plain_[k][i]);
      for (std::size_t k = 0; k < fields_; ++k)
        for (std::size_t a = 0; a < D; ++a) keep(grad_ + k * D + a, gradient_[k][a][i]);
      for (std::size_t k = 0; k < S; ++k) keep(tensor_ + k, next_B_[k][i]);
      const auto stress = graded_stress(i);
      for (std::size_t a = 0; a < D; ++a) keep(stress_ + a, stress[a]);
      if (!isotropic()) return;
      const double nu = viscosity(i);
      for (std::size_t a = 0; a < D; ++a) keep(force_ + a, nu * plain_viscous_[a][i]);
      for (std::size_t k = 0; k < N; ++k) keep(angles_ + k, next_angles_[k][i]);
      keep(angles_ + N, nu);
    });
    has_before_ = extrapolated;
    refresh_memory();
  }

  bool set_time(double t) override {
    const double before = reached_;
    reached_ = p_.ramp > 0.0 ? std::min(1.0, t / p_.ramp) : 1.0;
    nu_ = p_.fluid.nu * std::pow(p_.start, 1.0 - reached_);
    follow_viscosity();
    return reached_ != before;
  }

  bool complete_step() override {
    lacks_rate_ = false;
    const std::int64_t crossings = ranks().sum(images::reflect(world_.images, world_.w.s));
    crossings_ += crossings;
    return crossings > 0;
  }

  double moved() override { return images::moved_since_lists(world_); }
  double allowance() const override { return 0.5 * world_.skin; }
  // Of the particles, which are spread as well: as at the start of the last step in proportion.
  double speed() override { return fastest() * faster_; }
  double fastest() {
    const auto& s = world_.w.s;
    double v2 = 0.0;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      double sum = 0.0;
      for (std::size_t a = 0; a < D; ++a) sum += s.v[a][i] * s.v[a][i];
      v2 = std::max(v2, sum);
    }
    return std::sqrt(ranks().maximum(v2));
  }

  void rebuild(bool as_they_were) override {
    auto& s = world_.w.s;
    images::rebuild(world_, as_they_were);
    for (auto* all : scratch())
      if (all->size() < s.fluid) all->resize(s.fluid);
    refresh_memory();
  }

  // ---- measures ---------------------------------------------------------------------------

  std::vector<output::history_column> columns() const override {
    std::vector<output::history_column> all;
    for (std::size_t m = 0; m < measures.size(); ++m) all.push_back({measures[m], m >= 3 && m < 6 ? "kappa/L" : "1"});
    all.push_back({"v_rms_si", "m/s"});
    all.push_back({"mach", "1"});
    all.push_back({"mean_density_drift", "1"});
    return all;
  }

  // Velocities in kappa/L.
  std::vector<double> row(double t) override {
    const auto& s = world_.w.s;
    const auto& f = p_.fluid;
    const double unit = f.kappa / f.L;
    foundation::exact_sum drift;
    std::array<foundation::exact_sum, D> momentum;
    foundation::exact_sum speeds;
    std::int64_t outside = 0;
    peaks_ = {};
    double fastest = 0.0;
    const auto& p = pressure_of();
    for (std::size_t i = 0; i < s.fluid; ++i) {
      double v2 = 0.0;
      for (std::size_t a = 0; a < D; ++a) {
        v2 += s.v[a][i] * s.v[a][i];
        momentum[a].add(s.v[a][i]);
        if (std::abs(s.v[a][i]) > peaks_[a].value) {
          peaks_[a].value = std::abs(s.v[a][i]);
          for (std::size_t b = 0; b < D; ++b) peaks_[a].x[b] = s.x[b][i];
        }
      }
      fastest = std::max(fastest, v2);
      speeds.add(std::sqrt(v2));
      if (p_.law.table && !p_.law.table->covers(s.T[i], f.L - s.x[1][i])) ++outside;
      drift.add(p[i] / (f.rho * stiffness(i) * p_.c_eff * p_.c_eff));
    }
    const auto mean = means();
    v_rms_ = std::sqrt(std::max(mean.v2, 0.0));  // interpolation may overshoot where a few particles hold a roll
    mach_ = std::sqrt(ranks().maximum(fastest)) / p_.c_eff;
    density_drift_ = ranks().exact(drift) / static_cast<double>(world_.fluid_total);
    outside_ = std::max(outside_, static_cast<double>(ranks().sum(outside)) / static_cast<double>(world_.fluid_total));
    const double scale = ranks().exact(speeds);
    momentum_ = 0.0;
    for (std::size_t a = 0; a < D; ++a) momentum_ = std::max(momentum_, std::abs(ranks().exact(momentum[a])));
    momentum_ = scale > 0.0 ? momentum_ / scale : 0.0;
    for (std::size_t a = 0; a < D; ++a) agree_on_peak(peaks_[a]);
    const auto walls = wall_heat(world_, particles_, o_.physics.domain.length[0], f.L / f.dT, conductivity());
    std::vector<double> m{1.0 + mean.carried / (unit * f.dT),
                          walls.top,
                          walls.bottom,
                          v_rms_ / unit,
                          peaks_[0].value / unit,
                          peaks_[1].value / unit};
    for (const double q : walls.corners) m.push_back(q);
    // Where the flow is steady viscosity takes what buoyancy gives, <2 nu e:e> = alpha g <v_y T'>.
    m.push_back(1.0 + mean.friction / (f.alpha * f.g * unit * f.dT));
    const double heat_unit = heat_capacity() * unit / f.L * f.dT;
    m.push_back(mean.friction / heat_unit);
    m.push_back(mean.cooling / heat_unit);
    m.push_back(mean.work / heat_unit);
    samples_.add(t, m);
    m.push_back(v_rms_);
    m.push_back(mach_);
    m.push_back(density_drift_);
    return m;
  }

  bool steady() const override {
    return level_ == 0 && o_.convection.steady_tolerance > 0.0 && settled(o_.convection.steady_tolerance);
  }

  std::string refine(double) override {
    if (level_ == 0 || !settled(coarser_tolerance * o_.convection.steady_tolerance)) return {};
    interpolate_to_next_level();
    samples_ = record(measures.size());
    return "half the particle spacing";
  }

  std::vector<output::particle_group> snapshot(std::vector<particles::array>& extra) override {
    const auto& s = world_.w.s;
    auto g = output::fluid_in_motion(s);
    extra.assign(2, particles::array(s.fluid));
    for (std::size_t i = 0; i < s.fluid; ++i) {
      extra[0][i] = viscosity(i) * p_.fluid.rho;
      extra[1][i] = 1.0 / W_sum_[i];
    }
    g.columns.push_back({"Temperature", "K", "temperature", {s.T.data()}, false});
    g.columns.push_back(
        {"Pressure", "Pa", "pressure beyond that of the conductive state", {pressure_of().data()}, false});
    g.columns.push_back({"Viscosity", "Pa s", "dynamic viscosity", {extra[0].data()}, false});
    g.columns.push_back({"Volume", D == 2 ? "m^2" : "m^3", "1/sum of W", {extra[1].data()}, false});
    return {g};
  }

  void report(double, simulation::summary& r) override {
    auto& j = r.metrics;
    const auto& f = p_.fluid;
    const double span = window();
    for (std::size_t m = 0; m < measures.size(); ++m) {
      const auto a = samples_.over(m, span);
      j[measures[m]] = a.mean;
      if (m < 4) j[std::string(measures[m]) + "_uncertainty"] = simulation::or_null(a.uncertainty);
    }
    j["averaged_over"] = span;
    j["steady"] = steady();
    j["levels_left"] = level_;
    constexpr std::array<const char*, 3> names{"u_max_at", "v_max_at", "w_max_at"};
    for (std::size_t a = 0; a < D; ++a) {
      auto place = nlohmann::ordered_json::array();
      for (const double x : peaks_[a].x) place.push_back(x / f.L);
      j[names[a]] = place;
    }
    j["mach"] = mach_;
    j["reynolds_effective"] = v_rms_ * f.L / p_.nu_eff;
    j["mean_density_drift"] = density_drift_;
    j["wall_crossings"] = crossings_;
    j["rayleigh"] = relaxation::rayleigh(f);
    j["prandtl"] = relaxation::prandtl(f);
    j["dissipation_number"] = p_.dissipation_number;
    // Where the flow is steady, friction takes the work of buoyancy.
    const double friction = j["viscous_heating"], work = j["buoyancy_work"];
    j["work_imbalance"] = friction > 0.0 ? (work - friction) / friction : 0.0;
    j["prandtl_effective"] = p_.nu_eff / f.kappa;
    if (p_.law.table) j["outside_viscosity_table"] = outside_;
    j["viscous_response"] = p_.relaxed ? "relaxed" : "instant";
    j["zeta"] = p_.slowing.zeta;
    j["xi"] = p_.slowing.xi;
    j["sound_speed_effective"] = p_.c_eff;
    j["target"] = p_.steady ? "steady" : "transient";
    const double top = j[measures[1]], bottom = j[measures[2]];
    const double through = 0.5 * (bottom + top), imbalance = through != 0.0 ? (bottom - top) / through : 0.0;
    j["heat_imbalance"] = imbalance;
    r.conservation = {{"mass", density_drift_}, {"momentum", momentum_}, {"energy", imbalance}};
    r.stages = world_.w.times.seconds();
  }

  std::string hash() override {
    const auto& s = world_.w.s;
    output::particle_group g{0, s.fluid, s.id.data(), {}};
    const auto add = [&](const particles::array& a) { g.columns.push_back({"", "", "", {a.data()}, false}); };
    for (const auto& a : s.x) add(a);
    for (const auto& a : s.v) add(a);
    add(s.T);
    add(pressure_of());
    for (std::size_t a = 0; a < D && p_.relaxed; ++a) add(relaxed_velocity(a));
    return output::state_hash(ranks().comm, {g});
  }

  output::table_view particles_table(std::vector<std::int64_t>& materials) override {
    return simulation::checkpoint_table(world_.w.s, materials);
  }
  // A checkpoint of another method has neither the rate of the step before nor what was extrapolated from.
  void read_particles(const output::table& t) override {
    lacks_rate_ = keeps_rate() && !t.reals.contains("EarlierRate_0_0");
    simulation::fluid_from_checkpoint(t, world_.w.s, [](std::string_view name) {
      return name.starts_with("EarlierRate_") || name.starts_with("Before_");
    });
  }
  void save(output::checkpoint_globals& g) const override {
    g.reals["v_max"] = v_max_;
    g.reals["faster"] = faster_;
    g.reals["v_rms"] = v_rms_;
    g.reals["outside"] = outside_;
    g.integers["level"] = level_;
    g.integers["has_before"] = has_before_ ? 1 : 0;
    g.integers["wall_crossings"] = crossings_;
    g.blobs["samples"] = samples_.flat();
  }
  void restore(const output::checkpoint_globals& g) override {
    lay(g.integers.at("level"));
    has_before_ = extrapolates() && g.integers.at("has_before") != 0;
    outside_ = g.reals.at("outside");
    v_max_ = g.reals.at("v_max");
    faster_ = g.reals.at("faster");
    crossings_ = g.integers.at("wall_crossings");
    samples_.restore(g.blobs.at("samples"));
    v_rms_ = g.reals.at("v_rms");
  }

 private:
  // Steadiness and averages are over so many turnovers, and a coarser level is steady to so many times the tolerance:
  // in six the flow has swung to rest (docs/theory/convection.md).
  static constexpr double turnovers = 6.0, coarser_tolerance = 10.0;
  // Fields of the operators: v, T, p, and z where the viscous response is relaxed.
  static constexpr std::size_t plain_fields = D + 2, most_fields = 2 * D + 2;
  static constexpr std::size_t S = operators::symmetric_terms(D), N = angular_terms;
  // The last three are of kappa DeltaT c_p/L² (W/kg): heat of friction, what rising takes, work of buoyancy, whether or
  // not they heat.
  static constexpr std::array<const char*, 14> measures{"nusselt_volume",
                                                        "nusselt_top",
                                                        "nusselt_bottom",
                                                        "v_rms",
                                                        "u_max",
                                                        "v_max",
                                                        "q1",
                                                        "q2",
                                                        "q3",
                                                        "q4",
                                                        "nusselt_dissipation",
                                                        "viscous_heating",
                                                        "adiabatic_cooling",
                                                        "buoyancy_work"};

  // Over the box: T v_y beyond conduction (K m/s), v² (m2/s2), and W/kg of friction, of rising and of buoyancy.
  struct box_means {
    double carried, v2, friction, cooling, work;
  };
  box_means means() {
    auto& s = world_.w.s;
    constexpr std::size_t products = 5;
    std::array<particles::array, products> product;
    for (auto& f : product) f.resize(s.total() + 1);
    const auto& p = pressure_of();
    foundation::for_all(s.fluid, [&](std::size_t i) { product[4][i] = dissipation(i, viscosity(i)); });
    world_.w.exchange_fluid({product[4].data()});
    foundation::for_all(world_.images.source.size(),
                        [&](std::size_t r) { product[4][s.first_wall() + r] = product[4][world_.images.source[r]]; });
    foundation::for_all(s.total(), [&](std::size_t i) {
      const double y = s.x[1][i], T = s.T[i], rising = s.v[1][i];
      product[0][i] = rising * (T - reference(y));
      product[1][i] = 0.0;
      for (std::size_t a = 0; a < D; ++a) product[1][i] += s.v[a][i] * s.v[a][i];
      product[2][i] = buoyancy(y, T, p[i]) * rising;
      product[3][i] = buoyancy_slope(y, T) * rising * T;
    });
    const auto mean = mean_over_box(world_, particles_, product);
    return {.carried = mean[0], .v2 = mean[1], .friction = mean[4], .cooling = mean[3], .work = mean[2]};
  }

  struct peak {
    double value = 0.0;  // m/s
    std::array<double, D> x{};
  };

  particles::array& pressure_of() { return world_.w.s.extras[pressure_].values; }
  const particles::array& pressure_of() const { return world_.w.s.extras[pressure_].values; }

  particles::array& relaxed_velocity(std::size_t a) { return world_.w.s.extras[z_ + a].values; }
  std::array<double*, most_fields> field_arrays() {
    auto& s = world_.w.s;
    std::array<double*, most_fields> f{};
    for (std::size_t a = 0; a < D; ++a) f[a] = s.v[a].data();
    f[D] = s.T.data();
    f[D + 1] = pressure_of().data();
    for (std::size_t a = 0; a < D && p_.relaxed; ++a) f[plain_fields + a] = relaxed_velocity(a).data();
    return f;
  }

  double reference(double y) const { return o_.temperature_bottom() - p_.fluid.dT * y / p_.fluid.L; }
  double buoyancy(double y, double T, double p) const {  // m/s2, upwards
    const auto& f = p_.fluid;
    if (p_.weighed) return p_.weighed->buoyancy(y, T, p, p_.compressibility);
    return f.alpha * f.g * (T - reference(y)) - f.g * p_.compressibility * p / f.K;
  }
  // ∂b/∂T, m/(s2 K): what rises cools by it, times T v_y/c_p.
  double buoyancy_slope(double y, double T) const {
    return p_.weighed ? p_.weighed->slope(y, T) : p_.fluid.alpha * p_.fluid.g;
  }

  void follow_viscosity() { follow(p_, world_.w.dx, nu_ / p_.fluid.nu); }

  bool isotropic() const { return D == 2 && varies(); }
  bool varies() const { return p_.law.varies; }
  double viscosity(double y, double T) const {  // m2/s
    return varies() ? nu_ * std::exp(reached_ * p_.law.log(T, y)) : nu_;
  }
  double viscosity(std::size_t i) const { return viscosity(world_.w.s.x[1][i], world_.w.s.T[i]); }
  // xi² at the particle.
  double inertia(double nu) const { return p_.steady ? nu / p_.nu_eff : p_.slowing.xi * p_.slowing.xi; }
  double stiffness(std::size_t i) const { return inertia(viscosity(i)); }
  // What the step is bound by, slowed. Where viscosity varies, compression is damped three times as strongly as shear.
  double largest_viscosity() {
    if (p_.steady) return (varies() ? 3.0 : 1.0) * p_.instant_share * p_.nu_eff;
    if (!varies()) return std::max(nu_, p_.fluid.nu) / (p_.slowing.xi * p_.slowing.xi);
    double nu = 0.0;
    for (std::size_t i = 0; i < world_.w.s.fluid; ++i) nu = std::max(nu, viscosity(i));
    return 3.0 * ranks().maximum(nu) / (p_.slowing.xi * p_.slowing.xi);
  }

  std::vector<particles::array*> scratch() {
    std::vector<particles::array*> all{&W_sum_, &viscous_stiffer_, &coupled_};
    for (std::size_t k = 0; k < fields_; ++k) {
      for (auto& component : gradient_[k]) all.push_back(&component);
      for (auto* group : {&laplacian_, &plain_, &noise_}) all.push_back(&(*group)[k]);
    }
    for (auto& a : next_B_) all.push_back(&a);
    for (auto* group : {&uneven_, &viscous_, &plain_viscous_, &log_slope_})
      for (auto& a : *group) all.push_back(&a);
    for (auto& a : next_angles_) all.push_back(&a);
    return all;
  }

  // Ghosts and images of the state; what the images lag behind is in their memory fields.
  void refresh_state() {
    auto& w = world_.w;
    auto& s = w.s;
    const foundation::stage timed(w.times, "halo");
    if (varies()) foundation::for_all(s.fluid, [&](std::size_t i) { set_viscosity(i, s.x[1][i]); });
    const auto fields = field_arrays();
    domain::exchange<D>(w.d.ranks, w.d.fluid_halo, std::span<double* const>(fields.data(), fields_), &s.x);
    images::move(world_.images, s);
    if (varies())
      foundation::for_all(s.fluid_ghosts, [&](std::size_t g) { set_viscosity(s.fluid + g, s.x[1][s.fluid + g]); });
    foundation::for_all(world_.images.source.size(), [&](std::size_t r) { mirror_state(r); });
  }

  void mirror_state(std::size_t r) {
    auto& s = world_.w.s;
    const auto& f = p_.fluid;
    const std::size_t i = s.first_wall() + r, j = world_.images.source[r];
    const auto fields = field_arrays();
    std::array<std::array<double, D>, 2> u{}, curvature{};  // of v, and of z
    std::array<std::array<double, D>, most_fields> gradient;
    const std::size_t flows = p_.relaxed ? 2 : 1;
    for (std::size_t n = 0; n < flows; ++n)
      for (std::size_t a = 0; a < D; ++a) {
        u[n][a] = fields[n * plain_fields + a][j];
        curvature[n][a] = s.extras[lap_ + n * plain_fields + a].values[j];
      }
    for (std::size_t k = 0; k < fields_; ++k)
      for (std::size_t a = 0; a < D; ++a) gradient[k][a] = s.extras[grad_ + k * D + a].values[j];
    double T = s.T[j], p = pressure_of()[j], y = s.x[1][j];
    images::for_each_mirror(world_.images, r, [&](const images::side<D>& wall) {
      const double d = wall.distance(s.x[wall.axis][j]), T_inside = T, y_inside = y;
      if (wall.axis == 1) y = 2.0 * wall.position - y;
      for (std::size_t k = 0; k < fields_; ++k) gradient[k][wall.axis] = -gradient[k][wall.axis];  // of even fields
      if (wall.thermal == images::heat::fixed_temperature) {
        T = 2.0 * wall.temperature - T;
        for (double& g : gradient[D]) g = -g;
      } else {
        T += 2.0 * d * wall.flux / conductivity();
        gradient[D][wall.axis] -= 2.0 * wall.flux / conductivity() * wall.inward;
      }
      double slope = 0.0;  // Pa/m, of p, inwards
      if (varies())        // the normal one goes on smoothly
        slope += f.rho * viscosity(y_inside, T_inside) * s.extras[stress_ + wall.axis].values[j] * wall.inward;
      if (wall.no_slip) slope += f.rho * viscosity(y_inside, T_inside) * curvature[flows - 1][wall.axis] * wall.inward;
      if (wall.axis == 1) slope += 0.5 * f.rho * wall.inward * (buoyancy(y_inside, T_inside, p) + buoyancy(y, T, p));
      p -= 2.0 * d * slope;
      gradient[D + 1][wall.axis] += 2.0 * slope * wall.inward;
      for (std::size_t n = 0; n < flows; ++n) {
        const auto gradient_of = gradient.begin() + static_cast<std::ptrdiff_t>(n * plain_fields);
        if (wall.no_slip)
          for (std::size_t a = 0; a < D; ++a) {
            u[n][a] = 2.0 * wall.velocity[a] - u[n][a] + d * d * curvature[n][a];
            for (double& g : gradient_of[a]) g = -g;
            gradient_of[a][wall.axis] -= 2.0 * d * wall.inward * curvature[n][a];
          }
        else {
          u[n][wall.axis] = -u[n][wall.axis];
          curvature[n][wall.axis] = -curvature[n][wall.axis];
          for (double& g : gradient_of[wall.axis]) g = -g;
        }
      }
    });
    for (std::size_t n = 0; n < flows; ++n)
      for (std::size_t a = 0; a < D; ++a) fields[n * plain_fields + a][i] = u[n][a];
    for (std::size_t k = 0; k < fields_; ++k)
      for (std::size_t a = 0; a < D; ++a) s.extras[grad_ + k * D + a].values[i] = gradient[k][a];
    s.T[i] = T;
    pressure_of()[i] = p;
    if (!varies()) return;
    set_viscosity(i, y);
    s.extras[own_viscosity_].values[i] = s.extras[own_viscosity_].values[j];
  }
  void set_viscosity(std::size_t i, double y) {
    auto& s = world_.w.s;
    const double nu = viscosity(y, s.T[i]);
    s.extras[own_viscosity_].values[i] = nu;
    s.extras[root_].values[i] = std::sqrt(nu);
  }

  // Ghosts and images of the plain Laplacians: odd where their field is, but for a velocity that does not slip, whose
  // curvature goes on smoothly; and the ghosts' gradients of pressure.
  void refresh_memory() {
    auto& w = world_.w;
    auto& s = w.s;
    const foundation::stage timed(w.times, "halo");
    std::vector<double*> fields;
    for (std::size_t k = 0; k < fields_; ++k) fields.push_back(s.extras[lap_ + k].values.data());
    for (std::size_t k = 0; k < fields_ * D; ++k) fields.push_back(s.extras[grad_ + k].values.data());
    for (std::size_t a = 0; a < D; ++a) fields.push_back(s.extras[stress_ + a].values.data());
    for (std::size_t k = 0; k < D + N + 1 && isotropic(); ++k) fields.push_back(s.extras[force_ + k].values.data());
    domain::exchange<D>(w.d.ranks, w.d.fluid_halo, std::span<double* const>(fields));
    foundation::for_all(world_.images.source.size(), [&](std::size_t r) {
      const std::size_t i = s.first_wall() + r, j = world_.images.source[r];
      std::array<double, most_fields> sign;
      sign.fill(1.0);
      images::for_each_mirror(world_.images, r, [&](const images::side<D>& wall) {
        if (!wall.no_slip)
          for (const std::size_t first : {std::size_t{0}, plain_fields})
            sign[first + wall.axis] = -sign[first + wall.axis];
        if (wall.thermal == images::heat::fixed_temperature) sign[D] = -sign[D];
      });
      for (std::size_t k = 0; k < fields_; ++k) s.extras[lap_ + k].values[i] = sign[k] * s.extras[lap_ + k].values[j];
      if (isotropic()) mirror_viscous_memory(r);
    });
  }

  // The viscous force along a wall is even. Across one that lets slip it goes on smoothly through its value there, ν
  // ∇ln ν times the rate of strain; where there is no slip it is taken as even.
  void mirror_viscous_memory(std::size_t r) {
    auto& s = world_.w.s;
    const std::size_t i = s.first_wall() + r, j = world_.images.source[r];
    const double nu = s.extras[angles_ + N].values[j];
    for (std::size_t a = 0; a < D; ++a) s.extras[force_ + a].values[i] = s.extras[force_ + a].values[j];
    for (std::size_t k = 0; k < N; ++k) s.extras[angles_ + k].values[i] = s.extras[angles_ + k].values[j];
    images::for_each_mirror(world_.images, r, [&](const images::side<D>& wall) {
      if (!wall.no_slip) {
        double& across = s.extras[force_ + wall.axis].values[i];
        across = 2.0 * nu * s.extras[stress_ + wall.axis].values[j] - across;
      }
      if constexpr (D == 2)
        for (const std::size_t sine : {1, 3}) {
          double& odd = s.extras[angles_ + sine].values[i];
          odd = -odd;
        }
    });
  }

  void sum_over_neighbours() {
    const foundation::stage timed(world_.w.times, "sums");
    whole_ ? sum_consistently<true>() : sum_consistently<false>();
  }
  // whole: with what is kept for the step, which the stages after the first do not need. The spreading is that of the
  // first.
  template <bool whole>
  void sum_consistently() {
    if (varies())
      sum_consistently<plain_fields, whole, true>();
    else if (p_.relaxed)
      sum_consistently<most_fields, whole, false>();
    else
      sum_consistently<plain_fields, whole, false>();
  }
  template <int K, bool whole, bool graded>
  void sum_consistently() {
    auto& w = world_.w;
    auto& s = w.s;
    bool singular = false;
    // Laplacians of T, and of the velocity whose viscous force is no sum of its own.
    constexpr unsigned first = K == most_fields ? plain_fields : 0, velocity = (1U << D) - 1U;
    constexpr unsigned wanted = 1U << D | (graded ? 0U : velocity << first);
    operators::consistent<D, K, whole, wanted> derivatives{{}, {}, {}, volume_, beta_, {}, &singular};
    const auto fields = field_arrays();
    for (std::size_t k = 0; k < K; ++k) {
      derivatives.f[k] = fields[k];
      derivatives.P[k] = s.extras[lap_ + k].values.data();
      for (std::size_t a = 0; a < D; ++a) derivatives.out.gradient[k][a] = gradient_[k][a].data();
      derivatives.out.laplacian[k] = laplacian_[k].data();
      derivatives.out.plain[k] = plain_[k].data();
    }
    for (std::size_t k = 0; k < S; ++k) {
      derivatives.B[k] = s.extras[tensor_ + k].values.data();
      derivatives.out.next_B[k] = next_B_[k].data();
    }
    unevenness<D> uneven{volume_, W_self_, per_W_dx_, {}, W_sum_.data()};
    for (std::size_t a = 0; a < D; ++a) uneven.out[a] = uneven_[a].data();
    noise<D, K, graded> smooth{{}, volume_, {}};
    for (std::size_t k = 0; k < K; ++k) smooth.out[k] = noise_[k].data();
    for (std::size_t k = 0; k < K * D; ++k) smooth.gradients[k] = s.extras[grad_ + k].values.data();
    const auto sum = [&](const auto&... more) {
      if constexpr (whole && graded)
        w.sum(w.fluid(), derivatives, smooth, uneven, more...,
              contrast{s.extras[root_].values.data(), s.extras[own_viscosity_].values.data(), viscous_stiffer_.data(),
                       coupled_.data()});
      else if constexpr (whole)
        w.sum(w.fluid(), derivatives, smooth, uneven, more...);
      else
        w.sum(w.fluid(), derivatives, smooth, more...);
    };
    if constexpr (graded) {
      graded_viscosity<D> viscous{};
      viscous.root = s.extras[root_].values.data();
      for (std::size_t a = 0; a < D; ++a) {
        viscous.out[a] = viscous_[a].data();
        viscous.slope[a] = log_slope_[a].data();
        for (std::size_t b = 0; b < D; ++b) viscous.gradient[a][b] = gradient_[a][b].data();
      }
      if constexpr (viscous.isotropic) {
        viscous.beta = beta_ * (D + 2.0) / (D + 4.0);
        for (std::size_t a = 0; a < D; ++a) {
          viscous.force[a] = s.extras[force_ + a].values.data();
          viscous.plain[a] = plain_viscous_[a].data();
        }
        for (std::size_t k = 0; k < N; ++k) {
          viscous.angular[k] = s.extras[angles_ + k].values.data();
          viscous.next_angular[k] = next_angles_[k].data();
        }
      }
      sum(viscous);
    } else {
      sum();
    }
    if (singular) w.first_fault.report(0, "particles lie so that a gradient is not determined; the flow has blown up");
  }
  // (G(v) + G(v)ᵀ - D(v))·∇ln ν, 1/(m s). With ∇²v it is the divergence of 2 ν (e - ½ ∇·v) over ν, e the rate of
  // strain: a stress that takes energy from compression too (in 2-D), where that of ∇·v = 0 alone would feed it.
  std::array<double, D> graded_stress(std::size_t i) const {
    std::array<double, D> stress{};
    if (!varies()) return stress;
    for (std::size_t a = 0; a < D; ++a)
      for (std::size_t b = 0; b < D; ++b)
        stress[a] +=
            (gradient_[a][b][i] + gradient_[b][a][i]) * log_slope_[b][i] - gradient_[b][b][i] * log_slope_[a][i];
    return stress;
  }

  void combine(std::span<double* const> rate) {
    auto& w = world_.w;
    auto& s = w.s;
    const auto& f = p_.fluid;
    const auto& c = o_.convection;
    const foundation::stage timed(w.times, "rates");
    const double a_inertia = p_.steady ? 1.0 : 0.0, e_pressure = 1.0;
    const double spread = c.shifting * h_ * v_max_, most = 0.5 * v_max_;
    const double smoothing = *c.pressure_diffusion * h_ * p_.c_eff;
    const double heating = c.heating * f.kappa / conductivity() * f.rho;
    const auto& p = pressure_of();
    const bool graded = varies();
    const std::size_t z = p_.relaxed ? plain_fields : 0;  // the velocity of the viscous force
    const double theta = p_.instant_share, per_lambda = p_.relaxed ? 1.0 / p_.relaxation_time : 0.0;
    const bool follows_pressure = p_.weighed && c.adiabatic_heating;  // c_p, gravity_density.hpp
    bool finite = true;
    double displacing = 0.0;  // m2/s2
#pragma omp parallel for schedule(static) reduction(&& : finite) reduction(max : displacing) if (s.fluid > foundation::rows_worth_threads)
    for (std::size_t i = 0; i < s.fluid; ++i) {
      std::array<double, D> w_i, v_i, moving_v, moving_p;
      double w2 = 0.0;
      for (std::size_t a = 0; a < D; ++a) {
        v_i[a] = s.v[a][i];
        w_i[a] = -spread * uneven_[a][i];
        w2 += w_i[a] * w_i[a];
      }
      const double cut = w2 > most * most ? most / std::sqrt(w2) : 1.0;
      const double remap = c.remap_diffusion * h_ * cut * std::sqrt(w2);
      for (std::size_t a = 0; a < D; ++a) {
        w_i[a] *= cut;
        moving_v[a] = w_i[a] + a_inertia * v_i[a];
        moving_p[a] = w_i[a] + e_pressure * v_i[a];
      }
      const double nu = viscosity(i), xi2 = inertia(nu), per_xi2 = 1.0 / xi2;
      double moving2 = 0.0, divergence = 0.0, dp = smoothing * noise_[D + 1][i];
      double dT = f.kappa * laplacian_[D][i] + heating + remap * noise_[D][i];
      for (std::size_t a = 0; a < D; ++a) {
        double advected = 0.0;
        for (std::size_t b = 0; b < D; ++b) advected += moving_v[b] * gradient_[a][b][i];
        double force = nu * (graded ? viscous_[a][i] : laplacian_[z + a][i]) - gradient_[D + 1][a][i] / f.rho;
        if (a == 1) force += buoyancy(s.x[1][i], s.T[i], p[i]);
        rate[a][i] = v_i[a] + w_i[a];
        moving2 += rate[a][i] * rate[a][i];
        rate[D + a][i] = per_xi2 * force + advected + remap * noise_[a][i];
        if (p_.relaxed) {
          const double z_a = s.extras[z_ + a].values[i];
          double carried = 0.0;
          for (std::size_t b = 0; b < D; ++b) carried += moving_v[b] * gradient_[z + a][b][i];
          rate[D + z + a][i] =
              theta * per_xi2 * force + (v_i[a] - z_a) * per_lambda + carried + remap * noise_[z + a][i];
        }
        divergence += gradient_[a][a][i];
        dT += w_i[a] * gradient_[D][a][i];
        dp += moving_p[a] * gradient_[D + 1][a][i];
        finite = finite && std::isfinite(rate[D + a][i]);
      }
      displacing = std::max(displacing, moving2);
      const double per_c_p = 1.0 / heat_capacity();
      double released = 0.0;  // W/kg
      if (c.viscous_heating) released += dissipation(i, nu);
      if (c.adiabatic_heating) released -= buoyancy_slope(s.x[1][i], s.T[i]) * v_i[1] * s.T[i];
      if (follows_pressure)
        dT += (f.kappa * laplacian_[D][i] + heating + released * per_c_p) *
                  (heat_capacity() / (heat_capacity() + p_.weighed->heat_capacity_change(s.x[1][i], s.T[i]))) -
              f.kappa * laplacian_[D][i] - heating;
      else
        dT += released * per_c_p;
      rate[2 * D][i] = dT;
      rate[2 * D + 1][i] = dp - f.rho * p_.c_eff * p_.c_eff * xi2 * divergence;
      finite = finite && std::isfinite(rate[2 * D][i]) && std::isfinite(rate[2 * D + 1][i]);
    }
    displacing_ = std::sqrt(displacing);
    if (finite) return;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      bool good = true;
      for (const double* r : rate) good = good && std::isfinite(r[i]);
      if (!good) w.first_fault.report(s.id[i], what_failed(i));
    }
  }

  double heat_capacity() const { return o_.physics.material.heat_capacity; }
  double dissipation(std::size_t i, double nu) const {  // 2 ν e:e, W/kg
    double sum = 0.0;
    for (std::size_t a = 0; a < D; ++a)
      for (std::size_t b = 0; b < D; ++b) {
        const double shear = gradient_[a][b][i] + gradient_[b][a][i];
        sum += 0.5 * nu * shear * shear;
      }
    return sum;
  }

  // In a closed box the mean divergence is zero: what the operators leave of it would let the mean pressure, which
  // nothing feels, grow without bound.
  void keep_mean_pressure(double* dp) {
    const std::size_t n = world_.w.s.fluid;
    foundation::exact_sum sum;
    for (std::size_t i = 0; i < n; ++i) sum.add(dp[i]);
    const double mean = ranks().exact(sum) / static_cast<double>(world_.fluid_total);
    for (std::size_t i = 0; i < n; ++i) dp[i] -= mean;
  }

  std::string what_failed(std::size_t i) const {
    const auto& s = world_.w.s;
    return "a rate is not finite at particle " + std::to_string(s.id[i]) + ", T = " + std::to_string(s.T[i]) +
           " K; the time step may be too large";
  }

  double conductivity() const { return o_.physics.material.conductivity; }

  // The lattice of a level, at rest, without temperature, and all that goes with its spacing.
  void lay(std::int64_t level) {
    level_ = level;
    const auto& d = o_.physics.domain;
    const auto& kernel = o_.march.kernel;
    auto& s = world_.w.s;
    particles_ = particles_of_level(o_, level);
    const double dx = d.length[1] / static_cast<double>(particles_[1]);
    world_.w.dx = dx;
    follow_viscosity();
    images::set_up(world_, domain::communicator::world(), {d.length, particles_, d.periodic, o_.ranks_x}, o_.walls,
                   kernel.name, kernel.h_over_dx, kernel.skin, 0.0, fit_radius * dx);
    for (auto& extra : s.extras) std::fill(extra.values.begin(), extra.values.end(), 0.0);
    has_before_ = false;
    for (std::size_t a = 0, k = 0; a < D; ++a)
      for (std::size_t b = a; b < D; ++b, ++k)
        std::fill_n(s.extras[tensor_ + k].values.begin(), s.fluid, a == b ? 1.0 : 0.0);
    volume_ = std::pow(dx, D);
    beta_ = operators::lattice_beta<D>(world_.w.kernel, dx);
    h_ = kernel.h_over_dx * dx;
    std::visit(
        [&](const auto& k) {
          W_self_ = k.self();
          per_W_dx_ = 1.0 / k.value(dx);
        },
        world_.w.kernel);
  }

  void interpolate_to_next_level() {
    auto& s = world_.w.s;
    // Ghosts and images are those of the state, but T is taken beyond its reference.
    particles::array excess(s.total());
    for (std::size_t i = 0; i < s.total(); ++i) excess[i] = s.T[i] - reference(s.x[1][i]);
    std::array<const double*, most_fields> f;
    std::ranges::copy(field_arrays(), f.begin());
    f[D] = excess.data();
    for (std::size_t a = 0; a < D && !p_.relaxed; ++a) f[plain_fields + a] = f[a];  // not used
    const interpolation<D> at(s, world_.w.support());
    // Each rank where its particles stood; rebuild() hands them on where the finer cells differ.
    std::vector<std::int64_t> ids;
    std::vector<std::array<double, D>> places;
    std::vector<std::array<double, most_fields>> values;
    for_each_place(world_, particles_of_level(o_, level_ - 1), 0.5 * world_.w.dx,
                   [&](std::int64_t id, const std::array<double, D>& x) {
                     ids.push_back(id);
                     places.push_back(x);
                     values.emplace_back();
                     if (const auto found = at(x, f))
                       values.back() = *found;
                     else
                       world_.w.first_fault.report(id, "too few particles are near a place of the finer lattice");
                   });
    world_.w.agree();
    lay(level_ - 1);
    particles::allocate(s, ids.size(), 0, 0, 0);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      s.id[i] = ids[i];
      s.material[i] = 0;
      for (std::size_t a = 0; a < D; ++a) {
        s.x[a][i] = places[i][a];
        s.v[a][i] = values[i][a];
      }
      s.T[i] = reference(places[i][1]) + values[i][D];
      pressure_of()[i] = values[i][D + 1];
      for (std::size_t a = 0; a < D && p_.relaxed; ++a) relaxed_velocity(a)[i] = values[i][plain_fields + a];
    }
    // In a closed box the pressure's mean stays what it was, zero.
    foundation::exact_sum sum;
    auto& p = pressure_of();
    for (std::size_t i = 0; i < s.fluid; ++i) sum.add(p[i]);
    const double mean = ranks().exact(sum) / static_cast<double>(world_.fluid_total);
    for (std::size_t i = 0; i < s.fluid; ++i) p[i] -= mean;
  }

  bool settled(double tolerance) const {
    if (samples_.size() == 0 || samples_.last_time() < p_.ramp + window()) return false;
    for (const std::size_t m : {std::size_t{0}, std::size_t{3}})
      if (!samples_.settled(m, window(), tolerance)) return false;
    return true;
  }

  // Averages are over some turnovers, and at least a hundredth of the diffusion time.
  double window() const {
    const auto& f = p_.fluid;
    const double turnover = v_rms_ > 0.0 ? f.L / v_rms_ : f.L * f.L / f.kappa;
    return std::max(turnovers * turnover, 0.01 * f.L * f.L / f.kappa);
  }

  // Of all ranks' peaks the largest; of equal ones the one lowest in x, then y.
  void agree_on_peak(peak& mine) const {
    const double largest = ranks().maximum(mine.value);
    bool candidate = mine.value == largest;
    mine.value = largest;
    for (std::size_t b = 0; b < D; ++b) {
      const double x = ranks().minimum(candidate ? mine.x[b] : std::numeric_limits<double>::infinity());
      candidate = candidate && mine.x[b] == x;
      mine.x[b] = x;
    }
  }

  const options& o_;
  parameters p_;            // of the present level
  std::size_t fields_;      // of the operators
  std::int64_t level_ = 0;  // so many finer ones come
  std::array<std::int64_t, 3> particles_{};
  images::scene<D> world_;
  std::size_t pressure_ = 0, z_ = 0, lap_ = 0, grad_ = 0, root_ = 0, own_viscosity_ = 0, stress_ = 0, tensor_ = 0,
              force_ = 0, angles_ = 0, before_ = 0,
              earlier_ = 0;  // first of each in the extras
  double volume_ = 0.0, beta_ = 0.0, h_ = 0.0, W_self_ = 0.0, per_W_dx_ = 0.0;

  std::array<std::array<particles::array, D>, most_fields> gradient_;
  std::array<particles::array, most_fields> laplacian_, plain_, noise_;
  std::array<particles::array, S> next_B_;
  std::array<particles::array, D> uneven_, viscous_, plain_viscous_, log_slope_;
  std::array<particles::array, N> next_angles_;
  particles::array W_sum_, viscous_stiffer_, coupled_;
  double viscous_contrast_ = 1.0, sound_contrast_ = 1.0;  // of the start of the step, contrast.hpp

  double reached_ = 1.0;     // of the viscosity's exponents and of the way to it
  double nu_ = p_.fluid.nu;  // m2/s, without the exponents
  bool has_before_ = false;  // memory of the step before, to extrapolate from
  bool lacks_rate_ = false;  // of the step before: 'ab2' starts anew
  bool whole_ = true;        // the next evaluation is one that is kept
  double v_max_ = 0.0;       // m/s, at the start of the step
  double displacing_ = 0.0;  // m/s, the largest speed of a particle with its spreading
  double faster_ = 1.5;      // the ratio of the two
  std::int64_t crossings_ = 0;
  record samples_;
  std::array<peak, D> peaks_{};
  double v_rms_ = 0.0, mach_ = 0.0, density_drift_ = 0.0, momentum_ = 0.0;
  double outside_ = 0.0;  // the largest share of particles that the viscosity's table did not cover
};

}  // namespace tetsuame::boussinesq
