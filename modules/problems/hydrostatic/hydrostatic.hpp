// A liquid at rest in a box, by the scheme of a program.
#pragma once

#include <fmt/format.h>

#include <hydrostatic/measures.hpp>
#include <liquid/scheme.hpp>
#include <optional>
#include <output/groups.hpp>
#include <sources/fields.hpp>

namespace tetsuame::hydrostatic {

// Fluid and walls for a snapshot; of the fluid, displacement and exact solution too. `extra` holds what is made for the
// occasion.
template <int D>
std::vector<output::particle_group> snapshot_groups(const scene<D>& scene, double h,
                                                    std::vector<particles::array>& extra) {
  const auto& s = scene.w.s;
  std::vector<output::particle_group> groups;
  const auto begin_group = [&](int type, std::size_t begin, std::size_t n) {
    auto& g = groups.emplace_back(output::group_of(s, type, begin, n));
    const auto make = [&](auto&& value) { return output::make_array(extra, n, value); };
    using named = std::pair<const char*, const particles::array*>;
    for (const auto& [name, values] :
         {named{"Density", &s.rho}, named{"Temperature", &s.T}, named{"Weight", &s.Y},
          named{"InternalEnergyGain", &s.u}, named{"Masses", &s.m}, named{"Viscosity", &s.eta},
          named{"PressureEOS", &s.p_eos}, named{"Pressure", &s.p}, named{"SoundSpeed", &s.c}})
      output::add_quantity(g, name, {values->data() + begin});
    output::add_quantity(g, "SmoothingLength", {make([&](auto) { return h; })});
    output::add_quantity(g, "Material", {make([&](auto i) { return s.material[begin + i]; })});
  };
  begin_group(0, 0, s.fluid);
  const auto row = [&](std::size_t i) { return row_of(scene, i); };
  const auto make = [&](auto&& value) { return output::make_array(extra, s.fluid, value); };
  output::add_quantity(groups[0], "PressureReference", {make([&](auto i) { return scene.p_exact[row(i)]; })});
  output::add_quantity(groups[0], "DensityReference", {make([&](auto i) { return scene.rho_exact[row(i)]; })});
  std::vector<const double*> moved;
  for (std::size_t a = 0; a < D; ++a) moved.push_back(make([&](auto i) { return displacement(scene, i)[a]; }));
  output::add_quantity(groups[0], "Displacement", moved);
  // Images are the fluid again.
  if (!scene.mirrors() && scene.w.d.ranks.sum(static_cast<std::int64_t>(s.walls)) > 0)
    begin_group(1, s.first_wall(), s.walls);
  return groups;
}

template <int D>
class problem : public liquid::problem<D> {
 public:
  using base = liquid::problem<D>;
  using base::scheme_;

  scene<D> world;

  problem(const options& o, std::unique_ptr<liquid::scheme<D>> scheme,
          const domain::communicator& of = domain::communicator::world())
      : base(world, o, std::move(scheme)), o_(o) {
    set_up(o, of, world);
    scheme_->begin(world);
    declare_evaluation();
  }

  std::vector<integrators::field> fields() override { return evaluation_.fields(); }
  void sum_rates(std::span<double* const> rate) override { evaluation_.run(rate); }
  integrators::step_limit largest_step() override { return measure_limits(world, o_.time).least(); }

  double sound_of_start() override { return fastest_sound(o_, world); }

  // ---- what is told -----------------------------------------------------------------------

  void begin_tables(run::run_directory& files) override {
    base::begin_tables(files);
    const auto& material = eos::about(world.w.materials[0]);
    files.say(fmt::format("equation of state {}: {}{}", material.name, material.source,
                          material.illustrative ? " (illustrative)" : ""));
  }

  std::vector<output::history_column> measured_columns() const override {
    return {{"pressure_error_mean", "1"},    {"pressure_error_max", "1"}, {"density_error_max", "1"},
            {"displacement_max", "dx"},      {"kinetic_energy", "J"},     {"potential_energy", "J"},
            {"internal_energy_gained", "J"}, {"energy_change", "J"}};
  }
  std::vector<double> measure(double) override {
    const auto e = measure_errors(world);
    const auto t = measure_totals(world);
    if (!start_) start_ = t;
    base::note_density_excess(e.density_excess);
    return {e.pressure_mean, e.pressure_max, e.density_max, e.displacement_max_over_dx,
            t.kinetic,       t.potential,    t.internal,    energy_made(t)};
  }

