// Gas with contacts and shocks, by one of the schemes of module schemes, as a problem of the time loop. Integrated: x,
// v, u, and α where it depends on time or ρ where it follows from continuity. Supports stay during a step; from one to
// the next they take a step of Newton's method (schemes/common.hpp). What a scheme conserves it does whatever h and f
// are, so they need not be converged.
#pragma once

#include <bit>
#include <gas/convergence.hpp>
#include <gas/evaluation.hpp>
#include <gas/lists.hpp>
#include <gas/start.hpp>
#include <output/groups.hpp>
#include <run/particle_simulation.hpp>

namespace tetsuame::gas {

// ---- what is told of the state -------------------------------------------------------------

// Of all ranks' particles: kg, J, and kg m/s.
template <int D>
struct totals {
  double mass, kinetic, internal, potential, momentum_scale;
  std::array<double, D> momentum;
  std::array<double, 3> angular_momentum;  // kg m²/s, about the origin of the box
  double energy() const { return kinetic + internal + potential; }
  double scale() const { return kinetic + std::abs(internal) + std::abs(potential); }  // of bodies at rest and cold too
};

template <int D>
totals<D> sum_up(const world<D>& g) {
  const auto& s = g.w.s;
  foundation::exact_sum mass, kinetic, internal, potential, scale;
  std::array<foundation::exact_sum, D> momentum;
  std::array<foundation::exact_sum, 3> angular;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    double v2 = 0.0;
    const double m = g.inertia_of(i) * s.m[i];
    for (std::size_t a = 0; a < D; ++a) {
      v2 += s.v[a][i] * s.v[a][i];
      momentum[a].add(m * s.v[a][i]);
    }
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
      if (b < D && c < D) angular[a].add(m * (s.x[b][i] * s.v[c][i] - s.x[c][i] * s.v[b][i]));
    }
    mass.add(s.m[i]);
    kinetic.add(0.5 * m * v2);
    internal.add(s.m[i] * s.u[i]);
    if constexpr (D > 1)
      potential.add(s.m[i] * (g.attraction ? 0.5 * g.attraction->potential()[i] : g.o.shock.gravity * s.x[1][i]));
    scale.add(s.m[i] * (std::sqrt(v2) + g.sound_speed(i)));
  }
  const auto& ranks = g.ranks();
  totals<D> t{ranks.exact(mass),
              ranks.exact(kinetic),
              ranks.exact(internal),
              ranks.exact(potential),
              ranks.exact(scale),
              {},
              {}};
  for (std::size_t a = 0; a < D; ++a) t.momentum[a] = ranks.exact(momentum[a]);
  for (std::size_t a = 0; a < 3; ++a) t.angular_momentum[a] = ranks.exact(angular[a]);
  return t;
}

// Largest change of a component that is kept, over the sum of m (|v| + c).
template <int D>
double momentum_change(const world<D>& g, const totals<D>& now, const totals<D>& first) {
  double momentum = 0.0;
  for (std::size_t a = 0; a < D; ++a)
    if (a != 1 || g.o.shock.gravity == 0.0)
      momentum = std::max(momentum, std::abs(now.momentum[a] - first.momentum[a]) / now.momentum_scale);
  return momentum;
}

template <int D>
double shortest_diffusion(const world<D>& g) {  // s, of this rank
  constexpr double any = std::numeric_limits<double>::infinity();
  const auto& m = g.molecular;
  const double all = std::max(m.largest(D), m.conducts() ? m.heat_conductivity / *g.o.shock.heat_capacity : 0.0);
  return foundation::smallest_of(g.w.s.fluid, any, [&](std::size_t i) {
    const double spacing = g.S[i] / g.support_over_dx;
    double most = all;
    // The harmonic mean of a pair is at most twice the viscosity of either end.
    if (g.viscosities_differ) most *= std::min(2.0 * g.w.s.eta[i] / m.viscosity, 1.0);
    return spacing * spacing * g.w.s.rho[i] * g.inertia_of(i) / most;
  });
}

template <int D>
double largest_density(const world<D>& g) {
  double densest = 0.0;
  for (std::size_t i = 0; i < g.w.s.fluid; ++i) densest = std::max(densest, g.told_density()[i]);
  return g.ranks().maximum(densest);
}

template <int D>
view particles_seen(const world<D>& g) {
  const auto& s = g.w.s;
  view seen{
      g.ranks(),         s.fluid,    {}, {}, s.m.data(), g.told_density().data(), s.p.data(), g.number_volume.data(),
      s.material.data(), s.id.data()};
  if (g.melts) seen.melt = g.melt.data();
  if (g.dissolved) seen.concentration = g.concentration.data(), seen.partition = g.partition.data();
  for (std::size_t a = 0; a < D; ++a) {
    seen.x[a] = s.x[a].data();
    seen.v[a] = s.v[a].data();
  }
  return seen;
}

