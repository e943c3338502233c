// What all problems of particles in a box have in common: whose particle is whose, lists, cuts that move with the load,
// walls as the last guard, checkpoints, and what of these is told.
#pragma once

#include <fmt/format.h>

#include <foundation/error.hpp>
#include <foundation/waiting.hpp>
#include <gauges/points.hpp>
#include <output/checkpoint.hpp>
#include <output/groups.hpp>
#include <particles/storage.hpp>
#include <run/finite.hpp>
#include <run/lists.hpp>
#include <run/load_balance.hpp>
#include <run/simulation.hpp>

namespace tetsuame::run {

// Every travelling field of the fluid, as a checkpoint's table. Component names: Velocities_0, …
template <int D>
output::table_view checkpoint_table(const particles::particles<D>& s, std::vector<std::int64_t>& materials) {
  output::table_view t{"fluid", s.fluid, s.id.data(), {}, {}};
  particles::for_each_field<D>(s, [&](const particles::field_info& field, const auto& components) {
    if (!particles::travels(field.kind)) return;
    for (std::size_t k = 0; k < components.size(); ++k)
      t.reals.emplace_back(std::string(field.name) + "_" + std::to_string(k), components[k]->data());
  });
  materials.assign(s.material.begin(), s.material.begin() + static_cast<std::ptrdiff_t>(s.fluid));
  t.integers.emplace_back("Material", materials.data());
  return t;
}

// The reverse: fluid as the checkpoint's rows lie, the walls kept. may_lack(name): of a field that is zero where the
// checkpoint lacks it, as one that was written with another method of time integration does.
template <int D>
void fluid_from_checkpoint(
    const output::table& t, particles::particles<D>& s,
    bool (*may_lack)(std::string_view) = [](std::string_view) { return false; }) {
  particles::allocate(s, t.ids.size(), 0, s.walls, 0);
  std::copy(t.ids.begin(), t.ids.end(), s.id.begin());
  particles::for_each_field<D>(s, [&](const particles::field_info& field, const auto& components) {
    if (!particles::travels(field.kind)) return;
    for (std::size_t k = 0; k < components.size(); ++k) {
      const auto found = t.reals.find(std::string(field.name) + "_" + std::to_string(k));
      if (found != t.reals.end())
        std::copy(found->second.begin(), found->second.end(), components[k]->begin());
      else if (may_lack(field.name))
        std::fill_n(components[k]->begin(), s.fluid, 0.0);
      else
        foundation::fail_file(std::string("the checkpoint has no field ") + field.name);
    }
  });
  const auto& materials = t.integers.at("Material");
  for (std::size_t i = 0; i < materials.size(); ++i) s.material[i] = static_cast<std::int32_t>(materials[i]);
}

// A simulation on particles in a box: neighbour lists, ghosts, cuts between ranks and the walls' last guard are here,
// in the order that simulation.hpp has; what a problem adds are the hooks below.
template <int D>
class particle_simulation : public simulation {
 public:
  state<D>& box;
  load_balance<D> balancer;
  // The state outlives the simulation.
  particle_simulation(state<D>& of_problem, const common_options& o)
      : simulation(of_problem.w.d.ranks, of_problem.w.times, D, pairs::lanes),
        box(of_problem),
        balancer(o.balance),
        gauges_(o.gauges) {}

  // ---- what the time loop asks ------------------------------------------------------------

  bool begin(const output::checkpoint* saved, run_directory& files) final {
    files_ = &files;
    expect_names_of_columns();
    if (saved == nullptr) {
      rebuild(false);
      set_time(0.0);
      return false;
    }
    restore_globals(saved->globals);
    read_particles(saved->tables.at("fluid"));
    read_further_tables(*saved);
    check_state();
    rebuild(true);
    set_time(saved->globals.reals.at("time"));
    return steady();
  }

  state_arrays arrays() final { return {fields(), box.w.s.fluid}; }

