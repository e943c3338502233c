// A case on the bench, stepped as the programs' time loop does with steps so small that nothing changes: all that is
// measured is what a step costs. Every particle is off its lattice place and moving, so that nothing is special.
#pragma once

#include <fmt/format.h>
#include <malloc.h>
#include <omp.h>

#include <bench/measure.hpp>
#include <bench/scalar.hpp>
#include <cmath>
#include <gas/convergence.hpp>
#include <gas/world.hpp>
#include <hydrostatic/options.hpp>
#include <liquid/passes.hpp>
#include <output/hash.hpp>
#include <problems/make.hpp>
#include <programs/schemes.hpp>
#include <run/particle_simulation.hpp>

namespace tetsuame::bench {

// The very scheme that a case of liquid measures, with the library that the programs are linked with.
const liquid::program& program_of(const std::string& name);

// One of the programs on a box of liquid iron at 10 GPa between two walls with markers, periodic sideways.
template <int D>
hydrostatic::options box_of_liquid(const request& asked) {
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
  o.kernel.precision = asked.precision;
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

// A scheme of program shock: a periodic box of gas, a square of it four times as dense (a cube in 3-D), particles on
// one lattice.
inline gas::options box_of_gas(const request& asked) {
  const auto n = asked.side;
  gas::options o;
  namelist::schema schema;
  gas::declare(schema, o);
  schema.read(namelist::parse_text(
      fmt::format(
          "&domain dimension = {} length_x = {} particles_x = {} periodic_x = T periodic_y = T periodic_z = T /\n"
          "&shock test = 'square' scheme = '{}' masses = 'equal_spacing' rho_l = 4 p_l = 2.5 rho_r = 1 p_r = 2.5 /\n"
          "&kernel precision = '{}' /\n"
          "&time method = 'euler' dt = 1e-15 t_end = 1 /\n",
          asked.dimension, n, n, asked.name, asked.precision),
      "bench"));
  gas::resolve(schema, o);
  return o;
}

// In [-1, 1), of a particle's ID and a salt.
inline double scatter(std::int64_t id, std::uint64_t salt) {
  const auto z = (static_cast<std::uint64_t>(id) + 1) * 0x9e3779b97f4a7c15U + salt * 0xd1342543de82ef95U;
  return static_cast<double>(output::mix(z) >> 11) * 0x1p-52 - 1.0;
}

// Bytes in use on the heap, as malloc counts them.
inline double heap_bytes() {
  const auto info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

template <int D>
class rig {
 public:
  rig(const request& asked, const run::time_options& time, std::unique_ptr<run::simulation> box)
      : asked_(asked),
        dt_(*time.dt),
        box_(std::move(box)),
        particles_(static_cast<run::particle_simulation<D>&>(*box_)),
        world_(particles_.box) {
    const bool gas = is_scheme(asked.name);
    auto& w = world_.w;
    auto& s = w.s;
    if (gas) make_lists();  // it settles on its lattice
    for (std::size_t i = 0; i < s.fluid; ++i) {
      for (std::size_t a = 0; a < D; ++a) {
        s.x[a][i] += 0.05 * w.dx * scatter(s.id[i], a);
        s.v[a][i] = scatter(s.id[i], 3 + a);  // m/s
      }
      if (!gas) s.T[i] += scatter(s.id[i], 6);  // K
    }
    make_lists();
    integrators::explicit_options how;
    how.method = time.method;
    how.dt = dt_;
    const auto arrays = box_->arrays();
    integrator_ = std::make_unique<integrators::explicit_integrator>(
        box_->ranks.comm, arrays.fields, arrays.size, 0.0, how, [this](double t, std::span<double* const> rate) {
          return box_->evaluate({.time = t, .step = steps_, .shorter_steps_help = true}, rate) ? 0 : -1;
        });
    step();
  }

  // For each number of threads asked for. heap_before: bytes, before the box was made.
  std::vector<result> measure(int passes, double heap_before) {
    result found;
    found.name = asked_.name;
    found.precision = asked_.precision;
    found.dimension = D;
    found.particles = asked_.particles();
    found.passes = passes;
    count_pairs(found);
    count_bytes(found, heap_before);
    auto all = time_steps(
        found, asked_, [&] { make_lists(); }, [&] { step(); }, world_.w.times);
    if (asked_.name == "program_c")
      for (result& r : all) {
        omp_set_num_threads(r.threads);
        compare_with_scalar(r);
      }
    return all;
  }

 private:
  void make_lists() {
    particles_.rebuild(false);
    if (!integrator_) return;
    const auto arrays = box_->arrays();
    integrator_->resize(arrays.fields, arrays.size);
  }

  // As in the time loop (run/time_loop.cpp), with lists that keep their width.
  void step() {
    if (particles_.moved().length() + particles_.speed().length() * dt_ > particles_.allowance()) make_lists();
    {
      const foundation::stage timed(box_->times, "integration");
      integrator_->prepare();
      box_->commit();
      integrator_->step(integrator_->time() + dt_);
    }
    box_->complete({integrator_->time(), ++steps_});
  }

  // m2, of particle i
  double support2(std::size_t i) const {
    if (!is_scheme(asked_.name)) return world_.w.support() * world_.w.support();
    const auto& S = static_cast<const gas::world<D>&>(world_).S;
    return S[i] * S[i];
  }

  // f(j) for the neighbours of particle i nearer than the root of `reach2`, m2.
  template <class F>
  void for_each_within(std::size_t i, double reach2, F&& f) const {
    const auto& w = world_.w;
    w.list.for_each(i / pairs::lanes, [&](std::uint32_t j, std::uint32_t of_lanes, auto...) {
      double r2 = 0.0;
      for (const auto& x : w.s.x) r2 += (x[i] - x[j]) * (x[i] - x[j]);
      if ((of_lanes >> i % pairs::lanes & 1U) != 0 && r2 < reach2) f(j);
    });
  }

  void count_pairs(result& r) const {
    const auto& w = world_.w;
    std::size_t close = 0;
    for (std::size_t i = 0; i < w.s.fluid; ++i) for_each_within(i, support2(i), [&](std::uint32_t) { ++close; });
    r.neighbours = static_cast<double>(close) / static_cast<double>(w.s.fluid);
    r.list_entries = static_cast<double>(w.list.pairs) / static_cast<double>(w.s.fluid);
  }

  void count_bytes(result& r, double heap_before) const {
    const double lists = world_.w.list.bytes();
    const auto n = static_cast<double>(world_.w.s.fluid);
    r.list_bytes_per_particle = lists / n;
    r.bytes_per_particle = (heap_bytes() - heap_before - lists) / n;
  }

  // Engine and scalar loop in turn on the same particles and list; the median of the pairs' ratios. The scalar loop's
  // list takes 4 bytes a pair: of many particles it has the first ones only.
  static constexpr std::size_t most_of_scalar = 250'000;
  void compare_with_scalar(result& r) {
    const std::size_t n = world_.w.s.fluid;
    std::vector<double> heat(n), dlnrho(n);
    integrator_->lend([&](std::span<double* const> rates) {
      auto out = liquid::rates_in_order<D>(rates);
      out.heat = heat.data();
      out.dlnrho = dlnrho.data();
      compare_with_scalar(r, out);
    });
  }
  void compare_with_scalar(result& r, const liquid::rates<D>& out) {
    auto& w = world_.w;
    auto& s = w.s;
    scalar_problem<D> problem{s, w.support() / 3.0, *w.uniform_transport, w.g, {0}, {}};
    const double reach = w.support() + world_.skin;
    const std::size_t n = std::min(s.fluid, most_of_scalar);
    for (std::size_t i = 0; i < n; ++i) {
      for_each_within(i, reach * reach,
                      [&](std::uint32_t j) { problem.neighbours.push_back(static_cast<std::int32_t>(j)); });
      problem.start.push_back(problem.neighbours.size());
    }
    scalar_sums<D> sums(n);
    const double share = static_cast<double>(n) / static_cast<double>(s.fluid);
    std::vector<double> ratios, scalars;
    const auto start = clock::now();
    while (ratios.size() < 3 || (since(start) < asked_.seconds && ratios.size() < 101)) {
      const double engine = time_of([&] {
        volume::smooth_by_lattice(w, false, w.fluid());
        liquid::begin_forces(world_, out);
        liquid::sum_forces<programs::disph_c::gradient>(world_, out, w.fluid(), false);
        foundation::for_all(s.fluid, [&](std::size_t i) {  // as in liquid::finish_rates
          for (std::size_t a = 0; a < D; ++a) out.dv[a][i] = out.dv[a][i] / s.m[i] + w.g[a];
          out.du[i] /= s.m[i];
        });
      });
      const double scalar = time_of([&] { sum_scalar(problem, sums); }) / share;
      ratios.push_back(scalar / engine);
      scalars.push_back(scalar);
    }
    r.speedup_over_scalar = median(ratios);
    r.scalar_ns_per_pair = 1e9 * median(scalars) * r.threads / (static_cast<double>(s.fluid) * r.neighbours);

    const double worst = deviation(out, sums);
    r.deviation_from_scalar = worst;
    // Hundreds of terms that nearly cancel, added in another order, or of seven digits.
    const double round_off = asked_.precision == "single" ? 1e-5 : 1e-11;
    if (!(worst <= round_off))
      foundation::fail_calculation(fmt::format(
          "{} in {}-D, {} particles: the engine's sums and the scalar reference differ by {:.2g} of the largest value, "
          "more than round-off ({:.0e}); one of the two is wrong, so no speed is given",
          asked_.name, D, r.particles, worst, round_off));
  }

  // Largest difference of the engine's sums from the scalar ones, relative to the field's largest value.
  double deviation(const liquid::rates<D>& out, const scalar_sums<D>& sums) const {
    const auto& s = world_.w.s;
    double worst = 0.0;
    const auto differ = [&](const auto& a, const std::vector<double>& b) {
      double difference = 0.0, largest = 0.0;
      for (std::size_t i = 0; i < b.size(); ++i) {
        difference = std::max(difference, std::abs(a[i] - b[i]));
        largest = std::max(largest, std::abs(b[i]));
        if (!std::isfinite(a[i]) || !std::isfinite(b[i])) worst = std::numeric_limits<double>::infinity();
      }
      worst = std::max(worst, difference / largest);
    };
    differ(s.p, sums.p);
    for (std::size_t a = 0; a < D; ++a) differ(out.dv[a], sums.dv[a]);
    differ(out.du, sums.work);
    differ(out.dlnrho, sums.dlnrho);
    differ(out.heat, sums.heat);
    return worst;
  }

  request asked_;
  double dt_;  // s
  std::unique_ptr<run::simulation> box_;
  run::particle_simulation<D>& particles_;
  run::state<D>& world_;
  std::unique_ptr<integrators::explicit_integrator> integrator_;
  std::int64_t steps_ = 0;
};

// The options outlive the box.
template <int D>
std::vector<result> measure_in(const request& asked) {
  const double before = heap_bytes();
  if (is_scheme(asked.name)) {
    const auto o = box_of_gas(asked);
    const std::vector<gas::level> alone;
    return rig<D>(asked, o.common.time, D == 2 ? gas::make_2d(o, alone) : gas::make_3d(o, alone))
        .measure(o.evolves_density() ? 4
                 : o.godunov()       ? 3
                                     : 2,
                 before);
  }
  const auto o = box_of_liquid<D>(asked);
  return rig<D>(asked, o.time, problems::at_rest(o, program_of(asked.name)))
      .measure(asked.name == "program_f" ? 1 : 2, before);
}

}  // namespace tetsuame::bench
