// Water with a free surface in a box of plane walls (docs/theory/free_surface.md), as a problem of the time loop:
//   dx/dt = v, dv/dt and dρ/dt by terms.hpp, with forces from outside (sources/fields.hpp); after each step particles
//   drift, and what has lost its concentration its pressure (surface.hpp)
#pragma once

#include <free_surface/evaluation.hpp>
#include <free_surface/gauges.hpp>
#include <free_surface/measures.hpp>
#include <free_surface/openings.hpp>
#include <free_surface/probes.hpp>
#include <free_surface/surface.hpp>
#include <output/groups.hpp>
#include <run/particle_simulation.hpp>

namespace tetsuame::free_surface {

// 1/s: twice the larger of (k/m)^½ and c/m of what restrains free bodies; 0: there is none.
template <int D>
double fastest_spring(const water<D>& f) {
  double most = 0.0;
  for (const auto& b : f.moving) {
    if (!b.free) continue;
    const auto& r = b.free->restrained;
    for (std::size_t k = 0; k < r.components; ++k) {
      const double inertia = k < D ? b.free->mass : b.free->inertia[0][0];
      most = std::max({most, 2.0 * std::sqrt(r.stiffness[k] / inertia), 2.0 * r.damping[k] / inertia});
    }
  }
  return most;
}

template <int D>
class flow : public run::particle_simulation<D> {
 public:
  using base = run::particle_simulation<D>;
  using base::ranks;

  flow(const options& o, const parameters& p) : base(f_.world, o.common), f_(o, p), probes_(probes_of<D>(o, p)) {
    for (const auto& probe : probes_)
      for (const auto& column : probe.columns) read_.columns.push_back(column);
    set_up(f_);
    free_surface::declare(f_);
    this->about = {fmt::format(
        "speed of sound {:.4g} m/s, kinematic viscosity {:.4g} m2/s {}", p.water.sound, p.kinematic_viscosity,
        p.by == scheme::riemann ? "beside what Riemann problems dissipate" : "with the artificial one")};
  }

  std::vector<integrators::field> fields() override { return f_.rates.fields(); }

  void at_time(double t) override {
    base::at_time(t);
    set_bodies_at(f_, t);
  }
  void sum_rates(std::span<double* const> rate) override { f_.rates.run(rate); }
  double sound_of_start() override { return f_.p.water.sound; }
  run::apart moved() override { return with_bodies(base::moved(), bodies_moved(f_)); }
  std::string farthest_moved() override {
    if (f_.moving.empty() || bodies_moved(f_) < run::on_all(ranks, base::moved()).length())
      return base::farthest_moved();
    const auto& farthest = *std::ranges::max_element(f_.moving, {}, rigid::body_moved<D>);
    return fmt::format("body '{}'", f_.p.template bodies_in<D>()[farthest.body].name());
  }
  run::apart speed() override { return with_bodies(base::speed(), bodies_speed(f_)); }

  integrators::step_limit largest_step() override {
    const auto of_water = step_of_water();
    const double springs = fastest_spring(f_);
    return springs * of_water.dt > 1.0 ? integrators::step_limit{1.0 / springs, "springs"} : of_water;
  }

  // Sound over the spacing, and viscosity with the density's diffusion. Of Riemann problems, which take 2.3 c/h in two
  // dimensions, 3 c/h in three times 1 - cos k·x off a wave, this is less than sound's own 2.2 c/Δx.
  integrators::step_limit step_of_water() const {
    const auto& time = f_.o.common.time;
    const double dx = f_.dx(), c = f_.p.water.sound;
    const double diffusivity = std::max(f_.p.kinematic_viscosity, f_.p.density_diffusivity);
    const double sound = *time.cfl * dx / c;
    const double diffusive =
        diffusivity > 0.0 ? *time.diffusive * dx * dx / diffusivity : std::numeric_limits<double>::infinity();
    const double both = std::hypot(1.0 / sound, 1.0 / diffusive);
    const char* name = sound < diffusive ? "sound" : "viscosity";
    if (!f_.has_tension()) return {1.0 / both, name};
    // Half a spacing's way of the shortest waves [J. U. Brackbill, D. B. Kothe, C. Zemach, J. Comput. Phys. 100, 335
    // (1992)], with nothing above the water.
    const double waves =
        *time.cfl * std::sqrt(f_.o.flow.density * dx * dx * dx / (4.0 * std::numbers::pi * f_.o.flow.surface_tension));
    return {1.0 / std::hypot(both, 1.0 / waves), waves < std::min(sound, diffusive) ? "surface tension" : name};
  }

