#include <fmt/format.h>
#include <omp.h>

#include <cmath>
#include <foundation/error.hpp>
#include <foundation/waiting.hpp>
#include <kernels/kernel.hpp>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <output/progress.hpp>
#include <run/amounts.hpp>
#include <run/plan.hpp>
#include <run/run_directory.hpp>
#include <run/simulation.hpp>

namespace tetsuame::run {

namespace {

struct loop {
  simulation& p;
  const common_options& o;
  const command_line& line;
  const std::string& resolved;

  const domain::communicator& ranks = p.ranks;
  run_directory files{ranks, line, resolved, p.simd_lanes};
  summary& report = files.report;
  std::unique_ptr<integrators::explicit_integrator> integrator{};
  std::int64_t step = 0;
  bool is_steady = false;
  double coarser_updates = 0.0;  // of particles, before there were as many as now
  std::int64_t coarser_evaluations = 0;

  bool varies_steps() const { return o.time.varies_steps(); }
  double t_end() const { return o.time.end(); }
  // Where steps set the end of the run and some may be shorter than dt, their number is no limit.
  std::int64_t last_step() const {
    constexpr std::int64_t unlimited = std::int64_t{1} << 50;
    return o.time.t_end || o.time.counts_steps(o.output.interval) ? o.time.steps : unlimited;
  }

  // What all ranks know together after a step.
  struct {
    std::optional<step_maxima> maxima{};  // what the simulation asked for; none: it has other arrays now
    double stop = 0.0;                    // why to stop; 0: nobody asks for it
    double since_checkpoint = 0.0;        // s, by rank 0's clock
    bool state_changed = false;           // after the step
  } step_flags{};

  // One reduction for all that a step has to agree on.
  void reduce_step_flags(const completion* done) {
    std::array<double, 3 + std::tuple_size_v<step_maxima>> most{files.stop_reason(o.run),
                                                                ranks.rank == 0 ? files.checkpoint_age() : 0.0,
                                                                done != nullptr && done->state_changed ? 1.0 : 0.0};
    if (done != nullptr) std::copy(done->maxima.begin(), done->maxima.end(), most.begin() + 3);
    ranks.maximum(most);
    step_flags = {{}, most[0], most[1], most[2] > 0.0};
    if (done == nullptr) return;
    auto& maxima = step_flags.maxima.emplace();
    std::copy(most.begin() + 3, most.end(), maxima.begin());
    const bool bounded =
        std::ranges::all_of(maxima, [](double m) { return m < std::numeric_limits<double>::infinity(); });
    if (!bounded) check_state();
  }
  void check_state() { p.evaluate({.of = purpose::check}, {}); }

  // ---- stepping ---------------------------------------------------------------------------

  evaluation next_evaluation{};  // but for its time and purpose
  int right_hand_side(double at, std::span<double* const> rate) {
    next_evaluation.time = at;
    next_evaluation.step = step;
    next_evaluation.shorter_steps_help = varies_steps();
    next_evaluation.slow_forces = integrator ? integrator->weight_of_slow_forces() : 1.0;
    return p.evaluate(next_evaluation, rate) ? 0 : 1;
  }

  void evaluate_for(purpose of, bool counts = true) {
    const evaluation what{.time = integrator->time(), .step = step, .of = of, .counts = counts};
    integrator->lend([&](std::span<double* const> rates) { p.evaluate(what, rates); });
  }

  // What the length of steps follows from: where a restart changes it, they are chosen anew.
  std::string steps_follow_from() const {
    const auto& t = o.time;
    const auto first = fmt::format("{} {} dt {}", t.method, o.time.controls_error() ? t.order : 0, t.dt.value_or(0.0));
    return o.time.controls_error()
               ? first + " by error"
               : fmt::format("{} cfl {} diffusive {} substeps {}", first, *t.cfl, *t.diffusive, t.substeps);
  }

  // Of a whole step.
  integrators::step_limit stable_step() {
    auto limit = p.limits(false).stable;
    limit.dt *= static_cast<double>(o.time.substeps);
    return limit;
  }