  void settle(damped part, std::span<double* const> rate, double dt, double kept) final {
    auto& s = box.w.s;
    if (part == damped::rest) {
      for (std::size_t a = 0; a < D; ++a) {
        for (std::size_t i = 0; i < s.fluid; ++i) s.v[a][i] = velocity_once_settled(a, i);
        if (s.keeps_start && starts_anew()) std::copy_n(s.x[a].begin(), s.fluid, s.x_start[a].begin());
      }
      return;
    }
    const auto all = fields();
    for (std::size_t k = 0; k < all.size(); ++k) {
      double* const value = all[k].data;
      std::size_t kicked = D;  // the component of the velocity; D: it is none
      bool drifts = value == s.rho.data() || value == s.Y.data() || settles_along(value);
      for (std::size_t a = 0; a < D; ++a) {
        if (value == s.v[a].data()) kicked = a;
        drifts = drifts || value == s.x[a].data();
      }
      if (part == damped::kick && kicked < D)
        for (std::size_t i = 0; i < s.fluid; ++i)
          value[i] = kept * (value[i] + dt * (rate[k][i] + settling_acceleration(kicked, i)));
      if (part == damped::drift && drifts)
        for (std::size_t i = 0; i < s.fluid; ++i) value[i] += dt * rate[k][i];
    }
    if (part == damped::drift) walls::reflect(box.walls, s);
  }
  // Over the longest edge.
  double crossing_time() final {
    const double c = sound_of_start();
    const auto& length = box.w.d.region.length;
    return c > 0.0 ? *std::max_element(length.begin(), length.end()) / c : 0.0;
  }

  bool evaluate(const evaluation& what, std::span<double* const> rate) final {
    if (what.of == purpose::check) {
      check_state();
      return true;
    }
    evaluating_ = what;
    at_time(what.time);
    show_all(what.of == purpose::snapshot);
    if (what.of == purpose::step) {
      if (!expect_within_lists(what.shorter_steps_help)) return false;
      if (what.shorter_steps_help && !evaluable()) return false;
    } else if (!has_tables_) {
      begin_tables(*files_);
      has_tables_ = true;
    }
    expect_counts(what.counts);
    evaluate_rates(rate);
    if (what.step == 0 && what.of == purpose::snapshot && !equilibrium_residual) note_acceleration(rate);
    if (what.of != purpose::step) complete_tables(what.step);
    return true;
  }

  step_limits limits(bool asks_radius) final { return {largest_step(), asks_radius ? diffusion_radius() : 0.0}; }

  // New lists before the next step could outrun the old ones, with a wider skin where it could outrun those that the
  // input asks for: that costs less than to halve the step. Where it could outrun the widest, a shorter step. Particles
  // may gain speed on the way.
  step_preparation prepare(const step_ahead& next) final {
    constexpr double faster = 1.6, a_little_faster = 1.2, any = std::numeric_limits<double>::infinity();
    step_preparation ready;
    if (next.first) ready.warning = warning_of_step(next.dt);
    const auto [flow, moved] = motion_on_all(next);
    const double speed = faster * flow;
    // A step that the input gives is kept as long as lists can follow particles that keep their speed; one with error
    // control that they cannot follow is tried again, where lists are no limit of the flow's own.
    const bool lists_widen = possible_allowance(any) > possible_allowance(0.0);
    const double most = (next.fixed ? 1.0 : next.varies_steps && lists_widen ? a_little_faster : faster) * flow;
    const double now = allowance();
    double wanted = speed * (next.bound > 0.0 ? std::min(next.dt, next.bound) : next.dt);
    if (next.varies_steps && wanted > now) wanted = std::min(wanted, speed * largest_step().dt * next.substeps);
    const auto longest_within = [&](double allowed) { return most > 0.0 ? allowed / most : any; };
    const bool wider = possible_allowance(wanted) > now * (1.0 + 1e-9);
    const bool due = (moved != 0.0 || wider) && !(moved + speed * std::min(next.dt, longest_within(now)) <= now);
    if (due) set_skin(box, skin_for(wanted));
    box.next_dt = next.dt;
    ready.longest = {longest_within(allowance()), "displacement"};
    ready.arrays_moved = renew(due, next.step, next.steps_left);
    ready.number_changed = std::exchange(number_changed_, false);
    if (!(next.time + 1e-3 * ready.longest.dt > next.time))
      foundation::fail_calculation("particles are so fast that no step can follow them: the flow has blown up");
    return ready;
  }