  bool set_time(double t) override {
    last_step_ = t - time_;
    time_ = t;
    set_bodies_at(f_, t);
    return false;
  }

  bool complete_step(std::int64_t step) override {
    bool changed = base::complete_step(step);
    if (f_.p.shifting > 0.0) {
      arrange(f_, last_step_);
      changed = true;
      base::complete_step(step);  // a drift ends at a wall
    }
    if (f_.has_openings) {
      guide_inflows(f_, time_);
      guide_outflows(f_);
      changed = true;
    }
    changed = changed || !f_.held.empty() || std::exchange(f_.pushed_apart, false);
    if (table_ && time_ >= next_reading_ * (1.0 - 1e-9)) read_gauges(step);
    return changed;
  }

  void begin_tables(run::run_directory& files) override {
    base::begin_tables(files);
    if (probes_.empty()) return;
    std::vector<output::history_column> columns{{"time", "s"}};
    for (const auto& c : read_.columns) columns.push_back(c);
    table_ = &files.table("gauges.csv", columns);
    if (read_.size() == 0)
      read_gauges(0);
    else
      choose_next_reading();
  }

  std::vector<output::history_column> measured_columns() const override {
    std::vector<output::history_column> all{{"kinetic_energy", "J"},
                                            {"potential_energy", "J"},
                                            {"elastic_energy", "J"},
                                            {"speed_max", "m/s"},
                                            {"compression_max", "1"}};
    if (!f_.free.empty()) all.push_back({"energy_of_bodies", "J"});
    if (f_.has_tension()) all.push_back({"surface_energy", "J"});
    if (f_.has_bodies)
      for (std::size_t a = 0; a < D; ++a) all.push_back({fmt::format("momentum_{}", "xyz"[a]), "N s"});
    if (f_.counts_impacts) all.push_back({"energy_put_back", "J"});
    if (f_.has_openings) {
      all.push_back({"mass", D == 2 ? "kg/m" : "kg"});
      for (const auto& column : columns_of_openings<D>()) all.push_back(column);
    }
    if (f_.counts_work) {
      all.push_back({"work_of_pressure", "J"});
      all.push_back({"work_of_friction", "J"});
    }
    return all;
  }
  std::vector<double> measure(double) override {
    const energies now = energies_of(f_);
    if (!first_) first_ = now;
    base::note_density_excess(density_excess(f_));
    kinetic_most_ = std::max(kinetic_most_, now.kinetic);
    std::vector<double> all{now.kinetic, now.potential, now.elastic, ranks.maximum(run::largest_speed(f_.world)),
                            largest_compression(f_)};
    if (!f_.free.empty()) all.push_back(now.bodies);
    if (f_.has_tension()) all.push_back(now.surface);
    if (f_.has_bodies)
      for (const double momentum : momentum_of(f_).c) all.push_back(momentum);
    if (f_.counts_impacts) all.push_back(f_.counted.energy);
    if (f_.has_openings) {
      all.push_back(now.mass);
      for (const double passed : values_of_openings(f_)) all.push_back(passed);
    }
    for (const double work : count_of(f_).work) all.push_back(work);
    return all;
  }