  // kept: s, the fixed step of the run that goes on.
  void make_integrator(double kept = 0.0) {
    integrators::explicit_options how;
    how.method = o.time.method;
    how.order = static_cast<int>(o.time.order);
    how.rtol = o.time.rtol;
    how.error_control = varies_steps();
    how.substeps = static_cast<int>(o.time.substeps);
    if (o.time.dt) {
      how.dt = *o.time.dt;
      dt_is = "fixed";
    } else {
      const auto limit = stable_step();
      how.dt = how.error_control ? 0.0 : kept > 0.0 ? kept : limit.dt;
      dt_is = limit.name;
      if (!how.error_control && !(how.dt > 0.0 && std::isfinite(how.dt)))
        foundation::fail_input(fmt::format(
            "default value: &time dt: must be given: with this input the limit by {} is {} s", limit.name, how.dt));
    }
    how.dt_is = dt_is;
    integrators::radius_function radius;
    if (o.time.method == "rkl2" || o.time.method == "rkc2") radius = [this](double) { return p.limits(true).radius; };
    const auto arrays = p.arrays();
    integrator = std::make_unique<integrators::explicit_integrator>(
        ranks.comm, arrays.fields, arrays.size, 0.0, how,
        [this](double at, std::span<double* const> rate) { return right_hand_side(at, rate); },
        [this](double) { return stable_step(); }, radius, [this] { p.evaluate_slow(); });
    dt = how.dt;
  }
  double dt = 0.0;                         // s, fixed
  std::string dt_is{};                     // what set it
  integrators::step_limit bound{0.0, {}};  // of equations that have changed since dt was chosen; 0: they have not

  step_preparation prepared{};
  void prepare_step(bool first = false) {
    const double next = varies_steps() ? integrator->statistics().next_dt : dt;
    prepared = p.prepare({.time = integrator->time(),
                          .step = step,
                          .steps_left = last_step() - step,
                          .dt = next,
                          .bound = bound.dt,
                          .fixed = o.time.dt.has_value(),
                          .varies_steps = varies_steps(),
                          .substeps = static_cast<double>(o.time.substeps),
                          .first = first,
                          .maxima = step_flags.maxima});
    if (!prepared.arrays_moved) return;
    const auto arrays = p.arrays();
    integrator->resize(arrays.fields, arrays.size);
    if (prepared.number_changed) count_values_anew();
  }

  // With the simulation's new arrays, at the same time; the integrator's counts go on.
  void refine() {
    if (finished()) return;
    const std::string change = p.refine(integrator->time());
    if (change.empty()) return;
    const auto before = integrator->save();
    end_counting_updates();
    make_integrator();
    bound = {0.0, {}};
    integrators::explicit_memory fresh;
    fresh.t = before.t;
    fresh.statistics = before.statistics;
    integrator->restore(fresh);
    count_values();
    reduce_step_flags(nullptr);
    files.tell(fmt::format("step {}, t = {:.6g} s: {}; goes on with {} particles{}", step, before.t, change,
                           report.fluid_particles, dt > 0.0 ? fmt::format(", dt = {:.4g} s", dt) : ""));
    warn_about_step();
  }
  void count_values() { report.fluid_particles = ranks.sum(static_cast<std::int64_t>(p.arrays().size)); }
  // What was counted so far is of as many as there were.
  void end_counting_updates() {
    coarser_updates = updates();
    coarser_evaluations = integrator->statistics().evaluations;
  }
  void count_values_anew() {
    end_counting_updates();
    count_values();
  }
  double updates() const {
    return coarser_updates + static_cast<double>(report.fluid_particles) *
                                 static_cast<double>(integrator->statistics().evaluations - coarser_evaluations);
  }

  bool finished() const { return step >= last_step() || is_steady || integrator->time() >= t_end() * (1.0 - 1e-12); }

  // Where the next step must end. Fixed steps keep their length but for what the state asks, output times and the end.
  run::next_end choose_end(double for_accuracy) const {
    const double t = integrator->time(), interval = o.output.interval;
    integrators::step_limit most = prepared.longest;
    if (for_accuracy < most.dt) most = {for_accuracy, "accuracy"};
    if (varies_steps()) {
      const double last = files.last_end(t_end(), interval);
      return t + most.dt < last ? run::next_end{t + most.dt, most.name} : run::next_end{last, "output"};
    }
    if (bound.dt > 0.0 && bound.dt < most.dt) most = bound;
    if (!(most.dt < dt)) most = {dt, dt_is};
    return files.end_of_fixed_step(t, dt, most, t_end(), interval);
  }

  void advance() {
    output::progress progress(ranks.rank == 0, stderr, state());
    reduce_step_flags(nullptr);
    while (!finished()) {
      if (step_flags.stop > 0.0) {
        progress.finish(state());
        interrupt_run();
      }
      const foundation::stopwatch watch;
      p.communication.begin();
      prepare_step(std::exchange(warns, false));
      if (!prepared.warning.empty()) files.tell("warning: " + prepared.warning);
      take_step();
      p.communication.end();
      files.stepping_seconds += watch.elapsed();
      record();
      progress.update(state());
    }
    progress.finish(state());
  }