  committed commit() final {
    commit_lagged();
    return {needs_lagged(), longest_step()};
  }

  completion complete(const completed_step& done) final {
    balancer.computing += done.busy_seconds;
    ++balancer.steps;
    completion all;
    all.equations_changed = set_time(done.time);
    all.state_changed = complete_step(done.step);
    at_time(done.time);
    const apart flow = speed(), way = moved();
    constexpr std::size_t n = std::tuple_size_v<decltype(flow.numbers)>;
    static_assert(2 * n == std::tuple_size_v<decltype(all.maxima)>);
    std::copy_n(flow.numbers.begin(), n, all.maxima.begin());
    std::copy_n(way.numbers.begin(), n, all.maxima.begin() + n);
    return all;
  }

  std::vector<output::history_column> columns() const final {
    auto all = measured_columns();
    const auto read = gauges::columns(gauges_, D);
    all.insert(all.end(), read.begin(), read.end());
    return all;
  }

  history_line row(double time) final {
    history_line line{measure(time), false};
    line.steady = steady();
    if (!gauges_.any()) return line;
    std::vector<particles::array> made;
    const auto read = gauges::read<D>(gauges_, particle_groups(made).front(), box.w.d.region, box.w.kernel, ranks);
    line.values.insert(line.values.end(), read.begin(), read.end());
    return line;
  }

  snapshot_contents snapshot() final {
    snapshot_contents all;
    all.header.dimension = D;
    std::copy_n(box.w.d.region.length.begin(), D, all.header.box_lengths.begin());
    std::copy_n(box.w.d.region.periodic.begin(), D, all.header.periodic.begin());
    all.groups = particle_groups(all.made);
    show_all(false);
    return all;
  }

  std::string refine(double time) final {
    const std::string change = refine_particles(time);
    if (change.empty()) return {};
    rebuild(false);
    set_time(time);
    return change;
  }

  void report(const ending& end, summary& r) final {
    if (end.failed != nullptr) report_failure(*end.failed, end.step, r);
    report_counts(r);
    if (end.failed != nullptr) return;
    report_results(end.time, r);
    r.state_hash = hash();
  }

  std::vector<output::table_view> save(output::checkpoint_globals& g, std::vector<std::int64_t>& materials) final {
    save_globals(g);
    std::vector<output::table_view> all{checkpoint_table(box.w.s, materials)};
    for (auto& t : further_tables()) all.push_back(std::move(t));
    return all;
  }

  // ---- what a problem says ----------------------------------------------------------------

