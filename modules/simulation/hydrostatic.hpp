// The time loop the six programs share. Read `advance` first: it is the algorithm.
#pragma once

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <foundation/waiting.hpp>
#include <functional>
#include <integrators/explicit_integrator.hpp>
#include <memory>
#include <optional>
#include <output/history.hpp>
#include <output/progress.hpp>
#include <simulation/command_line.hpp>
#include <simulation/communication.hpp>
#include <simulation/load_balance.hpp>
#include <simulation/measures.hpp>
#include <simulation/records.hpp>
#include <simulation/residuals.hpp>
#include <simulation/restart.hpp>
#include <simulation/right_hand_side.hpp>
#include <simulation/run_directory.hpp>
#include <simulation/state.hpp>
#include <simulation/summary.hpp>
#include <volume/hosono_iteration.hpp>

namespace tetsuame::simulation {

template <class Program, int D>
struct run {
  using volume_module = typename Program::volume;
  static constexpr int simd_lanes = static_cast<int>(pairs::lanes);
  static constexpr bool iterates = requires(volume_module v) { v.residuals; };

  const command_line& line;
  const options& o;
  const std::string& resolved;
  domain::communicator ranks = domain::communicator::world();

  scene<D> world;
  volume_module how{};
  std::unique_ptr<integrators::explicit_integrator> integrator;
  std::int64_t step = 0;
  std::int64_t wall_crossings = 0;  // of this rank
  totals<D> start_totals;

  run_directory files{ranks, line, resolved, simd_lanes};
  summary& report = files.report;
  std::optional<residual_file> residuals;
  communication_meter communication;

  load_balance<D> balancer;
  output::history* balance_history = nullptr;
  // Cuts from elsewhere, asked for whenever lists are made anew, in the balancer's place; the same on every rank.
  std::function<balance::cuts<D>(const balance::cuts<D>&)> other_cuts;

  // What all ranks know together after a step.
  struct {
    double speed2 = 0.0, moved2 = 0.0;  // m2/s2, m2, the largest; the latter since the lists were made
    double stop = 0.0;                  // why to stop; 0: nobody asks for it
    double since_checkpoint = 0.0;      // s, by rank 0's clock
    bool crossed = false;               // a particle was put back inside the walls
  } news;

  run(const command_line& command, const input& in)
      : line(command), o(in.values), resolved(in.resolved), balancer(in.values) {}

  // ---- evaluation and stepping ------------------------------------------------------------

  int right_hand_side(std::span<double* const> rate) {
    // A stage may leave what the lists cover: a smaller step then helps, where there is a choice.
    const double moved = std::sqrt(ranks.maximum(moved_since_lists(world.w.s)));
    if (!(moved <= 0.5 * world.skin)) {
      if (o.time.method == "adaptive") return 1;
      foundation::fail_calculation(fmt::format(
          "particles moved {:.3g} m within one step, more than half the skin of the neighbour lists ({:.3g} m): "
          "the time step is too large, or the flow has blown up",
          moved, 0.5 * world.skin));
    }
    evaluate<Program>(world, how, o.smoothing, rate);
    return 0;
  }

  // Brings p, ρ and the rest up to date with the state, for measuring and output.
  void evaluate_here() {
    std::vector<particles::array> rates(state_fields(world, o.time).size(), particles::array(world.w.s.fluid));
    std::vector<double*> pointers;
    for (auto& a : rates) pointers.push_back(a.data());
    evaluate<Program>(world, how, o.smoothing, pointers);
  }

  void make_integrator(double t) {
    integrators::explicit_options how_to;
    how_to.method = o.time.method;
    how_to.order = static_cast<int>(o.time.order);
    how_to.dt = o.time.dt;
    how_to.rtol = o.time.rtol;
    integrator = std::make_unique<integrators::explicit_integrator>(
        ranks.comm, state_fields(world, o.time), world.w.s.fluid, t, how_to,
        [this](double, std::span<double* const> rate) { return right_hand_side(rate); },
        [this](double) { return measure_limits(world, o.time).least(); });
  }

  // One reduction for all that a step has to agree on.
  void hear_news(std::int64_t crossings) {
    const auto& s = world.w.s;
    double speed2 = 0.0;
#pragma omp parallel for schedule(static) reduction(max : speed2) if (s.fluid > foundation::values_worth_threads)
    for (std::size_t i = 0; i < s.fluid; ++i) {
      double v2 = 0.0;
      for (std::size_t a = 0; a < D; ++a) v2 += s.v[a][i] * s.v[a][i];
      speed2 = std::max(speed2, v2);
    }
    std::array<double, 5> most{speed2, moved_since_lists(s), files.stop_reason(o.run),
                               ranks.rank == 0 ? files.checkpoint_age() : 0.0, crossings > 0 ? 1.0 : 0.0};
    ranks.maximum(most);
    news = {most[0], most[1], most[2], most[3], most[4] > 0.0};
  }

