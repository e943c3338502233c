// DT/Dt = κ∇²T + J/c on particles that stand still; J: sources/fields.hpp
//
//   sum         ∇²T = Σ_j 2 V F (T_i - T_j), F = W'(r)/r                                  [S2]
//   consistent  operators/consistent.hpp
//   corrected   that with the deferred correction
#pragma once

#include <conduction/exact.hpp>
#include <conduction/options.hpp>
#include <diffusion/conduction.hpp>
#include <liquid/sums.hpp>
#include <operators/consistent.hpp>
#include <particles/named_fields.hpp>
#include <passes/evaluation.hpp>
#include <regions/apply.hpp>
#include <run/particle_simulation.hpp>
#include <run/start.hpp>
#include <run/start_from_file.hpp>
#include <sources/fields.hpp>

namespace tetsuame::conduction {

template <int D>
class problem : public run::particle_simulation<D> {
 public:
  using base = run::particle_simulation<D>;
  using base::ranks;

  explicit problem(const options& o) : base(world_, o.common), o_(o) {
    auto& s = world_.w.s;
    auto kernel = o.common.kernel;
    kernel.skin = 0.01;  // nothing moves
    run::set_up(world_, domain::communicator::world(), o.domain, o.walls, kernel, o.halo());
    if (o.by_program) {
      world_.treatment = walls::make(o.walls.treatment);
      world_.walls.how = o.walls;
    }
    on_lattice_ = world_.fluid_total;
    if (o.common.start.is_read()) run::start_from_file(o.common.start, {.motion = false}, world_);
    share_volume();
    place_walls();
    for (std::size_t i = 0; i < s.fluid; ++i) {
      if (!o.common.start.is_read()) s.T[i] = o.start;
      s.rho[i] = 1.0;
      s.m[i] = volume_;
      for (std::size_t a = 0, k = 0; a < D; ++a)
        for (std::size_t b = a; b < D; ++b) B_[k++][i] = a == b ? 1.0 : 0.0;
    }
    if (o.regions.any()) warm_regions();
    this->about = o.lines;
    beta_ = o.scheme == "corrected" ? operators::lattice_beta<D>(world_.w.kernel, world_.w.dx) : 0.0;
    declare_evaluation();
  }

  std::vector<integrators::field> fields() override { return evaluation_.fields(); }
  void sum_rates(std::span<double* const> rate) override { evaluation_.run(rate); }

  // Euler on the lattice is stable up to dx²/(2 d kappa).
  integrators::step_limit largest_step() override {
    const double dx = world_.w.dx;
    return {*o_.common.time.diffusive * dx * dx / o_.kappa, "diffusion"};
  }
  double diffusion_radius() override {
    const double dx = world_.w.dx;
    return 4.0 * D * o_.kappa / (dx * dx);
  }

  void commit_lagged() override {
    if (o_.scheme == "sum") return;
    std::copy_n(next_plain_.begin(), world_.w.s.fluid, plain_.begin());
    for (std::size_t k = 0; k < S; ++k) std::copy_n(next_B_[k].begin(), world_.w.s.fluid, B_[k].begin());
    refresh_memory();
  }

  std::vector<output::history_column> measured_columns() const override {
    return {{"temperature_error_l2", "1"}, {"temperature_error_max", "1"}, {"heat", "K m^D"}};
  }
  std::vector<double> measure(double t) override {
    const auto e = errors(t);
    return {e.l2, e.maximum, e.heat};
  }

  std::vector<output::particle_group> particle_groups(std::vector<particles::array>& extra) override {
    const auto& s = world_.w.s;
    auto g = output::group_of(s, 0, 0, s.fluid);
    const auto add = [&](const char* name, double value) {
      output::add_quantity(g, name, {output::make_array(extra, s.fluid, [&](auto) { return value; })});
    };
    output::add_quantity(g, "Temperature", {s.T.data()});
    add("Masses", volume_);  // nothing moves, and conduction knows no density: that of a body of 1 kg/m3
    add("Density", 1.0);
    add("Pressure", 0.0);
    add("SmoothingLength", o_.common.kernel.h_over_dx * world_.w.dx);
    add("Material", 0.0);
    return {g};
  }