  std::vector<output::particle_group> particle_groups(std::vector<particles::array>& extra) override {
    const auto& s = f_.world.w.s;
    const auto on_surface = find_surface(f_);
    auto g = output::group_of(s, 0, 0, s.fluid);
    const auto add = [&](const char* name, const double* values) { output::add_quantity(g, name, {values}); };
    const auto make = [&](auto&& value) { return output::make_array(extra, s.fluid, value); };
    add("Masses", s.m.data());
    add("Density", s.rho.data());
    add("Pressure", s.p.data());
    add("Temperature", make([](auto) { return 0.0; }));
    add("SmoothingLength", make([&](auto) { return f_.p.smoothing_length; }));
    add("Material", make([](auto) { return 0.0; }));
    add("Volume", s.dV.data());
    add("FreeSurface", make([&](auto i) { return on_surface[i] ? 1.0 : 0.0; }));
    if (f_.has_openings) add("Zone", f_.zone.data());
    if (!f_.world.walls.bodies.any()) return {g};
    return {g, rigid::group_of_walls(f_.world, f_.p.smoothing_length, extra)};
  }

  void report_results(double t, run::summary& r) override {
    const energies now = energies_of(f_);
    using counted = passed_through<D>;
    const double passed = f_.entered[counted::mass] - f_.left[counted::mass];
    const double change = energy_change(now);
    // What drives the zones of inflow and outflow is not counted.
    r.conservation = {{"mass", (now.mass - passed) / first_->mass - 1.0},
                      {"energy", run::or_null(f_.has_openings ? std::nullopt : std::optional(change))}};
    auto& m = r.metrics;
    // The water's energy falls by friction; what it gains while nobody works on it is made by the sums.
    const bool all_free = std::ranges::all_of(f_.moving, [](const auto& b) { return b.free.has_value(); });
    const bool work_is_known =
        !f_.has_openings && (works_alone() || (f_.sources.force() ? f_.moving.empty() : all_free));
    if (work_is_known) m["energy_residual"] = std::max(0.0, change);
    m["start"] = f_.o.flow.start;
    m["sound_speed"] = f_.p.water.sound;
    m["kinetic_energy_largest"] = kinetic_most_;
    const double weight = now.mass * f_.gravity() * f_.p.height;
    m["kinetic_energy_over_mgh"] = run::or_null(weight > 0.0 ? std::optional(now.kinetic / weight) : std::nullopt);
    f_.sources.tell(m);
    report_budget(m);
    report_openings(now, m);
    if (is_still(f_.o, f_.p) && !f_.sources.force()) m["hydrostatic_error"] = hydrostatic_error(f_);
    report_exact(t, m);
    report_gauges(m);
  }

  // What came in and went out (openings.hpp): mass is what it was, and what has come, less what has gone.
  void report_openings(const energies& now, nlohmann::ordered_json& m) {
    if (!f_.has_openings) return;
    m["mass"] = now.mass;
    m["mass_of_start"] = first_->mass;
    m["particles_in"] = static_cast<std::int64_t>(f_.entered[passed_through<D>::number]);
    m["particles_out"] = static_cast<std::int64_t>(f_.left[passed_through<D>::number]);
    const auto columns = columns_of_openings<D>();
    const auto values = values_of_openings(f_);
    for (std::size_t k = 0; k < columns.size(); ++k) m[columns[k].name] = values[k];
  }

  // What bodies and the water gave each other (budget.hpp).
  void report_budget(nlohmann::ordered_json& m) {
    if (f_.counts_impacts) m["energy_put_back"] = f_.counted.energy;
    const auto names = force_names(f_.p.force.size(), D);
    for (std::size_t n = 0; n < names.size(); ++n) {
      constexpr std::size_t N = water<D>::counted_loads::components;
      m[names[n] + "_put_back"] = f_.counted.put_back[n / N][n % N];
    }
    if (!f_.counts_work) return;
    const auto work = count_of(f_).work;
    m["work_of_pressure"] = work[0];
    m["work_of_friction"] = work[1];
  }