  // New lists before the next step could outrun the old ones; new cuts where these pay.
  void refresh_lists() {
    const double speed = std::sqrt(news.speed2), moved = std::sqrt(news.moved2);
    const double dt = o.time.method == "adaptive" ? integrator->statistics().next_dt : o.time.dt;
    const bool lists_are_due = moved + 1.5 * speed * dt > 0.5 * world.skin && moved > 0.0;
    if (lists_are_due) domain::wrap(world.w.d.region, world.w.s);
    auto verdict = decide_on_cuts(lists_are_due);
    const bool moves = verdict && verdict->decision.move;
    if (lists_are_due || moves) {
      const foundation::stage timed(world.w.times, moves ? "balance" : "lists");
      if (!lists_are_due) exchange_positions();
      const auto had = static_cast<std::int64_t>(world.w.s.fluid);
      const std::int64_t left = moves ? balancer.leaving(world) : 0;
      rebuild(world, lists_are_due ? set_list_positions : keep_list_positions);
      if (verdict) balancer.learn(world, *verdict, left, static_cast<std::int64_t>(world.w.s.fluid) - had + left);
      if (!lists_are_due) exchange_positions();
      integrator->resize(state_fields(world, o.time), world.w.s.fluid);
    }
    if (verdict) note(*verdict);
  }

  // Cuts that are to move have done so, particles have not.
  std::optional<typename load_balance<D>::verdict> decide_on_cuts(bool lists_are_due) {
    if (other_cuts) {
      if (lists_are_due) move_cuts(o, world, other_cuts(world.w.d.cuts));
      return {};
    }
    if (ranks.size == 1 || !balancer.due(lists_are_due)) return {};
    const foundation::stage timed(world.w.times, "balance");
    auto verdict = balancer.decide(world, lists_are_due, last_step() - step);
    if (verdict && verdict->decision.move) move_cuts(o, world, verdict->cuts);
    return verdict;
  }