  void report_results(double t, run::summary& r) override {
    const auto e = errors(t);
    if (!o_.regions.any() && !o_.sources.any()) r.errors = {{"temperature_l2", e.l2}, {"temperature_max", e.maximum}};
    r.metrics["reference"] = o_.reference;
    r.metrics["operator"] = o_.scheme;
    r.metrics["heat"] = e.heat;
    sources_.tell(r.metrics);
  }

  void restore_globals(const output::checkpoint_globals& g) override {
    base::restore_globals(g);
    share_volume();
  }

 protected:
  void make_lists(bool as_they_were) override {
    auto& s = world_.w.s;
    run::rebuild(world_, as_they_were);
    std::fill(s.k.begin(), s.k.end() - 1, o_.kappa);
    std::fill(s.dV.begin(), s.dV.end() - 1, volume_);
    std::fill(s.rho.begin(), s.rho.end() - 1, 1.0);
    particles::clear_derived(s);
    refresh_memory();
  }
  void place_walls() override {
    const bool stand = std::visit([](auto t) { return decltype(t)::has_particles; }, world_.treatment);
    if (stand) walls::place(world_.w, world_.walls, world_.fluid_total, world_.w.support());
  }

 private:
  static constexpr std::size_t S = operators::symmetric_terms(D);

  // A cell of the lattice; particles of a file that are more or fewer share the box.
  void share_volume() {
    volume_ = std::pow(world_.w.dx, D) * (static_cast<double>(on_lattice_) / static_cast<double>(world_.fluid_total));
  }
  void warm_regions() {
    auto& s = world_.w.s;
    regions::apply(ranks, o_.regions, s,
                   [&](std::size_t i, const regions::values& v) { s.T[i] = v.temperature.value_or(s.T[i]); });
  }

  struct error_measures {
    double l2, maximum;  // of the difference in temperature at the start
    double heat;         // K m^D
  };
  error_measures errors(double t) const {
    const auto& s = world_.w.s;
    const double T0 = o_.temperature_top(), L = o_.domain.length[1];
    double largest = 0.0;
    const auto [squares, heat] = liquid::exact_sums<2>(world_, [&](std::size_t i, const auto& add) {
      const double depth = L - s.x[1][i];
      const double exact = o_.reference == "plate" ? plate(T0, o_.start, o_.kappa, L, depth, t)
                                                   : half_space(T0, o_.start, o_.kappa, depth, t);
      const double e = (s.T[i] - exact) / (o_.start - T0);
      add(e * e, s.T[i] * volume_);
      largest = std::max(largest, std::abs(e));
    });
    return {std::sqrt(squares / static_cast<double>(world_.fluid_total)), ranks.maximum(largest), heat};
  }

