// A liquid at rest in a box, by the modules of a program: volume, pressure, walls, gradient (right_hand_side.hpp).
#pragma once

#include <fmt/format.h>

#include <functional>
#include <hydrostatic/load_balance.hpp>
#include <hydrostatic/measures.hpp>
#include <hydrostatic/residuals.hpp>
#include <hydrostatic/right_hand_side.hpp>
#include <hydrostatic/state.hpp>
#include <optional>
#include <run/state.hpp>
#include <run/time_loop.hpp>
#include <volume/hosono_iteration.hpp>

namespace tetsuame::hydrostatic {

template <class Program, int D>
class problem : public run::problem {
 public:
  using volume_module = typename Program::volume;
  static constexpr bool iterates = requires(volume_module v) { v.residuals; };

  scene<D> world;
  volume_module how{};
  load_balance<D> balancer;
  // Cuts from elsewhere, asked for whenever lists are made anew, in the balancer's place; the same on every rank.
  std::function<balance::cuts<D>(const balance::cuts<D>&)> other_cuts;

  explicit problem(const options& o, const domain::communicator& ranks = domain::communicator::world())
      : balancer(o), o_(o) {
    set_up(o, ranks, world);
    world.density_carried = volume_module::carried == volume::carries::density;
    world.weight_carried = volume_module::carried == volume::carries::weight;
    if constexpr (iterates) {
      how.how = o.hosono;
      volume::add_density_guess(world.w.s);
      volume::equation_of_state(world.w, world.w.s.fluid);
      start_kappa_ = volume::detail::largest_kappa(world.w);
    }
  }