  void take_step() {
    const foundation::stopwatch watch;
    {
      const foundation::stage timed(p.times, "integration");
      // The rate that was known when the checkpoint was written was counted then.
      next_evaluation.counts = !integrator->repeats();
      integrator->prepare();
      next_evaluation.counts = true;
      const committed now = p.commit();
      if (now.evaluate_again) integrator->state_changed();
      // The other methods may take the last stage's rate for the first of the next step.
      next_evaluation.may_commit = o.time.method != "rk4";
      const auto end = choose_end(now.longest);
      integrator->step(end.t, end.by);
      next_evaluation.may_commit = true;
    }
    ++step;
    const completion done = p.complete({integrator->time(), step, watch.busy()});
    if (done.equations_changed && !o.time.dt && !varies_steps()) bound = stable_step();
    reduce_step_flags(&done);
    if (step_flags.state_changed || done.equations_changed) integrator->state_changed();
  }

  output::progress_state state() const {
    const auto& statistics = integrator->statistics();
    return {step, steps_asked().value_or(0), integrator->time(), t_end(), statistics.last_dt, updates()};
  }

  // Where it is they that end the run, or may.
  std::optional<std::int64_t> steps_asked() const {
    return o.time.counts_steps(o.output.interval) ? std::optional(o.time.steps) : std::nullopt;
  }

  [[noreturn]] void interrupt_run() {
    write_checkpoint();
    const auto steps = steps_asked();
    files.interrupt(step_flags.stop, step, steps ? fmt::format(" of {}", *steps) : "", integrator->time());
  }

  // ---- output -----------------------------------------------------------------------------

  // The steps of the last ones.
  std::int64_t line_step = -1, snapshot_step = -1, checkpoint_step = -1;

  void record() {
    const bool line_due = step % o.output.history_interval == 0;
    const bool snapshot_due = files.snapshot_due(integrator->time(), o.output.interval);
    if (snapshot_due)
      evaluate_for(purpose::snapshot);
    else if (line_due)
      evaluate_for(purpose::line);
    if (line_due) append_history();
    if (snapshot_due) write_snapshot();
    if (line_due) refine();
    if (finished() || checkpoint_is_due()) write_checkpoint();
  }

  // The last checkpoint stands before what only the end of a run has, a line and a snapshot that were not due: a run
  // that is continued from it is one that was not stopped.
  void record_end() {
    if (checkpoint_step != step) write_checkpoint();
    if (snapshot_step != step)
      evaluate_for(purpose::snapshot);
    else
      evaluate_for(purpose::line);
    if (line_step != step) append_history();
    if (snapshot_step != step) write_snapshot();
  }

  bool checkpoint_is_due() const {
    if (o.run.checkpoint_interval > 0 && step % o.run.checkpoint_interval == 0) return true;
    return o.run.checkpoint_seconds > 0.0 && step_flags.since_checkpoint >= o.run.checkpoint_seconds;
  }

  std::vector<output::history_column> columns() const {
    std::vector<output::history_column> all{{"time", "s"}, {"dt", "s"}};
    for (const auto& c : p.columns()) all.push_back(c);
    return all;
  }

  void append_history() {
    const foundation::stage timed(p.times, "output");
    std::vector<double> values{integrator->time(), integrator->statistics().last_dt};
    const auto line_now = p.row(integrator->time());
    values.insert(values.end(), line_now.values.begin(), line_now.values.end());
    files.append_line(step, values);
    line_step = step;
    is_steady = line_now.steady;
  }

  void write_snapshot() {
    const foundation::stage timed(p.times, "output");
    auto [header, groups, made] = p.snapshot();
    header.time = integrator->time();
    header.step = step;
    header.kernel_support = kernels::find(o.kernel.name).support_over_h;
    files.write_snapshot(header, std::move(groups), o.output);
    snapshot_step = step;
  }

  // Collective.
  bool state_is_finite() {
    try {
      check_state();
    } catch (const foundation::error&) {
      return false;
    }
    return true;
  }

