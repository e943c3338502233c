// Dynamic load balance on the slice grid (cuts.hpp): from the time each rank measured, new cuts under which the times
// become equal, by the methods of docs/load_balancer.md. Nothing here communicates: every rank holds all cuts and all
// times and comes to the same result.
#pragma once

#include <algorithm>
#include <array>
#include <balance/cuts.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <namelist/schema.hpp>
#include <string>
#include <vector>

namespace tetsuame::balance {

struct balancer_options {
  std::string method = "remap";
  double relaxation = 1.0;     // part of a method's full step
  double minimum_width = 0.0;  // m, of every slab along every axis
  // Density of cost everywhere at least this part of its mean: it decides where cuts stand in empty space.
  double floor = 1e-4;
  std::int64_t levels = 30;   // level_relaxation: coarsest groups have 2^levels slabs, as far as there are so many
  std::int64_t readings = 5;  // of the clock, which have to agree: lasting_cost
};

void declare(namelist::schema& schema, balancer_options& o);

// Where a rank's particles are: the least box around them, m (lower > upper: it has none), and what part of their cost
// lies in each of `bins` equal parts of the box along each axis. Everywhere alike until it is told.
template <int D>
struct extent {
  static constexpr std::size_t bins = 16;
  std::array<double, D> lower, upper;
  std::array<std::array<double, bins>, D> cost;  // any unit
  extent() {
    lower.fill(std::numeric_limits<double>::infinity());
    upper.fill(-std::numeric_limits<double>::infinity());
    for (auto& along : cost) along.fill(1.0);
  }
  void include(const std::array<double, D>& x) {
    for (std::size_t a = 0; a < D; ++a) {
      lower[a] = std::min(lower[a], x[a]);
      upper[a] = std::max(upper[a], x[a]);
    }
  }
  // Once all are included: forgets the cost, then takes that of each.
  void begin_costs() {
    for (auto& along : cost) along.fill(0.0);
  }
  void add_cost(const std::array<double, D>& x, double of_particle) {
    for (std::size_t a = 0; a < D; ++a) {
      const double at = (x[a] - lower[a]) / (upper[a] - lower[a]);  // not a number where the box is flat
      cost[a][at > 0.0 ? static_cast<std::size_t>(std::min(at, 1.0 - 1e-9) * static_cast<double>(bins)) : 0] +=
          of_particle;
    }
  }
};
// One for each rank; empty: not known, particles may be anywhere in their cells.
template <int D>
using extents = std::vector<extent<D>>;

// New cuts. Times (s, any common factor) as many as ranks; such as are negative or not finite are taken as
// zero. Where all are zero the cuts stay. Throws fail_input where the number of times is wrong.
// Slabs are at least minimum_width wide, or equal where the box has no room for that.
template <int D>
cuts<D> propose(const cuts<D>& now, const std::vector<double>& time_per_rank, const balancer_options& o,
                const extents<D>& where = {});

// A part of an axis, of a group of cuts, in equal parts.
struct window {
  std::size_t group;
  double lower, upper;  // m
  // The part that x is in.
  std::size_t part(double x, std::size_t parts) const {
    const double last = static_cast<double>(parts) - 0.5;
    return static_cast<std::size_t>(std::clamp((x - lower) / (upper - lower) * static_cast<double>(parts), 0.0, last));
  }
};

// Where the cost is, of all ranks: what each part of each window holds, one window behind the other. Windows come by
// groups, in each from below, and may overlap; `then` has the new cuts of the axes before.
template <int D>
using density_along = std::function<std::vector<double>(std::size_t axis, const cuts<D>& then,
                                                        const std::vector<window>& windows, std::size_t parts)>;

// By `remap` with the cost itself in place of what each rank tells of its own: one update is enough. It asks for the
// density along the whole box, and again along the parts that cuts have come to lie in: they come to stand where the
// cost below is nearest to what is wanted, which between the rows of a lattice no interpolation tells.
template <int D>
cuts<D> propose_by_density(const cuts<D>& now, const std::vector<double>& time_per_rank, const balancer_options& o,
                           const density_along<D>& density);

// Measured; of a move.
struct move_costs {
  double per_particle = 0.0;  // s, for each particle a rank sends or receives
  double rebuild = 0.0;       // s, the new lists of the slowest rank and all that is paid once
};

struct decision {
  bool move = false;
  double gain = 0.0, cost = 0.0;  // s, of the slowest rank over the coming steps
  std::string reason;
  std::vector<double> after;  // s per step of each rank after a move between cuts
};

// Of the moves made so far ("Experience" of docs/load_balancer.md): how far to trust the next prediction, and how much
// of the imbalance to remove at once.
struct experience {
  double trust = 1.0;       // multiplies predicted gains
  double relaxation = 1.0;  // multiplies balancer_options::relaxation
  // The last move: predicted gain, s per step of the slowest rank; measured times per step before and after.
  void moved(double predicted, const std::vector<double>& before, const std::vector<double>& after);
  void stayed();  // forgets slowly, so that a new imbalance gets its chance
};
balancer_options relaxed(balancer_options o, const experience& so_far);

// The counted work, which does not scatter as the clock does, times the part of a rank's slowness that lasts: the least
// of what it was in each of the last readings, or nothing where these do not agree on slower or faster.
class lasting_cost {
 public:
  explicit lasting_cost(std::int64_t readings) : readings_(static_cast<std::size_t>(readings)) {}
  // s per step of each rank, as measured now and remembered from the readings before; counted: any unit. With one
  // reading, or nothing counted: the seconds.
  std::vector<double> of(const std::vector<double>& seconds, const std::vector<double>& counted);

 private:
  std::size_t readings_;
  std::vector<std::vector<double>> slowness_;  // of each rank: its share of the time over its share of the work
};

// Moves where the slowest rank gains more over `steps` steps than the move costs. Times are s per step, spread over
// the cells as in propose(). No rank can become faster than one of its particles: where ranks have few, there is little
// to gain.
template <int D>
decision worth_moving(const cuts<D>& now, const cuts<D>& then, const std::vector<double>& time_per_step,
                      const std::vector<double>& particles, const move_costs& moving, std::int64_t steps,
                      const experience& so_far = {}, const extents<D>& where = {});
// The same from numbers: s per step of the slowest rank before and after, s of the move.
decision worth_moving(double slowest_now, double slowest_then, double cost, std::int64_t steps, double trust = 1.0);

// Of the time over the ranks; 0 where all are zero.
struct spread {
  double mean = 0.0, minimum = 0.0, maximum = 0.0;  // s
  double over_mean() const { return mean > 0.0 ? (maximum - minimum) / mean : 0.0; }
  double over_maximum() const { return maximum > 0.0 ? (maximum - minimum) / maximum : 0.0; }
  double efficiency() const { return maximum > 0.0 ? mean / maximum : 1.0; }
};
spread spread_of(const std::vector<double>& time);

}  // namespace tetsuame::balance
