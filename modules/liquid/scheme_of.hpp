// The scheme that a program lists:
//
//   struct program_c {
//     static constexpr const char* name = "disph_c";
//     using volume = …;    how Y and ΔV come about
//     using pressure = …;  smoothed or not
//     using wall = …;      the treatment unless the input says otherwise
//     using gradient = …;  the form of the pressure gradient
//   };
#pragma once

#include <liquid/evaluation.hpp>
#include <liquid/scheme.hpp>
#include <optional>

namespace tetsuame::liquid {

template <class Program, int D>
class scheme_of : public scheme<D> {
 public:
  using volume_module = typename Program::volume;
  static constexpr bool iterates = requires(volume_module v) { v.residuals; };

  explicit scheme_of(const volume::options& o) : options_(o) {
    if constexpr (iterates) how_.how = o.hosono;
  }

  volume::carries carried() const override { return volume_module::carried; }

  void begin(run::state<D>& box) override {
    auto& w = box.w;
    volume::equation_of_state(w, 0, w.s.fluid, this->rule);
    if (options_.energy.internal()) particles::declare(w.s, start_energy, "J/kg", particles::role::constant);
    if constexpr (iterates) {
      volume::add_density_guess(w.s);
      start_kappa_ = volume::detail::largest_kappa(w);
    }
  }
  void recall_density(run::state<D>& box) const override {
    if constexpr (iterates)
      std::copy_n(particles::extra(box.w.s, volume::density_guess).begin(), box.w.s.fluid, box.w.s.rho.begin());
  }
  void declare(run::state<D>& box, passes::evaluation<D>& e, const passes::fields& rates, bool viscosity_changes,
               std::function<liquid::rates<D>()> out) override {
    list_.emplace(box, how_, options_, this->rule);
    list_->declare(e, rates, viscosity_changes, std::move(out));
  }

  // The iteration for Y starts from what it found at the last state that was reached. The start value
  // moves on only when the rate there is known, so that a restart, which has to find that rate
  // again, finds the same bits.
  void commit_lagged(run::state<D>& box) override {
    if constexpr (iterates)
      std::copy_n(box.w.s.rho.begin(), box.w.s.fluid, particles::extra(box.w.s, volume::density_guess).begin());
  }

  void begin_tables(run::run_directory& files) override {
    if constexpr (iterates)
      residuals_ = &files.table("residuals.csv", {{"evaluation", "1"}, {"iteration", "1"}, {"residual", "1"}});
  }
  void expect_counts(bool counted) override {
    if constexpr (iterates) how_.counts = counted;
  }
  void complete_tables(std::int64_t step) override {
    if constexpr (iterates) {
      append_residuals(step);
      how_.residuals.clear();
    }
  }
  void fail(const foundation::error& e, std::int64_t step, run::summary& r) override {
    if (const auto* diverged = dynamic_cast<const volume::divergence*>(&e)) {
      r.status = "diverged";
      r.diverged_step = step + 1;
      r.diverged_iteration = diverged->iteration();
    }
    if constexpr (iterates) append_residuals(step + 1);
  }

  void report(const run::state<D>& box, nlohmann::ordered_json& metrics) const override {
    if constexpr (iterates) {
      metrics["hosono_solver"] = how_.how.solver;
      metrics["hosono_passes"] = how_.passes;
      metrics["hosono_evaluations"] = how_.evaluations;
      metrics["hosono_kappa"] = start_kappa_;
      metrics["hosono_growth_predicted"] =
          (start_kappa_ - 1.0) * (1.0 - kernels::transfer_minimum<D>(box.w.kernel, box.w.dx).value);
    }
  }
  void save(output::checkpoint_globals& g) const override {
    if constexpr (iterates) {
      g.integers["hosono_evaluations"] = how_.evaluations;
      g.integers["hosono_passes"] = how_.passes;
    }
  }
  void restore(const output::checkpoint_globals& g) override {
    if constexpr (iterates) {
      how_.evaluations = g.integers.at("hosono_evaluations");
      how_.passes = g.integers.at("hosono_passes");
    }
  }

 private:
  // residuals.csv: the course of Hosono's iteration in every evaluation of the right-hand side.
  void append_residuals(std::int64_t step) {
    if (residuals_ == nullptr) return;  // no run: its tables were not begun
    for (const auto& r : how_.residuals)
      residuals_->append(step,
                         std::array{static_cast<double>(r.evaluation), static_cast<double>(r.iteration), r.residual});
  }

  volume_module how_{};
  const volume::options options_;
  std::optional<list_of_passes<Program, D>> list_;
  output::history* residuals_ = nullptr;
  double start_kappa_ = 0.0;  // K_T/p of the start state, at its largest
};

template <class Program>
program describe() {
  using scheme = scheme_of<Program, 2>;
  return {.name = Program::name,
          .wall = Program::wall::name,
          .iterates = scheme::iterates,
          .integrates_volume = scheme::volume_module::carried != volume::carries::nothing,
          .integrates_weight = scheme::volume_module::carried == volume::carries::weight,
          .remembers_density = scheme::iterates || scheme::volume_module::carried == volume::carries::density,
          .by_number = std::is_same_v<typename Program::volume, volume::number_density> &&
                       !std::is_same_v<typename Program::pressure, volume::smoothed>,
          .in_2d = [](const volume::options& o) { return std::make_unique<scheme_of<Program, 2>>(o); },
          .in_3d = [](const volume::options& o) { return std::make_unique<scheme_of<Program, 3>>(o); }};
}

}  // namespace tetsuame::liquid
