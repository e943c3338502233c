// Thermal convection as the time loop asks for it. state.hpp: what there is; mirror.hpp: walls; pass.hpp: sums;
// start.hpp: the start; rates.hpp: the equations; evaluation.hpp: these in order; step.hpp: what lags behind;
// levels.hpp: coarser lattices before; history.hpp: measures.
#pragma once

#include <fmt/format.h>

#include <convection/evaluation.hpp>
#include <convection/history.hpp>
#include <convection/levels.hpp>
#include <convection/start.hpp>
#include <convection/step.hpp>
#include <output/groups.hpp>
#include <run/particle_simulation.hpp>

namespace tetsuame::convection {

template <int D>
class problem : public run::particle_simulation<D> {
 public:
  using base = run::particle_simulation<D>;
  using base::ranks;

  problem(const options& o, const parameters& p) : base(state_.world, o.common), state_(o, p) {
    this->about = state_.layer.lines;
    convection::declare(state_, evaluation_, [this] { return base::evaluating().may_commit; });
  }

  std::vector<integrators::field> fields() override { return evaluation_.fields(); }
  void sum_rates(std::span<double* const> rate) override { evaluation_.run(rate); }
  // In a closed box the mean divergence is zero: what the operators leave of it would let the mean pressure, which
  // nothing feels, grow without bound.
  void complete_rates(std::span<double* const> rate) override { remove_mean(state_, rate[D + unknown<D>::p]); }

  integrators::step_limit largest_step() override {
    const auto& layer = state_.layer;
    const auto& time = state_.input.common.time;
    const double dx = state_.world.w.dx, fastest = std::max(largest_viscosity(state_), layer.fluid.kappa);
    const double sound = *time.cfl * dx / std::hypot(layer.c_eff, layer.shear_speed);
    const double diffusion = *time.diffusive * dx * dx / fastest;
    const auto stiff =
        sound < diffusion ? integrators::step_limit{sound, "sound"} : integrators::step_limit{diffusion, "diffusion"};
    constexpr double most = 0.1;  // spacings that a wall may go in a step
    return layer.lid * stiff.dt > most * dx ? integrators::step_limit{most * dx / layer.lid, "walls"} : stiff;
  }
  // Euler's steps make a wave of frequency c k grow by c² k² dt/2, against which stand the friction ν k²/2 and the
  // pressure's diffusion P h c β k⁴/2 (of the noise Q on the start lattice, pass.hpp): the fastest grows by
  // (c² dt - ν)²/(8 P h c β). A flow stirs waves all the time, and some e-foldings later it is lost in them.
  std::string warning_of_step(double dt) override {
    constexpr double many = 8.0;  // e-foldings: air at Ra 1e6 blows up after 10 to 14, with 16 to 100 particles a side
    const auto& layer = state_.layer;
    const auto& o = state_.input;
    if (o.common.time.method != "euler" || layer.law.varies) return {};
    const double c = layer.c_eff, xi = layer.slowing.xi;
    const double nu = layer.steady ? layer.instant_share * layer.nu_eff : layer.nu / (xi * xi);
    const double left = c * c * dt - nu, of_pressure = *o.convection.pressure_diffusion * state_.at_start.h * c;
    if (!(left > 0.0 && of_pressure > 0.0)) return {};
    const auto& time = o.common.time;
    const double growth = left * left / (8.0 * of_pressure * state_.at_start.beta),
                 end = time.t_end ? *time.t_end : static_cast<double>(time.steps) * dt;
    if (!(growth * end > many)) return {};
    return fmt::format(
        "with Euler's steps of {:.3g} s sound grows by a factor of e in {:.3g} s, {:.2g} times until {:.4g} s: the "
        "flow may blow up on the way; with time.method = 'ab2' it does not grow",
        dt, 1.0 / growth, growth * end, end);
  }
  double diffusion_radius() override {
    const double dx = state_.world.w.dx, fastest = state_.start.viscous_contrast * largest_viscosity(state_);
    return 4.0 * D * std::max(fastest, state_.layer.fluid.kappa) / (dx * dx);
  }
  // The fixed step of 'rk4' is bound by what lags behind; to its limit of stability there are factors of 2.7 (damping)
  // and 3.8 (sound) with one viscosity, found from the eigenvalues of the rates.
  double longest_step() override {
    const double viscous = state_.start.viscous_contrast, sound = state_.start.sound_contrast;
    const bool rk4 = state_.input.common.time.method == "rk4";
    const double margin = rk4                          ? std::hypot(viscous / 2.7, sound / 3.8)
                          : extrapolates(state_.input) ? sound
                                                       : std::max(viscous, sound);
    return margin > 1.0 ? largest_step().dt / margin : std::numeric_limits<double>::infinity();
  }

