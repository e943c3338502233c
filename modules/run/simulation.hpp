// What the time loop (time_loop.cpp) asks of a simulation, in this order. A simulation has arrays that are integrated,
// their rate, and what is told of them. It need not have particles: those that have are particle_simulation.hpp's, and
// tests/run/heat_on_a_grid.cpp is one on a grid.
//
//   begin            at the start, or from a checkpoint
//   evaluate, row, snapshot     the state at the start
//   each step:       prepare -> evaluate at its start -> commit -> evaluate at its stages -> complete
//     lines due:     evaluate (purpose line or snapshot) -> row -> snapshot -> refine
//     checkpoint due: save
//   report           at the end, and where the run failed
//
// All functions are collective.
#pragma once

#include <algorithm>
#include <array>
#include <domain/decomposition.hpp>
#include <foundation/stages.hpp>
#include <foundation/waiting.hpp>
#include <integrators/explicit_integrator.hpp>
#include <limits>
#include <numeric>
#include <optional>
#include <output/checkpoint.hpp>
#include <output/history.hpp>
#include <output/snapshot.hpp>
#include <particles/particles.hpp>
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

// The arrays that are integrated, with `size` values each on this rank. They may move in begin, prepare and refine.
struct state_arrays {
  std::vector<integrators::field> fields;
  std::size_t size = 0;
};

// Why a rate is evaluated: for nothing but the check that the state is finite, for a step, for a line of the history,
// for a snapshot.
enum class purpose { check, step, line, snapshot };

struct evaluation {
  double time = 0.0;      // s, of the state in the arrays
  std::int64_t step = 0;  // the last complete one
  purpose of = purpose::step;
  bool may_commit = true;           // commit() may follow: otherwise what serves that alone can be left out
  bool counts = true;               // false: a run that this one continues has counted it
  bool shorter_steps_help = false;  // a state that cannot be evaluated is no failure
  double slow_forces = 1.0;         // by how much rates have these in them (integrators::explicit_integrator)
};

struct step_limits {
  integrators::step_limit stable{std::numeric_limits<double>::infinity(), ""};  // s, of fixed steps
  double radius = 0.0;  // 1/s, bounds the spectrum of the rate, for 'rkl2' and 'rkc2' where these are offered
};

// A simulation's own numbers after a step, of which prepare() is given the maxima over the ranks.
using step_maxima = std::array<double, 16>;

// What prepare() knows of the step that follows.
struct step_ahead {
  double time = 0.0;      // s
  std::int64_t step = 0;  // the last complete one
  std::int64_t steps_left = 0;
  double dt = 0.0;     // s, of the next step if nothing bounds it
  double bound = 0.0;  // s, of equations that have changed since dt was chosen; 0: none
  bool fixed = false;  // the input gives dt
  bool varies_steps = false;
  double substeps = 1.0;                // of which a stable one is as long as limits() says
  bool first = false;                   // warnings are welcome
  std::optional<step_maxima> maxima{};  // of complete(), over the ranks; none: the state is a new one
};
struct step_preparation {
  bool arrays_moved = false;
  bool number_changed = false;                                                   // of particles, on any rank
  integrators::step_limit longest{std::numeric_limits<double>::infinity(), ""};  // s, whatever the method
  std::string warning{};                                                         // of steps of dt; empty: none
};

struct committed {
  bool evaluate_again = false;                               // so that all stages of the step have one memory
  double longest = std::numeric_limits<double>::infinity();  // s, bounds the step for accuracy
};

struct completed_step {
  double time = 0.0;  // s
  std::int64_t step = 0;
  double busy_seconds = 0.0;  // this rank's, without what it waited for others
};
struct completion {
  bool state_changed = false;      // on this rank
  bool equations_changed = false;  // with the time, so that a rate known is none
  // This rank's numbers of which prepare() is given the maxima; one that is not a number, or infinite, has the state
  // checked.
  step_maxima maxima{};
};

struct history_line {
  std::vector<double> values;
  bool steady = false;  // nothing more will happen
};
struct snapshot_contents {
  output::snapshot_header header;  // all but time and step
  std::vector<output::particle_group> groups;
  std::vector<particles::array> made;  // for the occasion
};

// How a run ended. failed: null where it is complete.
struct ending {
  double time = 0.0;  // s
  std::int64_t step = 0;
  const foundation::error* failed = nullptr;
};

class simulation {
 public:
  virtual ~simulation() = default;
  simulation(const domain::communicator& of, foundation::stage_times& of_stages, int dimension_of_space, int lanes = 1)
      : ranks(of), times(of_stages), dimension(dimension_of_space), simd_lanes(lanes) {}
  simulation(const simulation&) = delete;
  simulation& operator=(const simulation&) = delete;

  const domain::communicator& ranks;
  foundation::stage_times& times;     // s in each stage of the steps, of this rank
  const int dimension, simd_lanes;    // of the pair loop, which is compiled with the program
  std::vector<std::string> about;     // lines for the log and the terminal
  communication_meter communication;  // of the steps, without output

  // From the start where there is no checkpoint. Tables of the simulation's own are in `files` once a line is due.
  // Returns whether nothing more will happen.
  virtual bool begin(const output::checkpoint* saved, run_directory& files) = 0;
  virtual state_arrays arrays() = 0;
  // dy/dt at the state in the arrays, both of finite numbers, or fail_calculation. Returns false where the state cannot
  // be evaluated and shorter steps help. What lags behind may be read; it moves on in commit() alone.
  virtual bool evaluate(const evaluation& what, std::span<double* const> rate) = 0;
  // Of rates a part that depends on positions alone: into integrators::field::slow_rate, where there is one.
  virtual void evaluate_slow() {}
  virtual step_limits limits(bool asks_radius) = 0;  // of the present state, the same on all ranks
  // Before each step: neighbour lists, cuts between ranks.
  virtual step_preparation prepare(const step_ahead&) { return {}; }
  // The rate at the present state is known: what the next evaluations lag behind may become the present.
  virtual committed commit() { return {}; }
  virtual completion complete(const completed_step&) { return {}; }

  virtual std::vector<output::history_column> columns() const = 0;  // beside time and dt
  virtual history_line row(double time) = 0;                        // after an evaluation at the present state
  virtual snapshot_contents snapshot() = 0;
  // Before the run (time_loop.cpp): velocities change by their rate over dt (s), less the part 1 - kept; or what moves
  // with them, places and what is carried along, by its own. At the end all are at rest.
  enum class damped { kick, drift, rest };
  virtual void settle(damped, std::span<double* const> /*rate*/, double /*dt*/, double /*kept*/) {}
  // s, in which sound crosses the box at the start; 0: it is not known.
  virtual double crossing_time() { return 0.0; }
  // Of the first evaluation: the largest acceleration over g, or over c²/L; none where it has no meaning.
  std::optional<double> equilibrium_residual{};
  // After row(). What has changed, where the simulation goes on at the same time with other arrays, or with other
  // sums; empty: nothing.
  virtual std::string refine(double /*time*/) { return {}; }
  virtual void report(const ending&, summary&) = 0;
  // The tables' values stay as they are until the next call; `integers` holds those that are made for the first one.
  virtual std::vector<output::table_view> save(output::checkpoint_globals&, std::vector<std::int64_t>& integers) = 0;
};

// The time loop. Collective. Carries the simulation from its start, or from a checkpoint, to the end, and leaves the
// output directory as docs/user_guide.md describes it. Throws foundation::error with the exit status of a run that did
// not complete.
void carry_out(simulation& s, const common_options& o, const command_line& line, const std::string& resolved);

}  // namespace tetsuame::run