  const domain::communicator& ranks() const override { return world.w.d.ranks; }
  std::size_t local_particles() const override { return world.w.s.fluid; }
  std::size_t simd_lanes() const override { return pairs::lanes; }
  foundation::stage_times& times() override { return world.w.times; }
  output::snapshot_header header() const override {
    output::snapshot_header header;
    header.dimension = D;
    for (std::size_t a = 0; a < D; ++a) {
      header.box_lengths[a] = o_.domain.length[a];
      header.periodic[a] = o_.domain.periodic[a];
    }
    return header;
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

  // The record of the iteration; walls as the last guard.
  bool complete_step(std::int64_t step) override {
    if constexpr (iterates) {
      residuals_->append(step, how.residuals);
      how.residuals.clear();
    }
    const std::int64_t crossings = walls::reflect(world.walls, world.w.s);
    wall_crossings_ += crossings;
    return crossings > 0;
  }

  double moved() override { return std::sqrt(particles::moved_since_lists(world.w.s)); }
  double allowance() const override { return 0.5 * world.skin; }
  double speed() override {
    const auto& s = world.w.s;
    double speed2 = 0.0;
#pragma omp parallel for schedule(static) reduction(max : speed2) if (s.fluid > foundation::values_worth_threads)
    for (std::size_t i = 0; i < s.fluid; ++i) {
      double v2 = 0.0;
      for (std::size_t a = 0; a < D; ++a) v2 += s.v[a][i] * s.v[a][i];
      speed2 = std::max(speed2, v2);
    }
    return std::sqrt(speed2);
  }

  // ---- lists and cuts ---------------------------------------------------------------------

  void rebuild(bool as_they_were) override {
    const foundation::stopwatch watch;
    if (as_they_were) {
      exchange_positions();
      hydrostatic::rebuild(world, keep_list_positions);
      exchange_positions();
    } else {
      domain::wrap(world.w.d.region, world.w.s);
      hydrostatic::rebuild(world);
    }
    if (!has_lists_) balancer.first_lists(world, watch.elapsed());
    has_lists_ = true;
  }

  bool renew(bool lists_are_due, std::int64_t step, std::int64_t left) override {
    if (lists_are_due) domain::wrap(world.w.d.region, world.w.s);
    auto verdict = decide_on_cuts(lists_are_due, left);
    const bool moves = verdict && verdict->decision.move;
    if (lists_are_due || moves) {
      const foundation::stage timed(world.w.times, moves ? "balance" : "lists");
      const auto had = static_cast<std::int64_t>(world.w.s.fluid);
      if (!lists_are_due) exchange_positions();
      const std::int64_t leaving = moves ? balancer.leaving(world) : 0;
      hydrostatic::rebuild(world, lists_are_due ? set_list_positions : keep_list_positions);
      if (!lists_are_due) exchange_positions();
      if (verdict) balancer.learn(world, *verdict, leaving, static_cast<std::int64_t>(world.w.s.fluid) - had + leaving);
    }
    if (verdict) note(*verdict, step);
    return lists_are_due || moves;
  }

  void worked(double seconds) override {
    balancer.computing += seconds;
    ++balancer.steps;
  }

  // ---- what is told -----------------------------------------------------------------------

  void begin_tables(run::run_directory& files) override {
    files_ = &files;
    const auto& material = eos::about(world.w.materials[0]);
    files.say(fmt::format("equation of state {}: {}{}", material.name, material.source,
                          material.illustrative ? " (illustrative)" : ""));
    if (balancer.mode != "off") balance_history_ = &files.table("balance.csv", balance_columns());
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
    report_counts(r);
  }

  void fail(const foundation::error& e, std::int64_t step, run::summary& r) override {
    if (const auto* diverged = dynamic_cast<const volume::divergence*>(&e)) {
      r.status = "diverged";
      r.diverged_step = step + 1;
      r.diverged_iteration = diverged->iteration();
    }
    if constexpr (iterates)
      if (residuals_) residuals_->append(step + 1, how.residuals);
    report_counts(r);
  }

  // ---- checkpoints ------------------------------------------------------------------------

  output::table_view particles_table(std::vector<std::int64_t>& materials) override {
    return run::checkpoint_table(world.w.s, materials);
  }
  void read_particles(const output::table& t) override { run::fluid_from_checkpoint(t, world.w.s); }
  void save(output::checkpoint_globals& g) const override {
    hydrostatic::save(start_.value_or(totals<D>{}), g);
    g.integers["wall_crossings"] = ranks().sum(wall_crossings_);
    if constexpr (iterates) {
      g.integers["hosono_evaluations"] = how.evaluations;
      g.integers["hosono_passes"] = how.passes;
    }
  }
  void restore(const output::checkpoint_globals& g) override {
    start_ = totals_of_start<D>(g);
    wall_crossings_ = ranks().rank == 0 ? g.integers.at("wall_crossings") : 0;
    if constexpr (iterates) {
      how.evaluations = g.integers.at("hosono_evaluations");
      how.passes = g.integers.at("hosono_passes");
    }
  }

 private:
  // Cuts that are to move have done so, particles have not.
  std::optional<typename load_balance<D>::verdict> decide_on_cuts(bool lists_are_due, std::int64_t left) {
    if (other_cuts) {
      if (lists_are_due) move_cuts(o_, world, other_cuts(world.w.d.cuts));
      return {};
    }
    if (ranks().size == 1 || !balancer.due(lists_are_due)) return {};
    const foundation::stage timed(world.w.times, "balance");
    auto verdict = balancer.decide(world, lists_are_due, left);
    if (verdict && verdict->decision.move) move_cuts(o_, world, verdict->cuts);
    return verdict;
  }

  void note(const typename load_balance<D>::verdict& v, std::int64_t step) {
    files_->say(fmt::format("step {}: spread {:.1f} %, {}", step, 100.0 * v.spread.over_mean(), v.decision.reason));
    if (balance_history_)
      balance_history_->append(step,
                               std::array{v.spread.over_mean(), 1.0 / v.spread.efficiency(), v.decision.gain,
                                          v.decision.cost, v.decision.move ? 1.0 : 0.0, v.migrated},
                               v.decision.reason);
  }

  static std::vector<output::history_column> balance_columns() {
    return {{"spread", "1"}, {"max_over_mean", "1"}, {"gain", "s or pairs"}, {"cost", "s or pairs"},
            {"moved", "1"},  {"migrated", "1"},      {"reason", "text"}};
  }

  // Lists stand where they stood, so that sums keep their order: they are made from the positions
  // of that time, and the present ones put back after.
  void exchange_positions() {  // of the fluid: walls stay where they are
    auto& s = world.w.s;
    for (std::size_t n = 0; n < D; ++n)
      std::swap_ranges(s.x[n].begin(), s.x[n].begin() + static_cast<std::ptrdiff_t>(s.fluid), s.x_list[n].begin());
  }

  void report_counts(run::summary& r) {
    r.wall_particles = ranks().sum(static_cast<std::int64_t>(world.w.s.walls));
    r.metrics["wall_crossings"] = ranks().sum(wall_crossings_);
    r.metrics["balance_decisions"] = balancer.decisions;
    r.metrics["balance_moves"] = balancer.moves;
    r.metrics["balance_gain_predicted"] = balancer.gain_predicted;
    r.metrics["balance_seconds"] = ranks().maximum(balancer.seconds);
    r.metrics["time_spread"] = balancer.time_spread_now(ranks());
    communication.describe(world.w.d, r.metrics);
    if constexpr (iterates) {
      r.metrics["hosono_solver"] = how.how.solver;
      r.metrics["hosono_passes"] = how.passes;
      r.metrics["hosono_evaluations"] = how.evaluations;
      r.metrics["hosono_kappa"] = start_kappa_;
      r.metrics["hosono_growth_predicted"] =
          (start_kappa_ - 1.0) * (1.0 - kernels::transfer_minimum<D>(world.w.kernel, world.w.dx).value);
    }
  }

  const options& o_;
  run::run_directory* files_ = nullptr;
  output::history* balance_history_ = nullptr;
  std::optional<residual_file> residuals_;
  std::optional<totals<D>> start_;
  std::int64_t wall_crossings_ = 0;  // of this rank
  bool has_lists_ = false;
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
