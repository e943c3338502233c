#include <fmt/format.h>
#include <omp.h>

#include <chrono>
#include <cmath>
#include <foundation/error.hpp>
#include <limits>
#include <march/march.hpp>
#include <memory>
#include <optional>
#include <output/directory.hpp>
#include <output/log.hpp>
#include <output/progress.hpp>
#include <output/series.hpp>
#include <simulation/interrupt.hpp>
#include <simulation/restart.hpp>

namespace tetsuame::march {

namespace {

using std::chrono::steady_clock;

double since(steady_clock::time_point begin) {
  return std::chrono::duration<double>(steady_clock::now() - begin).count();
}

struct loop {
  problem& p;
  const options& o;
  const simulation::command_line& line;
  const std::string& resolved;

  const domain::communicator& ranks = p.ranks();
  int simd_lanes = 0;
  std::unique_ptr<integrators::explicit_integrator> integrator;
  std::int64_t step = 0, snapshots = 0;
  double next_snapshot = 0.0;  // s
  bool is_steady = false;
  std::optional<output::run_log> log;
  std::optional<output::history> history;
  output::series series;
  std::string good_checkpoint;  // the newest; empty: none
  simulation::summary report;
  double coarser_updates = 0.0;  // of particles, before there were as many as now
  std::int64_t coarser_evaluations = 0;
  steady_clock::time_point began = steady_clock::now(), last_checkpoint = began;
  double stepping_seconds = 0.0;

  bool controls_error() const {
    return o.time.method == "adaptive" ||
           ((o.time.method == "rkl2" || o.time.method == "rkc2") && o.time.error_control);
  }
  double t_end() const { return *o.time.t_end; }

  void say(const std::string& text) {
    if (log) log->write(text);
  }
  void tell(const std::string& text) {
    say(text);
    if (ranks.rank == 0) fmt::print(stderr, "{}: {}\n", line.program, text);
  }

  // ---- stepping ---------------------------------------------------------------------------

  int right_hand_side(std::span<double* const> rate) {
    // A stage may leave what the lists cover: a smaller step then helps, where there is a choice.
    const double moved = p.moved();
    if (!(moved <= p.allowance())) {
      if (controls_error()) return 1;
      foundation::fail_calculation(
          fmt::format("particles moved {:.3g} m within one step, more than half the skin of the neighbour lists "
                      "({:.3g} m): the time "
                      "step is too large, or the flow has blown up",
                      moved, p.allowance()));
    }
    if (controls_error() && !p.evaluable()) return 1;
    if (stages_done > 0) p.renew_memory();
    if (in_step) ++stages_done;
    p.evaluate(rate);
    return 0;
  }
  bool in_step = false;
  int stages_done = 0;  // of the step

  void evaluate_here() {
    std::vector<particles::array> rates(p.fields().size(), particles::array(p.local_particles()));
    std::vector<double*> pointers;
    for (auto& a : rates) pointers.push_back(a.data());
    p.evaluate(pointers);
  }

  // kept: s, the fixed step of the run that goes on.
  void make_integrator(double kept = 0.0) {
    integrators::explicit_options how;
    how.method = o.time.method;
    how.order = static_cast<int>(o.time.order);
    how.rtol = o.time.rtol;
    how.error_control = controls_error();
    how.dt = o.time.dt ? *o.time.dt : kept > 0.0 ? kept : p.largest_step().dt;
    if (how.error_control && !o.time.dt) how.dt = 0.0;
    integrators::radius_function radius;
    if (o.time.method == "rkl2" || o.time.method == "rkc2") radius = [this](double) { return p.diffusion_radius(); };
    integrator = std::make_unique<integrators::explicit_integrator>(
        ranks.comm, p.fields(), p.local_particles(), 0.0, how,
        [this](double, std::span<double* const> rate) { return right_hand_side(rate); },
        [this](double) { return p.largest_step(); }, radius);
    dt = how.dt;
  }
  double dt = 0.0;        // s, fixed
  double bound_dt = 0.0;  // s, of equations that have changed since dt was chosen; 0: they have not

