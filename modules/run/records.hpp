// When a loop writes what: lines of the history, snapshots, checkpoints.
#pragma once

#include <cstdint>
#include <functional>
#include <output/checkpoint.hpp>

namespace tetsuame::run {

class records {
 public:
  // How a line, a snapshot and a checkpoint of the present state are written; the first two need an evaluation there.
  struct duties {
    std::function<void()> evaluate, line, snapshot, checkpoint;
  };
  explicit records(duties d) : write_(std::move(d)) {}

  // The first ones; the present state has been evaluated.
  void begin(std::int64_t step) {
    line(step);
    snapshot(step);
  }
  void lines_and_snapshots(std::int64_t step, bool line_due, bool snapshot_due) {
    if (line_due || snapshot_due) write_.evaluate();
    if (line_due) line(step);
    if (snapshot_due) snapshot(step);
  }
  void checkpoint(std::int64_t step) {
    write_.checkpoint();
    checkpoint_ = step;
  }
  bool has_line(std::int64_t step) const { return line_ == step; }

  // The last checkpoint stands before what only the end of a run has, a line and a snapshot that were not due: a run
  // that is continued from it is one that was not stopped.
  void end(std::int64_t step) {
    if (checkpoint_ != step) checkpoint(step);
    write_.evaluate();
    if (line_ != step) line(step);
    if (snapshot_ != step) snapshot(step);
  }

  void save(output::checkpoint_globals& g) const {
    g.integers["line_step"] = line_;
    g.integers["snapshot_step"] = snapshot_;
  }
  // holds_checkpoint: whether that of this step lies in the run's own directory.
  void restore(const output::checkpoint_globals& g, std::int64_t step, bool holds_checkpoint) {
    line_ = g.integers.at("line_step");
    snapshot_ = g.integers.at("snapshot_step");
    if (holds_checkpoint) checkpoint_ = step;
  }

 private:
  void line(std::int64_t step) {
    write_.line();
    line_ = step;
  }
  void snapshot(std::int64_t step) {
    write_.snapshot();
    snapshot_ = step;
  }

  duties write_;
  std::int64_t line_ = -1, snapshot_ = -1, checkpoint_ = -1;  // the steps of the last ones
};

}  // namespace tetsuame::run