  virtual std::vector<integrators::field> fields() = 0;
  // Whether the state can be evaluated; where it cannot, methods that choose their steps take a shorter one.
  virtual bool evaluable() { return true; }
  // The state in the arrays is of this time (s).
  virtual void at_time(double t) { box.state_time = t; }
  // At the start and after each step. Returns whether the equations change with the time.
  virtual bool set_time(double) { return false; }
  virtual integrators::step_limit largest_step() = 0;
  // What the log is to warn of with fixed steps of dt (s), beside that limit; empty: nothing.
  virtual std::string warning_of_step(double) { return {}; }
  virtual double diffusion_radius() { return 0.0; }
  // m/s, the fastest at the start, of pressure over mass; 0: accelerations say nothing of a balance.
  virtual double sound_of_start() { return 0.0; }
  // Whether what is integrated in this array, beside places, velocities, ρ and Y, follows its rate while a start
  // settles (the internal energy then follows the work of pressure, and the entropy stays), or keeps its value.
  virtual bool settles_along(const double* /*values*/) const { return false; }
  // m/s², m/s: what a start is at rest under in a frame that turns, and the velocity that it has outside of it then.
  virtual double settling_acceleration(std::size_t /*axis*/, std::size_t /*i*/) const { return 0.0; }
  virtual double velocity_once_settled(std::size_t /*axis*/, std::size_t /*i*/) const { return 0.0; }
  // Whether displacements count from where a settled start comes to rest.
  virtual bool starts_anew() const { return true; }
  // s, of the present state, once its rate is known: a bound for the next step.
  virtual double longest_step() { return std::numeric_limits<double>::infinity(); }
  virtual void commit_lagged() {}
  virtual bool needs_lagged() const { return false; }
  // Whether the next evaluation counts, for what is told of it.
  virtual void expect_counts(bool) {}
  // Tables of the problem's own, beside the history, and their lines of the evaluations up to this step.
  virtual void begin_tables(run_directory& files) {
    if (balancer.mode != "off") balance_table_ = &files.table("balance.csv", balance_columns());
  }
  virtual void complete_tables(std::int64_t /*step*/) {}
  // Returns whether the state changed on this rank.
  virtual bool complete_step(std::int64_t) {
    const std::int64_t put_back = walls::reflect(box.walls, box.w.s) + put_out_of_bodies();
    put_back_ += put_back;
    return put_back > 0;
  }
  // m: what has moved on this rank since the lists were made, and what of that they allow; m/s, the velocities.
  virtual apart moved() {
    apart all = moved_since_lists(box);
    if (drifted(box, all.numbers[apart::longest])) all.numbers[apart::at_least] = allowance();
    return all;
  }
  virtual std::string farthest_moved() { return "particles"; }  // who, for messages
  virtual double allowance() const { return 0.5 * box.skin; }
  virtual apart speed() { return velocities(box); }
  // A line of the history, and its columns.
  virtual std::vector<output::history_column> measured_columns() const = 0;
  virtual std::vector<double> measure(double time) = 0;
  virtual bool steady() const { return false; }  // after measure()
  // Collective, before lists of present places are made: particles that enter the box and leave it. Ghosts may be gone
  // afterwards. Whether there were any, on any rank.
  virtual bool let_particles_pass() { return false; }
  // What has changed, where the problem goes on with other particles or sums; lists are made anew then.
  virtual std::string refine_particles(double /*time*/) { return {}; }
  virtual std::vector<output::particle_group> particle_groups(std::vector<particles::array>& made) = 0;
  virtual void report_results(double time, summary& r) = 0;
  virtual void report_failure(const foundation::error&, std::int64_t /*step*/, summary&) {}

  // ---- lists and cuts ---------------------------------------------------------------------

  // What is integrated, then what only steps change, then all else that travels with the particles, which evaluations
  // may have written.
  void check_state() {
    using particles::role;
    auto& fault = box.w.first_fault;
    fault = {};
    report_state();
    ++fault.stage;
    report_not_finite_in_table(box.w, [](role kind) { return kind == role::constant || kind == role::memory; });
    ++fault.stage;
    report_not_finite_in_table(box.w, particles::travels);
    box.w.agree();
  }
  // What is not finite in the state is the cause of all that a rate has of it, and goes before faults of the sums; so
  // does what is not finite in any other field that travels, which is looked for once there is a fault.
  void evaluate_rates(std::span<double* const> rate) {
    auto& fault = box.w.first_fault;
    fault = {};
    report_state();
    ++fault.stage;
    try {
      sum_rates(rate);
      ++fault.stage;
      report_not_finite<D>(box.w, fields(), std::vector<const double*>(rate.begin(), rate.end()), "the rate of ");
      box.w.agree();
    } catch (const foundation::error&) {  // of all ranks
      check_state();
      throw;
    }
    complete_rates(rate);
  }

  // Sorting, ghosts, lists. as_they_were: positions of the last time are used, so that sums keep their order.
  void rebuild(bool as_they_were) {
    if (!has_lists_) even_out(false);
    if (!has_lists_ && !as_they_were) box.w.frame = on_all(ranks, velocities(box)).template middle<D>();
    const foundation::stopwatch watch;
    make_lists(as_they_were);
    if (!has_lists_ && even_out(true)) make_lists(as_they_were);
    if (!has_lists_) balancer.first_lists(box, watch.elapsed());
    has_lists_ = true;
  }

