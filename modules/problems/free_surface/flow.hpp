// Water with a free surface in a box of plane walls (docs/theory/free_surface.md), as a problem of the time loop:
//   dx/dt = v, dv/dt and dρ/dt by terms.hpp; after each step particles drift (surface.hpp)
#pragma once

#include <free_surface/gauges.hpp>
#include <free_surface/measures.hpp>
#include <free_surface/right_hand_side.hpp>
#include <free_surface/surface.hpp>
#include <free_surface/traction.hpp>
#include <output/groups.hpp>
#include <run/box.hpp>

namespace tetsuame::free_surface {

// A column of gauges.csv.
template <int D>
struct probe {
  output::history_column column;
  std::function<double(const water<D>&)> value;  // collective
};

template <int D>
std::vector<probe<D>> probes_of(const options& o) {
  std::vector<probe<D>> all;
  const auto& g = o.gauges;
  const auto place = [](const std::array<std::vector<double>, 3>& of, std::size_t n) {
    point x{};
    for (std::size_t a = 0; a < D; ++a)
      if (n < of[a].size()) x[a] = of[a][n];
    return x;
  };
  if (g.front) all.push_back({{"front", "m"}, [](const water<D>& f) { return front_of(f); }});
  if (o.flow.start == "standing_wave") all.push_back({{"wave", "1"}, [](const water<D>& f) { return wave_of_now(f); }});
  if (o.flow.start == "drop") {
    all.push_back({{"semi_axis_x", "m"}, [](const water<D>& f) { return semi_axes_of(f).a; }});
    all.push_back({{"semi_axis_y", "m"}, [](const water<D>& f) { return semi_axes_of(f).b; }});
  }
  for (std::size_t n = 0; n < g.height[0].size(); ++n)
    all.push_back({{fmt::format("height_{}", n + 1), "m"},
                   [x = place(g.height, n)](const water<D>& f) { return depth_at(f, x); }});
  for (std::size_t n = 0; n < g.pressure[0].size(); ++n)
    all.push_back({{fmt::format("pressure_{}", n + 1), "Pa"},
                   [x = place(g.pressure, n)](const water<D>& f) { return pressure_at(f, x); }});
  return all;
}

template <int D>
class flow : public run::problem_in_a_box<D> {
 public:
  using base = run::problem_in_a_box<D>;
  using base::ranks;

  flow(const options& o, const parameters& p) : base(f_.world, o.common.balance), f_(o, p), probes_(probes_of<D>(o)) {
    for (const auto& probe : probes_) read_.columns.push_back(probe.column);
    set_up(f_);
  }

  std::vector<std::string> about() const override {
    return {fmt::format("speed of sound {:.4g} m/s, kinematic viscosity {:.4g} m2/s with the artificial one",
                        f_.p.water.sound, f_.p.kinematic_viscosity)};
  }

  std::vector<integrators::field> fields() override {
    auto& s = f_.world.w.s;
    constexpr std::array<const char*, 3> axis{"x", "y", "z"};
    std::vector<integrators::field> all;
    for (std::size_t a = 0; a < D; ++a) all.push_back({axis[a], s.x[a].data(), 0.0, f_.dx()});
    for (std::size_t a = 0; a < D; ++a)
      all.push_back({std::string("v") + axis[a], s.v[a].data(), 0.0, 0.1 * f_.p.water.sound});
    all.push_back({"rho", s.rho.data(), 0.0, 0.01 * f_.o.flow.density});
    return all;
  }

  void evaluate(std::span<double* const> rate) override { free_surface::evaluate(f_, rate); }

  // Sound over the spacing, and viscosity with the density's diffusion, δ h c.
  integrators::step_limit largest_step() override {
    const auto& time = f_.o.common.time;
    const double dx = f_.dx(), c = f_.p.water.sound;
    const double diffusivity = std::max(f_.p.kinematic_viscosity, f_.o.flow.delta * f_.p.smoothing_length * c);
    const double sound = *time.cfl * dx / c;
    const double diffusive =
        diffusivity > 0.0 ? *time.diffusive * dx * dx / diffusivity : std::numeric_limits<double>::infinity();
    return {1.0 / std::hypot(1.0 / sound, 1.0 / diffusive), sound < diffusive ? "sound" : "viscosity"};
  }

  bool set_time(double t) override {
    last_step_ = t - time_;
    time_ = t;
    return false;
  }