// Means of |value - exact| over the volume of the particles measured; null where there are none.
template <int D>
nlohmann::ordered_json errors(const world<D>& g, double t) {
  const auto& s = g.w.s;
  foundation::exact_sum volume, rho, v, p;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const point x = g.place(i);
    if (g.test.measured && !g.test.measured(x, t)) continue;
    const state right = g.test.exact(x, t);
    double dv2 = 0.0;
    for (std::size_t a = 0; a < D; ++a) dv2 += (s.v[a][i] - right.v[a]) * (s.v[a][i] - right.v[a]);
    const double V = g.number_volume[i];
    volume.add(V);
    rho.add(V * std::abs(g.told_density()[i] - right.rho));
    v.add(V * std::sqrt(dv2));
    p.add(V * std::abs(s.p[i] - right.p));
  }
  const double all = g.ranks().exact(volume);
  const auto mean = [&](const foundation::exact_sum& sum) {
    const double of_all = g.ranks().exact(sum);
    return run::or_null(all != 0.0 ? std::optional(of_all / all) : std::nullopt);
  };
  return {{"density_l1", mean(rho)}, {"velocity_l1", mean(v)}, {"pressure_l1", mean(p)}};
}

// extra: what is made for the snapshot
template <int D>
output::particle_group snapshot(world<D>& g, double t, std::vector<particles::array>& extra) {
  const auto& s = g.w.s;
  auto group = output::group_of(s, 0, 0, s.fluid);
  const auto add = [&](const char* name, const double* values) { output::add_quantity(group, name, {values}); };
  const auto make = [&](auto&& value) { return output::make_array(extra, s.fluid, value); };
  add("Masses", s.m.data());
  add("Density", g.told_density().data());
  add("Pressure", s.p.data());
  add("Temperature", g.any_eos || g.molecular.conducts() ? s.T.data() : make([](auto) { return 0.0; }));
  add("SmoothingLength", make([&](auto i) { return g.S[i] / g.support_over_h; }));
  add("Material", make([&](auto i) { return s.material[i]; }));
  add("InternalEnergy", s.u.data());
  if constexpr (D > 1)
    if (g.attraction) add("GravitationalPotential", g.attraction->potential().data());
  if (g.o.has_alpha()) add("ArtificialViscosity", g.alpha.data());
  if (g.dissolved) add("Concentration", g.concentration.data());
  if (g.melts) add("MeltFraction", g.melt.data());
  if (g.o.melting.viscosity_varies()) add("Viscosity", s.eta.data());
  if (!g.test.exact) return group;
  std::vector<state> exact;
  for (std::size_t i = 0; i < s.fluid; ++i) exact.push_back(g.test.exact(g.place(i), t));
  add("DensityReference", make([&](auto i) { return exact[i].rho; }));
  add("PressureReference", make([&](auto i) { return exact[i].p; }));
  std::vector<const double*> v;
  for (std::size_t a = 0; a < D; ++a) v.push_back(make([&](auto i) { return exact[i].v[a]; }));
  output::add_quantity(group, "VelocitiesReference", v);
  return group;
}

// --------------------------------------------------------------------------------------------

template <int D>
class flow : public run::particle_simulation<D> {
 public:
  using base = run::particle_simulation<D>;
  using base::ranks;

  flow(const options& o, setup start, const std::vector<level>& coarser)
      : base(g_, o.common), g_(o, std::move(start)), coarser_(coarser) {
    set_up(g_);
    passes_.declare();
  }

  std::vector<integrators::field> fields() override {
    auto all = passes_.e.fields();
    if constexpr (D > 1)
      if (g_.attraction)
        for (auto& one : all)
          for (std::size_t a = 0; a < D; ++a)
            if (one.data == g_.w.s.v[a].data()) one.slow_rate = g_.attraction->kept(a);
    return all;
  }
  void evaluate_slow() override {
    if constexpr (D > 1) {
      if (!g_.attraction) return;
      try {
        g_.attraction->update();
      } catch (const foundation::error&) {  // of all ranks
        this->check_state();
        throw;
      }
    }
  }

  bool evaluable() override {
    constexpr double any = std::numeric_limits<double>::infinity();
    const auto& s = g_.w.s;
    if (g_.any_eos) return true;
    return ranks.minimum(foundation::smallest_of(s.fluid, any, [&](std::size_t i) { return s.u[i]; })) > 0.0;
  }
  void sum_rates(std::span<double* const> rate) override {
    if constexpr (D > 1)
      if (g_.attraction) g_.attraction->weigh(this->evaluating().slow_forces);
    passes_.e.run(rate);
  }

