// A case on the bench: a box of liquid iron at 10 GPa between two walls, periodic sideways, every
// particle off its lattice place and moving, so that nothing is special. It is stepped by the programs' own
// time loop with steps so small that nothing changes: all that is measured is what a step costs.
#pragma once

#include <omp.h>

#include <bench/measure.hpp>
#include <bench/scalar.hpp>
#include <chrono>
#include <cmath>
#include <gradient/pattern_1.hpp>
#include <simulation/hydrostatic.hpp>
#include <volume/number_density.hpp>
#include <volume/our_method.hpp>

namespace tetsuame::bench {

struct program_c {
  using volume = tetsuame::volume::our_method;
  using pressure = tetsuame::volume::smoothed;
  using gradient = tetsuame::gradient::pattern_1;
  static constexpr int passes = 2;
};
struct program_f {
  using volume = tetsuame::volume::our_method;
  using pressure = tetsuame::volume::non_smoothed;
  using gradient = tetsuame::gradient::pattern_1;
  static constexpr int passes = 1;
};
struct number_density {
  using volume = tetsuame::volume::number_density;
  using pressure = tetsuame::volume::non_smoothed;
  using gradient = tetsuame::gradient::pattern_1;
  static constexpr int passes = 2;
};

using clock = std::chrono::steady_clock;
inline double since(clock::time_point start) { return std::chrono::duration<double>(clock::now() - start).count(); }

// In [-1, 1), of a particle's ID and a salt (SplitMix64's finaliser, by S. Vigna).
inline double scatter(std::int64_t id, std::uint64_t salt) {
  std::uint64_t z = (static_cast<std::uint64_t>(id) + 1) * 0x9e3779b97f4a7c15U + salt * 0xd1342543de82ef95U;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
  z ^= z >> 31;
  return static_cast<double>(z >> 11) * 0x1p-52 - 1.0;
}

template <int D>
simulation::options box(const request& asked) {
  simulation::options o;
  o.domain.dimension = D;
  for (std::size_t a = 0; a < D; ++a) {
    o.domain.particles[a] = asked.side;
    o.domain.length[a] = static_cast<double>(asked.side);  // spacing 1 m
    o.domain.periodic[a] = a != 1;
  }
  o.initial.profile = "uniform";
  o.g = 10.0;
  o.kernel.name = "quintic";
  o.kernel.h_over_dx = 1.2;
  o.walls.treatment = walls::virtual_marker::name;
  o.material.eos.name = "liquid_iron";
  o.material.eos = eos::resolve(o.material.eos);
  o.material.viscosity = 1e9;  // Pa s: viscous forces as large as those of pressure
  o.material.conductivity = asked.name == "transport" ? 100.0 : 0.0;
  o.time.dt = 1e-15;  // s
  o.time.steps = std::int64_t{1} << 40;
  o.time.t_end = 1.0;
  return o;
}

template <class Program, int D>
class rig {
 public:
  explicit rig(const request& asked)
      : asked_(asked), heap_before_(heap_bytes()), in_{box<D>(asked), ""}, run_(line_, in_) {
    auto& world = run_.world;
    simulation::set_up<D>(in_.values, run_.ranks, world);
    world.density_carried = Program::volume::carried == volume::carries::density;
    world.weight_carried = Program::volume::carried == volume::carries::weight;
    auto& s = world.w.s;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      for (std::size_t a = 0; a < D; ++a) {
        s.x[a][i] += 0.05 * world.w.dx * scatter(s.id[i], a);
        s.v[a][i] = scatter(s.id[i], 3 + a);  // m/s
      }
      s.T[i] += scatter(s.id[i], 6);  // K
    }
    make_lists();
    run_.make_integrator(0.0);
    step();
    count_pairs();
    const double lists = static_cast<double>(world.w.list.start.capacity() * sizeof(world.w.list.start[0]) +
                                             world.w.list.neighbours.capacity() * sizeof(world.w.list.neighbours[0]));
    found_.list_bytes_per_particle = lists / static_cast<double>(s.fluid);
    found_.bytes_per_particle = (heap_bytes() - heap_before_ - lists) / static_cast<double>(s.fluid);
    found_.name = asked.name;
    found_.dimension = D;
    found_.particles = asked.particles();
    found_.passes = Program::passes;
  }

