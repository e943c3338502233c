// The load balancer on virtual ranks: how it would cut a given distribution of particles, under a
// modelled cost, for any number of ranks. The balancer is the one of the time loop (modules/balance) and
// sees what it sees there, the time of each rank; docs/load_balancer.md has the results.
//
//   1  cuts with equal counts of particles; the model gives each rank's time for a step
//   2  every steps_between steps: new cuts from the measured times; moved if that pays
//   3  where Zoltan is installed, again with its partitioners, which see every particle's cost, under the same rule
#include <fmt/format.h>
#include <mpi.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <foundation/agree.hpp>
#include <nlohmann/json.hpp>
#include <output/directory.hpp>
#include <output/file.hpp>
#include <output/history.hpp>
#include <run/command_line.hpp>
#include <run/summary.hpp>
#include <virtual_ranks/machine.hpp>
#include <virtual_ranks/zoltan.hpp>

namespace {

using namespace tetsuame;
using namespace tetsuame::virtual_ranks;
using json = nlohmann::ordered_json;
using clock = std::chrono::steady_clock;

double seconds_since(clock::time_point begin) { return std::chrono::duration<double>(clock::now() - begin).count(); }

// One way to partition, followed through the run.
struct course {
  std::string name;  // of the keys in summary.json: "rcb"; empty: ours
  std::vector<int> owner;
  load now;
  balance::spread times, first_times;
  balance::decision last;
  std::int64_t updates = 0;                              // moves made
  double run_time = 0.0, moved = 0.0, last_moved = 0.0;  // s; parts of all particles
  std::optional<std::int64_t> balanced_after;            // decisions until the spread was at most 5 %

  std::string prefix() const { return name.empty() ? name : name + "_"; }
  double moved_per_update() const { return updates > 0 ? moved / static_cast<double>(updates) : 0.0; }
};

// Of history.csv, for each course.
struct column {
  const char* name;
  const char* unit;
  double (*of)(const course& c);
};
constexpr std::array columns_of_a_course{
    column{"spread", "1", [](const course& c) { return c.times.over_mean(); }},
    column{"spread_of_maximum", "1", [](const course& c) { return c.times.over_maximum(); }},
    column{"max_over_mean", "1",
           [](const course& c) { return c.times.mean > 0.0 ? c.times.maximum / c.times.mean : 1.0; }},
    column{"slowest_step", "s", [](const course& c) { return c.times.maximum; }},
    column{"migrated_fraction", "1", [](const course& c) { return c.last_moved; }},
    column{"gain", "s", [](const course& c) { return c.last.gain; }},
    column{"cost", "s", [](const course& c) { return c.last.cost; }},
    column{"moved", "1", [](const course& c) { return c.last.move ? 1.0 : 0.0; }}};

template <int D>
struct virtual_run {
  const options& o;
  scene<D> s;
  std::vector<double> slowness;
  balance::cuts<D> cuts;
  std::vector<course> courses;  // ours first
  course first;                 // the run that keeps its first cuts
  balance::experience experience;
  balance::lasting_cost lasting{o.balancer.readings};
  std::optional<double> expected;  // gain per step of the last move, to be compared with the next reading
  std::vector<double> time_before;
  double proposing = 0.0;  // s, spent by our balancer
  std::int64_t proposals = 0;
  std::string cuts_csv = "decision,axis,group,index,position [m]\n";
  std::string times_csv = "decision,rank,particles,computing [s],communication [s]\n";

  explicit virtual_run(const options& opt)
      : o(opt), s(make_scene<D>(o.distribution, o.cost.halo_width)), slowness(slowness_of(o.machine)) {
    const auto counts =
        balance::choose_counts<D>(static_cast<int>(o.machine.ranks), s.length, static_cast<int>(o.machine.ranks_x));
    cuts = o.schedule.start == "equal_size" ? balance::equal_cuts<D>(counts, s.length) : equal_count_cuts<D>(s, counts);
    add("", owners(s, cuts));
    for (const auto& name : o.compare)
      add(name, partition<D>(name, s.x, {}, std::vector<double>(slowness.size(), 1.0)));
    first = courses[0];
  }

  void add(const std::string& name, std::vector<int> owner) {
    auto& c = courses.emplace_back();
    c.name = name;
    c.owner = std::move(owner);
    look(c);
    c.first_times = c.times;
  }

  void look(course& c) {
    c.now = load_of(s, c.owner, o.cost, slowness);
    c.times = balance::spread_of(c.now.time);
  }

  void note(std::int64_t decision) {
    for (std::size_t a = 0; a < D; ++a)
      for (std::size_t g = 0; g < cuts.groups(a); ++g)
        for (int n = 0; n <= cuts.counts[a]; ++n)
          cuts_csv += fmt::format("{},{},{},{},{}\n", decision, a, g, n, cuts.group(a, g)[n]);
    const auto& now = courses[0].now;
    for (std::size_t r = 0; r < slowness.size(); ++r)
      times_csv += fmt::format("{},{},{:.0f},{:.6g},{:.6g}\n", decision, r, now.particles[r], now.computing[r],
                               now.communication[r]);
  }

