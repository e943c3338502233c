#include <fmt/format.h>
#include <omp.h>

#include <cmath>
#include <filesystem>
#include <foundation/agree.hpp>
#include <foundation/error.hpp>
#include <foundation/files.hpp>
#include <limits>
#include <output/file.hpp>
#include <run/doubts.hpp>
#include <run/interrupt.hpp>
#include <run/restart.hpp>
#include <run/run_directory.hpp>
#include <type_traits>

namespace tetsuame::run {

namespace {

namespace fs = std::filesystem;

constexpr double no_reason = 0.0, wall_clock_reason = 1.0, file_reason = 2.0;  // a signal: 100 and its number
constexpr double first_signal_reason = 100.0;

std::string told_by(double reason) {
  if (reason == wall_clock_reason) return "at the wall-clock limit";
  if (reason == file_reason) return "by the file stop";
  return "by " + signal_name(static_cast<int>(reason - first_signal_reason));
}

// In a checkpoint, before the name of a file that the input names.
constexpr std::string_view hash_prefix = "hash of ";

bool is_inside(const std::string& file, const std::string& directory) {
  std::error_code ignored;
  const auto parent = fs::path(file).parent_path();
  return fs::equivalent(parent.empty() ? fs::path(".") : parent, directory, ignored);
}

double next_multiple(double interval, double t) {
  const double next = interval * (std::floor(t * (1.0 + 1e-9) / interval) + 1.0);
  // An interval may be below the spacing of numbers at this time.
  return next > t ? next : std::nextafter(t, std::numeric_limits<double>::max());
}

// The integrator's memory by the names of a checkpoint: f(name, value) for each number in it.
template <class Memory, class F>
void for_each_number(Memory& memory, const F& f) {
  auto& s = memory.statistics;
  f("time", memory.t);
  f("next_dt", memory.next_dt);
  f("previous_error", memory.previous_error);
  f("previous_dt", memory.previous_dt);
  f("stable_dt", memory.stable.dt);
  f("radius", s.radius);
  f("last_dt", s.last_dt);
  f("steps", s.steps);
  f("attempts", s.attempts);
  f("rejections", s.rejections);
  f("unevaluable", s.unevaluable);
  f("evaluations", s.evaluations);
}

void save(const integrators::explicit_memory& memory, output::checkpoint_globals& g) {
  for_each_number(memory, [&](const char* name, auto value) {
    if constexpr (std::is_same_v<decltype(value), double>)
      g.reals[name] = value;
    else
      g.integers[name] = value;
  });
  g.integers["rate_known"] = memory.rate_known ? 1 : 0;
  g.texts["stable_dt_is"] = memory.stable.name;
  for (const auto& [name, count] : memory.statistics.limited_by) g.integers["limited_by " + name] = count;
}

integrators::explicit_memory integrator_memory(const output::checkpoint_globals& g) {
  integrators::explicit_memory memory;
  for_each_number(memory, [&](const char* name, auto& value) {
    if constexpr (std::is_same_v<decltype(value), double&>)
      value = g.reals.at(name);
    else
      value = g.integers.at(name);
  });
  memory.rate_known = g.integers.at("rate_known") != 0;
  memory.stable.name = g.texts.at("stable_dt_is");
  memory.statistics.next_dt = memory.next_dt;
  constexpr std::string_view prefix = "limited_by ";
  for (const auto& [name, count] : g.integers)
    if (name.starts_with(prefix)) memory.statistics.limited_by[name.substr(prefix.size())] = count;
  return memory;
}

}  // namespace

void run_directory::say(const std::string& text) {
  if (log_)
    log_->write(text);
  else
    unsaid_.push_back(text);
}

void run_directory::tell(const std::string& text) {
  say(text);
  // Not fmt::print, which throws when the stream cannot be written: a closed window must not end the run.
  if (ranks.rank == 0) std::fputs((line.program + ": " + text + "\n").c_str(), stderr);
}

void run_directory::warn(const std::string& text) {
  report.warnings.push_back(text);
  tell("warning: " + text);
}

std::optional<output::latest_checkpoint> run_directory::open() {
  if (ranks.maximum(simd_lanes) != ranks.minimum(simd_lanes))
    foundation::fail_input(
        "some ranks run on processors with AVX-512 and some without: results would depend on where a particle is. "
        "Set TETSUAME_SIMD=avx2 in the environment of all ranks");
  report.program = line.program;
  report.ranks = ranks.size;
  report.threads = omp_get_max_threads();
  report.simd_lanes = simd_lanes;
  using enum output::directory_mode;
  watch_signals();
  if (line.restart.empty()) {
    mode_ = line.force ? force : fresh;
    place_.emplace(ranks.comm, line.output, mode_);
    hash_files();
    return {};
  }
  if (line.restart == "latest") {
    mode_ = restart;
    place_.emplace(ranks.comm, line.output, mode_);
    return read_saved();
  }
  // A checkpoint that is named may start a directory of its own.
  auto found = read_saved();
  place_.emplace(ranks.comm, line.output, force);
  mode_ = holds_another_run(found.state) ? force : restart;
  if (mode_ == force && !line.force)
    foundation::fail_input(fmt::format(
        "output directory {} holds another run than that of checkpoint {}: name another directory by --output, or "
        "replace that run by --force; nothing was written",
        line.output, line.restart));
  return found;
}

bool run_directory::continues_here() const {
  return line.restart == "latest" || (mode_ == output::directory_mode::restart && is_inside(line.restart, line.output));
}

// The same on all ranks, as what a checkpoint holds must be.
void run_directory::hash_files() {
  std::map<std::string, std::string> found;
  foundation::on_rank_0(ranks.comm, [&] { found = hashes_of(line.files); });
  for (const auto& f : line.files)
    if (const auto hash = ranks.broadcast(found[f.label()]); !hash.empty()) hashes_[f.label()] = hash;
}

// Of those that are copied; those of rank 0: others have nothing.
std::vector<std::string> run_directory::contents_of_files() const {
  std::vector<std::string> contents(line.files.size());
  foundation::on_rank_0(ranks.comm, [&] {
    for (std::size_t n = 0; n < contents.size(); ++n)
      if (line.files[n].copied) contents[n] = foundation::read_plain_file(line.files[n].from);
  });
  return contents;
}

void run_directory::begin() {
  const auto contents = contents_of_files();  // which may stand here
  const bool named = !line.restart.empty() && line.restart != "latest" && is_inside(line.restart, line.output);
  place_->clear(mode_, named ? fs::path(line.restart).filename().string() : "",
                ranks.rank == 0 ? copies_in(line.output) : std::vector<std::string>());
  if (ranks.rank == 0) output::remove_quietly(path_of("stop"));
  log_.emplace(ranks.comm, path_of("run.log"));
  log_->when_damaged([this](const std::string& text) { warn(text); });
  say(fmt::format("{} {} on {} ranks x {} threads, input {}", line.program, version(), ranks.size,
                  omp_get_max_threads(), line.input));
  for (const auto& text : std::exchange(unsaid_, {})) log_->write(text);
  if (ranks.rank == 0) std::fputs(fmt::format("{}: results go to {}\n", line.program, line.output).c_str(), stderr);
  for (std::size_t n = 0; n < contents.size(); ++n)
    if (line.files[n].copied) output::write_text(ranks.comm, path_of(line.files[n].name), contents[n]);
  output::write_text(ranks.comm, path_of("resolved.nml"), resolved);
  keep_good(good_checkpoint_);
}

output::latest_checkpoint run_directory::read_saved() {
  output::latest_checkpoint saved;
  if (line.restart == "latest")
    saved = output::find_latest(ranks.comm, line.output);
  else
    saved = {line.restart, output::read_checkpoint(ranks.comm, line.restart), {}};
  const auto& g = saved.state.globals;
  const saved_run was{g.texts.at("program"), g.texts.at("input"), g.integers.at("step"), g.reals.at("time")};
  check_restart(was, {line.program, resolved, line.keys});
  check_end(was, {line.program, resolved, line.keys});
  for (const auto& [name, hash] : g.texts)
    if (name.starts_with(hash_prefix)) hashes_[name.substr(hash_prefix.size())] = hash;
  foundation::on_rank_0(ranks.comm, [&] { expect_same_files(line.files, hashes_); });
  return saved;
}

// Which would be lost, if this checkpoint were continued here.
bool run_directory::holds_another_run(const output::checkpoint& saved) const {
  std::string another;
  foundation::on_rank_0(ranks.comm, [&] {
    if (!output::holds_a_run(line.output)) return;
    another = is_inside(line.restart, line.output) ? "" : "yes";
    std::error_code ignored;
    const auto input = path_of("resolved.nml");
    if (!fs::is_regular_file(input, ignored) || fs::is_empty(input, ignored)) return;
    try {  // its first line names the program
      check_restart({line.program, saved.globals.texts.at("input")},
                    {line.program, namelist::read_file(input), line.keys});
    } catch (const foundation::error&) {
      another = "yes";
    }
  });
  return foundation::broadcast(ranks.comm, another) == "yes";
}

output::history& run_directory::table(const std::string& name, const std::vector<output::history_column>& columns) {
  const auto mark = marks_.find(name);
  const auto path = path_of(name);
  std::error_code ignored;
  const bool lost =
      mark != marks_.end() && ranks.rank == 0 && (!fs::exists(path, ignored) || fs::is_empty(path, ignored));
  auto made = mark == marks_.end() ? output::history::start(ranks.comm, path, columns)
                                   : output::history::resume(ranks.comm, path, columns, mark->second);
  if (lost && continues_here()) tell(fmt::format("{} was lost: it begins anew", path));
  made.when_damaged([this](const std::string& text) { warn(text); });
  return tables_.insert_or_assign(name, std::move(made)).first->second;
}

void run_directory::start_history(const std::vector<output::history_column>& columns) {
  columns_ = columns;
  history_ = &table("history.csv", columns);
}

void run_directory::append_line(std::int64_t step, std::span<const double> values) {
  check_line(columns_, values);
  history_->append(step, values);
}

next_end run_directory::end_of_fixed_step(double t, double dt, const integrators::step_limit& most, double t_end,
                                          double interval) const {
  const bool shorter = most.dt < dt;
  const double h = shorter ? most.dt : dt;
  const double stop = last_end(t_end, interval), rest = stop - t, steps = rest / h;
  const bool to_output = interval > 0.0 && next_snapshot <= t_end * (1.0 + 1e-9);
  // So many steps bring it there: what rounding did to t over many steps is no reason for another length.
  if (const double whole = std::round(steps); whole >= 1.0 && std::abs(steps - whole) <= 1e-6)
    return {shorter ? t + h : t + 2.0 * h, most.name};
  if (!to_output) return shorter && h < rest ? next_end{t + h, most.name} : next_end{stop, "output"};
  const double n = std::ceil(steps);
  return {n <= 1.0 ? stop : t + rest / n, rest / n < 0.9 * h ? "output" : most.name};
}

void run_directory::write_snapshot(const output::snapshot_header& header, std::vector<output::particle_group> groups,
                                   const output_options& o) {
  const std::string name = output::snapshot_name(static_cast<int>(snapshots_));
  output::write_snapshot(ranks.comm, path_of(name), header, std::move(groups), {line.program, version(), resolved},
                         o.form());
  output::add_to_series(ranks.comm, line.output, name, series_);
  ++snapshots_;
  if (o.interval > 0.0) next_snapshot = next_multiple(o.interval, header.time);
}

void run_directory::keep_good(const std::string& checkpoint) {
  good_checkpoint_ = checkpoint;
  if (ranks.rank != 0) return;
  const std::string until = good_checkpoint_.empty()
                                ? "no checkpoint stands yet"
                                : "until it stands, --restart latest continues from " + good_checkpoint_;
  tell_on_signal(fmt::format(": {} stops after this step, with a checkpoint; {}\n", line.program, until));
}

void run_directory::write_checkpoint(std::int64_t step, const integrators::explicit_integrator& integrator,
                                     output::checkpoint_globals g, const std::vector<output::table_view>& tables) {
  save(integrator.save(), g);
  g.reals["stepping_seconds"] = stepping_seconds;
  g.integers["step"] = step;
  g.integers["simd_lanes"] = simd_lanes;
  g.integers["snapshots"] = snapshots_;
  g.texts["program"] = line.program;
  g.texts["input"] = resolved;
  g.texts["version"] = version();
  for (const auto& [name, hash] : hashes_) g.texts[fmt::format("{}{}", hash_prefix, name)] = hash;
  for (auto& [name, table] : tables_) {
    const auto mark = table.mark();
    g.integers["bytes of " + name] = mark.bytes;
    g.texts["sum of " + name] = mark.sum;
  }
  keep_good(output::write_checkpoint(ranks.comm, line.output, step, g, tables));
  checkpointed_ = {};
  say(fmt::format("checkpoint {} at step {}", good_checkpoint_, step));
}

std::int64_t run_directory::continue_from(const output::latest_checkpoint& saved,
                                          integrators::explicit_integrator& integrator,
                                          const std::vector<output::history_column>& columns, double interval) {
  const auto& g = saved.state.globals;
  integrator.restore(integrator_memory(g));
  const std::int64_t step = g.integers.at("step");
  snapshots_ = g.integers.at("snapshots");
  if (interval > 0.0) next_snapshot = next_multiple(interval, integrator.time());
  stepping_seconds = g.reals.at("stepping_seconds");
  g.integers.at("bytes of history.csv");  // of every checkpoint of this version
  constexpr std::string_view prefix = "sum of ";
  for (const auto& [key, sum] : g.texts)
    if (key.starts_with(prefix)) {
      const auto name = key.substr(prefix.size());
      marks_[name] = {g.integers.at("bytes of " + name), sum};
      if (continues_here()) output::history::check(ranks.comm, path_of(name), marks_[name]);
    }

  for (const auto& message : saved.messages) tell(message);
  say("continuing from " + saved.path);
  if (const auto before = g.integers.at("simd_lanes"); before != simd_lanes)
    say(
        fmt::format("the checkpoint was written with {} SIMD lanes, this run has {}: sums are rounded in another "
                    "order, so the last digits will differ from the uninterrupted run's",
                    before, simd_lanes));
  begin();
  start_history(columns);
  output::forget_checkpoints_after(ranks.comm, line.output, step);
  series_ = output::continue_series(ranks.comm, line.output, static_cast<int>(snapshots_));
  for (const auto& message : series_.messages) tell(message);
  keep_good(saved.path);
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

void run_directory::complete(std::int64_t step, double t, double t_end, const std::string& remark) {
  report.check_finite(ranks);
  report.status = "completed";
  report.message = fmt::format("completed {} steps, t = {:.6g} s{}", step, t, remark);
  if (remark.empty() && t < t_end * (1.0 - 1e-9))
    report.message += fmt::format(": before t_end = {:.6g} s, as time.steps asks for no more", t_end);
  if (const auto doubt = ranks.broadcast(doubts(report)); !doubt.empty()) {
    report.status = "completed_doubtful";
    report.message += "; doubtful: " + doubt;
    tell("warning: the run came to its end, but its result is doubtful: " + doubt);
  }
  report.write(ranks, line.output);
  if (ranks.rank == 0) output::remove_quietly(path_of("stop"));
  say(report.message);
  if (ranks.rank == 0) report.print(line.output);
}

bool run_directory::stop_file_is_there() {
  constexpr double patience = 0.2;  // s between two looks, which cost something on a cluster's file system
  if (ranks.rank != 0 || looked_.elapsed() < patience) return false;
  looked_ = {};
  std::error_code ignored;
  return fs::is_regular_file(fs::symlink_status(path_of("stop"), ignored));
}

double run_directory::stop_reason(const run_options& o) {
  if (const int signal = stop_requested(); signal != 0) return first_signal_reason + signal;
  if (stop_file_is_there()) return file_reason;
  return o.wall_clock_limit > 0.0 && age() >= o.wall_clock_limit ? wall_clock_reason : no_reason;
}

std::string run_directory::to_go_on() const {
  const std::string start = ranks.size > 1 ? fmt::format("mpirun -n {} ", ranks.size) : "";
  return fmt::format("{}{} --output {} --restart latest", start, line.started_as, line.output);
}

void run_directory::interrupt(double reason, std::int64_t step, const std::string& of_steps, double t) {
  if (ranks.rank == 0) output::remove_quietly(path_of("stop"));
  throw foundation::error(
      foundation::exit_status::interrupted,
      fmt::format("stopped {} at step {}{}, t = {:.6g} s, after a checkpoint: continue with --restart latest, {}",
                  told_by(reason), step, of_steps, t, to_go_on()));
}
void run_directory::interrupt_settling(double reason, std::int64_t done, std::int64_t of_steps) {
  if (ranks.rank == 0) output::remove_quietly(path_of("stop"));
  throw foundation::error(foundation::exit_status::interrupted,
                          fmt::format("stopped {} while the start settled, after {} of {} steps: nothing was written, "
                                      "the same command begins again",
                                      told_by(reason), done, of_steps));
}

// As rank 0 sees it.
std::string run_directory::what_is_good() const {
  if (good_checkpoint_.empty()) return "; no checkpoint was written";
  std::error_code ignored;
  if (fs::exists(good_checkpoint_, ignored))
    return "; " + good_checkpoint_ + " is good: continue with --restart latest";
  const auto moved = output::present_place(line.output);
  const auto there = fs::path(moved) / fs::path(good_checkpoint_).filename();
  if (moved != line.output && fs::exists(there, ignored))
    return fmt::format("; the directory was moved, and {} is good: continue with --restart latest --output {}",
                       there.string(), moved);
  return "; its checkpoint " + good_checkpoint_ + " is no longer there";
}

void run_directory::fail(const foundation::error& e, std::int64_t step, const std::function<void()>& save) {
  using foundation::exit_status;
  std::string message = e.what();
  if (e.status() == exit_status::calculation_failed) message = fmt::format("step {}: {}", step + 1, message);
  if (!log_ && e.status() != exit_status::calculation_failed) throw foundation::error(e.status(), message);
  if (e.status() == exit_status::file_failed) message += what_is_good();
  report.status = e.status() == exit_status::interrupted ? "interrupted" : "failed";
  report.message = message;
  try {
    if (!log_) begin();
    save();
    report.write(ranks, line.output);
    say(message);
  } catch (const foundation::error& second) {
    // The first reason is the one to be told; on a full disk neither can be written.
    message += std::string("; and ") + second.what();
  }
  throw foundation::error(e.status(), message);
}

}  // namespace tetsuame::run