  void write_checkpoint() {
    const foundation::stage timed(p.times, "output");
    output::checkpoint_globals g;
    std::vector<std::int64_t> integers;
    const auto tables = p.save(g, integers);
    g.reals["fixed_dt"] = dt;
    g.reals["bound_dt"] = bound.dt;
    g.texts["bound_is"] = bound.name;
    g.texts["steps_follow_from"] = steps_follow_from();
    g.reals["coarser_updates"] = coarser_updates;
    g.integers["coarser_evaluations"] = coarser_evaluations;
    g.integers["line_step"] = line_step;
    g.integers["snapshot_step"] = snapshot_step;
    files.write_checkpoint(step, *integrator, std::move(g), tables);
    checkpoint_step = step;
  }

  // ---- start, restart, end ----------------------------------------------------------------

  void make_ready() {
    p.begin(nullptr, files);
    make_integrator();
  }

  struct settling {
    double steps, dt, crossing;  // dt, crossing: s
  };
  // How a start at rest is to settle, where the input asks for it. Once the integrator is made.
  std::optional<settling> settling_ahead() {
    if (!o.start.settles()) return {};
    const auto limit = p.limits(true);
    const double crossing = p.crossing_time();
    // The stable steps of 'kdk' are shorter than those of methods with more evaluations a step; these are as long.
    double step_of = (o.time.method == "kdk" ? 0.8 : 0.5) * limit.stable.dt;
    if (limit.radius > 0.0) step_of = std::min(step_of, 1.0 / limit.radius);
    const double steps = std::ceil(o.start.settle * crossing / step_of);
    constexpr double most = 1e6;
    if (!(steps >= 1.0 && steps <= most))
      foundation::fail_input(
          fmt::format("&initial settle: {:.3g} crossings of {:.4g} s are {:.3g} steps of {:.3g} s: "
                      "expected at most {:.0e}",
                      o.start.settle, crossing, steps, step_of, most));
    return settling{steps, step_of, crossing};
  }

  // A damped motion before the run: symplectic Euler steps, v by its rate and then what moves with it by its own, so
  // that sound neither grows nor, but for the damping, decays. The damping 2 ω of the box's slowest wave, ω = π c/L,
  // lets that one come to rest in its shortest time, and those that are faster in e-foldings of 1/ω.
  std::string settle() {
    const auto ahead = settling_ahead();
    if (!ahead) return {};
    const auto [steps_needed, step_of, crossing] = *ahead;
    const double kept = std::exp(-2.0 * std::numbers::pi / crossing * step_of);
    using part = simulation::damped;
    const auto move = [&](part of) {
      integrator->lend([&](std::span<double* const> rates) {
        p.evaluate({.of = purpose::step, .counts = false}, rates);
        p.settle(of, rates, step_of, kept);
      });
    };
    const auto so_far = [&, steps_needed = steps_needed, step_of = step_of](double n) {
      return output::progress_state{static_cast<std::int64_t>(n),
                                    static_cast<std::int64_t>(steps_needed),
                                    n * step_of,
                                    steps_needed * step_of,
                                    step_of,
                                    2.0 * n * static_cast<double>(report.fluid_particles),
                                    "settling, step"};
    };
    output::progress progress(ranks.rank == 0, stderr, so_far(0.0));
    for (double n = 0.0; n < steps_needed; ++n) {
      move(part::kick);
      move(part::drift);
      p.commit();
      reduce_step_flags(nullptr);
      prepare_step();
      progress.update(so_far(n + 1.0));
      if (step_flags.stop > 0.0) {
        progress.finish(so_far(n + 1.0));
        files.interrupt_settling(step_flags.stop, static_cast<std::int64_t>(n + 1.0),
                                 static_cast<std::int64_t>(steps_needed));
      }
    }
    progress.finish(so_far(steps_needed));
    p.settle(part::rest, {}, 0.0, 0.0);
    integrator->state_changed();
    return fmt::format("settled: {:.0f} steps of {:.3g} s of a damped motion, {:.3g} crossings of the box by sound",
                       steps_needed, step_of, o.start.settle);
  }

  void start_anew() {
    make_ready();
    const std::string settled = settle();
    files.begin();
    if (!settled.empty()) files.tell(settled);
    files.start_history(columns());
    evaluate_for(purpose::snapshot);
    append_history();
    write_snapshot();
  }

