// What the time loop asks of a problem: its state, the right-hand side, and what is to be told of it.
#pragma once

#include <algorithm>
#include <array>
#include <domain/decomposition.hpp>
#include <foundation/stages.hpp>
#include <foundation/waiting.hpp>
#include <integrators/explicit_integrator.hpp>
#include <limits>
#include <numeric>
#include <output/checkpoint.hpp>
#include <output/history.hpp>
#include <output/snapshot.hpp>
#include <particles/particles.hpp>
#include <run/apart.hpp>
#include <run/run_directory.hpp>
#include <run/summary.hpp>
#include <span>
#include <string>
#include <vector>

namespace tetsuame::run {

// What the steps of this process (without output) cost in communication, for the metrics of summary.json.
class communication_meter {
 public:
  // Around each step.
  void begin() { before_ = now(); }
  void end() {
    const auto after = now();
    for (std::size_t k = 0; k < total_.size(); ++k) total_[k] += after[k] - before_[k];
    ++steps_;
  }

  // Collective. NAME: mean over the ranks, NAME_max: the largest rank's; all but the halo's particles a step.
  template <int D>
  void describe(const domain::decomposition<D>& d, nlohmann::ordered_json& metrics) const {
    const auto put = [&](const std::string& name, double mine) {
      const auto all = d.ranks.every(mine);
      metrics[name] = std::accumulate(all.begin(), all.end(), 0.0) / static_cast<double>(all.size());
      metrics[name + "_max"] = *std::max_element(all.begin(), all.end());
    };
    const double steps = std::max(1.0, static_cast<double>(steps_));
    put("waiting_seconds_per_step", total_[0] / steps);
    put("halo_messages_per_step", total_[1] / steps);
    put("halo_bytes_per_step", total_[2] / steps);
    put("migration_bytes_per_step", total_[3] / steps);
    put("fluid_halo_particles", received(d.ranks, d.fluid_halo));
    put("wall_halo_particles", received(d.ranks, d.wall_halo));
    metrics["collectives_per_step"] = total_[4] / steps;
  }

 private:
  // Ghosts that come from other ranks.
  template <int D>
  static double received(const domain::communicator& ranks, const domain::halo<D>& h) {
    double n = 0.0;
    for (const auto& s : h.from)
      if (s.rank != ranks.rank) n += static_cast<double>(s.count);
    return n;
  }

  // Since the process began: s waited, messages and bytes of halos, bytes of migration, collective operations.
  static std::array<double, 5> now() {
    const auto& s = foundation::sent;
    return {foundation::waited_seconds, static_cast<double>(s.halo_messages), static_cast<double>(s.halo_bytes),
            static_cast<double>(s.migration_bytes), static_cast<double>(s.collectives)};
  }

  std::array<double, 5> total_{}, before_{};  // of the steps that ended; at the last one's begin
  std::int64_t steps_ = 0;
};

class problem {
 public:
  virtual ~problem() = default;

  virtual const domain::communicator& ranks() const = 0;
  virtual std::size_t local_particles() const = 0;
  virtual std::size_t simd_lanes() const = 0;                    // of the pair loop, which is compiled with the program
  virtual output::snapshot_header header() const = 0;            // all but time and step
  virtual std::vector<std::string> about() const { return {}; }  // lines for the log and the terminal

  virtual foundation::stage_times& times() = 0;  // seconds in each stage of the steps, of this rank

  // The integrated arrays, which rebuild() and read_particles() move.
  virtual std::vector<integrators::field> fields() = 0;
  // Whether the state can be evaluated; where it cannot, methods that choose their steps take a shorter one.
  virtual bool evaluable() { return true; }
  // Collective: the state in the arrays is of this time (s), until another is said.
  virtual void at_time(double) {}
  // Collective: fail_calculation where a value of the integrated arrays is not finite.
  virtual void check_state() {}
  // dy/dt at the state in the arrays, both of finite numbers or fail_calculation. A memory (lagged terms) may be read;
  // it moves on in commit_lagged only.
  virtual void evaluate(std::span<double* const> rate) = 0;
  virtual integrators::step_limit largest_step() = 0;  // s, of the present state, the same on all ranks
  // Collective: what the log is to warn of with fixed steps of dt (s), beside that limit; empty: nothing.
  virtual std::string warning_of_step(double) { return {}; }
  virtual double diffusion_radius() { return 0.0; }  // 1/s, a bound for 'rkl2' and 'rkc2', where these are offered
  // s, of the present state, once its rate is known: a bound for the next step, whatever its length was to be.
  virtual double longest_step() { return std::numeric_limits<double>::infinity(); }

