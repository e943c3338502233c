// Two fluids of different density under gravity, or more, compressible and viscous, in a box: metal over silicate, or a
// drop (docs/theory/core_formation.md).
//
//   dx/dt = v,   ξ² m dv/dt = pressure + viscosity + surface tension (terms.hpp) + m g
//   volume number_density:  ΔV_i = s/Σ_j W_ij,  ρ = m/ΔV;  s: the sum over the start lattice
//   volume our_method [S0]:  ρ by continuity, with δ-SPH on the dynamic pressure (δ = 0: the notes' programs)
//   reference pressure p_r(y) = ρ_l g (L_y - y), ρ_l the lightest density: p - p_r in the forces, and -ΔV ∇p_r
//   pressure: p̂, or Σ Y W over Σ ΔV W
//   temperature: constant, or dT/dt = γ_th T dlnρ/dt + (friction + conduction)/(m c_V);
//     or out of the heat content, dh/dt = (friction + conduction)/m, with which materials melt (melting/melting.hpp)
//   variable inertia: ξ² of the input, times η/η_x where η is above η_x (docs/theory/relaxation.md)
//   slowed sound: slowing.hpp
//
// Start: start.hpp; one evaluation: evaluation.hpp; steps: step_limit.hpp; what is measured: measures.hpp, and
// told: report.hpp.
#pragma once

#include <fmt/ranges.h>

#include <liquid/scheme.hpp>
#include <output/groups.hpp>
#include <two_fluids/evaluation.hpp>
#include <two_fluids/report.hpp>
#include <two_fluids/step_limit.hpp>

namespace tetsuame::two_fluids {

// ---- the problem -----------------------------------------------------------------------------

template <int D>
class problem : public liquid::problem<D> {
 public:
  using base = liquid::problem<D>;
  using base::scheme_;

  // scheme: of a program; none: that of terms.hpp, as the input says.
  problem(problem_kind kind, const options& o, const parameters& p, std::unique_ptr<liquid::scheme<D>> scheme = {})
      : base(f_.world, o.common, std::move(scheme)), f_(kind, o, p, scheme_ != nullptr) {
    if (scheme_) {
      f_.carried = scheme_->carried() == volume::carries::density;
      f_.weighed = scheme_->carried() == volume::carries::weight;
    }
    set_up(f_);
    place_fluid(f_);
    find_reference(f_);
    bounds_ = find_limit(f_);
    f_.world.walls.force = walls::make_boundary_force(f_.world.w.dx, bounds_.fastest_sound);
    f_.bodies.contact = {.gravity = f_.o.gravity, .deepest = f_.world.walls.force.range};
    if (scheme_) begin_scheme();
    passes_.declare(1e-2 * bounds_.fastest_sound, f_.p.base->at(0.0));
    this->about = f_.p.lines;
  }

  std::vector<integrators::field> fields() override { return passes_.e.fields(); }
  void sum_rates(std::span<double* const> rate) override { passes_.e.run(rate); }
  // Sound and diffusion over the narrowest kernel.
  integrators::step_limit largest_step() override {
    const double n = narrowest(f_);
    return {bounds_.step.dt * n * n, bounds_.step.name};
  }
  double sound_of_start() override { return bounds_.fastest_sound; }
  bool starts_anew() const override { return !f_.p.mode; }
  double diffusion_radius() override {
    const double n = narrowest(f_);
    return bounds_.radius / (n * n);
  }
  void commit_lagged() override {
    if (f_.follows) follow_volumes(f_);
    base::commit_lagged();
  }

  // From one line of the history to the next, as far as the run goes on: the same lines in a continued run.
  std::string refine_particles(double) override {
    const bool fell = m_.dissipated < m_.dissipated_most * (1.0 - 1e-6);
    m_.dissipated_most = std::max(m_.dissipated_most, m_.dissipated);
    if (!fell || !f_.fourth_order()) return {};
    f_.second_order = true;
    bounds_ = find_limit(f_);
    return "the energy dissipated fell: the viscous sum is of second order from here on";
  }

