// What every run keeps in its directory, and how it is begun, continued and ended: log, resolved input, history,
// snapshots and their series, checkpoints, summary. The loops (hydrostatic.hpp, march/march.cpp) say when.
#pragma once

#include <chrono>
#include <domain/communicator.hpp>
#include <functional>
#include <integrators/explicit_integrator.hpp>
#include <optional>
#include <output/checkpoint.hpp>
#include <output/history.hpp>
#include <output/log.hpp>
#include <output/series.hpp>
#include <output/snapshot.hpp>
#include <simulation/command_line.hpp>
#include <simulation/summary.hpp>
#include <string>
#include <vector>

namespace tetsuame::simulation {

using seconds_clock = std::chrono::steady_clock;

inline double since(seconds_clock::time_point begin) {
  return std::chrono::duration<double>(seconds_clock::now() - begin).count();
}

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
  std::optional<output::history> history;
  double stepping_seconds = 0.0;  // of the run, over its interruptions
  double next_snapshot = 0.0;     // s

  // Makes the directory, or reads the checkpoint that is to be continued, which is checked before anything is written;
  // begins run.log and resolved.nml, and heeds signals. Throws bad_input where ranks have different SIMD lanes, where
  // the directory holds another run, or where the checkpoint is of another input; file_failed where nothing can be
  // written or no checkpoint is whole.
  std::optional<output::latest_checkpoint> open();

  void say(const std::string& text);   // to the log
  void tell(const std::string& text);  // and to the terminal

  double age() const { return since(began_); }                    // s, of this run, by this rank's clock
  double checkpoint_age() const { return since(checkpointed_); }  // s, of the last checkpoint or of this run
  bool late(const run_options& o) const { return o.wall_clock_limit > 0.0 && age() >= o.wall_clock_limit; }

  void start_history(const std::vector<output::history_column>& columns);

  bool snapshot_due(double t, double interval) const { return interval > 0.0 && t >= next_snapshot * (1.0 - 1e-9); }
  // The header's time and step say when. interval: s, of the model, from one to the next; 0: none is due.
  void write_snapshot(const output::snapshot_header& header, const std::vector<output::particle_group>& groups,
                      double interval);

  // Adds to what the run has put into g what all have, the integrator's memory among it.
  void write_checkpoint(std::int64_t step, const integrators::explicit_integrator& integrator,
                        output::checkpoint_globals g, const output::table_view& fluid);
  // The counterpart, for what is not particles: the integrator's memory and the files as they were at that step, which
  // is returned.
  std::int64_t continue_from(const output::latest_checkpoint& saved, integrators::explicit_integrator& integrator,
                             const std::vector<output::history_column>& columns);
  // Before the particles are taken up: what the log should have of it.
  void announce(const output::latest_checkpoint& saved);

  // None: a run that failed before its first step could be prepared.
  void fill_report(std::int64_t step, const integrators::explicit_integrator* integrator);
  void complete(const std::string& message);
  // The exit of a run that was told to stop, after its checkpoint.
  [[noreturn]] static void interrupt(std::int64_t step, const std::string& of_steps, double t);
  // Ends the run with the reason in summary and log, and throws it again. save: puts to disk and into the report what
  // there is; it may change the report's status.
  [[noreturn]] void fail(const foundation::error& e, std::int64_t step, const std::function<void()>& save);

 private:
  output::latest_checkpoint read_saved() const;

  std::int64_t snapshots_ = 0;
  std::optional<output::run_log> log_;
  output::series series_;
  std::string good_checkpoint_;  // the newest; empty: none
  seconds_clock::time_point began_ = seconds_clock::now(), checkpointed_ = began_;
};

}  // namespace tetsuame::simulation