  void continue_from(const output::latest_checkpoint& saved) {
    const auto& g = saved.state.globals;
    step = g.integers.at("step");
    is_steady = p.begin(&saved.state, files);
    count_values();
    const bool as_before = g.texts.at("steps_follow_from") == steps_follow_from();
    make_integrator(as_before ? g.reals.at("fixed_dt") : 0.0);
    if (as_before) bound = {g.reals.at("bound_dt"), g.texts.at("bound_is")};
    step = files.continue_from(saved, *integrator, columns(), o.output.interval);
    if (!as_before) integrator->choose_steps_anew();
    line_step = g.integers.at("line_step");
    snapshot_step = g.integers.at("snapshot_step");
    if (files.continues_here()) checkpoint_step = step;
    coarser_updates = g.reals.at("coarser_updates");
    coarser_evaluations = g.integers.at("coarser_evaluations");
    evaluate_for(purpose::line, false);  // it was counted before the checkpoint
    // An interrupted run may have ended before it went on finer.
    if (step % o.output.history_interval == 0) refine();
  }

  void fill_report() {
    files.fill_report(step, integrator.get());
    if (integrator) report.particle_updates = updates();
    report.stages = p.times.seconds();
  }

  bool warns = false;  // the next step is the first of its kind
  void warn_about_step() {
    warns = true;
    const auto limit = stable_step();
    if (!varies_steps() && dt > limit.dt * (1.0 + 1e-12))
      files.tell(fmt::format("warning: dt = {:.3g} s is above the {} limit, {:.3g} s; expect it to blow up", dt,
                             limit.name, limit.dt));
  }

  double first_dt = 0.0;  // s, of a plan

  // A few steps from the start, of which the first is not timed: it makes lists and evaluates twice.
  void plan() {
    constexpr std::int64_t most = 20;
    constexpr double long_enough = 5.0;  // s
    report.dimension = p.dimension;
    count_values();
    make_ready();
    const auto settles = settling_ahead();
    reduce_step_flags(nullptr);
    long long evaluations = 0;
    foundation::stopwatch watch;
    double elapsed = 0.0;
    while (!finished() && step < most && elapsed < long_enough) {
      // As if they were written.
      while (files.snapshot_due(integrator->time(), o.output.interval)) files.next_snapshot += o.output.interval;
      prepare_step();
      take_step();
      if (step == 1) {
        first_dt = integrator->statistics().last_dt;
        watch = {};
        evaluations = integrator->statistics().evaluations;
      }
      elapsed = ranks.maximum(watch.elapsed());
    }
    const auto tried = what_was_tried(elapsed, integrator->statistics().evaluations - evaluations, settles);
    const auto text = text_of(tried, o, line.rehearsed);
    if (ranks.rank == 0) print(fmt::format("{} {}\n{}", line.program, line.input, text));
  }

  plan_of_run what_was_tried(double seconds, long long evaluations, const std::optional<settling>& settles) {
    plan_of_run plan{.dimension = report.dimension, .particles = report.fluid_particles, .ranks = ranks.size};
    plan.first_dt = first_dt;
    plan.last_dt = integrator->statistics().last_dt;
    plan.limit = o.time.controls_error() ? "by error control" : dt_is;
    plan.time = integrator->time();
    plan.end = t_end();
    plan.step = step;
    plan.asked = steps_asked().value_or(0);
    plan.finished = finished();
    plan.seconds = seconds;
    plan.evaluations = evaluations;
    if (settles) plan.settling = {settles->steps, settles->dt};
    const auto shown = p.snapshot();
    plan.snapshot =
        static_cast<double>(ranks.sum(static_cast<std::int64_t>(output::bytes_of(shown.groups, o.output.form()))));
    plan.memory = resident_bytes(ranks);
    return plan;
  }

  void carry_out() {
    report.dimension = p.dimension;
    count_values();
    auto found = files.open();
    for (const auto& text : p.about) files.tell(text);
    try {
      if (found)
        continue_from(*found);
      else
        start_anew();
      found.reset();
      warn_about_step();
      advance();
      record_end();
      fill_report();
      p.report({integrator->time(), step}, report);
      files.complete(step, integrator->time(), t_end(), is_steady ? ", where what is measured no longer changes" : "");
    } catch (const foundation::error& e) {
      // The last good state is in the arrays: it goes to disk with the reason.
      files.fail(e, step, [&] {
        p.report({integrator ? integrator->time() : 0.0, step, &e}, report);
        if (e.status() == foundation::exit_status::calculation_failed && integrator && state_is_finite())
          write_checkpoint();
        fill_report();
      });
    }
  }
};

}  // namespace

void carry_out(simulation& p, const common_options& o, const run::command_line& line, const std::string& resolved) {
  loop run{p, o, line, resolved};
  line.plan ? run.plan() : run.carry_out();
}

}  // namespace tetsuame::run
