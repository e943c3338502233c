#include <fmt/format.h>
#include <omp.h>

#include <foundation/error.hpp>
#include <output/directory.hpp>
#include <simulation/interrupt.hpp>
#include <simulation/restart.hpp>
#include <simulation/run_directory.hpp>

namespace tetsuame::simulation {

void run_directory::say(const std::string& text) {
  if (log_) log_->write(text);
}

void run_directory::tell(const std::string& text) {
  say(text);
  if (ranks.rank == 0) fmt::print(stderr, "{}: {}\n", line.program, text);
}

std::optional<output::latest_checkpoint> run_directory::open() {
  using mode = output::directory_mode;
  if (ranks.maximum(simd_lanes) != ranks.minimum(simd_lanes))
    foundation::fail_input(
        "some ranks run on processors with AVX-512 and some without: results would depend on where a particle is. "
        "Set TETSUAME_SIMD=avx2 in the environment of all ranks");
  report.program = line.program;
  report.ranks = ranks.size;
  report.threads = omp_get_max_threads();
  report.simd_lanes = simd_lanes;
  output::open_directory(ranks.comm, line.output,
                         !line.restart.empty() ? mode::restart
                         : line.force          ? mode::force
                                               : mode::fresh);
  std::optional<output::latest_checkpoint> found;
  if (!line.restart.empty()) found = read_saved();
  log_.emplace(ranks.comm, line.output + "/run.log");
  say(fmt::format("{} {} on {} ranks x {} threads, input {}", line.program, version(), ranks.size,
                  omp_get_max_threads(), line.input));
  write_text(ranks, line.output + "/resolved.nml", resolved);
  watch_signals();
  return found;
}

output::latest_checkpoint run_directory::read_saved() const {
  output::latest_checkpoint saved;
  if (line.restart == "latest")
    saved = output::find_latest(ranks.comm, line.output);
  else
    saved = {line.restart, output::read_checkpoint(ranks.comm, line.restart), {}};
  const auto& texts = saved.state.globals.texts;
  check_restart(texts.at("program"), texts.at("input"), line.program, resolved);
  return saved;
}

void run_directory::start_history(const std::vector<output::history_column>& columns) {
  history = output::history::start(ranks.comm, line.output + "/history.csv", columns);
}

void run_directory::write_snapshot(const output::snapshot_header& header,
                                   const std::vector<output::particle_group>& groups, double interval) {
  const std::string name = output::snapshot_name(static_cast<int>(snapshots_));
  output::write_snapshot(ranks.comm, line.output + "/" + name, header, groups, {line.program, version(), resolved});
  output::add_to_series(ranks.comm, line.output, name, series_);
  ++snapshots_;
  while (interval > 0.0 && next_snapshot <= header.time * (1.0 + 1e-9) + 1e-300) next_snapshot += interval;
}

void run_directory::write_checkpoint(std::int64_t step, const integrators::explicit_integrator& integrator,
                                     output::checkpoint_globals g, const output::table_view& fluid) {
  save(integrator.save(), g);
  g.reals["next_snapshot"] = next_snapshot;
  g.reals["stepping_seconds"] = stepping_seconds;
  g.integers["step"] = step;
  g.integers["simd_lanes"] = simd_lanes;
  g.integers["snapshots"] = snapshots_;
  g.texts = {{"program", line.program}, {"input", resolved}, {"version", version()}};
  good_checkpoint_ = output::write_checkpoint(ranks.comm, line.output, step, g, {fluid});
  checkpointed_ = seconds_clock::now();
  say(fmt::format("checkpoint {} at step {}", good_checkpoint_, step));
}

void run_directory::announce(const output::latest_checkpoint& saved) {
  for (const auto& message : saved.messages) tell(message);
  say("continuing from " + saved.path);
  good_checkpoint_ = saved.path;
  if (const auto before = saved.state.globals.integers.at("simd_lanes"); before != simd_lanes)
    say(
        fmt::format("the checkpoint was written with {} SIMD lanes, this run has {}: sums are rounded in another "
                    "order, so the last digits will differ from the uninterrupted run's",
                    before, simd_lanes));
}

std::int64_t run_directory::continue_from(const output::latest_checkpoint& saved,
                                          integrators::explicit_integrator& integrator,
                                          const std::vector<output::history_column>& columns) {
  const auto& g = saved.state.globals;
  integrator.restore(integrator_memory(g));
  const std::int64_t step = g.integers.at("step");
  snapshots_ = g.integers.at("snapshots");
  next_snapshot = g.reals.at("next_snapshot");
  stepping_seconds = g.reals.at("stepping_seconds");
  output::forget_checkpoints_after(ranks.comm, line.output, step);
  history = output::history::resume(ranks.comm, line.output + "/history.csv", columns, step);
  series_ = output::continue_series(ranks.comm, line.output, static_cast<int>(snapshots_));
  return step;
}

void run_directory::fill_report(std::int64_t step, const integrators::explicit_integrator* integrator) {
  report.steps = step;
  report.wall_seconds = age();
  report.stepping_seconds = stepping_seconds;
  if (!integrator) return;
  report.time = integrator->time();
  report.statistics = integrator->statistics();
}

void run_directory::complete(const std::string& message) {
  report.status = "completed";
  report.message = message;
  report.write(ranks, line.output);
  say(message);
  if (ranks.rank == 0) report.print();
}

void run_directory::interrupt(std::int64_t step, const std::string& of_steps, double t) {
  throw foundation::error(
      foundation::exit_status::interrupted,
      fmt::format("stopped at step {}{}, t = {:.6g} s, after a checkpoint: continue with --restart latest", step,
                  of_steps, t));
}

void run_directory::fail(const foundation::error& e, std::int64_t step, const std::function<void()>& save) {
  using foundation::exit_status;
  std::string message = e.what();
  if (e.status() == exit_status::calculation_failed) message = fmt::format("step {}: {}", step + 1, message);
  if (e.status() == exit_status::file_failed)
    message += good_checkpoint_.empty() ? "; no checkpoint was written"
                                        : "; " + good_checkpoint_ + " is good: continue with --restart latest";
  report.status = e.status() == exit_status::interrupted ? "interrupted" : "failed";
  report.message = message;
  try {
    save();
    report.write(ranks, line.output);
    say(message);
  } catch (const foundation::error& second) {
    // The first reason is the one to be told; on a full disk neither can be written.
    message += std::string("; and ") + second.what();
  }
  throw foundation::error(e.status(), message);
}

}  // namespace tetsuame::simulation