  void save_globals(output::checkpoint_globals& to) const override {
    base::save_globals(to);
    if (f_.counts_impacts) to.blobs["loads"] = saved_loads(f_);
    if (f_.has_openings) {
      auto& saved = to.blobs["passed_through"];
      for (const auto* passed : {&f_.entered, &f_.left})
        for (const auto* part : {&passed->sum, &passed->rest}) saved.insert(saved.end(), part->begin(), part->end());
    }
    to.blobs["readings"] = read_.saved();
    to.reals["kinetic_most"] = kinetic_most_;
    if (!f_.moving.empty()) to.blobs["bodies"] = saved_bodies(f_);
    if (first_)
      to.blobs["first_energies"] = {first_->mass,    first_->kinetic, first_->potential,
                                    first_->elastic, first_->bodies,  first_->surface};
  }
  void restore_globals(const output::checkpoint_globals& from) override {
    base::restore_globals(from);
    read_.restore(from.blobs.at("readings"));
    kinetic_most_ = from.reals.at("kinetic_most");
    time_ = from.reals.at("time");
    if (!f_.moving.empty()) restore_bodies(f_, from.blobs.at("bodies"), time_);
    if (f_.counts_impacts) restore_loads(f_, from.blobs.at("loads"));
    if (f_.has_openings) {
      auto saved = from.blobs.at("passed_through").begin();
      for (auto* passed : {&f_.entered, &f_.left})
        for (auto* part : {&passed->sum, &passed->rest})
          for (double& value : *part) value = *saved++;
    }
    const auto& e = from.blobs.at("first_energies");
    first_ = energies{e.at(0), e.at(1), e.at(2), e.at(3), e.at(4), e.at(5)};
  }

 protected:
  void make_lists(bool as_they_were) override {
    place_bodies_for_lists(f_, as_they_were);
    run::rebuild(f_.world, as_they_were);
    particles::clear_derived(f_.world.w.s);
    find_beside_bodies(f_);
    find_rows_beside(f_);
    group_walls(f_);
  }
  void place_walls() override { hand_over_walls(f_); }
  bool let_particles_pass() override { return pass_openings(f_); }
  std::int64_t put_out_of_bodies() override {
    const std::int64_t put_back = rigid::put_out_of_bodies(f_);
    count_put_back(f_);
    return put_back;
  }

 private:
  static run::apart with_bodies(run::apart all, double of_bodies) {
    auto& at_least = all.numbers[run::apart::at_least];
    at_least = std::max(at_least, of_bodies);
    return all;
  }
  void read_gauges(std::int64_t step) {
    std::vector<double> values;
    if (!f_.o.gauges.pressure[0].empty()) refresh(f_);
    f_.counted.since_read = time_ - f_.counted.read_at;
    for (const auto& probe : probes_)
      for (const double value : probe.values(f_)) values.push_back(value);
    f_.counted.forget(time_);
    read_.add(time_, values);
    values.insert(values.begin(), time_);
    table_->append(step, values);
    choose_next_reading();
  }
  void choose_next_reading() {
    const double interval = f_.o.gauges.interval;
    if (interval > 0.0) next_reading_ = interval * (std::floor(time_ * (1.0 + 1e-9) / interval) + 1.0);
  }

  // All that moves is prescribed, and its work known.
  bool works_alone() const { return f_.counts_work && f_.free.empty(); }

  // Over the kinetic energy of the start, or where there was none over what the weight could give; with surface tension
  // and springs over their energy beside that.
  // Collective.
  double energy_change(const energies& now) {
    const double weight = now.mass * f_.gravity() * f_.p.height;
    const double scale =
        (first_->kinetic > 0.0 ? first_->kinetic : weight) + first_->surface + energy_of_springs_at_start(f_);
    double supplied = f_.sources.work_of_forces();
    if (works_alone()) {
      const auto work = count_of(f_).work;
      supplied += work[0] + work[1] + f_.counted.energy;
    }
    return (now.mechanical() - first_->mechanical() - supplied) / scale;
  }

