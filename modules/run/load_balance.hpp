// When the cuts between ranks move in a run, and where to (docs/load_balancer.md). What is decided changes who computes
// a particle, never what is computed.
#pragma once

#include <fmt/format.h>

#include <balance/balancer.hpp>
#include <bit>
#include <cstring>
#include <foundation/waiting.hpp>
#include <numeric>
#include <optional>
#include <run/loads.hpp>
#include <run/options.hpp>
#include <string>
#include <vector>

namespace tetsuame::run {

template <int D>
struct load_balance {
  // One decision, the same on every rank.
  struct verdict {
    balance::decision decision;
    balance::cuts<D> cuts;
    balance::spread spread;  // of the cost per step
    balance::spread particles;
    double migrated = 0.0;        // particles
    bool lists_were_due = false;  // new lists had to be made in any case
    foundation::stopwatch since;
  };

  std::string mode;
  std::int64_t interval;  // steps
  balance::balancer_options how;
  balance::experience experience;
  balance::lasting_cost measured{how.readings};

  // Of this rank, since the last decision.
  double computing = 0.0;  // s
  std::int64_t steps = 0;
  std::int64_t steps_before = 0;  // since the last move, until that decision

  // What a move costs, in the unit of the cost: seconds, learnt from lists and moves as they are made, or pairs.
  balance::move_costs moving;
  bool moves_known = false;
  std::optional<double> expected;  // gain per step of the last move
  std::vector<double> before;

  std::int64_t decisions = 0, moves = 0;
  double gain_predicted = 0.0;            // in the unit of the cost, of all moves
  double seconds = 0.0;                   // s, for deciding and moving
  std::optional<double> worst_load;       // largest over mean pairs, from the second decision on
  std::optional<double> worst_particles;  // and particles, from the first one on
  double time_spread = 0.0;               // (max - min)/mean of the ranks' computing times, last heard of

  explicit load_balance(const balance_options& o) : mode(o.follows), interval(o.interval), how(o.how) {}

  bool measures() const { return mode == "measured"; }

  // Whether it is time. A move beside new lists costs least, so a decision waits for them for a while.
  bool due(bool lists_are_due) const { return mode != "off" && steps >= (lists_are_due ? interval : 4 * interval); }

  // Collective. Nothing where too little was measured to go by. `remaining`: steps of the run.
  std::optional<verdict> decide(const state<D>& box, bool lists_are_due, std::int64_t remaining) {
    verdict v;
    v.lists_were_due = lists_are_due;
    std::vector<double> seconds_per_step, pairs, particles;
    balance::extents<D> where;
    for (const rank_readings& r : readings_of_ranks(box)) {
      seconds_per_step.push_back(r.seconds_per_step);
      pairs.push_back(r.pairs);
      particles.push_back(r.particles);
      where.push_back(r.where);
    }
    const auto times = balance::spread_of(seconds_per_step);
    time_spread = times.over_mean();
    // Readings of the clock that are shorter than what else goes on in a machine say nothing.
    constexpr double least_seconds = 0.1;
    if (measures() && times.mean * static_cast<double>(steps) < least_seconds) {
      seconds += v.since.busy();
      return {};
    }
    v.particles = balance::spread_of(particles);
    worst_particles = std::max(worst_particles.value_or(1.0), 1.0 / v.particles.efficiency());
    const auto cost = measures() ? measured.of(seconds_per_step, pairs) : pairs;
    // New cuts are taken to serve as long as those that are.
    steps_before += steps;
    weigh(v, box, cost, particles, where, std::min(steps_before, remaining));
    if (v.decision.move) steps_before = 0;
    ++decisions;
    if (decisions > 1) worst_load = std::max(worst_load.value_or(1.0), 1.0 / balance::spread_of(pairs).efficiency());
    computing = 0.0;
    steps = 0;
    seconds += v.since.busy();
    return v;
  }

  // Collective, at the start: cuts by which ranks have as many particles each, or, once there are lists, as many pairs,
  // where equal cells are uneven.
  std::optional<balance::cuts<D>> even_out(const state<D>& box, bool by_pairs) const {
    constexpr double uneven = 1.2;  // largest over mean; what is less is left to decisions, which weigh its cost
    const auto& ranks = box.w.d.ranks;
    if (mode == "off" || ranks.size == 1) return {};
    std::vector<load<D>> all;
    if (by_pairs) all = loads_of(box);
    for (std::size_t i = 0; !by_pairs && i < box.w.s.fluid; ++i) all.push_back({cells::position<D>(box.w.s.x, i), 1.0});
    double mine = 0.0;
    for (const load<D>& l : all) mine += l.cost;
    const auto cost = ranks.every(mine);
    const double now = balance::spread_of(cost).maximum;
    if (balance::spread_of(cost).efficiency() >= 1.0 / uneven) return {};
    auto then = by_places(box, cuts_about(box, all), cost, how, all);
    const bool better = balance::spread_of(outcome_of(box, then, all).cost).maximum < now;
    return better ? std::optional(std::move(then)) : std::nullopt;
  }

