// A liquid at rest in a box, by the modules of a program: volume, pressure, walls, gradient (right_hand_side.hpp).
#pragma once

#include <fmt/format.h>

#include <hydrostatic/measures.hpp>
#include <hydrostatic/residuals.hpp>
#include <hydrostatic/right_hand_side.hpp>
#include <hydrostatic/state.hpp>
#include <optional>
#include <run/box.hpp>
#include <run/time_loop.hpp>
#include <volume/hosono_iteration.hpp>

namespace tetsuame::hydrostatic {

template <class Program, int D>
class problem : public run::problem_in_a_box<D> {
 public:
  using volume_module = typename Program::volume;
  static constexpr bool iterates = requires(volume_module v) { v.residuals; };

  using base = run::problem_in_a_box<D>;
  using base::ranks;

  scene<D> world;
  volume_module how{};

  explicit problem(const options& o, const domain::communicator& of = domain::communicator::world())
      : base(world, o.balance), o_(o) {
    set_up(o, of, world);
    world.density_carried = volume_module::carried == volume::carries::density;
    world.weight_carried = volume_module::carried == volume::carries::weight;
    if constexpr (iterates) {
      how.how = o.hosono;
      volume::add_density_guess(world.w.s);
      volume::equation_of_state(world.w, world.w.s.fluid);
      start_kappa_ = volume::detail::largest_kappa(world.w);
    }
  }

  // ---- evaluation and stepping ------------------------------------------------------------

  std::vector<integrators::field> fields() override { return state_fields(world); }
  void evaluate(std::span<double* const> rate) override {
    hydrostatic::evaluate<Program>(world, how, o_.smoothing, rate);
  }
  integrators::step_limit largest_step() override { return measure_limits(world, o_.time).least(); }

  // The iteration for Y starts from what it found at the last state that was reached. The start value
  // moves on only when the rate there is known, so that a restart, which has to find that rate
  // again, finds the same bits.
  void keep_memory() override {
    if constexpr (iterates)
      std::copy_n(world.w.s.rho.begin(), world.w.s.fluid, particles::extra(world.w.s, volume::density_guess).begin());
  }

  bool complete_step(std::int64_t step) override {
    if constexpr (iterates) {
      residuals_->append(step, how.residuals);
      how.residuals.clear();
    }
    return base::complete_step(step);
  }

  // ---- what is told -----------------------------------------------------------------------

  void begin_tables(run::run_directory& files) override {
    base::begin_tables(files);
    const auto& material = eos::about(world.w.materials[0]);
    files.say(fmt::format("equation of state {}: {}{}", material.name, material.source,
                          material.illustrative ? " (illustrative)" : ""));
    if constexpr (iterates) residuals_.emplace(files.table("residuals.csv", residual_file::columns()));
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
  std::string hash() override { return hash_of_state(world); }

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

  void fail(const foundation::error& e, std::int64_t step, run::summary& r) override {
    if (const auto* diverged = dynamic_cast<const volume::divergence*>(&e)) {
      r.status = "diverged";
      r.diverged_step = step + 1;
      r.diverged_iteration = diverged->iteration();
    }
    if constexpr (iterates)
      if (residuals_) residuals_->append(step + 1, how.residuals);
  }

  void report_counts(run::summary& r) override {
    base::report_counts(r);
    if constexpr (iterates) {
      r.metrics["hosono_solver"] = how.how.solver;
      r.metrics["hosono_passes"] = how.passes;
      r.metrics["hosono_evaluations"] = how.evaluations;
      r.metrics["hosono_kappa"] = start_kappa_;
      r.metrics["hosono_growth_predicted"] =
          (start_kappa_ - 1.0) * (1.0 - kernels::transfer_minimum<D>(world.w.kernel, world.w.dx).value);
    }
  }

  // ---- checkpoints ------------------------------------------------------------------------

  void save(output::checkpoint_globals& g) const override {
    hydrostatic::save(start_.value_or(totals<D>{}), g);
    base::save(g);
    if constexpr (iterates) {
      g.integers["hosono_evaluations"] = how.evaluations;
      g.integers["hosono_passes"] = how.passes;
    }
  }
  void restore(const output::checkpoint_globals& g) override {
    start_ = totals_of_start<D>(g);
    base::restore(g);
    if constexpr (iterates) {
      how.evaluations = g.integers.at("hosono_evaluations");
      how.passes = g.integers.at("hosono_passes");
    }
  }

 protected:
  void make_lists(bool as_they_were) override { rebuild(world, as_they_were); }
  void place_walls() override { hydrostatic::place_walls(o_, world); }

 private:
  const options& o_;
  std::optional<residual_file> residuals_;
  std::optional<totals<D>> start_;
  double start_kappa_ = 0.0;  // K_T/p of the start state, at its largest
};

// Main program: reads the input, runs in 2-D or 3-D, returns the exit status.
template <class Program>
int program(int argc, char** argv) {
  options o;
  o.walls.treatment = Program::wall::name;
  const run::program_input own{
      .program = Program::name,
      .shorthands = {},
      .restarts = true,
      .declare = [&](namelist::schema& schema) { declare(schema, o); },
      .complete = [&](const namelist::schema& schema) { resolve(schema, o); },
      .need = [&] { return run::need_of(expected_particles(o), 420.0, o.kernel, o.domain.dimension); }};
  return run::start(argc, argv, own, [&](const run::command_line& line, const std::string& resolved) {
    if (o.domain.dimension == 3) {
      problem<Program, 3> box(o);
      run::carry_out(box, o, line, resolved);
    } else {
      problem<Program, 2> box(o);
      run::carry_out(box, o, line, resolved);
    }
  });
}

}  // namespace tetsuame::hydrostatic