  void note(const typename load_balance<D>::verdict& v) {
    files.say(fmt::format("step {}: spread {:.1f} %, {}", step, 100.0 * v.spread.over_mean(), v.decision.reason));
    if (balance_history)
      balance_history->append(step,
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

  // A step of the integrator, with what it cost this rank.
  void timed_step() {
    const stopwatch watch;
    {
      const foundation::stage timed(world.w.times, "integration");
      start_from_present_state();
      const auto end = choose_end();
      integrator->step(end.t, end.by);
    }
    balancer.computing += watch.busy();
    ++balancer.steps;
  }

  // The iteration for Y starts from what it found at the last state that was reached. The start value
  // moves on only when the rate there is known, so that a restart, which has to find that rate
  // again, finds the same bits.
  void start_from_present_state() {
    if constexpr (iterates) {
      integrator->prepare();
      std::copy_n(world.w.s.rho.begin(), world.w.s.fluid, particles::extra(world.w.s, volume::density_guess).begin());
    }
  }

  // What follows a completed step: the record of the iteration, walls as the last guard.
  void complete_step() {
    auto& s = world.w.s;
    ++step;
    if constexpr (iterates) {
      residuals->append(step, how.residuals);
      how.residuals.clear();
    }
    const std::int64_t crossings = walls::reflect(world.walls, s);
    wall_crossings += crossings;
    hear_news(crossings);
    if (news.crossed) integrator->state_changed();
  }

  double t_end() const { return o.time.end(); }
  bool finished() const { return step >= last_step() || integrator->time() >= t_end() * (1.0 - 1e-12); }
  std::int64_t last_step() const { return o.time.last_step(o.output.interval); }

  // Where the next step must end. Fixed steps keep their length but for output times and the end.
  next_end choose_end() const {
    const double interval = o.output.interval;
    if (o.time.method == "adaptive") return {files.last_end(t_end(), interval), "output"};
    return files.end_of_fixed_step(integrator->time(), o.time.dt, {o.time.dt, "fixed"}, t_end(), interval);
  }

  void advance() {
    output::progress_state now = progress();
    output::progress line_of_progress(ranks.rank == 0, stderr, now);
    hear_news(0);
    while (!finished()) {
      if (news.stop > 0.0) {
        line_of_progress.finish(progress());
        interrupt_run();
      }
      const auto before = seconds_clock::now();
      communication.begin();
      refresh_lists();
      timed_step();
      complete_step();
      communication.end();
      files.stepping_seconds += since(before);
      record();
      line_of_progress.update(progress());
    }
    line_of_progress.finish(progress());
  }

  output::progress_state progress() const {
    const auto& statistics = integrator->statistics();
    return {step,
            last_step() < o.time.steps + 1 ? o.time.steps : 0,
            integrator->time(),
            t_end(),
            statistics.last_dt,
            static_cast<std::uint64_t>(statistics.evaluations) * static_cast<std::uint64_t>(world.fluid_total)};
  }

  // ---- output -----------------------------------------------------------------------------

  simulation::records records{{.evaluate = [this] { evaluate_here(); },
                               .line = [this] { append_history(); },
                               .snapshot = [this] { write_snapshot(); },
                               .checkpoint = [this] { write_checkpoint(); }}};

  void record() {
    records.lines_and_snapshots(step, step % o.output.history_interval == 0,
                                files.snapshot_due(integrator->time(), o.output.interval));
    const bool by_steps = o.run.checkpoint_interval > 0 && step % o.run.checkpoint_interval == 0;
    const bool by_time = o.run.checkpoint_seconds > 0.0 && news.since_checkpoint >= o.run.checkpoint_seconds;
    if (finished() || by_steps || by_time) records.checkpoint(step);
  }

  void append_history() {
    const foundation::stage timed(world.w.times, "output");
    const auto e = measure_errors(world);
    const auto t = measure_totals(world);
    files.append_line(step, std::array{integrator->time(), integrator->statistics().last_dt, e.pressure_mean,
                                       e.pressure_max, e.density_max, e.displacement_max_over_dx, t.kinetic,
                                       t.potential, t.internal, t.energy() - start_totals.energy()});
  }

  static std::vector<output::history_column> history_columns() {
    return {{"time", "s"},
            {"dt", "s"},
            {"pressure_error_mean", "1"},
            {"pressure_error_max", "1"},
            {"density_error_max", "1"},
            {"displacement_max", "dx"},
            {"kinetic_energy", "J"},
            {"potential_energy", "J"},
            {"internal_energy_gained", "J"},
            {"energy_change", "J"}};
  }

  void write_snapshot() {
    const foundation::stage timed(world.w.times, "output");
    output::snapshot_header header;
    header.time = integrator->time();
    header.step = step;
    header.dimension = D;
    for (std::size_t a = 0; a < D; ++a) {
      header.box_lengths[a] = o.domain.length[a];
      header.periodic[a] = o.domain.periodic[a];
    }
    std::vector<particles::array> extra;
    const auto groups = snapshot_groups(world, o.kernel.h_over_dx * world.w.dx, extra);
    files.write_snapshot(header, groups, o.output.interval);
  }

  void write_checkpoint() {
    const foundation::stage timed(world.w.times, "output");
    output::checkpoint_globals g;
    save(start_totals, g);
    g.integers["wall_crossings"] = ranks.sum(wall_crossings);
    if constexpr (iterates) {
      g.integers["hosono_evaluations"] = how.evaluations;
      g.integers["hosono_passes"] = how.passes;
    }
    std::vector<std::int64_t> materials;
    records.save(g);
    files.write_checkpoint(step, *integrator, std::move(g), checkpoint_table(world.w.s, materials));
  }

  // ---- start, restart, end ----------------------------------------------------------------

  [[noreturn]] void interrupt_run() {
    write_checkpoint();
    files.interrupt(news.stop, step, last_step() > o.time.steps ? "" : fmt::format(" of {}", o.time.steps),
                    integrator->time());
  }

  void start_anew() {
    const stopwatch watch;
    rebuild(world);
    balancer.first_lists(world, watch.elapsed());
    make_integrator(0.0);
    files.begin();
    files.start_history(history_columns());
    start_other_tables();
    evaluate_here();
    start_totals = measure_totals(world);
    records.begin(step);
  }

  void continue_from(const output::latest_checkpoint& saved) {
    fluid_from_checkpoint(saved.state.tables.at("fluid"), world.w.s);
    exchange_positions();
    const stopwatch watch;
    rebuild(world, keep_list_positions);
    balancer.first_lists(world, watch.elapsed());
    exchange_positions();
    make_integrator(0.0);
    step = files.continue_from(saved, *integrator, history_columns(), o.output.interval);
    restore(saved.state.globals);
    start_other_tables();
    evaluate_here();
  }

  void start_other_tables() {
    if (balancer.mode != "off") balance_history = &files.table("balance.csv", balance_columns());
    if constexpr (iterates) residuals.emplace(files.table("residuals.csv", residual_file::columns()));
  }

  void restore(const output::checkpoint_globals& g) {
    start_totals = totals_of_start<D>(g);
    records.restore(g, step, files.continues_here());
    wall_crossings = ranks.rank == 0 ? g.integers.at("wall_crossings") : 0;
    if constexpr (iterates) {
      how.evaluations = g.integers.at("hosono_evaluations");
      how.passes = g.integers.at("hosono_passes");
    }
  }

  void fill_report() {
    files.fill_report(step, integrator.get());
    report.dimension = D;
    report.fluid_particles = world.fluid_total;
    report.wall_particles = ranks.sum(static_cast<std::int64_t>(world.w.s.walls));
    report.stages = world.w.times.seconds();
    report.metrics["wall_crossings"] = ranks.sum(wall_crossings);
    report.metrics["balance_decisions"] = balancer.decisions;
    report.metrics["balance_moves"] = balancer.moves;
    report.metrics["balance_gain_predicted"] = balancer.gain_predicted;
    report.metrics["balance_seconds"] = ranks.maximum(balancer.seconds);
    report.metrics["time_spread"] = balancer.time_spread_now(ranks);
    communication.describe(world.w.d, report.metrics);
    if constexpr (iterates) {
      report.metrics["hosono_solver"] = how.how.solver;
      report.metrics["hosono_passes"] = how.passes;
      report.metrics["hosono_evaluations"] = how.evaluations;
      const double kappa = start_kappa;
      report.metrics["hosono_kappa"] = kappa;
      report.metrics["hosono_growth_predicted"] =
          (kappa - 1.0) * (1.0 - kernels::transfer_minimum<D>(world.w.kernel, world.w.dx).value);
    }
  }

  // Needs an evaluation at the final state.
  void measure_report() {
    const auto e = measure_errors(world);
    const auto t = measure_totals(world);
    const auto limits = measure_limits(world, o.time);
    report.set_errors(e.pressure_mean, e.pressure_max, e.density_max, e.displacement_max_over_dx);
    double momentum = 0.0;
    for (std::size_t a = 0; a < D; ++a)
      momentum = std::max(momentum, std::abs(t.momentum[a] - start_totals.momentum[a]) / start_totals.sound_momentum);
    report.set_conservation((t.mass - start_totals.mass) / start_totals.mass, momentum,
                            (t.energy() - start_totals.energy()) / start_totals.pressure_volume);
    report.metrics["limit_cfl"] = bound_or_null(limits.cfl);
    report.metrics["limit_viscous"] = bound_or_null(limits.viscous);
    report.metrics["limit_thermal"] = bound_or_null(limits.thermal);
    report.metrics["limit_least"] = limits.least().name;
    report.metrics["lattice_sum"] = world.w.lattice_sum;
    report.state_hash = hash_of_state(world);
  }

  void warn_about_step() {
    const auto least = measure_limits(world, o.time).least();
    if (o.time.method == "adaptive" || o.time.dt <= least.dt) return;
    files.tell(fmt::format("warning: dt = {:.3g} s is above the {} limit, {:.3g} s; expect it to blow up", o.time.dt,
                           least.name, least.dt));
  }

  double start_kappa = 0.0;  // K_T/p of the start state, at its largest

  void set_up_world() {
    set_up(o, ranks, world);
    world.density_carried = volume_module::carried == volume::carries::density;
    world.weight_carried = volume_module::carried == volume::carries::weight;
    if constexpr (iterates) {
      how.how = o.hosono;
      volume::add_density_guess(world.w.s);
      volume::equation_of_state(world.w, world.w.s.fluid);
      start_kappa = volume::detail::largest_kappa(world.w);
    }
  }

  void carry_out() {
    set_up_world();
    auto found = files.open();
    const auto& material = eos::about(world.w.materials[0]);
    files.say(fmt::format("equation of state {}: {}{}", material.name, material.source,
                          material.illustrative ? " (illustrative)" : ""));
    try {
      if (found)
        continue_from(*found);
      else
        start_anew();
      found.reset();
      warn_about_step();
      advance();
      records.end(step);
      measure_report();
      fill_report();
      files.complete(step, integrator->time(), t_end(), "");
    } catch (const foundation::error& e) {
      files.fail(e, step, [&] { save_what_there_is(e); });
    }
  }

  // The last good state is in the arrays: it goes to disk with the reason.
  void save_what_there_is(const foundation::error& e) {
    if (const auto* diverged = dynamic_cast<const volume::divergence*>(&e)) {
      report.status = "diverged";
      report.diverged_step = step + 1;
      report.diverged_iteration = diverged->iteration();
    }
    if constexpr (iterates)
      if (residuals) residuals->append(step + 1, how.residuals);
    if (e.status() == foundation::exit_status::calculation_failed && integrator) write_checkpoint();
    fill_report();
  }
};

// Main program: reads the input, runs in 2-D or 3-D, returns the exit status.
template <class Program>
int hydrostatic(int argc, char** argv) {
  return start(argc, argv, Program::name, Program::wall::name, [](const command_line& line, const input& in) {
    if (in.values.domain.dimension == 3)
      run<Program, 3>(line, in).carry_out();
    else
      run<Program, 2>(line, in).carry_out();
  });
}

}  // namespace tetsuame::simulation