  void commit_lagged() override { begin_step(state_); }
  bool needs_lagged() const override { return state_.before || lacks_rate_; }
  // The viscosity at time t; slowed sound may follow it.
  bool set_time(double t) override {
    auto& layer = state_.layer;
    const double before = layer.reached;
    layer.reached = layer.ramp > 0.0 ? std::min(1.0, t / layer.ramp) : 1.0;
    layer.nu = layer.fluid.nu * std::pow(layer.start, 1.0 - layer.reached);
    follow(layer, state_.world.w.dx);
    return layer.reached != before;
  }
  bool complete_step(std::int64_t step) override {
    lacks_rate_ = false;
    return base::complete_step(step);
  }

  // Of the particles, which are shifted as well: as at the start of the last step in proportion.
  run::apart speed() override {
    run::apart all = base::speed();
    for (double& of_the_flow : all.numbers) of_the_flow *= state_.start.faster;
    return all;
  }

  // ---- measures ---------------------------------------------------------------------------

  std::vector<output::history_column> measured_columns() const override { return history_columns(measured_); }
  std::vector<double> measure(double t) override { return convection::measure(state_, t, measured_); }
  bool steady() const override {
    const double tolerance = state_.input.convection.steady_tolerance;
    return state_.at_start.level == 0 && tolerance > 0.0 && settled(state_, measured_, tolerance);
  }
  std::string refine_particles(double) override {
    const double tolerance = coarser_tolerance * state_.input.convection.steady_tolerance;
    if (state_.at_start.level == 0 || !settled(state_, measured_, tolerance)) return {};
    go_to_next_level(state_);
    measured_.samples = record(measured_.names.size());
    return "half the particle spacing";
  }

  std::vector<output::particle_group> particle_groups(std::vector<particles::array>& extra) override {
    const auto& s = state_.fluid();
    auto g = output::group_of(s, 0, 0, s.fluid);
    const auto add = [&](const char* name, const double* values) { output::add_quantity(g, name, {values}); };
    const auto make = [&](auto&& value) { return output::make_array(extra, s.fluid, value); };
    const double rho = state_.layer.fluid.rho;
    add("Masses", make([&](auto i) { return rho / state_.last.W[i]; }));
    add("Density", make([&](auto) { return rho; }));
    add("Pressure", state_.p.data());
    add("Temperature", s.T.data());
    add("SmoothingLength", make([&](auto) { return state_.input.common.kernel.h_over_dx * state_.world.w.dx; }));
    add("Material", make([](auto) { return 0.0; }));
    add("Viscosity", make([&](auto i) { return state_.viscosity(i) * rho; }));
    add("Volume", make([&](auto i) { return 1.0 / state_.last.W[i]; }));
    return {g};
  }

  void report_results(double, run::summary& r) override { convection::report(state_, measured_, steady(), r); }

  // ---- checkpoints ------------------------------------------------------------------------

  // A checkpoint of another method has neither the rate of the step before nor what was extrapolated from.
  void read_particles(const output::table& t) override {
    lacks_rate_ = keeps_rate(state_.input) && !t.reals.contains("EarlierRate_0_0");
    run::fluid_from_checkpoint(t, state_.fluid(), [](std::string_view name) {
      return name.starts_with("EarlierRate_") || name.starts_with("Before");
    });
  }
  void save_globals(output::checkpoint_globals& g) const override {
    g.reals["v_max"] = state_.start.v_max;
    g.reals["faster"] = state_.start.faster;
    for (auto last = measured_; const auto& [name, value] : last.scalars()) g.reals[name] = *value;
    g.integers["level"] = state_.at_start.level;
    g.integers["has_before"] = state_.has_before ? 1 : 0;
    base::save_globals(g);
    g.blobs["samples"] = measured_.samples.flat();
  }
  void restore_globals(const output::checkpoint_globals& g) override {
    lay(state_, g.integers.at("level"));
    state_.has_before = state_.before && g.integers.at("has_before") != 0;
    state_.start.v_max = g.reals.at("v_max");
    state_.start.faster = g.reals.at("faster");
    for (const auto& [name, value] : measured_.scalars()) *value = g.reals.at(name);
    measured_.samples.restore(g.blobs.at("samples"));
    base::restore_globals(g);
    if (state_.at_start.level == 0) share_volume(state_);
  }

 protected:
  void make_lists(bool as_they_were) override {
    run::rebuild(state_.world, as_they_were);
    refresh_lagged_terms(state_);
  }

 private:
  convection_state<D> state_;
  passes::evaluation<D> evaluation_{state_.world};
  measured measured_{measures_of(state_)};
  bool lacks_rate_ = false;  // of the step before: 'ab2' starts anew
};

}  // namespace tetsuame::convection
