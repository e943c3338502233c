// What all problems of particles in a box have in common: whose particle is whose, lists, cuts that move with the load,
// walls as the last guard, checkpoints, and what of these is told.
#pragma once

#include <fmt/format.h>

#include <foundation/error.hpp>
#include <foundation/waiting.hpp>
#include <output/checkpoint.hpp>
#include <output/groups.hpp>
#include <particles/storage.hpp>
#include <run/finite.hpp>
#include <run/load_balance.hpp>
#include <run/problem.hpp>

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

template <int D>
class problem_in_a_box : public problem {
 public:
  state<D>& box;
  load_balance<D> balancer;
  // The state outlives the problem.
  problem_in_a_box(state<D>& of_problem, const balance_options& o) : box(of_problem), balancer(o) {}

  const domain::communicator& ranks() const final { return box.w.d.ranks; }
  std::size_t local_particles() const final { return box.w.s.fluid; }
  std::size_t simd_lanes() const final { return pairs::lanes; }
  foundation::stage_times& times() final { return box.w.times; }
  output::snapshot_header header() const final {
    output::snapshot_header h{.dimension = D};
    std::copy_n(box.w.d.region.length.begin(), D, h.box_lengths.begin());
    std::copy_n(box.w.d.region.periodic.begin(), D, h.periodic.begin());
    return h;
  }

  void at_time(double t) override { box.now = t; }
  void expect_snapshot(bool shown) final {
    box.walls.complete = shown;
    box.walls.unread.reset();
  }

  apart moved() override {
    apart all = moved_since_lists(box);
    if (drifted(box, all.numbers[apart::longest])) all.numbers[apart::at_least] = allowance();
    return all;
  }
  double allowance() const override { return 0.5 * box.skin; }
  apart speed() override { return velocities(box); }
  double possible_allowance(double wanted) const final { return part_of_skin() * skin_for(wanted); }
  void set_allowance(double wanted) final { set_skin(box, skin_for(wanted)); }

  bool complete_step(std::int64_t) override {
    const std::int64_t put_back = walls::reflect(box.walls, box.w.s) + put_out_of_bodies();
    put_back_ += put_back;
    return put_back > 0;
  }

  // What is integrated, and all else that travels with the particles.
  void check_state() final {
    box.w.first_fault = {};
    report_state();
    report_not_finite_in_table(box.w, particles::travels);
    box.w.agree();
  }
  // What is not finite in the state is the cause of all that a rate has of it, and goes before faults of the sums.
  void evaluate(std::span<double* const> rate) final {
    auto& fault = box.w.first_fault;
    fault = {};
    report_state();
    ++fault.stage;
    sum_rates(rate);
    ++fault.stage;
    report_not_finite<D>(box.w, fields(), std::vector<const double*>(rate.begin(), rate.end()), "the rate of ");
    box.w.agree();
    complete_rates(rate);
  }

  void rebuild(bool as_they_were) final {
    if (!has_lists_) even_out(false);
    if (!has_lists_ && !as_they_were) box.w.frame = on_all(ranks(), velocities(box)).template middle<D>();
    const foundation::stopwatch watch;
    make_lists(as_they_were);
    if (!has_lists_ && even_out(true)) make_lists(as_they_were);
    if (!has_lists_) balancer.first_lists(box, watch.elapsed());
    has_lists_ = true;
  }

  bool renew(bool lists_are_due, std::int64_t step, std::int64_t left) final {
    if (lists_are_due) domain::wrap(box.w.d.region, box.w.s);
    auto verdict = decide_on_cuts(lists_are_due, left);
    const bool moves = verdict && verdict->decision.move;
    if (lists_are_due || moves) {
      const foundation::stage timed(box.w.times, moves ? "balance" : "lists");
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

  void worked(double seconds) final {
    balancer.computing += seconds;
    ++balancer.steps;
  }

  void begin_tables(run_directory& files) override {
    files_ = &files;
    if (balancer.mode != "off") balance_table_ = &files.table("balance.csv", balance_columns());
  }

  output::table_view particles_table(std::vector<std::int64_t>& materials) final {
    return checkpoint_table(box.w.s, materials);
  }
  // Of all that a checkpoint holds of the particles.
  std::string hash() final {
    std::vector<std::int64_t> materials;
    const auto t = particles_table(materials);
    output::particle_group g{0, t.n, t.ids, {}};
    for (const auto& [name, values] : t.reals) g.columns.push_back({name, "", "", {values}, false});
    return output::state_hash(ranks().comm, {g});
  }
  void read_particles(const output::table& t) override { fluid_from_checkpoint(t, box.w.s); }
  void save(output::checkpoint_globals& g) const override {
    g.integers["particles_put_back"] = ranks().sum(put_back_);
    g.reals["density_excess"] = density_excess_;
    g.reals["skin"] = box.skin;
    g.blobs["frame"].assign(box.w.frame.begin(), box.w.frame.end());
    g.reals["list_time"] = box.list_time;
    g.integers["balance_decisions"] = balancer.decisions;
    g.integers["balance_moves"] = balancer.moves;
    g.reals["balance_gain_predicted"] = balancer.gain_predicted;
    g.reals["load_max_over_mean"] = balancer.worst_load.value_or(0.0);
    g.reals["balance_particles_max_over_mean"] = balancer.worst_particles.value_or(0.0);
  }
  void restore(const output::checkpoint_globals& g) override {
    put_back_ = ranks().rank == 0 ? g.integers.at("particles_put_back") : 0;
    density_excess_ = g.reals.at("density_excess");
    set_skin(box, g.reals.at("skin"));
    std::copy_n(g.blobs.at("frame").begin(), D, box.w.frame.begin());
    box.list_time = g.reals.at("list_time");
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
  void report_counts(summary& r) override {
    r.wall_particles =
        box.mirrors() && !box.walls.bodies.any() ? 0 : ranks().sum(static_cast<std::int64_t>(box.w.s.walls));
    r.metrics["particles_put_back"] = ranks().sum(put_back_);
    if (density_excess_ > 0.0) r.metrics["density_excess"] = density_excess_;
    r.metrics["balance_decisions"] = balancer.decisions;
    r.metrics["balance_moves"] = balancer.moves;
    r.metrics["balance_gain_predicted"] = balancer.gain_predicted;
    r.metrics["balance_seconds"] = ranks().maximum(balancer.seconds);
    r.metrics["time_spread"] = balancer.time_spread_now(ranks());
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
  void note_density_excess(double mine) { density_excess_ = std::max(density_excess_, ranks().maximum(mine)); }
  // As walls::reflect() for bodies; how many of this rank's particles.
  virtual std::int64_t put_out_of_bodies() { return 0; }

 private:
  void report_state() {
    const auto all = fields();
    std::vector<const double*> values;
    for (const auto& field : all) values.push_back(field.data);
    report_not_finite<D>(box.w, all, values, "");
  }
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
    if (!by_pairs) domain::migrate(box.w.d, box.w.s);
    return true;
  }

  // Cuts that are to move have done so, particles have not.
  std::optional<typename load_balance<D>::verdict> decide_on_cuts(bool lists_are_due, std::int64_t left) {
    if (ranks().size == 1 || !balancer.due(lists_are_due)) return {};
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

  run_directory* files_ = nullptr;
  output::history* balance_table_ = nullptr;
  std::int64_t put_back_ = 0;    // inside the walls and out of bodies, on this rank
  double density_excess_ = 0.0;  // the largest so far, on all ranks; 0: none was noted
  bool has_lists_ = false;
};

}  // namespace tetsuame::run