  // Sound and approach, Δt = cfl · 2 Δx_i/max_j(c_i + c_j - 3 min(w_ij, 0)); and friction or conduction, Δt = diffusive
  // · Δx_i²/D_i, D = max(μ + (d + 1) c, k/c_V)/ρ (schemes/molecular.hpp).
  integrators::step_limit largest_step() override {
    constexpr double any = std::numeric_limits<double>::infinity();
    const double least = foundation::smallest_of(g_.w.s.fluid, any, [&](std::size_t i) {
      const double spacing = g_.S[i] / g_.support_over_dx, signal = std::max(g_.signal[i], 2.0 * g_.sound_speed(i));
      return 2.0 * spacing / signal;
    });
    const double sound = *g_.o.common.time.cfl * ranks.minimum(least);
    integrators::step_limit least_of_all{sound, "sound"};
    if (g_.molecular.any()) {
      const double friction = *g_.o.common.time.diffusive * ranks.minimum(shortest_diffusion(g_));
      least_of_all = {1.0 / std::hypot(1.0 / sound, 1.0 / friction), sound < friction ? "sound" : "viscosity"};
    }
    if (g_.dissolved)
      if (const double exchange = *g_.o.common.time.diffusive * ranks.minimum(shortest_exchange(g_));
          exchange < least_of_all.dt)
        least_of_all = {exchange, "diffusion of the element"};
    if (g_.o.common.time.method == "kdk")
      if (const double kick = *g_.o.common.time.cfl * ranks.minimum(shortest_kick()); kick < least_of_all.dt)
        return {kick, "acceleration"};
    return least_of_all;
  }
  double sound_of_start() override { return g_.speed_scale; }
  run::apart moved() override { return gas::moved(g_); }
  run::apart speed() override { return gas::speed(g_); }
  double allowance() const override { return gas::allowance(g_); }
  bool settles_along(const double* values) const override {
    return values == g_.w.s.u.data() || values == g_.evolved.data();
  }
  double settling_acceleration(std::size_t a, std::size_t i) const override {
    return g_.test.turns.centrifugal(a, g_.place(i));
  }
  double velocity_once_settled(std::size_t a, std::size_t i) const override {
    return g_.test.turns.velocity(a, g_.place(i));
  }
  bool widens_lists() const override { return true; }  // the signal velocity limits steps too

  void commit_lagged() override {
    next_supports(g_);
    if (g_.weighs_power) next_weights(g_);
    if (g_.o.melting.inertia_viscosity > 0.0) take_up_inertia(g_);
  }
  bool set_time(double t) override {
    time_ = t;
    return false;
  }

  std::vector<output::history_column> measured_columns() const override {
    std::vector<output::history_column> all{
        {"kinetic_energy", "J"}, {"internal_energy", "J"}, {"momentum_x", "kg m/s"}, {"density_max", "kg/m^3"}};
    if (g_.in_open_space()) {
      constexpr std::array axis{"x", "y", "z"};
      for (std::size_t a = 1; a < D; ++a) all.push_back({std::string("momentum_") + axis[a], "kg m/s"});
      for (std::size_t a = D == 3 ? 0 : 2; a < 3; ++a)
        all.push_back({std::string("angular_momentum_") + axis[a], "kg m^2/s"});
      if (g_.attraction) all.push_back({"potential_energy", "J"});
    }
    for (const trace& t : g_.test.traces) all.push_back({t.name, t.unit});
    return all;
  }
  std::vector<double> measure(double time) override {
    const totals<D> now = sum_up(g_);
    if (!first_) first_ = now;
    std::vector<double> all{now.kinetic, now.internal, now.momentum[0], largest_density(g_)};
    if (g_.in_open_space()) {
      all.insert(all.end(), now.momentum.begin() + 1, now.momentum.end());
      all.insert(all.end(), now.angular_momentum.begin() + (D == 3 ? 0 : 2), now.angular_momentum.end());
      if (g_.attraction) all.push_back(now.potential);
    }
    std::vector<double> sample{time};
    for (const trace& t : g_.test.traces) sample.push_back(t.value(particles_seen(g_)));
    all.insert(all.end(), sample.begin() + 1, sample.end());
    samples_.push_back(std::move(sample));
    return all;
  }
  std::vector<output::particle_group> particle_groups(std::vector<particles::array>& extra) override {
    return {gas::snapshot(g_, time_, extra)};
  }