  // Whether commit_lagged may follow the next evaluations; else what serves that alone can be left out. True at first.
  virtual void expect_lagged(bool) {}
  // Whether the next evaluations are of a state that a snapshot shows: what serves that alone can be left out
  // otherwise. True at first.
  virtual void expect_snapshot(bool) {}
  // Whether the next evaluations count, for what is told of them: those that a restart repeats do not. True at first.
  virtual void expect_counts(bool) {}
  // After evaluations at the state of this step: tables of the problem's own that tell of them are brought up to date.
  virtual void complete_tables(std::int64_t /*step*/) {}
  // The rate at the present state is known: what the next evaluations lag behind may become the present.
  virtual void commit_lagged() {}
  // Whether that rate is to be evaluated again then, so that all stages of a step have one memory.
  virtual bool needs_lagged() const { return false; }
  // At the start and after each step. Returns whether the equations change with the time, so that a rate known is none.
  virtual bool set_time(double) { return false; }
  // After an accepted step. Returns whether it changed the state on this rank.
  virtual bool complete_step(std::int64_t) { return false; }
  // m: what has moved on this rank since the lists were made; what of that they allow; m/s, the velocities.
  virtual apart moved() { return {}; }
  virtual std::string farthest_moved() { return "particles"; }  // collective: who, for messages
  virtual double allowance() const { return 1.0; }
  virtual apart speed() { return {}; }
  // m: the allowance of new lists that are to allow so much. The next ones are to.
  virtual double possible_allowance(double) const { return allowance(); }
  virtual void set_allowance(double) {}
  // Sorting, ghosts, lists. as_they_were: positions of the last time are used, so that sums keep their order.
  virtual void rebuild(bool as_they_were) = 0;
  // Before the step after `step`, when `left` may follow: lists where they are due, and cuts between ranks where they
  // pay. Returns whether the arrays are others.
  virtual bool renew(bool lists_are_due, std::int64_t /*step*/, std::int64_t /*left*/) {
    if (lists_are_due) rebuild(false);
    return lists_are_due;
  }
  // s, that this rank computed in the last step, without what it waited for others.
  virtual void worked(double) {}
  // Of the steps, without output.
  communication_meter communication;

  // Tables of the problem's own, beside the history.
  virtual void begin_tables(run_directory&) {}
  // Measures need an evaluation at the present state.
  virtual std::vector<output::history_column> columns() const = 0;  // beside time and dt
  virtual std::vector<double> row(double t) = 0;
  virtual bool steady() const { return false; }  // after row(): nothing more will happen
  // After row(). What has changed, where the problem goes on at the same time with other particles, in other arrays, or
  // with other sums; empty: nothing.
  virtual std::string refine(double) { return {}; }
  virtual std::vector<output::particle_group> snapshot(std::vector<particles::array>& extra) = 0;
  virtual void report(double t, summary& s) = 0;
  // Collective. What may be said of a run that failed, too.
  virtual void report_counts(summary&) {}
  // The calculation failed in the step after `step`, for this reason: what of it summary and tables are to say.
  virtual void fail(const foundation::error&, std::int64_t /*step*/, summary&) {}
  virtual std::string hash() = 0;

  virtual output::table_view particles_table(std::vector<std::int64_t>& materials) = 0;
  virtual void save(output::checkpoint_globals&) const {}
  virtual void restore(const output::checkpoint_globals&) {}
  virtual void read_particles(const output::table& t) = 0;  // after restore()
};

// The time loop. Collective. Carries the problem from its start state, or from a checkpoint, to the end, and leaves the
// output directory as docs/user_guide.md describes it. Throws foundation::error with the exit status of a run that did
// not complete.
void carry_out(problem& p, const common_options& o, const command_line& line, const std::string& resolved);

}  // namespace tetsuame::run