  void take(course& c, std::vector<int> owner, const migration& m) {
    c.last_moved = static_cast<double>(m.particles) / static_cast<double>(s.size());
    c.moved += c.last_moved;
    c.run_time += m.seconds;
    ++c.updates;
    c.owner = std::move(owner);
  }

  // Our balancer: from measured times and counted work.
  void decide(std::int64_t reading) {
    auto& c = courses[0];
    const auto time = lasting.of(measured(c.now.time, o.machine, reading), c.now.work);
    if (expected) experience.moved(*expected, time_before, time);
    expected.reset();
    const auto where = extents_of(s, c.owner, slowness.size(), o.cost);
    const auto begin = clock::now();
    const auto then = balance::propose(cuts, time, relaxed(o.balancer, experience), where);
    const balance::move_costs moving{o.cost.migrate,
                                     o.cost.list * *std::max_element(c.now.particles.begin(), c.now.particles.end())};
    c.last = balance::worth_moving(cuts, then, time, c.now.particles, moving, o.schedule.horizon, experience, where);
    proposing += seconds_since(begin);
    ++proposals;
    if (o.schedule.move == "always") c.last.move = true;
    c.last_moved = 0.0;
    if (!c.last.move) return experience.stayed();
    expected = balance::spread_of(time).maximum - balance::spread_of(c.last.after).maximum;
    time_before = time;
    cuts = then;
    auto owner = owners(s, cuts);
    const auto m = migration_between(c.owner, owner, slowness.size(), o.cost);
    take(c, std::move(owner), m);
  }

  // A partitioner that sees every particle's cost and every rank's speed.
  void decide(course& c) {
    std::vector<double> speed(slowness);
    for (double& v : speed) v = 1.0 / v;
    auto owner = partition<D>(c.name, s.x, weights_of(s, o.cost), speed);
    const auto then = load_of(s, owner, o.cost, slowness);
    const auto m = migration_between(c.owner, owner, slowness.size(), o.cost);
    c.last =
        balance::worth_moving(c.times.maximum, balance::spread_of(then.time).maximum, m.seconds, o.schedule.horizon);
    if (o.schedule.move == "always") c.last.move = true;
    c.last_moved = 0.0;
    if (c.last.move) take(c, std::move(owner), m);
  }

  // From one decision to the next, or to the end.
  void count_steps(std::int64_t n) {
    for (auto& c : courses) c.run_time += static_cast<double>(n) * c.times.maximum;
    first.run_time += static_cast<double>(n) * first.times.maximum;
  }

  std::vector<double> row() const {
    std::vector<double> values;
    for (const auto& c : courses)
      for (const auto& one : columns_of_a_course) values.push_back(one.of(c));
    values.insert(values.end(), {experience.trust, experience.relaxation});
    return values;
  }