  void declare_evaluation() {
    auto& e = evaluation_;
    auto& s = world_.w.s;
    e.integrate(s.T, {.name = "T", .scale = std::abs(o_.start - o_.temperature_top())});
    e.given({s.k, s.dV, plain_, B_});
    if (o_.sources.any()) e.given({s.x});
    sources_.declare(o_.sources, world_, e);
    e.mirrored(walls::temperature(s.T));
    std::visit(
        [&]<class Treatment>(Treatment t) {
          if constexpr (Treatment::has_particles)
            e.walls("walls", {.at_neighbours = {s.T}, .gives = {s.T}},
                    [this, t] { t.kinematics(world_.w, world_.walls); });
        },
        world_.treatment);
    if (consistent_)
      declare_consistent(e);
    else
      declare_plain(e);
    sources_.account(e, o_.heat_capacity * std::abs(o_.start - o_.temperature_top()));
    e.complete(passes::behind<D>(world_));
  }
  // K/s
  double warming(std::size_t i) const { return (*world_.w.heating)[i] / o_.heat_capacity; }
  void declare_plain(passes::evaluation<D>& e) {
    auto& s = world_.w.s;
    e.sum("conduction", {.at_neighbours = {s.T, s.k, s.dV}, .writes = {heat_}}, [this, &s](const auto& rows) {
      std::fill(heat_.begin() + static_cast<std::ptrdiff_t>(rows.first),
                heat_.begin() + static_cast<std::ptrdiff_t>(rows.last), 0.0);
      world_.w.sum(rows, diffusion::conduction<D>{s.T.data(), s.k.data(), s.dV.data(), heat_.data()});
    });
    e.each("rates", {.reads = {heat_, passes::of_sources(world_)}, .rates = {s.T}}, [this](std::size_t i) {
      evaluation_.rate(0)[i] = heat_[i] / volume_;
      if (world_.w.heating != nullptr) evaluation_.rate(0)[i] += warming(i);
    });
  }
  void declare_consistent(passes::evaluation<D>& e) {
    auto& s = world_.w.s;
    e.sum("conduction",
          {.reads = {B_},
           .at_neighbours = {s.T, plain_},
           .writes = {next_B_, gradient_, next_plain_},
           .accumulates = {s.T}},
          [this, &s](const auto& rows) {
            bool singular = false;
            operators::consistent<D, 1, true, ~0U, true> term{{s.T.data()}, {plain_.data()}, {}, volume_, beta_,
                                                              {},           &singular};
            term.B = B_.read();
            term.out.next_B = next_B_.data();
            term.out.gradient[0] = gradient_.data();
            term.out.laplacian[0] = evaluation_.rate(0);
            term.out.plain[0] = next_plain_.data();
            world_.w.sum(rows, term);
            if (singular) world_.w.first_fault.report(0, "particles lie so that a gradient is not determined");
          });
    e.each("rates", {.reads = passes::of_sources(world_), .rates = {s.T}}, [this](std::size_t i) {
      evaluation_.rate(0)[i] *= o_.kappa;
      if (world_.w.heating != nullptr) evaluation_.rate(0)[i] += warming(i);
    });
  }
  // The Laplacian is odd where the temperature less the wall's is: there it is zero.
  void refresh_memory() { walls::update_ghosts_and_images(world_.w, world_.walls, walls::odd_temperature(plain_)); }

  const options& o_;
  run::state<D> world_;
  double volume_ = 0.0, beta_ = 0.0;
  std::int64_t on_lattice_ = 0;  // particles
  // The plain Laplacian that the correction lags behind, and the tensor B (operators/consistent.hpp), of the last step.
  particles::array& plain_ = particles::declare(world_.w.s, "LaplacianOfT", "K/m^2", particles::role::memory);
  particles::vector_field<S> B_ =
      particles::declare_vector<S>(world_.w.s, "LaplacianWeight", "1", particles::role::memory);
  // An evaluation leaves the next ones, and ∇T, where the operator is not the plain sum.
  const bool consistent_ = o_.scheme != "sum";
  particles::array& next_plain_ =
      particles::declare_if(consistent_, world_.w.s, "NextLaplacianOfT", "K/m^2", particles::role::derived);
  particles::vector_field<S> next_B_ =
      particles::declare_vector_if<S>(consistent_, world_.w.s, "NextLaplacianWeight", "1", particles::role::derived);
  particles::vector_field<D> gradient_ =
      particles::declare_vector_if<D>(consistent_, world_.w.s, "GradientOfT", "K/m", particles::role::derived);
  particles::array& heat_ = particles::declare_if(!consistent_, world_.w.s, "Heating", "W", particles::role::derived);
  passes::evaluation<D> evaluation_{world_};
  sources::fields<D> sources_;
};

}  // namespace tetsuame::conduction