  // New lists before the next step could outrun the old ones; and where it could outrun new ones, a shorter step.
  // Particles may gain speed on the way.
  static constexpr double faster = 1.6;
  double longest = std::numeric_limits<double>::infinity();  // s
  void refresh_lists() {
    const double moved = p.moved(), speed = faster * p.speed();
    const double next = controls_error() ? integrator->statistics().next_dt : dt;
    longest = speed > 0.0 ? p.allowance() / speed : std::numeric_limits<double>::infinity();
    if (moved == 0.0 || moved + speed * std::min(next, longest) <= p.allowance()) return;
    p.rebuild(false);
    integrator->resize(p.fields(), p.local_particles());
  }

  // With the problem's new particles, at the same time; the integrator's counts go on.
  void refine() {
    if (finished()) return;
    const std::string change = p.refine(integrator->time());
    if (change.empty()) return;
    const auto before = integrator->save();
    coarser_updates = updates();
    coarser_evaluations = before.statistics.evaluations;
    p.rebuild(false);
    p.set_time(before.t);
    make_integrator();
    bound_dt = 0.0;
    integrators::explicit_memory fresh;
    fresh.t = before.t;
    fresh.statistics = before.statistics;
    integrator->restore(fresh);
    count_particles();
    tell(fmt::format("step {}, t = {:.6g} s: {}; goes on with {} particles{}", step, before.t, change,
                     report.fluid_particles, dt > 0.0 ? fmt::format(", dt = {:.4g} s", dt) : ""));
    warn_about_step();
  }
  void count_particles() { report.fluid_particles = ranks.sum(static_cast<std::int64_t>(p.local_particles())); }
  double updates() const {
    return coarser_updates + static_cast<double>(report.fluid_particles) *
                                 static_cast<double>(integrator->statistics().evaluations - coarser_evaluations);
  }

  bool finished() const { return step >= o.time.steps || is_steady || integrator->time() >= t_end() * (1.0 - 1e-12); }

  // Where the next step must stop: fixed steps keep their length but for the last one.
  double next_stop() const {
    const double t = integrator->time(), end = t_end();
    if (!(t + 1e-3 * longest > t))
      foundation::fail_calculation("particles are so fast that no step can follow them: the flow has blown up");
    if (controls_error()) return std::min(t + longest, o.output.interval > 0.0 ? std::min(end, next_snapshot) : end);
    const double most = bound_dt > 0.0 ? std::min(longest, bound_dt) : longest;
    if (most < dt) return std::min(end, t + most);
    return std::abs(end - t - dt) < dt * 1e-6 ? t + 2.0 * dt : end;
  }

  void advance() {
    output::progress progress(ranks.rank == 0, stderr, state());
    while (!finished()) {
      if (must_stop()) {
        progress.finish(state());
        interrupt_run();
      }
      const auto before = steady_clock::now();
      refresh_lists();
      integrator->prepare();
      p.keep_memory();
      if (p.asks_again()) integrator->state_changed();
      // The other methods may take the last stage's rate for the first of the next step.
      p.expect_memory(o.time.method != "rk4");
      in_step = true;
      integrator->step(next_stop());
      in_step = false;
      stages_done = 0;
      p.expect_memory(true);
      ++step;
      const bool moved_on = p.set_time(integrator->time());
      if (moved_on && !o.time.dt && !controls_error()) bound_dt = p.largest_step().dt;
      if (p.complete_step() || moved_on) integrator->state_changed();
      stepping_seconds += since(before);
      record();
      progress.update(state());
    }
    progress.finish(state());
  }

  output::progress_state state() const {
    const auto& statistics = integrator->statistics();
    return {step,
            o.time.steps < 1'000'000'000 ? o.time.steps : 0,
            integrator->time(),
            t_end(),
            statistics.last_dt,
            static_cast<std::uint64_t>(updates())};
  }

  bool must_stop() const {
    const bool late = o.run.wall_clock_limit > 0.0 && since(began) >= o.run.wall_clock_limit;
    return ranks.maximum(simulation::stop_requested() || late ? 1.0 : 0.0) > 0.0;
  }

  [[noreturn]] void interrupt_run() {
    write_checkpoint();
    throw foundation::error(
        foundation::exit_status::interrupted,
        fmt::format("stopped at step {}, t = {:.6g} s, after a checkpoint: continue with --restart latest", step,
                    integrator->time()));
  }

  // ---- output -----------------------------------------------------------------------------