  // When the cuts of a verdict are the box's but the particles have not moved: those of this rank that will, by their
  // present positions, or those of the lists where these stay as they were.
  std::int64_t leaving(const state<D>& box, bool by_present) const {
    std::int64_t n = 0;
    const auto cell = box.w.d.cell();
    const auto& x = by_present ? box.w.s.x : box.w.s.x_list;
    for (std::size_t i = 0; i < box.w.s.fluid; ++i) n += box.w.d.within(cell, cells::position<D>(x, i)) ? 0 : 1;
    return n;
  }

  // Collective, after the new lists: what they and the move cost. `left`, `came`: particles of this rank.
  void learn(const state<D>& box, verdict& v, std::int64_t left, std::int64_t came) {
    const auto& ranks = box.w.d.ranks;
    std::array<double, 2> most{v.since.elapsed(), static_cast<double>(left + came)};  // all began together
    ranks.maximum(most);
    v.migrated = static_cast<double>(ranks.sum(left));
    if (!v.decision.move) {
      moving.rebuild = most[0];
      return;
    }
    const double beyond = std::max(0.0, most[0] - moving.rebuild);
    seconds += v.lists_were_due ? beyond : most[0];
    if (most[1] > 0.0) {
      const double reading = beyond / most[1];
      moving.per_particle = moves_known ? 0.5 * (moving.per_particle + reading) : reading;
      moves_known = true;
    }
  }

  // Collective. As of now, if there are enough steps since the last decision to tell.
  double time_spread_now(const domain::communicator& ranks) const {
    if (steps < std::min<std::int64_t>(interval, 10)) return time_spread;
    return balance::spread_of(ranks.every(computing)).over_mean();
  }

  // After the first lists: until a move has been seen, to move a particle counts as much as to make its list.
  void first_lists(const state<D>& box, double took) {
    std::array<double, 2> most{took, static_cast<double>(box.w.s.fluid)};
    box.w.d.ranks.maximum(most);
    moving.rebuild = most[0];
    moving.per_particle = most[0] / std::max(1.0, most[1]);
  }

 private:
  // Of one rank; nothing but doubles, which is how it is told.
  struct rank_readings {
    double seconds_per_step, pairs, particles;
    balance::extent<D> where;
  };

  std::vector<rank_readings> readings_of_ranks(const state<D>& box) const {
    return every_rank(box, {computing / static_cast<double>(steps), pairs_of(box), static_cast<double>(box.w.s.fluid),
                            extent_of(box)});
  }
  static std::vector<rank_readings> every_rank(const state<D>& box, const rank_readings& mine) {
    const auto message = std::bit_cast<std::array<double, sizeof(rank_readings) / sizeof(double)>>(mine);
    const auto& ranks = box.w.d.ranks;
    const auto all = ranks.every(std::span<const double>(message));
    std::vector<rank_readings> readings(static_cast<std::size_t>(ranks.size));
    std::memcpy(static_cast<void*>(readings.data()), all.data(), readings.size() * sizeof(rank_readings));
    return readings;
  }

  // Fills the verdict, and learns of the move before. horizon: steps that the gain lasts.
  void weigh(verdict& v, const state<D>& box, const std::vector<double>& cost, const std::vector<double>& particles,
             const balance::extents<D>& where, std::int64_t horizon) {
    v.spread = balance::spread_of(cost);
    if (expected) experience.moved(*expected, before, cost);
    expected.reset();
    auto loads = loads_of(box);
    scale_to(cost[static_cast<std::size_t>(box.w.d.ranks.rank)], loads);
    const auto with = relaxed(how, experience);
    const auto now = cuts_about(box, loads);
    v.cuts = with.method == "remap" ? by_places(box, now, cost, with, loads) : balance::propose(now, cost, with, where);
    auto price = measures() ? moving : counted_price(v.spread, particles);
    // Lists that are due anyway cost nothing; others, and the rate that has to be evaluated again, do.
    price.rebuild = v.lists_were_due ? 0.0 : price.rebuild + v.spread.maximum;
    const auto then = outcome_of(box, v.cuts, loads);
    v.decision = balance::worth_moving(v.spread.maximum, balance::spread_of(then.cost).maximum,
                                       price.per_particle * std::ranges::max(then.in_and_out) + price.rebuild, horizon,
                                       experience.trust);
    v.decision.after = then.cost;
    // Smaller gains come from a row of particles more or less: they do not come true.
    constexpr double least_gain = 0.01;  // of the slowest rank's cost
    const bool too_little = v.decision.gain < least_gain * v.spread.maximum * static_cast<double>(horizon);
    v.decision.move = v.decision.move && !too_little;
    v.decision.reason = fmt::format("{} {:.3g} {} over {} steps{}, moving costs {:.3g}: {}",
                                    v.decision.gain < 0.0 ? "would lose" : "gain", std::abs(v.decision.gain),
                                    measures() ? "s" : "pairs", horizon, too_little ? " (less than 1 %)" : "",
                                    v.decision.cost, v.decision.move ? "move" : "stay");
    if (!v.decision.move) return experience.stayed();
    expected = v.spread.maximum - balance::spread_of(v.decision.after).maximum;
    before = cost;
    gain_predicted += v.decision.gain;
    ++moves;
  }

