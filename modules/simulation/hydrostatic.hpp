// The time loop the six programs share. Read `advance` first: it is the algorithm.
#pragma once

#include <fmt/format.h>
#include <omp.h>

#include <chrono>
#include <filesystem>
#include <foundation/waiting.hpp>
#include <functional>
#include <integrators/explicit_integrator.hpp>
#include <memory>
#include <optional>
#include <output/directory.hpp>
#include <output/history.hpp>
#include <output/log.hpp>
#include <output/progress.hpp>
#include <output/series.hpp>
#include <simulation/command_line.hpp>
#include <simulation/communication.hpp>
#include <simulation/interrupt.hpp>
#include <simulation/load_balance.hpp>
#include <simulation/measures.hpp>
#include <simulation/residuals.hpp>
#include <simulation/restart.hpp>
#include <simulation/right_hand_side.hpp>
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
  std::int64_t step = 0, snapshots = 0;
  double next_snapshot = 0.0;       // s
  std::int64_t wall_crossings = 0;  // of this rank
  totals<D> start_totals;

  std::optional<output::run_log> log;
  std::optional<output::history> history;
  std::optional<residual_file> residuals;
  output::series series;
  std::optional<output::latest_checkpoint> found;  // to be continued
  std::string good_checkpoint;                     // the newest; empty: none
  summary report;
  std::chrono::steady_clock::time_point began = std::chrono::steady_clock::now(), last_checkpoint = began;
  double stepping_seconds = 0.0;
  communication_meter communication;

  load_balance<D> balancer;
  std::optional<output::history> balance_history;
  // Cuts from elsewhere, asked for whenever lists are made anew, in the balancer's place; the same on every rank.
  std::function<balance::cuts<D>(const balance::cuts<D>&)> other_cuts;

  // What all ranks know together after a step.
  struct {
    double speed2 = 0.0, moved2 = 0.0;  // m2/s2, m2, the largest; the latter since the lists were made
    bool stop = false;                  // a signal came, or the wall-clock limit is reached
    double since_checkpoint = 0.0;      // s, by rank 0's clock
    bool crossed = false;               // a particle was put back inside the walls
  } news;

  run(const command_line& command, const input& in)
      : line(command), o(in.values), resolved(in.resolved), balancer(in.values) {}

  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(); }

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
    const bool late = o.run.wall_clock_limit > 0.0 && seconds() >= o.run.wall_clock_limit;
    const double since = std::chrono::duration<double>(std::chrono::steady_clock::now() - last_checkpoint).count();
    std::array<double, 5> most{speed2, moved_since_lists(s), stop_requested() || late ? 1.0 : 0.0,
                               ranks.rank == 0 ? since : 0.0, crossings > 0 ? 1.0 : 0.0};
    ranks.maximum(most);
    news = {most[0], most[1], most[2] > 0.0, most[3], most[4] > 0.0};
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
    auto verdict = balancer.decide(world, lists_are_due, o.time.steps - step);
    if (verdict && verdict->decision.move) move_cuts(o, world, verdict->cuts);
    return verdict;
  }

  void note(const typename load_balance<D>::verdict& v) {
    say(fmt::format("step {}: spread {:.1f} %, {}", step, 100.0 * v.spread.over_mean(), v.decision.reason));
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
      integrator->step(next_stop());
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

  bool finished() const { return step >= o.time.steps || integrator->time() >= *o.time.t_end * (1.0 - 1e-12); }

  // Where the next step must stop: fixed steps keep their length but for the last one.
  double next_stop() const {
    if (o.time.method != "adaptive") {
      const double t = integrator->time(), end = *o.time.t_end;
      return end - t < o.time.dt * (1.0 + 1e-6) && end - t > o.time.dt * (1.0 - 1e-6) ? t + 2.0 * o.time.dt : end;
    }
    return o.output.interval > 0.0 ? std::min(*o.time.t_end, next_snapshot) : *o.time.t_end;
  }

  void advance() {
    output::progress_state now = progress();
    output::progress line_of_progress(ranks.rank == 0, stderr, now);
    hear_news(0);
    while (!finished()) {
      if (news.stop) {
        line_of_progress.finish(progress());
        interrupt_run();
      }
      const auto before = std::chrono::steady_clock::now();
      communication.begin();
      refresh_lists();
      timed_step();
      complete_step();
      communication.end();
      stepping_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
      record();
      line_of_progress.update(progress());
    }
    line_of_progress.finish(progress());
  }

  output::progress_state progress() const {
    const auto& statistics = integrator->statistics();
    return {step,
            o.time.method == "adaptive" ? 0 : o.time.steps,
            integrator->time(),
            *o.time.t_end,
            statistics.last_dt,
            static_cast<std::uint64_t>(statistics.evaluations) * static_cast<std::uint64_t>(world.fluid_total)};
  }

  // ---- output -----------------------------------------------------------------------------

  void record() {
    const double t = integrator->time();
    const bool snapshot_due = o.output.interval > 0.0 && t >= next_snapshot * (1.0 - 1e-9);
    const bool row_due = step % o.output.history_interval == 0;
    if (snapshot_due || row_due || finished()) evaluate_here();
    if (row_due || finished()) append_history();
    if (snapshot_due || finished()) write_snapshot();
    const bool by_steps = o.run.checkpoint_interval > 0 && step % o.run.checkpoint_interval == 0;
    if (by_steps || (o.run.checkpoint_seconds > 0.0 && news.since_checkpoint >= o.run.checkpoint_seconds))
      write_checkpoint();
  }

  void append_history() {
    const foundation::stage timed(world.w.times, "output");
    const auto e = measure_errors(world);
    const auto t = measure_totals(world);
    history->append(step, std::array{integrator->time(), integrator->statistics().last_dt, e.pressure_mean,
                                     e.pressure_max, e.density_max, e.displacement_max_over_dx, t.kinetic, t.potential,
                                     t.internal, t.energy() - start_totals.energy()});
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
    const auto groups = snapshot_groups(world, o.h_over_dx * world.w.dx, extra);
    const std::string name = output::snapshot_name(static_cast<int>(snapshots));
    output::write_snapshot(ranks.comm, line.output + "/" + name, header, groups, {line.program, version(), resolved});
    output::add_to_series(ranks.comm, line.output, name, series);
    ++snapshots;
    while (o.output.interval > 0.0 && next_snapshot <= integrator->time() * (1.0 + 1e-9) + 1e-300)
      next_snapshot += o.output.interval;
  }

  void write_checkpoint() {
    const foundation::stage timed(world.w.times, "output");
    output::checkpoint_globals g;
    save(integrator->save(), g);
    save(start_totals, g);
    g.reals["next_snapshot"] = next_snapshot;
    g.reals["stepping_seconds"] = stepping_seconds;
    g.integers["step"] = step;
    g.integers["simd_lanes"] = simd_lanes;
    g.integers["snapshots"] = snapshots;
    g.integers["wall_crossings"] = ranks.sum(wall_crossings);
    if constexpr (iterates) {
      g.integers["hosono_evaluations"] = how.evaluations;
      g.integers["hosono_passes"] = how.passes;
    }
    g.texts = {{"program", line.program}, {"input", resolved}, {"version", version()}};
    std::vector<std::int64_t> materials;
    const auto path =
        output::write_checkpoint(ranks.comm, line.output, step, g, {checkpoint_table(world.w.s, materials)});
    last_checkpoint = std::chrono::steady_clock::now();
    good_checkpoint = path;
    say(fmt::format("checkpoint {} at step {}", path, step));
  }

  void say(const std::string& text) {
    if (log) log->write(text);
  }

  // ---- start, restart, end ----------------------------------------------------------------

  [[noreturn]] void interrupt_run() {
    write_checkpoint();
    throw foundation::error(
        foundation::exit_status::interrupted,
        fmt::format("stopped at step {} of {}, t = {:.6g} s, after a checkpoint: continue with --restart latest", step,
                    o.time.steps, integrator->time()));
  }

  void start_anew() {
    const stopwatch watch;
    rebuild(world);
    balancer.first_lists(world, watch.elapsed());
    make_integrator(0.0);
    history = output::history::start(ranks.comm, line.output + "/history.csv", history_columns());
    if (balancer.mode != "off")
      balance_history = output::history::start(ranks.comm, line.output + "/balance.csv", balance_columns());
    if constexpr (iterates) residuals = residual_file::start(ranks, line.output + "/residuals.csv");
    evaluate_here();
    start_totals = measure_totals(world);
    append_history();
    write_snapshot();
  }

  // Read and checked before anything is written: one that does not fit leaves the directory as it was.
  output::latest_checkpoint read_saved() const {
    output::latest_checkpoint saved;
    if (line.restart == "latest")
      saved = output::find_latest(ranks.comm, line.output);
    else
      saved = {line.restart, output::read_checkpoint(ranks.comm, line.restart), {}};
    const auto& texts = saved.state.globals.texts;
    check_restart(texts.at("program"), texts.at("input"), line.program, resolved);
    return saved;
  }

  void continue_from_checkpoint() {
    for (const auto& message : found->messages) {
      say(message);
      if (ranks.rank == 0) fmt::print(stderr, "{}: {}\n", line.program, message);
    }
    say("continuing from " + found->path);
    good_checkpoint = found->path;
    const output::checkpoint saved = std::move(found->state);
    found.reset();
    if (const auto before = saved.globals.integers.at("simd_lanes"); before != simd_lanes)
      say(
          fmt::format("the checkpoint was written with {} SIMD lanes, this run has {}: sums are rounded in another "
                      "order, so the last digits will differ from the uninterrupted run's",
                      before, simd_lanes));
    fluid_from_checkpoint(saved.tables.at("fluid"), world.w.s);
    exchange_positions();
    const stopwatch watch;
    rebuild(world, keep_list_positions);
    balancer.first_lists(world, watch.elapsed());
    exchange_positions();
    make_integrator(0.0);
    restore(saved.globals);
    output::forget_checkpoints_after(ranks.comm, line.output, step);
    history = output::history::resume(ranks.comm, line.output + "/history.csv", history_columns(), step);
    if (balancer.mode != "off")
      balance_history = output::history::resume(ranks.comm, line.output + "/balance.csv", balance_columns(), step);
    if constexpr (iterates) residuals = residual_file::resume(ranks, line.output + "/residuals.csv", step);
    series = output::continue_series(ranks.comm, line.output, static_cast<int>(snapshots));
    evaluate_here();
  }

  void restore(const output::checkpoint_globals& g) {
    integrator->restore(integrator_memory(g));
    start_totals = totals_of_start<D>(g);
    step = g.integers.at("step");
    snapshots = g.integers.at("snapshots");
    next_snapshot = g.reals.at("next_snapshot");
    wall_crossings = ranks.rank == 0 ? g.integers.at("wall_crossings") : 0;
    stepping_seconds = g.reals.at("stepping_seconds");
    if constexpr (iterates) {
      how.evaluations = g.integers.at("hosono_evaluations");
      how.passes = g.integers.at("hosono_passes");
    }
  }

  void fill_report() {
    report.program = line.program;
    report.steps = step;
    report.dimension = D;
    report.fluid_particles = world.fluid_total;
    report.wall_particles = ranks.sum(static_cast<std::int64_t>(world.w.s.walls));
    report.ranks = ranks.size;
    report.threads = omp_get_max_threads();
    report.simd_lanes = simd_lanes;
    report.wall_seconds = seconds();
    report.stepping_seconds = stepping_seconds;
    report.stages = world.w.times.seconds();
    report.metrics["wall_crossings"] = ranks.sum(wall_crossings);
    report.metrics["balance_decisions"] = balancer.decisions;
    report.metrics["balance_moves"] = balancer.moves;
    report.metrics["balance_gain_predicted"] = balancer.gain_predicted;
    report.metrics["balance_seconds"] = ranks.maximum(balancer.seconds);
    report.metrics["time_spread"] = balancer.time_spread_now(ranks);
    communication.describe(world.w.d, report.metrics);
    if (integrator) {
      report.time = integrator->time();
      report.statistics = integrator->statistics();
    }
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
    report.metrics["limit_cfl"] = limits.cfl;
    report.metrics["limit_viscous"] = limits.viscous;
    report.metrics["limit_thermal"] = limits.thermal;
    report.metrics["limit_least"] = limits.least().name;
    report.metrics["lattice_sum"] = world.w.lattice_sum;
    report.state_hash = hash_of_state(world);
  }

  void warn_about_step() {
    const auto least = measure_limits(world, o.time).least();
    if (o.time.method == "adaptive" || o.time.dt <= least.dt) return;
    const auto text = fmt::format("warning: dt = {:.3g} s is above the {} limit, {:.3g} s; expect it to blow up",
                                  o.time.dt, least.name, least.dt);
    say(text);
    if (ranks.rank == 0) fmt::print(stderr, "{}: {}\n", line.program, text);
  }

  double start_kappa = 0.0;  // K_T/p of the start state, at its largest

  void prepare() {
    using mode = output::directory_mode;
    if (ranks.maximum(simd_lanes) != ranks.minimum(simd_lanes))
      foundation::fail_input(
          "some ranks run on processors with AVX-512 and some without: results would depend on where a particle is. "
          "Set TETSUAME_SIMD=avx2 in the environment of all ranks");
    set_up(o, ranks, world);
    world.density_carried = volume_module::carried == volume::carries::density;
    world.weight_carried = volume_module::carried == volume::carries::weight;
    if constexpr (iterates) {
      how.how = o.hosono;
      volume::add_density_guess(world.w.s);
      volume::equation_of_state(world.w, world.w.s.fluid);
      start_kappa = volume::detail::largest_kappa(world.w);
    }
    output::open_directory(ranks.comm, line.output,
                           !line.restart.empty() ? mode::restart
                           : line.force          ? mode::force
                                                 : mode::fresh);
    if (!line.restart.empty()) found = read_saved();
    log.emplace(ranks.comm, line.output + "/run.log");
    say(fmt::format("{} {} on {} ranks x {} threads, input {}", line.program, version(), ranks.size,
                    omp_get_max_threads(), line.input));
    const auto& material = eos::about(world.w.materials[0]);
    say(fmt::format("equation of state {}: {}{}", material.name, material.source,
                    material.illustrative ? " (illustrative)" : ""));
    write_text(ranks, line.output + "/resolved.nml", resolved);
    watch_signals();
  }

  void carry_out() {
    prepare();
    try {
      if (line.restart.empty())
        start_anew();
      else
        continue_from_checkpoint();
      warn_about_step();
      advance();
      evaluate_here();
      measure_report();
      report.status = "completed";
      report.message = fmt::format("completed {} steps, t = {:.6g} s", step, integrator->time());
      finish();
    } catch (const foundation::error& e) {
      fail(e);
    }
  }

  void finish() {
    fill_report();
    report.write(ranks, line.output);
    say(report.message);
    if (ranks.rank == 0) report.print();
  }

  // The last good state is in the arrays: it goes to disk with the reason.
  [[noreturn]] void fail(const foundation::error& e) {
    using foundation::exit_status;
    std::string message = e.what();
    if (e.status() == exit_status::calculation_failed) message = fmt::format("step {}: {}", step + 1, message);
    report.status = e.status() == exit_status::interrupted ? "interrupted" : "failed";
    if (const auto* diverged = dynamic_cast<const volume::divergence*>(&e)) {
      report.status = "diverged";
      report.diverged_step = step + 1;
      report.diverged_iteration = diverged->iteration();
    }
    if (e.status() == exit_status::file_failed)
      message += good_checkpoint.empty() ? "; no checkpoint was written"
                                         : "; " + good_checkpoint + " is good: continue with --restart latest";
    report.message = message;
    try {
      if constexpr (iterates)
        if (residuals) residuals->append(step + 1, how.residuals);
      if (e.status() == exit_status::calculation_failed && integrator) write_checkpoint();
      fill_report();
      report.write(ranks, line.output);
      say(message);
    } catch (const foundation::error& second) {
      // The first reason is the one to be told; on a full disk neither can be written.
      message += std::string("; and ") + second.what();
    }
    throw foundation::error(e.status(), message);
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
