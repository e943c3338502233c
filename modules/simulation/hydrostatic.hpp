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
  double next_snapshot = 0.0;  // s
  std::int64_t wall_crossings = 0;
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

  // Of this rank's steps since the lists were made.
  struct {
    double computing = 0.0, waiting = 0.0;  // s
  } load;
  // New cuts from the present ones and every rank's cost, asked for whenever lists are made anew; every rank must come
  // to the same. Empty: cuts stay. A rank's cost is its computing time, or else the entries of its neighbour lists,
  // which are the same in every run.
  std::function<balance::cuts<D>(const balance::cuts<D>&, const std::vector<double>&)> propose_cuts;
  bool cost_is_time = true;

  run(const command_line& command, const input& in) : line(command), o(in.values), resolved(in.resolved) {}

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

  // New lists before the next step could outrun the old ones.
  void refresh_lists() {
    auto& s = world.w.s;
    double speed2 = 0.0;
#pragma omp parallel for schedule(static) reduction(max : speed2) if (s.fluid > foundation::values_worth_threads)
    for (std::size_t i = 0; i < s.fluid; ++i) {
      double v2 = 0.0;
      for (std::size_t a = 0; a < D; ++a) v2 += s.v[a][i] * s.v[a][i];
      speed2 = std::max(speed2, v2);
    }
    const double speed = std::sqrt(ranks.maximum(speed2)), moved = std::sqrt(ranks.maximum(moved_since_lists(s)));
    const auto& statistics = integrator->statistics();
    const double dt = o.time.method == "adaptive" ? statistics.next_dt : o.time.dt;
    if (moved + 1.5 * speed * dt <= 0.5 * world.skin || moved == 0.0) return;
    domain::wrap(world.w.d.region, s);
    balance_load();
    rebuild(world);
    integrator->resize(state_fields(world, o.time), s.fluid);
  }

  void balance_load() {
    if (propose_cuts) {
      const double mine = cost_is_time ? load.computing : static_cast<double>(world.w.list.pairs);
      move_cuts(o, world, propose_cuts(world.w.d.cuts, ranks.every(mine)));
    }
    load = {};
  }

  // A step of the integrator, with what it cost this rank.
  void timed_step() {
    const auto before = std::chrono::steady_clock::now();
    const double waited = foundation::waited_seconds;
    {
      const foundation::stage timed(world.w.times, "integration");
      start_from_present_state();
      integrator->step(next_stop());
    }
    const double waiting = foundation::waited_seconds - waited;
    load.waiting += waiting;
    load.computing += std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count() - waiting;
  }

  // The iteration for Y starts from what it found at the last state that was reached. The start value
  // moves on only when the rate there is known, so that a restart, which has to find that rate
  // again, finds the same bits.
  void start_from_present_state() {
    if constexpr (iterates) {
      integrator->prepare();
      std::copy_n(world.w.s.rho.begin(), world.w.s.fluid, world.w.s.rho_guess.begin());
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
    const std::int64_t crossings = ranks.sum(walls::reflect(world.walls, s));
    wall_crossings += crossings;
    if (crossings > 0) integrator->state_changed();
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
    while (!finished()) {
      if (must_stop()) {
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
    const auto now = std::chrono::steady_clock::now();
    const bool by_steps = o.run.checkpoint_interval > 0 && step % o.run.checkpoint_interval == 0;
    // Rank 0's clock decides for all.
    const double since =
        ranks.maximum(ranks.rank == 0 ? std::chrono::duration<double>(now - last_checkpoint).count() : 0.0);
    if (by_steps || (o.run.checkpoint_seconds > 0.0 && since >= o.run.checkpoint_seconds)) write_checkpoint();
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
    g.integers["wall_crossings"] = wall_crossings;
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

  bool must_stop() const {
    const bool late = o.run.wall_clock_limit > 0.0 && seconds() >= o.run.wall_clock_limit;
    return ranks.maximum(stop_requested() || late ? 1.0 : 0.0) > 0.0;
  }

  [[noreturn]] void interrupt_run() {
    write_checkpoint();
    throw foundation::error(
        foundation::exit_status::interrupted,
        fmt::format("stopped at step {} of {}, t = {:.6g} s, after a checkpoint: continue with --restart latest", step,
                    o.time.steps, integrator->time()));
  }

  void start_anew() {
    rebuild(world);
    make_integrator(0.0);
    history = output::history::start(ranks.comm, line.output + "/history.csv", history_columns());
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
    // Lists stand where they stood, so that sums keep their order: they are made from the positions
    // of that time, and the present ones put back after.
    auto& s = world.w.s;
    const auto exchange_positions = [&] {  // of the fluid: walls stay where they are
      for (std::size_t n = 0; n < D; ++n)
        std::swap_ranges(s.x[n].begin(), s.x[n].begin() + static_cast<std::ptrdiff_t>(s.fluid), s.x_list[n].begin());
    };
    exchange_positions();
    rebuild(world, keep_list_positions);
    exchange_positions();
    make_integrator(0.0);
    restore(saved.globals);
    output::forget_checkpoints_after(ranks.comm, line.output, step);
    history = output::history::resume(ranks.comm, line.output + "/history.csv", history_columns(), step);
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
    wall_crossings = g.integers.at("wall_crossings");
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
    report.metrics["wall_crossings"] = wall_crossings;
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
