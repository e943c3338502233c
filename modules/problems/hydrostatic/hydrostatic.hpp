// A liquid at rest in a box, by the scheme of a program.
#pragma once

#include <fmt/format.h>

#include <hydrostatic/measures.hpp>
#include <hydrostatic/state.hpp>
#include <liquid/scheme.hpp>
#include <optional>
#include <run/box.hpp>

namespace tetsuame::hydrostatic {

template <int D>
class problem : public run::problem_in_a_box<D> {
 public:
  using base = run::problem_in_a_box<D>;
  using base::ranks;

  scene<D> world;

  problem(const options& o, std::unique_ptr<liquid::scheme<D>> scheme,
          const domain::communicator& of = domain::communicator::world())
      : base(world, o.balance), o_(o), scheme_(std::move(scheme)) {
    set_up(o, of, world);
    scheme_->begin(world);
  }

  std::vector<integrators::field> fields() override { return state_fields(world, scheme_->carried()); }
  void evaluate(std::span<double* const> rate) override { scheme_->evaluate(world, liquid::rates<D>(rate)); }
  integrators::step_limit largest_step() override { return measure_limits(world, o_.time).least(); }
  void keep_memory() override { scheme_->keep_memory(world); }
  bool complete_step(std::int64_t step) override {
    scheme_->complete_step(step);
    return base::complete_step(step);
  }

  // ---- what is told -----------------------------------------------------------------------

  void begin_tables(run::run_directory& files) override {
    base::begin_tables(files);
    const auto& material = eos::about(world.w.materials[0]);
    files.say(fmt::format("equation of state {}: {}{}", material.name, material.source,
                          material.illustrative ? " (illustrative)" : ""));
    scheme_->begin_tables(files);
  }

  std::vector<output::history_column> columns() const override {
    return {{"pressure_error_mean", "1"},    {"pressure_error_max", "1"}, {"density_error_max", "1"},
            {"displacement_max", "dx"},      {"kinetic_energy", "J"},     {"potential_energy", "J"},
            {"internal_energy_gained", "J"}, {"energy_change", "J"}};
  }
  std::vector<double> row(double) override {
    const auto e = measure_errors(world);
    const auto t = measure_totals(world);
    if (!start_) start_ = t;
    return {e.pressure_mean, e.pressure_max, e.density_max, e.displacement_max_over_dx,
            t.kinetic,       t.potential,    t.internal,    t.energy() - start_->energy()};
  }

  std::vector<output::particle_group> snapshot(std::vector<particles::array>& extra) override {
    return snapshot_groups(world, o_.kernel.h_over_dx * world.w.dx, extra);
  }

  void report(double, run::summary& r) override {
    const auto e = measure_errors(world);
    const auto t = measure_totals(world);
    r.set_errors(e.pressure_mean, e.pressure_max, e.density_max, e.displacement_max_over_dx);
    double momentum = 0.0;
    for (std::size_t a = 0; a < D; ++a)
      momentum = std::max(momentum, std::abs(t.momentum[a] - start_->momentum[a]) / start_->sound_momentum);
    r.set_conservation((t.mass - start_->mass) / start_->mass, momentum,
                       (t.energy() - start_->energy()) / start_->pressure_volume);
    const auto limits = measure_limits(world, o_.time);
    r.metrics["limit_cfl"] = run::bound_or_null(limits.cfl);
    r.metrics["limit_viscous"] = run::bound_or_null(limits.viscous);
    r.metrics["limit_thermal"] = run::bound_or_null(limits.thermal);
    r.metrics["limit_least"] = limits.least().name;
    r.metrics["lattice_sum"] = world.w.lattice_sum;
  }

  void fail(const foundation::error& e, std::int64_t step, run::summary& r) override { scheme_->fail(e, step, r); }

  void report_counts(run::summary& r) override {
    base::report_counts(r);
    scheme_->report(world, r.metrics);
  }

  // ---- checkpoints ------------------------------------------------------------------------

  void save(output::checkpoint_globals& g) const override {
    hydrostatic::save(start_.value_or(totals<D>{}), g);
    base::save(g);
    scheme_->save(g);
  }
  void restore(const output::checkpoint_globals& g) override {
    start_ = totals_of_start<D>(g);
    base::restore(g);
    scheme_->restore(g);
  }

 protected:
  void make_lists(bool as_they_were) override { rebuild(world, as_they_were); }
  void place_walls() override { hydrostatic::place_walls(o_, world); }

 private:
  const options& o_;
  std::unique_ptr<liquid::scheme<D>> scheme_;
  std::optional<totals<D>> start_;
};

}  // namespace tetsuame::hydrostatic