  void record() {
    const double t = integrator->time();
    const bool snapshot_due = o.output.interval > 0.0 && t >= next_snapshot * (1.0 - 1e-9);
    const bool measured = step % o.output.history_interval == 0 || finished();
    if (measured) {
      evaluate_here();
      append_history();
      is_steady = p.steady();
      if (snapshot_due || finished()) write_snapshot();
    } else if (snapshot_due) {
      evaluate_here();
      write_snapshot();
    }
    const bool by_steps = o.run.checkpoint_interval > 0 && step % o.run.checkpoint_interval == 0;
    // Rank 0's clock decides for all.
    const double age =
        o.run.checkpoint_seconds > 0.0 ? ranks.maximum(ranks.rank == 0 ? since(last_checkpoint) : 0.0) : 0.0;
    if (measured) refine();
    if (by_steps || (o.run.checkpoint_seconds > 0.0 && age >= o.run.checkpoint_seconds)) write_checkpoint();
  }

  std::vector<output::history_column> columns() const {
    std::vector<output::history_column> all{{"time", "s"}, {"dt", "s"}};
    for (const auto& c : p.columns()) all.push_back(c);
    return all;
  }

  void append_history() {
    std::vector<double> values{integrator->time(), integrator->statistics().last_dt};
    for (const double v : p.row(integrator->time())) values.push_back(v);
    history->append(step, values);
  }

  void write_snapshot() {
    auto header = p.header();
    header.time = integrator->time();
    header.step = step;
    std::vector<particles::array> extra;
    const auto groups = p.snapshot(extra);
    const std::string name = output::snapshot_name(static_cast<int>(snapshots));
    output::write_snapshot(ranks.comm, line.output + "/" + name, header, groups,
                           {line.program, simulation::version(), resolved});
    output::add_to_series(ranks.comm, line.output, name, series);
    ++snapshots;
    while (o.output.interval > 0.0 && next_snapshot <= integrator->time() * (1.0 + 1e-9) + 1e-300)
      next_snapshot += o.output.interval;
  }

  void write_checkpoint() {
    output::checkpoint_globals g;
    simulation::save(integrator->save(), g);
    p.save(g);
    g.reals["next_snapshot"] = next_snapshot;
    g.reals["stepping_seconds"] = stepping_seconds;
    g.reals["fixed_dt"] = dt;
    g.reals["bound_dt"] = bound_dt;
    g.reals["coarser_updates"] = coarser_updates;
    g.integers["coarser_evaluations"] = coarser_evaluations;
    g.integers["step"] = step;
    g.integers["simd_lanes"] = simd_lanes;
    g.integers["snapshots"] = snapshots;
    g.texts = {{"program", line.program}, {"input", resolved}, {"version", simulation::version()}};
    std::vector<std::int64_t> materials;
    good_checkpoint = output::write_checkpoint(ranks.comm, line.output, step, g, {p.particles_table(materials)});
    last_checkpoint = steady_clock::now();
    say(fmt::format("checkpoint {} at step {}", good_checkpoint, step));
  }

  // ---- start, restart, end ----------------------------------------------------------------

  void start_anew() {
    p.rebuild(false);
    p.set_time(0.0);
    make_integrator();
    history = output::history::start(ranks.comm, line.output + "/history.csv", columns());
    evaluate_here();
    append_history();
    write_snapshot();
  }

  output::latest_checkpoint read_saved() const {
    output::latest_checkpoint saved;
    if (line.restart == "latest")
      saved = output::find_latest(ranks.comm, line.output);
    else
      saved = {line.restart, output::read_checkpoint(ranks.comm, line.restart), {}};
    const auto& texts = saved.state.globals.texts;
    simulation::check_restart(texts.at("program"), texts.at("input"), line.program, resolved);
    return saved;
  }

