// A case on the bench: one of the programs (programs.hpp) on a box of liquid iron at 10 GPa between two walls with
// markers, periodic sideways, every particle off its lattice place and moving, so that nothing is special. It is
// stepped as the programs' time loop does with steps so small that nothing changes: all that is measured is what a step
// costs.
#pragma once

#include <omp.h>

#include <bench/programs.hpp>
#include <bench/scalar.hpp>
#include <bench/turns.hpp>
#include <cmath>
#include <hydrostatic/options.hpp>
#include <liquid/passes.hpp>
#include <problems/make.hpp>
#include <run/box.hpp>

namespace tetsuame::bench {

template <int D>
hydrostatic::options box(const request& asked) {
  hydrostatic::options o;
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

template <int D>
class rig {
 public:
  explicit rig(const request& asked)
      : asked_(asked),
        heap_before_(heap_bytes()),
        options_(box<D>(asked)),
        box_(problems::at_rest(options_, program_of(asked.name))),
        world_(static_cast<run::problem_in_a_box<D>&>(*box_).box) {
    auto& w = world_.w;
    auto& s = w.s;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      for (std::size_t a = 0; a < D; ++a) {
        s.x[a][i] += 0.05 * w.dx * scatter(s.id[i], a);
        s.v[a][i] = scatter(s.id[i], 3 + a);  // m/s
      }
      s.T[i] += scatter(s.id[i], 6);  // K
    }
    make_lists();
    integrators::explicit_options how;
    how.method = options_.time.method;
    how.dt = *options_.time.dt;
    integrator_ = std::make_unique<integrators::explicit_integrator>(
        box_->ranks().comm, box_->fields(), box_->local_particles(), 0.0, how,
        [this](double, std::span<double* const> rate) { return evaluate(rate); });
    step();
    const double support2 = w.support() * w.support();
    count_pairs(found_, w, [&](std::size_t) { return support2; });
    count_bytes(found_, w, heap_before_);
    found_.name = asked.name;
    found_.dimension = D;
    found_.particles = asked.particles();
    found_.passes = passes_of(asked.name);
  }

  // For each number of threads asked for. They take turns, so that what else the machine does falls on all of them.
  std::vector<result> measure() {
    auto all = with_threads(found_, asked_.threads);
    time_steps(all, asked_, {[&] { make_lists(); }, [&] { step(); }, world_.w.times});
    if (asked_.name == "program_c")
      for (result& r : all) {
        omp_set_num_threads(r.threads);
        compare_with_scalar(r);
      }
    return all;
  }

 private:
  void make_lists() {
    box_->rebuild(false);
    if (integrator_) integrator_->resize(box_->fields(), box_->local_particles());
  }

  // As in the time loop (run/time_loop.cpp).
  int evaluate(std::span<double* const> rate) {
    if (!(box_->moved() <= box_->allowance())) return -1;
    box_->evaluate(rate);
    return 0;
  }
  void step() {
    if (box_->moved() + box_->speed() * *options_.time.dt > box_->allowance()) make_lists();
    {
      const foundation::stage timed(box_->times(), "integration");
      integrator_->prepare();
      integrator_->step(integrator_->time() + *options_.time.dt);
    }
    box_->complete_step(++steps_);
  }

  // Engine and scalar loop in turn on the same particles and list; the median of the pairs' ratios.
  void compare_with_scalar(result& r) {
    auto& w = world_.w;
    auto& s = w.s;
    std::vector<particles::array> rates(2 * D + 3, particles::array(s.fluid));
    std::vector<double*> pointers;
    for (auto& a : rates) pointers.push_back(a.data());
    const liquid::rates<D> out(pointers);
    std::vector<std::size_t> row_start{0};  // of the scalar loop's own list
    std::vector<std::int32_t> neighbours;
    std::vector<std::uint32_t> row;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      for (const std::uint32_t j : w.list.row(i, row)) neighbours.push_back(static_cast<std::int32_t>(j));
      row_start.push_back(neighbours.size());
    }
    const scalar_problem<D> problem{s.fluid,
                                    row_start.data(),
                                    neighbours.data(),
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
        liquid::begin_forces(world_, out);
        liquid::sum_forces<programs::program_c::gradient>(world_, out, w.fluid());
        foundation::for_all(s.fluid, [&](std::size_t i) {  // as in hydrostatic::finish_rates
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
  hydrostatic::options options_;
  std::unique_ptr<run::problem> box_;
  run::state<D>& world_;
  std::unique_ptr<integrators::explicit_integrator> integrator_;
  std::int64_t steps_ = 0;
  result found_;
};

template <int D>
void measure_in(const request& asked, const std::function<void(const result&)>& take) {
  for (const result& r : rig<D>(asked).measure()) take(r);
}

}  // namespace tetsuame::bench
