// A scheme for liquids, as problems see it: what it carries, and its rates; what problems have in common by it. What it
// consists of, a program names (scheme_of.hpp).
#pragma once

#include <functional>
#include <liquid/rates.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <passes/evaluation.hpp>
#include <run/particle_simulation.hpp>

namespace tetsuame::liquid {

template <int D>
class scheme {
 public:
  virtual ~scheme() = default;

  // The problem's, of what the equation of state says; set before begin().
  volume::pressure_rule rule;

  // ρ, Y or nothing is integrated beside x, v, T and u.
  virtual volume::carries carried() const = 0;
  // When the particles of the start are in their places, with ρ, T and m.
  virtual void begin(run::state<D>& box) = 0;
  // ρ where it is remembered.
  virtual void recall_density(run::state<D>&) const {}
  // Its passes, after those that are there. viscosity_changes: one of these writes it. rates: the integrated fields
  // that the last pass serves; out(): where the rates stand, but for heat and dlnrho, which are the scheme's.
  virtual void declare(run::state<D>& box, passes::evaluation<D>& e, const passes::fields& rates,
                       bool viscosity_changes, std::function<liquid::rates<D>()> out) = 0;

  // As of run::particle_simulation.
  virtual void commit_lagged(run::state<D>&) {}
  virtual void begin_tables(run::run_directory&) {}
  virtual void expect_counts(bool) {}
  virtual void complete_tables(std::int64_t /*step*/) {}
  virtual void fail(const foundation::error&, std::int64_t /*step*/, run::summary&) {}
  virtual void report(const run::state<D>&, nlohmann::ordered_json& /*metrics*/) const {}
  virtual void save(output::checkpoint_globals&) const {}
  virtual void restore(const output::checkpoint_globals&) {}
};

// A problem that a scheme carries through, with what the scheme has to remember, to tell and to save. None: the problem
// has sums of its own.
template <int D>
class problem : public run::particle_simulation<D> {
 public:
  using base = run::particle_simulation<D>;

  problem(run::state<D>& of_problem, const run::common_options& o, std::unique_ptr<scheme<D>> how)
      : base(of_problem, o), scheme_(std::move(how)) {}

  void commit_lagged() override {
    if (scheme_) scheme_->commit_lagged(this->box);
  }
  void expect_counts(bool counted) override {
    if (scheme_) scheme_->expect_counts(counted);
  }
  void complete_tables(std::int64_t step) override {
    if (scheme_) scheme_->complete_tables(step);
  }
  bool complete_step(std::int64_t step) override {
    complete_tables(step);
    return base::complete_step(step);
  }
  void begin_tables(run::run_directory& files) override {
    base::begin_tables(files);
    if (scheme_) scheme_->begin_tables(files);
  }
  void report_failure(const foundation::error& e, std::int64_t step, run::summary& r) override {
    if (scheme_) scheme_->fail(e, step, r);
  }
  void report_counts(run::summary& r) override {
    base::report_counts(r);
    if (scheme_) scheme_->report(this->box, r.metrics);
  }
  void save_globals(output::checkpoint_globals& g) const override {
    base::save_globals(g);
    if (scheme_) scheme_->save(g);
  }
  void restore_globals(const output::checkpoint_globals& g) override {
    base::restore_globals(g);
    if (scheme_) scheme_->restore(g);
  }

 protected:
  std::unique_ptr<scheme<D>> scheme_;
};

// A program that runs liquids: its name, the walls it has unless the input says otherwise, and its scheme.
struct program {
  const char* name;
  const char* wall;
  bool iterates;           // for Y, to a tolerance
  bool integrates_volume;  // ρ or Y is integrated
  bool integrates_weight;  // Y is
  bool remembers_density;  // ρ is known before an evaluation, from what is carried or remembered
  bool by_number;          // volumes are those of the number density, pressures those of the equation of state
  std::function<std::unique_ptr<scheme<2>>(const volume::options&)> in_2d;
  std::function<std::unique_ptr<scheme<3>>(const volume::options&)> in_3d;
};

}  // namespace tetsuame::liquid