  // Before the step after `step`, when `left` may follow: lists where they are due, and cuts between ranks where they
  // pay. Returns whether the arrays are others.
  bool renew(bool lists_are_due, std::int64_t step, std::int64_t left) {
    if (lists_are_due) domain::wrap(box.w.d.region, box.w.s);
    auto verdict = decide_on_cuts(lists_are_due, left);
    const bool moves = verdict && verdict->decision.move;
    if (lists_are_due || moves) {
      const foundation::stage timed(box.w.times, moves ? "balance" : "lists");
      if (lists_are_due) number_changed_ = let_particles_pass();
      const auto had = static_cast<std::int64_t>(box.w.s.fluid);
      const std::int64_t leaving = moves ? balancer.leaving(box, lists_are_due) : 0;
      make_lists(!lists_are_due);
      if (verdict) balancer.learn(box, *verdict, leaving, static_cast<std::int64_t>(box.w.s.fluid) - had + leaving);
    }
    if (verdict) note(*verdict, step);
    return lists_are_due || moves;
  }

  // Gives the ranks other cells. What stands behind walls moves at once; the fluid, and all that hangs on it, with the
  // next lists.
  void move_cuts(const balance::cuts<D>& cuts) {
    box.w.d.cuts = cuts;
    place_walls();
  }

  // Of all that a checkpoint holds of the particles.
  std::string hash() {
    std::vector<std::int64_t> materials;
    const auto t = checkpoint_table(box.w.s, materials);
    std::vector<output::particle_group> groups{group_of_hash(0, t)};
    for (const auto& further : further_tables())
      groups.push_back(group_of_hash(static_cast<int>(groups.size()), further));
    return output::state_hash(ranks.comm, groups);
  }
  virtual void read_particles(const output::table& t) { fluid_from_checkpoint(t, box.w.s); }
  // Collective. What a checkpoint, and the hash, have beside the particles; and back, once these are read.
  virtual std::vector<output::table_view> further_tables() { return {}; }
  virtual void read_further_tables(const output::checkpoint&) {}
  virtual void save_globals(output::checkpoint_globals& g) const {
    g.integers["particles_put_back"] = ranks.sum(put_back_);
    g.integers["fluid_total"] = box.fluid_total;
    g.reals["density_excess"] = density_excess_;
    if (equilibrium_residual) g.reals["equilibrium_residual"] = *equilibrium_residual;
    g.reals["skin"] = box.skin;
    g.blobs["frame"].assign(box.w.frame.begin(), box.w.frame.end());
    g.reals["list_time"] = box.list_time;
    g.reals["list_lifetime"] = box.list_lifetime;
    g.integers["balance_decisions"] = balancer.decisions;
    g.integers["balance_moves"] = balancer.moves;
    g.reals["balance_gain_predicted"] = balancer.gain_predicted;
    g.reals["load_max_over_mean"] = balancer.worst_load.value_or(0.0);
    g.reals["balance_particles_max_over_mean"] = balancer.worst_particles.value_or(0.0);
  }
  virtual void restore_globals(const output::checkpoint_globals& g) {
    put_back_ = ranks.rank == 0 ? g.integers.at("particles_put_back") : 0;
    if (const auto total = g.integers.find("fluid_total");
        total != g.integers.end() &&
        total->second != box.fluid_total) {  // of a file with more or fewer than the lattice has
      box.fluid_total = total->second;
      place_walls();
    }
    density_excess_ = g.reals.at("density_excess");
    if (g.reals.contains("equilibrium_residual")) equilibrium_residual = g.reals.at("equilibrium_residual");
    set_skin(box, g.reals.at("skin"));
    std::copy_n(g.blobs.at("frame").begin(), D, box.w.frame.begin());
    box.list_time = g.reals.at("list_time");
    box.list_lifetime = g.reals.at("list_lifetime");
    balancer.decisions = g.integers.at("balance_decisions");
    balancer.moves = g.integers.at("balance_moves");
    balancer.gain_predicted = g.reals.at("balance_gain_predicted");
    const auto known = [&](const char* name) {
      const double value = g.reals.at(name);
      return value > 0.0 ? std::optional(value) : std::nullopt;
    };
    balancer.worst_load = known("load_max_over_mean");
    balancer.worst_particles = known("balance_particles_max_over_mean");
  }