  // So that they come to what this rank takes.
  static void scale_to(double cost, std::vector<load<D>>& all) {
    double sum = 0.0;
    for (const load<D>& l : all) sum += l.cost;
    for (load<D>& l : all) l.cost *= sum > 0.0 ? cost / sum : 0.0;
  }

  // Collective.
  static balance::cuts<D> by_places(const state<D>& box, const balance::cuts<D>& now, const std::vector<double>& cost,
                                    const balance::balancer_options& o, const std::vector<load<D>>& loads) {
    const auto& d = box.w.d;
    const auto density = [&](std::size_t axis, const balance::cuts<D>& then,
                             const std::vector<balance::window>& windows, std::size_t parts) {
      std::vector<double> along(windows.size() * parts, 0.0);
      for (const load<D>& l : loads) {
        const std::size_t group = then.group_of(l.x, axis);
        // What stands out of the box counts at its border.
        const double lower = then.group(axis, group)[0], upper = then.group(axis, group)[then.counts[axis]];
        const double x = std::clamp(l.x[axis], lower, std::nextafter(upper, lower));
        auto n = std::ranges::upper_bound(windows, std::pair(group, x), {},
                                          [](const balance::window& w) { return std::pair(w.group, w.upper); });
        for (; n != windows.end() && n->group == group && n->lower <= x; ++n)
          along[static_cast<std::size_t>(n - windows.begin()) * parts + n->part(x, parts)] += l.cost;
      }
      d.ranks.sum(along);
      return along;
    };
    return balance::propose_by_density<D>(now, cost, o, density);
  }

  // Of new cuts: what ranks would take, and the particles that each sends or receives. Collective.
  struct outcome {
    std::vector<double> cost, in_and_out;
  };
  static outcome outcome_of(const state<D>& box, const balance::cuts<D>& then, const std::vector<load<D>>& loads) {
    const auto& ranks = box.w.d.ranks;
    const auto number = static_cast<std::size_t>(ranks.size), me = static_cast<std::size_t>(ranks.rank);
    outcome o{std::vector<double>(number, 0.0), std::vector<double>(number, 0.0)};
    for (const load<D>& l : loads) o.cost[static_cast<std::size_t>(then.owner(l.x))] += l.cost;
    for (std::size_t i = 0; i < box.w.s.fluid; ++i)
      if (const auto to = static_cast<std::size_t>(then.owner(cells::position<D>(box.w.s.x, i))); to != me) {
        o.in_and_out[to] += 1.0;
        o.in_and_out[me] += 1.0;
      }
    ranks.sum(o.cost);
    ranks.sum(o.in_and_out);
    return o;
  }

  // Where the loads are in the box around the particles. Markers count with the fluid nearest to them along each axis.
  static balance::extent<D> extent_of(const state<D>& box) {
    const auto& s = box.w.s;
    balance::extent<D> mine;
    for (std::size_t i = 0; i < s.fluid; ++i) mine.include(cells::position<D>(s.x, i));
    if (s.fluid == 0) return mine;
    mine.begin_costs();
    for (const load<D>& l : loads_of(box)) mine.add_cost(l.x, l.cost);
    return mine;
  }
  // New lists cost about as much as two evaluations, to move a particle as much as its neighbours' share of one.
  static balance::move_costs counted_price(const balance::spread& pairs, const std::vector<double>& particles) {
    const double sum = std::accumulate(particles.begin(), particles.end(), 0.0);
    const double each = pairs.mean * static_cast<double>(particles.size()) / std::max(1.0, sum);
    return {each, 2.0 * pairs.maximum};
  }
};

}  // namespace tetsuame::run