  void report_exact(double t, nlohmann::ordered_json& m) const {
    if (f_.o.flow.start == "standing_wave") {
      const standing_wave wave = wave_of(f_.o, f_.p);
      const auto measured = measured_oscillation(read_.of("wave"));
      m["period"] = run::or_null(measured.period);
      m["period_theory"] = run::or_null(wave.mean_period(f_.p.kinematic_viscosity, t));
      m["energy_decay"] = run::or_null(measured.decay ? std::optional(2.0 * *measured.decay) : std::nullopt);
      m["energy_decay_theory"] = -2.0 * wave.rate(f_.p.kinematic_viscosity).real();
    }
    if (f_.o.flow.start == "drop") {
      const auto now = semi_axes_of(f_);
      m["semi_axis_x"] = now.a;
      m["semi_axis_y"] = now.b;
      if (f_.has_tension()) return report_oscillation(m);
      const auto exact = drawn_out(drop_of(f_.p).radius, f_.o.flow.strain_rate, t);
      m["semi_axis_x_exact"] = exact.a;
      m["semi_axis_y_exact"] = exact.b;
    }
  }

  // Of the drop, by the difference of its semi-axes; where it starts at rest there is none.
  void report_oscillation(nlohmann::ordered_json& m) const {
    const round_drop drop = round_drop_of(f_);
    m["laplace_pressure"] = mean_pressure_within(f_, 0.5 * drop.radius);
    m["laplace_pressure_theory"] = (D - 1) * f_.o.flow.surface_tension / drop.radius;
    if (!(f_.o.flow.strain_rate > 0.0)) return;
    series out_of_round = read_.of("semi_axis_y");
    const auto x = read_.of("semi_axis_x");
    for (std::size_t k = 0; k < x.value.size(); ++k) out_of_round.value[k] -= x.value[k];
    const auto measured = measured_oscillation(out_of_round);
    m["oscillation_period"] = run::or_null(measured.period);
    const auto rate = drop.rate(f_.p.kinematic_viscosity);
    m["oscillation_period_theory"] = run::or_null(period_of(rate));
    m["oscillation_decay"] = run::or_null(measured.decay);
    m["oscillation_decay_theory"] = -rate.real();
  }

  void report_gauges(nlohmann::ordered_json& m) const {
    const auto& known = f_.p.measured;
    if (f_.o.gauges.front) report_front(f_.p, read_.of("front"), m);
    for (std::size_t n = 0; n < known.height.size(); ++n) {
      const auto name = fmt::format("height_{}", n + 1);
      report_height(name, read_.of(name), known.height[n], m);
    }
    for (std::size_t n = 0; n < known.discharge.size(); ++n) {
      const auto name = fmt::format("discharge_{}", n + 1);
      report_height(name, read_.of(name), known.discharge[n], m);
    }
    for (std::size_t n = 0; n < known.pressure.size(); ++n) {
      const auto name = fmt::format("pressure_{}", n + 1);
      report_pressure(f_.o, name, read_.of(name), known.pressure[n], m);
    }
    const auto names = force_names(f_.p.force.size(), D);
    for (std::size_t n = 0; n < names.size(); ++n)
      report_force(f_.o, names[n], read_.of(names[n]), read_.of(impulse_name(names[n])), known.force[n], m);
    for (const auto& column : read_.columns)
      if (column.name.starts_with("motion_") || column.name.starts_with("angle_"))
        m[column.name + "_last"] = read_.of(column.name).value.back();
  }

  water<D> f_;
  const std::vector<probe<D>> probes_;
  readings read_;
  output::history* table_ = nullptr;                          // none: no gauges, or nothing is written
  double time_ = 0.0, last_step_ = 0.0, next_reading_ = 0.0;  // s
  double kinetic_most_ = 0.0;                                 // J
  std::optional<energies> first_;
};

}  // namespace tetsuame::free_surface