  // Of the run, for the metrics; a problem adds its own.
  virtual void report_counts(summary& r) {
    r.wall_particles =
        box.mirrors() && !box.walls.bodies.any() ? 0 : ranks.sum(static_cast<std::int64_t>(box.w.s.walls));
    r.metrics["particles_put_back"] = ranks.sum(put_back_);
    if (equilibrium_residual) r.metrics["equilibrium_residual"] = *equilibrium_residual;
    if (density_excess_ > 0.0) r.metrics["density_excess"] = density_excess_;
    r.metrics["balance_decisions"] = balancer.decisions;
    r.metrics["balance_moves"] = balancer.moves;
    r.metrics["balance_gain_predicted"] = balancer.gain_predicted;
    r.metrics["balance_seconds"] = ranks.maximum(balancer.seconds);
    r.metrics["time_spread"] = balancer.time_spread_now(ranks);
    r.metrics["load_max_over_mean"] = or_null(balancer.worst_load);
    r.metrics["balance_particles_max_over_mean"] = or_null(balancer.worst_particles);
    communication.describe(box.w.d, r.metrics);
  }

 protected:
  // dy/dt at the state in the arrays. A fault may be reported, on which all ranks agree afterwards.
  virtual void sum_rates(std::span<double* const> rate) = 0;
  // Collective. Of rates that are finite.
  virtual void complete_rates(std::span<double* const>) {}
  // Whether steps that outrun their lists get wider ones. Where no other limit of the steps knows how fast particles
  // are, lists are that limit, and stay: flows whose sound is slowed blow up else.
  virtual bool widens_lists() const { return false; }
  // rebuild() of run/lists.hpp or run/supports.hpp, and what of the problem hangs on lists.
  virtual void make_lists(bool as_they_were) = 0;
  // Where particles stand behind the walls, those of this rank's cell when the cuts have moved.
  virtual void place_walls() {}
  // Collective, of a line of the history: the largest factor by which a density on this rank has left the range that
  // the equation of state has at the pressures of the start, 1 or less inside it (run/doubts.hpp).
  void note_density_excess(double mine) { density_excess_ = std::max(density_excess_, ranks.maximum(mine)); }
  // As walls::reflect() for bodies; how many of this rank's particles.
  virtual std::int64_t put_out_of_bodies() { return 0; }

  // The largest acceleration of the start, over that of gravity, or over c²/L.
  void note_acceleration(std::span<double* const> rate) {
    const double c = sound_of_start();
    if (!(c > 0.0)) return;
    const auto& s = box.w.s;
    std::array<const double*, D> a{};
    const auto all = fields();
    for (std::size_t k = 0; k < all.size(); ++k)
      for (std::size_t axis = 0; axis < D; ++axis)
        if (all[k].data == s.v[axis].data()) a[axis] = rate[k];
    double largest2 = 0.0, g2 = 0.0;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      double a2 = 0.0;
      for (std::size_t axis = 0; axis < D; ++axis) a2 += a[axis] != nullptr ? a[axis][i] * a[axis][i] : 0.0;
      largest2 = std::max(largest2, a2);
    }
    for (const double g : box.w.g) g2 += g * g;
    const auto& length = box.w.d.region.length;
    const double scale = g2 > 0.0 ? std::sqrt(g2) : c * c / *std::max_element(length.begin(), length.end());
    equilibrium_residual = std::sqrt(ranks.maximum(largest2)) / scale;
    files_->say(fmt::format("largest acceleration of the start: {:.4g} of {}", *equilibrium_residual,
                            g2 > 0.0 ? "gravity" : "c^2/L"));
  }

  // The evaluation under way, or the last one.
  const evaluation& evaluating() const { return evaluating_; }

 private:
  // What only a snapshot shows of the walls is left out otherwise.
  void show_all(bool shown) {
    box.walls.complete = shown;
    box.walls.unread.reset();
  }

  // A stage may leave what the lists cover: a smaller step then helps, where there is a choice.
  bool expect_within_lists(bool shorter_steps_help) {
    const double way = on_all(ranks, moved()).length();
    if (way <= allowance()) return true;
    if (shorter_steps_help) return false;
    check_state();
    foundation::fail_calculation(
        fmt::format("{} moved {:.3g} m within one step, more than half the skin of the neighbour lists "
                    "({:.3g} m): the time step is too large, or the flow has blown up",
                    farthest_moved(), way, allowance()));
  }