  std::vector<output::history_column> columns() const {
    std::vector<output::history_column> all;
    for (const auto& c : courses)
      for (const auto& one : columns_of_a_course) all.push_back({c.prefix() + one.name, one.unit});
    all.insert(all.end(), {{"trust", "1"}, {"relaxation", "1"}});
    return all;
  }
};

template <int D>
json metrics_of(const virtual_run<D>& v) {
  json j;
  for (const auto& c : v.courses) {
    const auto p = c.prefix();
    j[p + "spread_initial"] = c.first_times.over_mean();
    j[p + "spread_final"] = c.times.over_mean();
    j[p + "spread_of_maximum_initial"] = c.first_times.over_maximum();
    j[p + "spread_of_maximum_final"] = c.times.over_maximum();
    j[p + "updates"] = c.updates;
    j[p + "updates_to_5_percent"] = c.balanced_after ? json(*c.balanced_after) : json(nullptr);
    j[p + "efficiency_initial"] = c.first_times.efficiency();
    j[p + "efficiency_predicted"] = c.times.efficiency();
    j[p + "migrated_fraction"] = c.moved;
    j[p + "migrated_fraction_per_update"] = c.moved_per_update();
    j[p + "run_time_balanced"] = c.run_time;
    j[p + "run_time_reduction"] = v.first.run_time > 0.0 ? 1.0 - c.run_time / v.first.run_time : 0.0;
  }
  j["run_time_equal_counts"] = v.first.run_time;
  j["balancer_seconds"] = v.proposals > 0 ? v.proposing / static_cast<double>(v.proposals) : 0.0;
  j["balancer_share_of_run_time"] = v.courses[0].run_time > 0.0 ? v.proposing / v.courses[0].run_time : 0.0;
  return j;
}

template <int D>
json summary_of(const virtual_run<D>& v, const std::string& program, std::int64_t step, double wall_seconds) {
  const auto walls =
      std::count_if(v.s.kinds.begin(), v.s.kinds.end(), [](kind k) { return k == kind::wall || k == kind::marker; });
  json j{{"program", program},
         {"status", "completed"},
         {"message", fmt::format("spread {:.1f} % -> {:.1f} %", 100.0 * v.courses[0].first_times.over_mean(),
                                 100.0 * v.courses[0].times.over_mean())},
         {"steps", step},
         {"dimension", D},
         {"fluid_particles", static_cast<std::int64_t>(v.s.size()) - walls},
         {"wall_particles", walls},
         {"ranks", 1},
         {"threads", 1},
         {"virtual_ranks", v.slowness.size()},
         {"counts", v.cuts.counts},
         {"wall_seconds", wall_seconds},
         {"metrics", metrics_of(v)},
         {"version", run::version()}};
  if (const auto lost = run::first_not_finite(j["metrics"]); !lost.empty())
    foundation::fail_calculation("metrics." + lost + " is not a finite number: times of the input lie too far apart");
  return j;
}

template <int D>
void print(const virtual_run<D>& v, std::int64_t decisions) {
  fmt::print("{} particles on {} ranks ({}), {} decisions\n", v.s.size(), v.slowness.size(),
             fmt::join(v.cuts.counts, " x "), decisions);
  fmt::print("{:<12}{:>20}{:>14}{:>10}{:>16}{:>12}{:>14}\n", "", "spread (max-min)/mean", "mean/max", "updates",
             "moved an update", "run time", "of equal counts");
  for (const auto& c : v.courses)
    fmt::print("{:<12}{:>9.1f} % -> {:>5.1f} %{:>12.3f}{:>10}{:>14.1f} %{:>10.4g} s{:>12.1f} %\n",
               c.name.empty() ? "balancer" : c.name, 100.0 * c.first_times.over_mean(), 100.0 * c.times.over_mean(),
               c.times.efficiency(), c.updates, 100.0 * c.moved_per_update(), c.run_time,
               v.first.run_time > 0.0 ? 100.0 * c.run_time / v.first.run_time : 100.0);
  run::check_standard_output();
}

template <int D>
void carry_out(const run::command_line& line, const options& o, const std::string& resolved) {
  if (foundation::size_of(MPI_COMM_WORLD) > 1)
    foundation::fail_input("balance models its ranks in one process: start it without mpirun, with --ranks P");
  const auto begin = clock::now();
  virtual_run<D> v(o);
  output::open_directory(MPI_COMM_WORLD, line.output,
                         line.force ? output::directory_mode::force : output::directory_mode::fresh,
                         {"cuts.csv", "times.csv"});
  output::write_text(MPI_COMM_WORLD, line.output + "/resolved.nml", resolved);
  output::run_log log(MPI_COMM_WORLD, line.output + "/run.log");
  auto history = output::history::start(MPI_COMM_WORLD, line.output + "/history.csv", v.columns());
  log.write(fmt::format("{} particles, {} ranks, {}-D", v.s.size(), v.slowness.size(), D));

  std::int64_t step = 0, decisions = 0;
  for (bool changed = true;; ++decisions) {
    for (auto& c : v.courses)
      if (!c.balanced_after && c.times.over_mean() <= 0.05) c.balanced_after = decisions;
    history.append(step, v.row());
    v.note(decisions);
    const bool last = decisions >= o.schedule.updates || o.schedule.steps - step <= o.schedule.steps_between;
    const std::int64_t n = last ? o.schedule.steps - step : o.schedule.steps_between;
    v.count_steps(n);
    step += n;
    if (last) break;
    const bool was = changed;
    changed = move_blobs(v.s, o.distribution, step);
    if (changed) {
      v.look(v.first);
      for (auto& c : v.courses) v.look(c);
    }
    v.decide(decisions);
    log.write(fmt::format("step {}: {}", step, v.courses[0].last.reason));
    for (std::size_t k = 1; k < v.courses.size(); ++k) {
      // The same particles with the same costs would be partitioned the same again.
      if (changed || was)
        v.decide(v.courses[k]);
      else
        v.courses[k].last = {}, v.courses[k].last_moved = 0.0;
    }
    for (auto& c : v.courses)
      if (c.last.move) v.look(c);
  }

  const json summary = summary_of(v, line.program, step, seconds_since(begin));
  output::write_text(MPI_COMM_WORLD, line.output + "/cuts.csv", v.cuts_csv);
  output::write_text(MPI_COMM_WORLD, line.output + "/times.csv", v.times_csv);
  output::write_summary(MPI_COMM_WORLD, line.output + "/summary.json", summary);
  print(v, decisions);
}

}  // namespace

int main(int argc, char** argv) {
  options o;
  run::program_input in;
  in.program = "balance";
  in.add_options = [](CLI::App& app, run::command_line& line) {
    const auto set = [&line](const std::string& ranks) { line.set.push_back("machine.ranks=" + ranks); };
    app.add_option_function<std::string>("--ranks", set, "virtual ranks: --set machine.ranks=P")->type_name("P");
  };
  in.declare = [&](namelist::schema& schema) { declare(schema, o); };
  in.complete = [&](const namelist::schema& schema) { complete(schema, o); };
  return run::start(argc, argv, in, [&](const run::command_line& line, const std::string& resolved) {
    o.distribution.dimension == 3 ? carry_out<3>(line, o, resolved) : carry_out<2>(line, o, resolved);
  });
}