  void continue_from(const output::latest_checkpoint& saved) {
    for (const auto& message : saved.messages) tell(message);
    say("continuing from " + saved.path);
    good_checkpoint = saved.path;
    const auto& g = saved.state.globals;
    if (const auto before = g.integers.at("simd_lanes"); before != simd_lanes)
      say(fmt::format(
          "the checkpoint was written with {} SIMD lanes, this run has {}: the last digits will differ from "
          "the uninterrupted run's",
          before, simd_lanes));
    p.restore(g);
    p.read_particles(saved.state.tables.at("fluid"));
    p.rebuild(true);
    count_particles();
    make_integrator(g.reals.at("fixed_dt"));
    bound_dt = g.reals.at("bound_dt");
    integrator->restore(simulation::integrator_memory(g));
    p.set_time(integrator->time());
    coarser_updates = g.reals.at("coarser_updates");
    coarser_evaluations = g.integers.at("coarser_evaluations");
    step = g.integers.at("step");
    snapshots = g.integers.at("snapshots");
    next_snapshot = g.reals.at("next_snapshot");
    stepping_seconds = g.reals.at("stepping_seconds");
    output::forget_checkpoints_after(ranks.comm, line.output, step);
    history = output::history::resume(ranks.comm, line.output + "/history.csv", columns(), step);
    series = output::continue_series(ranks.comm, line.output, static_cast<int>(snapshots));
    is_steady = p.steady();
    evaluate_here();
    // An interrupted run may have ended before it went on finer.
    if (step % o.output.history_interval == 0) refine();
  }

  void fill_report() {
    report.steps = step;
    report.wall_seconds = since(began);
    report.stepping_seconds = stepping_seconds;
    if (!integrator) return;
    report.time = integrator->time();
    report.statistics = integrator->statistics();
    report.particle_updates = updates();
  }

  std::optional<output::latest_checkpoint> prepare() {
    using mode = output::directory_mode;
    simd_lanes = static_cast<int>(p.simd_lanes());
    if (ranks.maximum(simd_lanes) != ranks.minimum(simd_lanes))
      foundation::fail_input(
          "some ranks run on processors with AVX-512 and some without: results would depend on where a particle is. "
          "Set TETSUAME_SIMD=avx2 in the environment of all ranks");
    report.program = line.program;
    report.dimension = p.header().dimension;
    count_particles();
    report.ranks = ranks.size;
    report.threads = omp_get_max_threads();
    report.simd_lanes = simd_lanes;
    output::open_directory(ranks.comm, line.output,
                           !line.restart.empty() ? mode::restart
                           : line.force          ? mode::force
                                                 : mode::fresh);
    std::optional<output::latest_checkpoint> found;
    if (!line.restart.empty()) found = read_saved();
    log.emplace(ranks.comm, line.output + "/run.log");
    say(fmt::format("{} {} on {} ranks x {} threads, input {}", line.program, simulation::version(), ranks.size,
                    omp_get_max_threads(), line.input));
    for (const auto& text : p.about()) tell(text);
    simulation::write_text(ranks, line.output + "/resolved.nml", resolved);
    simulation::watch_signals();
    return found;
  }

  void warn_about_step() {
    const auto limit = p.largest_step();
    if (!controls_error() && dt > limit.dt * (1.0 + 1e-12))
      tell(fmt::format("warning: dt = {:.3g} s is above the {} limit, {:.3g} s; expect it to blow up", dt, limit.name,
                       limit.dt));
  }

  void carry_out() {
    auto found = prepare();
    try {
      if (found)
        continue_from(*found);
      else
        start_anew();
      found.reset();
      warn_about_step();
      advance();
      evaluate_here();
      fill_report();
      p.report(integrator->time(), report);
      report.state_hash = p.hash();
      report.status = "completed";
      report.message = fmt::format("completed {} steps, t = {:.6g} s{}", step, integrator->time(),
                                   is_steady ? ", where the flow is steady" : "");
      report.write(ranks, line.output);
      say(report.message);
      if (ranks.rank == 0) report.print();
    } catch (const foundation::error& e) {
      fail(e);
    }
  }

  // The last good state is in the arrays: it goes to disk with the reason.
  [[noreturn]] void fail(const foundation::error& e) {
    using foundation::exit_status;
    std::string message = e.what();
    if (e.status() == exit_status::calculation_failed) message = fmt::format("step {}: {}", step + 1, message);
    if (e.status() == exit_status::file_failed)
      message += good_checkpoint.empty() ? "; no checkpoint was written"
                                         : "; " + good_checkpoint + " is good: continue with --restart latest";
    report.status = e.status() == exit_status::interrupted ? "interrupted" : "failed";
    report.message = message;
    try {
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

}  // namespace

void run(problem& p, const options& o, const simulation::command_line& line, const std::string& resolved) {
  loop{p, o, line, resolved}.carry_out();
}

}  // namespace tetsuame::march