  std::vector<output::particle_group> particle_groups(std::vector<particles::array>& extra) override {
    return snapshot_groups(world, o_.kernel.h_over_dx * world.w.dx, extra);
  }

  void report_results(double, run::summary& r) override {
    const auto e = measure_errors(world);
    const auto t = measure_totals(world);
    if (!o_.regions.any())
      r.errors = {{"pressure_mean", e.pressure_mean},
                  {"pressure_max", e.pressure_max},
                  {"density_max", e.density_max},
                  {"displacement_max_over_dx", e.displacement_max_over_dx}};
    double momentum = 0.0;
    for (std::size_t a = 0; a < D; ++a)
      momentum = std::max(momentum, std::abs(t.momentum[a] - start_->momentum[a]) / start_->sound_momentum);
    r.conservation = {{"mass", (t.mass - start_->mass) / start_->mass},
                      {"momentum", momentum},
                      {"energy", energy_made(t) / start_->pressure_volume}};
    sources_.tell(r.metrics);
    // Walls that drag, heat or cool the fluid change its energy.
    const bool closed = std::ranges::none_of(world.walls.sides, [](const walls::side<D>& wall) {
      return wall.thermal == walls::heat::fixed_temperature || wall.flux != 0.0 ||
             std::ranges::any_of(wall.velocity, [](double u) { return u != 0.0; });
    });
    if (closed) r.metrics["energy_residual"] = r.conservation["energy"];
    const auto limits = measure_limits(world, o_.time);
    r.metrics["limit_cfl"] = run::bound_or_null(limits.cfl);
    r.metrics["limit_viscous"] = run::bound_or_null(limits.viscous);
    r.metrics["limit_thermal"] = run::bound_or_null(limits.thermal);
    r.metrics["limit_least"] = limits.least().name;
    r.metrics["lattice_sum"] = world.w.lattice_sum;
  }

  // ---- checkpoints ------------------------------------------------------------------------

  void save_globals(output::checkpoint_globals& g) const override {
    hydrostatic::save(start_.value_or(totals<D>{}), g);
    base::save_globals(g);
  }
  void restore_globals(const output::checkpoint_globals& g) override {
    start_ = totals_of_start<D>(g);
    base::restore_globals(g);
  }

 protected:
  void make_lists(bool as_they_were) override { rebuild(world, as_they_were); }
  void place_walls() override { hydrostatic::place_walls(o_, world); }

 private:
  // J, beyond what came from outside.
  double energy_made(const totals<D>& now) const { return now.energy() - start_->energy() - sources_.supplied(); }

  // Integrated in the order of liquid::rates_in_order. The absolute errors that steps with error control allow, beside
  // those relative to a value (of positions, to the spacing), are far below what a flow has: mm, um/s, uK.
  void declare_evaluation() {
    auto& e = evaluation_;
    auto& s = world.w.s;
    sources_.declare(o_.sources, world, e);
    e.integrate_motion({1e-6 * world.w.dx, 1e-6, 0.0, true});
    const bool energy = o_.scheme.energy.internal();
    passes::fields rates{s.x, s.v, s.u};
    if (energy) {
      e.remembered({s.T});
    } else {
      e.integrate(s.T, {"T", 1e-6});
      rates.add({s.T});
    }
    e.integrate(s.u, {"u", 1e-3});
    const auto carry = [&](particles::array& field, const char* name) {
      e.integrate(field, {name, 1e-9});
      rates.add({field});
    };
    if (scheme_->carried() == volume::carries::density) carry(s.rho, "rho");
    if (scheme_->carried() == volume::carries::weight) carry(s.Y, "Y");
    const std::size_t own = e.fields().size();
    auto& warming = particles::declare_if(energy, s, "TemperatureRate", "K/s", particles::role::derived);
    scheme_->declare(world, e, rates, false, [this, own, energy, &warming] {
      return liquid::rates_in_order<D>(evaluation_.rates().first(own), energy ? warming.data() : nullptr);
    });
    const double c = fastest_sound(o_, world);
    sources_.account(e, 1e-4 * c * c);
    e.complete(passes::behind<D>(world));
  }

  const options& o_;
  passes::evaluation<D> evaluation_{world};
  sources::fields<D> sources_;
  std::optional<totals<D>> start_;
};

}  // namespace tetsuame::hydrostatic
