// Gas with contacts and shocks, by one of the schemes of module schemes, as a problem of the time loop. Integrated: x,
// v, u, and α where it depends on time or ρ where it follows from continuity. Supports stay during a step; from one to
// the next they take a step of Newton's method (schemes/common.hpp). What a scheme conserves it does whatever h and f
// are, so they need not be converged.
#pragma once

#include <gas/convergence.hpp>
#include <gas/measures.hpp>
#include <gas/rates.hpp>
#include <gas/start.hpp>
#include <run/box.hpp>

namespace tetsuame::gas {

template <int D>
class flow : public run::problem_in_a_box<D> {
 public:
  using base = run::problem_in_a_box<D>;
  using base::ranks;

  flow(const options& o, const std::vector<level>& coarser)
      : base(g_, o.common.balance), g_(o, make_setup(o)), coarser_(coarser) {
    set_up(g_);
  }

  std::vector<integrators::field> fields() override { return integrated_fields(g_); }

  bool evaluable() override {
    const auto& s = g_.w.s;
    double least = std::numeric_limits<double>::infinity();
    if (g_.o.any_eos()) return true;
    for (std::size_t i = 0; i < s.fluid; ++i) least = std::min(least, s.u[i]);
    return ranks().minimum(least) > 0.0;
  }
  void evaluate(std::span<double* const> rate) override { gas::evaluate(g_, rate); }

  // Sound and approach, Δt = cfl · 2 Δx_i/max_j(c_i + c_j - 3 min(w_ij, 0)).
  integrators::step_limit largest_step() override {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < g_.w.s.fluid; ++i) {
      const double spacing = g_.S[i] / g_.support_over_dx, signal = std::max(g_.signal[i], 2.0 * g_.sound_speed(i));
      least = std::min(least, 2.0 * spacing / signal);
    }
    return {*g_.o.common.time.cfl * ranks().minimum(least), "sound"};
  }
  double moved() override { return gas::moved(g_); }
  double allowance() const override { return gas::allowance(g_); }

  void keep_memory() override { next_supports(g_); }
  bool set_time(double t) override {
    time_ = t;
    return false;
  }

  std::vector<output::history_column> columns() const override {
    std::vector<output::history_column> all{
        {"kinetic_energy", "J"}, {"internal_energy", "J"}, {"momentum_x", "kg m/s"}, {"density_max", "kg/m^3"}};
    for (const trace& t : g_.test.traces) all.push_back({t.name, t.unit});
    return all;
  }
  std::vector<double> row(double time) override {
    const totals<D> now = sum_up(g_);
    if (!first_) first_ = now;
    std::vector<double> all{now.kinetic, now.internal, now.momentum[0], largest_density(g_)};
    std::vector<double> sample{time};
    for (const trace& t : g_.test.traces) sample.push_back(t.value(particles_seen(g_)));
    all.insert(all.end(), sample.begin() + 1, sample.end());
    samples_.push_back(std::move(sample));
    return all;
  }
  std::vector<output::particle_group> snapshot(std::vector<particles::array>& extra) override {
    return {gas::snapshot(g_, time_, extra)};
  }

  void report(double t, run::summary& r) override {
    const totals<D> now = sum_up(g_);
    r.conservation = {{"mass", now.mass / first_->mass - 1.0},
                      {"momentum", momentum_change(g_, now, *first_)},
                      {"energy", now.energy() / first_->energy() - 1.0}};
    r.metrics["test"] = g_.o.shock.test;
    r.metrics["scheme"] = g_.o.shock.scheme;
    for (const auto& [name, value] : g_.test.known) r.metrics[name] = run::or_null(value);
    if (g_.test.measures)
      for (const auto& [name, value] : g_.test.measures(particles_seen(g_), samples_))
        r.metrics[name] = run::or_null(value);
    if (g_.test.exact) r.errors = errors(g_, t);
    if (!coarser_.empty()) r.errors["convergence"] = convergence(coarser_, {g_.o.domain.particles[0], t, r.errors, ""});
  }

  void save(output::checkpoint_globals& to) const override {
    base::save(to);
    if (!first_) return;
    std::vector<double> all{first_->mass, first_->kinetic, first_->internal, first_->potential, first_->momentum_scale};
    all.insert(all.end(), first_->momentum.begin(), first_->momentum.end());
    to.blobs["first_totals"] = all;
    std::vector<double>& flat = to.blobs["samples"];
    for (const auto& line : samples_) flat.insert(flat.end(), line.begin(), line.end());
  }
  void restore(const output::checkpoint_globals& from) override {
    base::restore(from);
    const auto& all = from.blobs.at("first_totals");
    first_.emplace(totals<D>{all[0], all[1], all[2], all[3], all[4], {}});
    std::copy_n(all.begin() + 5, D, first_->momentum.begin());
    const auto& flat = from.blobs.at("samples");
    const auto width = static_cast<std::ptrdiff_t>(1 + g_.test.traces.size());
    for (auto line = flat.begin(); line != flat.end(); line += width) samples_.emplace_back(line, line + width);
  }

 protected:
  void make_lists(bool as_they_were) override {
    gas::make_lists(g_, as_they_were);
    const bool at_start = !settled_ && !as_they_were;
    settled_ = true;
    if (at_start) settle(g_);
  }

 private:
  world<D> g_;
  const std::vector<level> coarser_;
  double time_ = 0.0;  // s, of the state
  bool settled_ = false;
  std::optional<totals<D>> first_;
  samples samples_;
};

}  // namespace tetsuame::gas