  // A gauge may be called so that it reads a column that the problem has.
  void expect_names_of_columns() const {
    const auto own = measured_columns();
    for (const auto& read : gauges::columns(gauges_, D))
      for (const auto& column : own)
        if (column.name == read.name)
          foundation::fail_input(fmt::format(
              "&gauges point: history.csv has a column {} without gauges: give the gauge another name", read.name));
  }

  // m/s and m, of all ranks.
  std::pair<double, double> motion_on_all(const step_ahead& next) {
    apart flow = speed(), way = moved();
    if (!next.maxima) {
      flow = on_all(ranks, flow);
      way = on_all(ranks, way);
      if (!std::isfinite(flow.length() + way.length())) check_state();  // lists are made of finite places
      return {flow.length(), way.length()};
    }
    const std::size_t n = flow.numbers.size();
    std::copy_n(next.maxima->begin(), n, flow.numbers.begin());
    std::copy_n(next.maxima->begin() + static_cast<std::ptrdiff_t>(n), n, way.numbers.begin());
    return {flow.length(), way.length()};
  }

  static output::particle_group group_of_hash(int type, const output::table_view& t) {
    output::particle_group g{type, t.n, t.ids, {}};
    for (const auto& [name, values] : t.reals) g.columns.push_back({name, "", "", {values}, false});
    return g;
  }

  void report_state() {
    const auto all = fields();
    std::vector<const double*> values;
    for (const auto& field : all) values.push_back(field.data);
    report_not_finite<D>(box.w, all, values, "");
  }
  double possible_allowance(double wanted) const { return part_of_skin() * skin_for(wanted); }
  // That is the allowance.
  double part_of_skin() const { return box.skin > 0.0 ? allowance() / box.skin : 0.5; }
  double skin_for(double allowance) const {
    return widens_lists() ? skin_within_limits(box, allowance / part_of_skin()) : box.skin;
  }

  // By the places of the start, or of a checkpoint. Whether lists have to be made anew.
  bool even_out(bool by_pairs) {
    const auto cuts = balancer.even_out(box, by_pairs);
    if (!cuts) return false;
    move_cuts(*cuts);
    if (!by_pairs) domain::migrate(box.w.d, box.w.s, box.partners);
    return true;
  }

  // Cuts that are to move have done so, particles have not.
  std::optional<typename load_balance<D>::verdict> decide_on_cuts(bool lists_are_due, std::int64_t left) {
    if (ranks.size == 1 || !balancer.due(lists_are_due)) return {};
    const foundation::stage timed(box.w.times, "balance");
    auto verdict = balancer.decide(box, lists_are_due, left);
    if (verdict && verdict->decision.move) move_cuts(verdict->cuts);
    return verdict;
  }

  void note(const typename load_balance<D>::verdict& v, std::int64_t step) {
    files_->say(fmt::format("step {}: spread {:.1f} %, {}", step, 100.0 * v.spread.over_mean(), v.decision.reason));
    if (balance_table_)
      balance_table_->append(
          step,
          std::array{v.spread.over_mean(), 1.0 / v.spread.efficiency(), v.decision.gain, v.decision.cost,
                     v.decision.move ? 1.0 : 0.0, v.migrated, 1.0 / v.particles.efficiency()},
          v.decision.reason);
  }

  static std::vector<output::history_column> balance_columns() {
    return {{"spread", "1"}, {"max_over_mean", "1"}, {"gain", "s or pairs"},           {"cost", "s or pairs"},
            {"moved", "1"},  {"migrated", "1"},      {"particles_max_over_mean", "1"}, {"reason", "text"}};
  }

  gauges::options gauges_;
  run_directory* files_ = nullptr;
  output::history* balance_table_ = nullptr;
  std::int64_t put_back_ = 0;    // inside the walls and out of bodies, on this rank
  double density_excess_ = 0.0;  // the largest so far, on all ranks; 0: none was noted
  bool has_lists_ = false, has_tables_ = false, number_changed_ = false;
  evaluation evaluating_{};
};

}  // namespace tetsuame::run