  void report_results(double t, run::summary& r) override {
    const totals<D> now = sum_up(g_);
    r.conservation = {{"mass", now.mass / first_->mass - 1.0},
                      {"momentum", momentum_change(g_, now, *first_)},
                      {"energy", (now.energy() - g_.sources.supplied()) / first_->energy() - 1.0}};
    r.metrics["energy_residual"] = (now.energy() - first_->energy() - g_.sources.supplied()) / first_->scale();
    g_.sources.tell(r.metrics);
    if (g_.test.scales) report_drift(now, r.metrics);
    if constexpr (D > 1)
      if (g_.attraction) {
        const auto errors = g_.attraction->against_direct_sum();
        r.metrics["gravity_error_median"] = errors.median;
        r.metrics["gravity_error_99"] = errors.most;
      }
    r.metrics["test"] = g_.o.shock.test;
    r.metrics["scheme"] = g_.o.shock.scheme;
    for (const auto& [name, value] : g_.test.known) r.metrics[name] = run::or_null(value);
    if (g_.test.measures)
      for (const auto& [name, value] : g_.test.measures(particles_seen(g_), samples_))
        r.metrics[name] = run::or_null(value);
    if (g_.test.exact) r.errors = errors(g_, t);
    if (!coarser_.empty()) r.errors["convergence"] = convergence(coarser_, {g_.o.domain.particles[0], t, r.errors, ""});
  }

  // Of a run that goes on with 'kdk' after another method the first step evaluates its rate anew.
  void read_particles(const output::table& t) override {
    run::fluid_from_checkpoint(t, g_.w.s, [](std::string_view name) {
      return name.starts_with("EarlierRate_") || name.starts_with("NeighbourCount");
    });
  }
  void save_globals(output::checkpoint_globals& to) const override {
    base::save_globals(to);
    if (!first_) return;
    const auto all = std::bit_cast<numbers_of_totals>(*first_);
    to.blobs["first_totals"].assign(all.begin(), all.end());
    std::vector<double>& flat = to.blobs["samples"];
    for (const auto& line : samples_) flat.insert(flat.end(), line.begin(), line.end());
  }
  void restore_globals(const output::checkpoint_globals& from) override {
    base::restore_globals(from);
    numbers_of_totals all;
    const auto& saved = from.blobs.at("first_totals");
    if (saved.size() != all.size()) foundation::fail_file("the checkpoint is of another version of this program");
    std::copy_n(saved.begin(), all.size(), all.begin());
    first_ = std::bit_cast<totals<D>>(all);
    const auto& flat = from.blobs.at("samples");
    const auto width = static_cast<std::ptrdiff_t>(1 + g_.test.traces.size());
    for (auto line = flat.begin(); line != flat.end(); line += width) samples_.emplace_back(line, line + width);
  }

 protected:
  void make_lists(bool as_they_were) override {
    gas::make_lists(g_, as_they_were);
    const bool at_start = !settled_ && !as_they_were;
    settled_ = true;
    if (at_start) settle(g_, passes_.densities);
  }

 private:
  // s, of this rank: (Δx_i/|a_i|)^½, as nothing else limits a step whose error is not estimated.
  double shortest_kick() const {
    constexpr double any = std::numeric_limits<double>::infinity();
    return foundation::smallest_of(g_.w.s.fluid, any, [&](std::size_t i) {
      double a2 = 0.0;
      for (std::size_t a = 0; a < D; ++a) a2 += std::pow(passes_.e.kept_acceleration(a)[i], 2);
      return a2 > 0.0 ? std::sqrt(g_.S[i] / g_.support_over_dx / std::sqrt(a2)) : any;
    });
  }

  // From the first line of the history on, over the scales of the setup.
  void report_drift(const totals<D>& now, nlohmann::ordered_json& metrics) const {
    const auto change = [](const auto& a, const auto& b) {
      double all = 0.0;
      for (std::size_t k = 0; k < a.size(); ++k) all += (a[k] - b[k]) * (a[k] - b[k]);
      return std::sqrt(all);
    };
    metrics["energy_drift"] = metrics["energy_residual"];
    metrics["momentum_drift"] = change(now.momentum, first_->momentum) / g_.test.scales->momentum;
    if (g_.o.self_gravity) {
      metrics["gravitational_energy_change"] = now.potential - first_->potential;
      metrics["internal_energy_change"] = now.internal - first_->internal;
      metrics["kinetic_energy_change"] = now.kinetic - first_->kinetic;
    }
    metrics["angular_momentum_drift"] =
        change(now.angular_momentum, first_->angular_momentum) / g_.test.scales->angular_momentum;
  }

  using numbers_of_totals = std::array<double, sizeof(totals<D>) / sizeof(double)>;

  world<D> g_;
  list_of_passes<D> passes_{g_};
  const std::vector<level> coarser_;
  double time_ = 0.0;  // s, of the state
  bool settled_ = false;
  std::optional<totals<D>> first_;
  samples samples_;
};

}  // namespace tetsuame::gas
