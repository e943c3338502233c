// What every run keeps in its directory, and how it is begun, continued and ended: log, resolved input, history,
// snapshots and their series, checkpoints, summary. The time loop says when.
#pragma once

#include <domain/communicator.hpp>
#include <foundation/waiting.hpp>
#include <functional>
#include <integrators/explicit_integrator.hpp>
#include <map>
#include <optional>
#include <output/checkpoint.hpp>
#include <output/directory.hpp>
#include <output/history.hpp>
#include <output/snapshot.hpp>
#include <run/command_line.hpp>
#include <run/summary.hpp>
#include <span>
#include <string>
#include <vector>

namespace tetsuame::run {

// Where the next step should end, and what decided that.
struct next_end {
  double t;        // s
  std::string by;  // for the statistics
};

// All functions but say(), tell() and the ages are collective.
struct run_directory {
  const domain::communicator& ranks;
  const command_line& line;
  const std::string& resolved;  // the input
  int simd_lanes;               // of the pair loop, which is compiled with the program

  run_directory(const domain::communicator& ranks_of_run, const command_line& command, const std::string& input,
                int lanes)
      : ranks(ranks_of_run), line(command), resolved(input), simd_lanes(lanes) {}

  summary report;
  double stepping_seconds = 0.0;  // of the run, over its interruptions
  double next_snapshot = 0.0;     // s

  // Claims the directory, or reads the checkpoint that is to be continued, and heeds signals. Nothing is written yet.
  std::optional<output::latest_checkpoint> open();
  // The run is set up: removes what --force replaces, begins run.log and resolved.nml.
  void begin();

  void say(const std::string& text);   // to the log
  std::string to_go_on() const;        // the command that continues this run
  void tell(const std::string& text);  // and to the terminal
  void warn(const std::string& text);  // and to the summary; on rank 0

  double age() const { return began_.elapsed(); }                    // s, of this run, by this rank's clock
  double checkpoint_age() const { return checkpointed_.elapsed(); }  // s, of the last checkpoint or of this run

  // Why this rank would have the run stop: 0 not at all; a signal, the file DIR/stop, or the wall-clock limit. The
  // largest of all ranks' counts, and is what interrupt() is to be told.
  double stop_reason(const run_options& o);

  // A table of the run, made anew or continued as the checkpoint knows it, by its name in the directory.
  output::history& table(const std::string& name, const std::vector<output::history_column>& columns);
  void start_history(const std::vector<output::history_column>& columns);
  // To history.csv. Throws calculation_failed where a value is not finite.
  void append_line(std::int64_t step, std::span<const double> values);

  bool snapshot_due(double t, double interval) const { return interval > 0.0 && t >= next_snapshot * (1.0 - 1e-9); }
  // For steps of the fixed length dt (s), or of `most` where that is less: those before an output time are equal and a
  // little shorter where it is no multiple of them away; the last one before t_end is cut.
  next_end end_of_fixed_step(double t, double dt, const integrators::step_limit& most, double t_end,
                             double interval) const;
  // For steps that are chosen one by one.
  double last_end(double t_end, double interval) const {
    return interval > 0.0 ? std::min(t_end, next_snapshot) : t_end;
  }
  // The header's time and step say when.
  void write_snapshot(const output::snapshot_header& header, std::vector<output::particle_group> groups,
                      const output_options& o);

  // Adds to what the run has put into g what all have, the integrator's memory among it.
  void write_checkpoint(std::int64_t step, const integrators::explicit_integrator& integrator,
                        output::checkpoint_globals g, const std::vector<output::table_view>& tables);
  // The counterpart, for what is not particles: the integrator's memory and the files as they were at that step, which
  // is returned. interval: s, as above, which may be another now.
  std::int64_t continue_from(const output::latest_checkpoint& saved, integrators::explicit_integrator& integrator,
                             const std::vector<output::history_column>& columns, double interval);

  // Of a restart: whether the checkpoint lies among what the run wrote before.
  bool continues_here() const;

  // None: a run that failed before its first step could be prepared.
  void fill_report(std::int64_t step, const integrators::explicit_integrator* integrator);
  // remark: of the end, where it is neither the last of the steps asked for nor t_end.
  void complete(std::int64_t step, double t, double t_end, const std::string& remark);
  // The exit of a run that was told to stop, after its checkpoint.
  [[noreturn]] void interrupt(double reason, std::int64_t step, const std::string& of_steps, double t);
  // Before begin(), when so many steps of the motion before the run are done.
  [[noreturn]] void interrupt_settling(double reason, std::int64_t done, std::int64_t of_steps);
  // Ends the run with the reason in summary and log, and throws it again. save: puts to disk and into the report what
  // there is; it may change the report's status. What fails before the run began leaves no trace in the directory.
  [[noreturn]] void fail(const foundation::error& e, std::int64_t step, const std::function<void()>& save);

 private:
  void hash_files();
  std::vector<std::string> contents_of_files() const;
  std::string path_of(const std::string& name) const { return line.output + "/" + name; }
  output::latest_checkpoint read_saved();
  bool holds_another_run(const output::checkpoint& saved) const;
  void keep_good(const std::string& checkpoint);
  std::string what_is_good() const;
  bool stop_file_is_there();

  std::int64_t snapshots_ = 0;
  std::optional<output::claimed_directory> place_;
  output::directory_mode mode_ = output::directory_mode::fresh;
  std::optional<output::run_log> log_;
  std::vector<std::string> unsaid_;  // of before the log
  std::map<std::string, output::table_mark> marks_;
  std::map<std::string, output::history> tables_;
  output::history* history_ = nullptr;
  std::map<std::string, std::string> hashes_;    // of the files that the input names
  std::vector<output::history_column> columns_;  // of the history
  output::series series_;
  std::string good_checkpoint_;  // the newest; empty: none
  foundation::stopwatch began_, checkpointed_ = began_, looked_ = began_;
};

}  // namespace tetsuame::run