  // Supports take a part of the skin, and particles the rest.
  run::apart moved() override {
    run::apart all = base::moved();
    if (f_.follows && supports(f_).have_no_room(f_.world.w.s.fluid)) all.numbers[run::apart::at_least] = allowance();
    return all;
  }
  double allowance() const override { return 0.5 * (f_.world.skin - room_to_grow(f_)); }
  std::vector<output::history_column> measured_columns() const override {
    std::vector<output::history_column> all;
    for (const auto& [column, value] : columns_of(f_)) all.push_back(column);
    for (auto& column : columns_of_materials(f_)) all.push_back(std::move(column));
    return all;
  }
  std::vector<double> measure(double t) override {
    next_line(m_, f_, t);
    base::note_density_excess(m_.density_excess);
    std::vector<double> values;
    for (const auto& [column, value] : columns_of(f_)) values.push_back(m_.*value);
    for (const auto& of : m_.further) values.push_back(of.centroid);
    return values;
  }
  void report_results(double, run::summary& r) override { tell(r, m_, f_); }

  std::vector<output::particle_group> particle_groups(std::vector<particles::array>& extra) override {
    const auto& s = f_.world.w.s;
    auto g = output::group_of(s, 0, 0, s.fluid);
    const auto add = [&](const char* name, const double* values) { output::add_quantity(g, name, {values}); };
    const auto& of_kernel = kernels::find(f_.o.common.kernel.name);
    add("Masses", s.m.data());
    add("Density", s.rho.data());
    add("Pressure", s.p.data());
    add("Temperature", s.T.data());
    add("SmoothingLength", output::make_array(extra, s.fluid, [&](auto i) {
          return f_.follows ? f_.S[i] / of_kernel.support_over_h : f_.h;
        }));
    add("Material", output::make_array(extra, s.fluid, [&](auto i) { return static_cast<double>(s.material[i]); }));
    g.columns.back().names = fmt::format("{}", fmt::join(f_.o.names(), ", "));
    add("Volume", s.dV.data());
    add("DensityReference", f_.rho_start.data());
    if (f_.dissolved) add("Concentration", f_.element.data());
    if (f_.enthalpy) {
      add("Viscosity", s.eta.data());
      add("MeltFraction", f_.melt.data());
    }
    if (!f_.has_bodies) return {g};
    return {g, rigid::group_of_walls(f_.world, f_.h, extra)};
  }

  void save_globals(output::checkpoint_globals& g) const override {
    base::save_globals(g);
    two_fluids::save(m_, f_, g);
  }
  void restore_globals(const output::checkpoint_globals& g) override {
    base::restore_globals(g);
    if (!f_.has_bodies) f_.placed = f_.world.fluid_total;
    m_ = restored(f_, g);
    bounds_ = find_limit(f_);
  }

 protected:
  void make_lists(bool as_they_were) override {
    two_fluids::make_lists(f_, as_they_were);
    if (f_.follows && !settled_ && !as_they_were) settle_supports(f_);
    settled_ = true;
  }
  void place_walls() override { two_fluids::place_walls(f_); }
  std::int64_t put_out_of_bodies() override { return f_.has_bodies ? rigid::put_out_of_bodies(f_.bodies) : 0; }

 private:
  void begin_scheme() {
    auto& s = f_.world.w.s;
    two_fluids::place_walls(f_);
    if (f_.slows)
      scheme_->rule = [this](std::size_t first, std::size_t last) { slow_equation_of_state(f_, first, last); };
    scheme_->begin(f_.world);
    for (std::size_t i = 0; i < s.fluid; ++i) s.Y[i] = s.p_eos[i] * s.m[i] / s.rho[i];
  }

  fluids<D> f_;
  list_of_passes<D> passes_{f_, scheme_.get()};
  measures m_;
  step_bounds bounds_;
  bool settled_ = false;  // the supports of the start
};

}  // namespace tetsuame::two_fluids