  bool complete_step(std::int64_t step) override {
    bool changed = base::complete_step(step);
    if (f_.o.flow.shifting > 0.0) {
      shift(f_, last_step_);
      changed = true;
      base::complete_step(step);  // a drift ends at a wall
    }
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

  std::vector<output::history_column> columns() const override {
    return {{"kinetic_energy", "J"},
            {"potential_energy", "J"},
            {"elastic_energy", "J"},
            {"speed_max", "m/s"},
            {"compression_max", "1"}};
  }
  std::vector<double> row(double) override {
    const energies now = energies_of(f_);
    if (!first_) first_ = now;
    kinetic_most_ = std::max(kinetic_most_, now.kinetic);
    return {now.kinetic, now.potential, now.elastic, ranks().maximum(run::largest_speed(f_.world)),
            largest_compression(f_)};
  }

  std::vector<output::particle_group> snapshot(std::vector<particles::array>& extra) override {
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
    return {g};
  }

  void report(double t, run::summary& r) override {
    const energies now = energies_of(f_);
    r.conservation = {{"mass", now.mass / first_->mass - 1.0}, {"energy", energy_change(now)}};
    auto& m = r.metrics;
    m["start"] = f_.o.flow.start;
    m["sound_speed"] = f_.p.water.sound;
    m["kinetic_energy_largest"] = kinetic_most_;
    const double weight = now.mass * f_.gravity() * f_.p.height;
    m["kinetic_energy_over_mgh"] = run::or_null(weight > 0.0 ? std::optional(now.kinetic / weight) : std::nullopt);
    if (is_still(f_.o, f_.p)) m["hydrostatic_error"] = hydrostatic_error(f_);
    report_exact(t, m);
    report_gauges(m);
  }

  void save(output::checkpoint_globals& to) const override {
    base::save(to);
    to.blobs["readings"] = read_.saved();
    to.reals["kinetic_most"] = kinetic_most_;
    if (first_) to.blobs["first_energies"] = {first_->mass, first_->kinetic, first_->potential, first_->elastic};
  }
  void restore(const output::checkpoint_globals& from) override {
    base::restore(from);
    read_.restore(from.blobs.at("readings"));
    kinetic_most_ = from.reals.at("kinetic_most");
    const auto& e = from.blobs.at("first_energies");
    first_ = energies{e.at(0), e.at(1), e.at(2), e.at(3)};
  }

 protected:
  void make_lists(bool as_they_were) override {
    run::rebuild(f_.world, as_they_were);
    f_.make_room();
    find_beside_bodies(f_);
  }
  std::int64_t put_out_of_bodies() override { return free_surface::put_out_of_bodies(f_); }

 private:
  void read_gauges(std::int64_t step) {
    std::vector<double> values;
    if (!f_.o.gauges.pressure[0].empty()) refresh(f_);
    for (const auto& probe : probes_) values.push_back(probe.value(f_));
    read_.add(time_, values);
    values.insert(values.begin(), time_);
    table_->append(step, values);
    choose_next_reading();
  }
  void choose_next_reading() {
    const double interval = f_.o.gauges.interval;
    if (interval > 0.0) next_reading_ = interval * (std::floor(time_ * (1.0 + 1e-9) / interval) + 1.0);
  }

  // Over the kinetic energy of the start, or where there was none over what the weight could give.
  double energy_change(const energies& now) const {
    const double weight = now.mass * f_.gravity() * f_.p.height;
    const double scale = first_->kinetic > 0.0 ? first_->kinetic : weight;
    return (now.mechanical() - first_->mechanical()) / scale;
  }

  void report_exact(double t, nlohmann::ordered_json& m) const {
    if (f_.o.flow.start == "standing_wave") {
      const standing_wave wave = wave_of(f_.o, f_.p);
      const auto measured = measured_oscillation(read_.of("wave"));
      m["period"] = run::or_null(measured.period);
      m["period_theory"] = wave.period();
      m["energy_decay"] = run::or_null(measured.decay ? std::optional(2.0 * *measured.decay) : std::nullopt);
      m["energy_decay_theory"] = wave.energy_decay(f_.p.kinematic_viscosity);
    }
    if (f_.o.flow.start == "drop") {
      const auto now = semi_axes_of(f_), exact = drawn_out(drop_of(f_.p).radius, f_.o.flow.strain_rate, t);
      m["semi_axis_x"] = now.a;
      m["semi_axis_x_exact"] = exact.a;
      m["semi_axis_y"] = now.b;
      m["semi_axis_y_exact"] = exact.b;
    }
  }

  void report_gauges(nlohmann::ordered_json& m) const {
    const auto& known = f_.p.measured;
    if (f_.o.gauges.front) report_front(f_.p, read_.of("front"), m);
    for (std::size_t n = 0; n < known.height.size(); ++n) {
      const auto name = fmt::format("height_{}", n + 1);
      report_height(name, read_.of(name), known.height[n], m);
    }
    for (std::size_t n = 0; n < known.pressure.size(); ++n) {
      const auto name = fmt::format("pressure_{}", n + 1);
      report_pressure(f_.o, name, read_.of(name), known.pressure[n], m);
    }
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