  // For each number of threads asked for. They take turns, so that what else the machine does falls on all of them.
  std::vector<result> measure() {
    std::vector<result> all;
    for (const int threads : asked_.threads) {
      all.push_back(found_);
      all.back().threads = threads;
      if (double load = 0.0; getloadavg(&load, 1) == 1) all.back().load_average = load;
    }
    time_steps(all);
    if constexpr (std::is_same_v<Program, program_c>)
      if (run_.world.w.uniform_transport)
        for (result& r : all) {
          omp_set_num_threads(r.threads);
          compare_with_scalar(r);
        }
    return all;
  }

 private:
  // As the time loop does it (simulation::run::refresh_lists), whether it is due or not.
  void make_lists() {
    auto& world = run_.world;
    domain::wrap(world.w.d.region, world.w.s);
    simulation::rebuild(world);
    if (run_.integrator) run_.integrator->resize(simulation::state_fields(world, in_.values.time), world.w.s.fluid);
  }

  // As in simulation::run::advance.
  void step() {
    run_.refresh_lists();
    {
      const foundation::stage timed(run_.world.w.times, "integration");
      run_.integrator->step(run_.next_stop());
    }
    run_.complete_step();
  }

  double time_of(auto&& work) {
    const auto start = clock::now();
    work();
    return since(start);
  }

  // Rounds, in each of which every number of threads has its turn: new lists, the step that finds them new, ordinary
  // steps. What the first step takes more than an ordinary one (what is kept while lists live) is charged to the lists.
  void time_steps(std::vector<result>& all) {
    struct record {
      std::vector<double> lists, steps, rounds;  // s, s, and s an ordinary step of a round with its share of the lists
      std::map<std::string, double> seconds;
    };
    std::vector<record> records(all.size());
    constexpr std::size_t fewest = 3, most = 25;
    const double turn = asked_.seconds / 10.0;
    const auto begin = clock::now();
    for (std::size_t n = 0; n < fewest || (n < most && since(begin) < asked_.seconds * static_cast<double>(all.size()));
         ++n)
      for (std::size_t k = 0; k < all.size(); ++k) {
        omp_set_num_threads(all[k].threads);
        auto& [lists, steps, rounds, seconds] = records[k];
        lists.push_back(time_of([&] { make_lists(); }) + time_of([&] { step(); }));
        run_.world.w.times.clear();
        const auto start = clock::now();
        std::vector<double> these;
        do these.push_back(time_of([&] { step(); }));
        while (since(start) < turn || these.size() < 3);
        for (const auto& [name, s] : run_.world.w.times.seconds()) seconds[name] += s;
        steps.insert(steps.end(), these.begin(), these.end());
        const double ordinary = median(these);
        rounds.push_back(ordinary + std::max(0.0, lists.back() - ordinary) / static_cast<double>(asked_.steps_a_list));
      }

    for (std::size_t k = 0; k < all.size(); ++k) {
      auto& [lists, steps, rounds, seconds] = records[k];
      result& r = all[k];
      const double ordinary = median(steps);
      r.list_seconds = std::max(0.0, median(lists) - ordinary);
      const double lists_a_step = r.list_seconds / static_cast<double>(asked_.steps_a_list);
      r.step_seconds = ordinary + lists_a_step;
      std::vector<double> ratios;
      for (std::size_t n = 0; n < rounds.size(); ++n) ratios.push_back(records[0].rounds[n] / rounds[n]);
      r.speedup_over_first = median(ratios);

      double total = 0.0, staged = 0.0;
      for (const double s : steps) total += s;
      for (const auto& [name, s] : seconds) staged += s;
      seconds["rest"] = std::max(0.0, total - staged);  // displacements, the largest speed, the walls' last guard
      total = std::max(total, staged);
      for (const auto& [name, s] : seconds) r.stages[name] = s / total * ordinary / r.step_seconds;
      r.stages["lists"] = lists_a_step / r.step_seconds;
    }
  }

  void count_pairs() {
    const auto& w = run_.world.w;
    const double support2 = w.support() * w.support();
    std::size_t close = 0;
    for (std::size_t i = 0; i < w.s.fluid; ++i)
      for (std::size_t k = w.list.start[i]; k < w.list.start[i + 1]; ++k) {
        double r2 = 0.0;
        for (const auto& x : w.s.x) {
          const double d = x[i] - x[static_cast<std::size_t>(w.list.neighbours[k])];
          r2 += d * d;
        }
        close += r2 < support2 ? 1 : 0;
      }
    found_.neighbours = static_cast<double>(close) / static_cast<double>(w.s.fluid);
    found_.list_entries = static_cast<double>(w.list.pairs) / static_cast<double>(w.s.fluid);
  }

  // Engine and scalar loop in turn on the same particles and list; the median of the pairs' ratios.
  void compare_with_scalar(result& r) {
    auto& world = run_.world;
    auto& w = world.w;
    auto& s = w.s;
    std::vector<particles::array> rates(2 * D + 3, particles::array(s.fluid));
    std::vector<double*> pointers;
    for (auto& a : rates) pointers.push_back(a.data());
    const simulation::state_rates<D> out(pointers);
    const scalar_problem<D> problem{s.fluid,
                                    w.list.start.data(),
                                    w.list.neighbours.data(),
                                    w.x(),
                                    pairs::pointers<D>(s.v),
                                    s.Y.data(),
                                    s.p.data(),
                                    s.dV.data(),
                                    s.m.data(),
                                    w.support() / 3.0,
                                    *w.uniform_transport,
                                    w.g};
    scalar_sums<D> sums(s.fluid);
    std::vector<double> ratios, scalars;
    const auto start = clock::now();
    while (ratios.size() < 3 || (since(start) < asked_.seconds && ratios.size() < 101)) {
      const double engine = time_of([&] {
        volume::smooth_by_lattice(w, false);
        simulation::begin_forces(world, out);
        simulation::sum_forces<typename Program::gradient>(world, out, world.w.fluid());
        foundation::for_all(s.fluid, [&](std::size_t i) {  // as in simulation::finish_rates
          for (std::size_t a = 0; a < D; ++a) out.dv[a][i] = out.dv[a][i] / s.m[i] + w.g[a];
          out.du[i] /= s.m[i];
        });
      });
      const double scalar = time_of([&] { sum_scalar(problem, sums); });
      ratios.push_back(scalar / engine);
      scalars.push_back(scalar);
    }
    r.speedup_over_scalar = median(ratios);
    r.scalar_ns_per_pair = 1e9 * median(scalars) * r.threads / (static_cast<double>(s.fluid) * r.neighbours);

    double worst = 0.0;
    const auto differ = [&](const auto& a, const std::vector<double>& b) {
      double difference = 0.0, largest = 0.0;
      for (std::size_t i = 0; i < s.fluid; ++i) {
        difference = std::max(difference, std::abs(a[i] - b[i]));
        largest = std::max(largest, std::abs(b[i]));
        if (!std::isfinite(a[i]) || !std::isfinite(b[i])) worst = std::numeric_limits<double>::infinity();
      }
      worst = std::max(worst, difference / largest);
    };
    differ(s.p, sums.p);
    for (std::size_t a = 0; a < D; ++a) differ(out.dv[a], sums.dv[a]);
    differ(out.du, sums.work);
    differ(out.dlnrho(), sums.dlnrho);
    differ(out.heat(), sums.heat);
    r.deviation_from_scalar = worst;
    // Hundreds of terms that nearly cancel, added in another order.
    constexpr double round_off = 1e-11;
    if (!(worst <= round_off))
      foundation::fail_calculation(fmt::format(
          "{} in {}-D, {} particles: the engine's sums and the scalar reference differ by {:.2g} of the largest value, "
          "more than round-off ({:.0e}); one of the two is wrong, so no speed is given",
          asked_.name, D, found_.particles, worst, round_off));
  }

  request asked_;
  double heap_before_;
  simulation::command_line line_{};
  simulation::input in_;
  simulation::run<Program, D> run_;
  result found_;
};

template <class Program, int D>
void measure_case(const request& asked, const std::function<void(const result&)>& take) {
  rig<Program, D> bench(asked);
  for (const result& r : bench.measure()) take(r);
}

template <int D>
void measure_in(const request& asked, const std::function<void(const result&)>& take) {
  if (asked.name == "program_f")
    measure_case<program_f, D>(asked, take);
  else if (asked.name == "number_density")
    measure_case<number_density, D>(asked, take);
  else  // program_c, and transport: the same with conduction and viscosity of each particle's own
    measure_case<program_c, D>(asked, take);
}

}  // namespace tetsuame::bench
