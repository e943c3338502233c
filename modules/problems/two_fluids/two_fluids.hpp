// Two fluids of different density under gravity, compressible and viscous, in a box: metal over silicate, or a drop
// (docs/theory/core_formation.md).
//
//   dx/dt = v,   ξ² m dv/dt = pressure + viscosity + surface tension (terms.hpp) + m g
//   volume number_density:  ΔV_i = s/Σ_j W_ij,  ρ = m/ΔV;  s: the sum over the start lattice
//   volume our_method [S0]:  ρ by continuity, with δ-SPH on the dynamic pressure (δ = 0: the notes' programs)
//   reference pressure p_r(y) = ρ_l g (L_y - y), ρ_l the lightest density: p - p_r in the forces, and -ΔV ∇p_r
//   pressure: p̂, or Σ Y W over Σ ΔV W
//   temperature: constant, or dT/dt = γ_th T dlnρ/dt + (friction + conduction)/(m c_V);
//     or out of the heat content, dh/dt = (friction + conduction)/m, with which material 0 melts (melting/melting.hpp)
//   variable inertia: ξ² of the input, times η/η_x where η is above η_x (docs/theory/relaxation.md)
//   slowed sound: slowing.hpp
//
// Start: start.hpp; one evaluation: right_hand_side.hpp; steps: step_limit.hpp; what is measured: measures.hpp, and
// told: report.hpp.
#pragma once

#include <liquid/scheme.hpp>
#include <output/groups.hpp>
#include <two_fluids/report.hpp>
#include <two_fluids/right_hand_side.hpp>
#include <two_fluids/step_limit.hpp>

namespace tetsuame::two_fluids {

// ---- by the scheme of a program: volumes, pressure, walls, forces are the scheme's ----------

// Where the scheme puts its rates; those that nobody integrates, where nothing reads them.
template <int D>
liquid::rates<D> rates_of_scheme(fluids<D>& f, const places_of_rates<D>& at, std::span<double* const> rate) {
  liquid::rates<D> out;
  for (std::size_t a = 0; a < D; ++a) {
    out.dx[a] = rate[at.x + a];
    out.dv[a] = rate[at.v + a];
  }
  out.du = rate[at.u];
  out.friction = rate[at.q];
  if (f.o.conductivity > 0.0) out.conducted = f.conducted.data();
  if (f.carried || f.weighed) out.volume = rate[at.rho];
  out.dT = f.warms ? rate[at.T] : f.heat.data();
  return out;
}

// u is of compression alone; the heat of friction and conduction stands apart.
template <int D>
void part_heat(fluids<D>& f, const places_of_rates<D>& at, std::span<double* const> rate) {
  const auto& s = f.world.w.s;
  foundation::for_all(s.fluid, [&](std::size_t i) {
    const double conducted = f.o.conductivity > 0.0 ? f.conducted[i] / s.m[i] : 0.0;
    const double heating = rate[at.q][i] + conducted;
    rate[at.u][i] -= heating;
    if (f.enthalpy) rate[at.h][i] = heating;
    if (!f.enthalpy || f.inertia[i] == 1.0) return;
    for (std::size_t a = 0; a < D; ++a) rate[at.v + a][i] /= f.inertia[i];
  });
}

// Nothing dissolved in what stands behind walls takes part.
template <int D>
void exchange_element(fluids<D>& f, const places_of_rates<D>& at, std::span<double* const> rate) {
  auto& s = f.world.w.s;
  find_partition(f);
  if (!f.world.mirrors())
    for (std::size_t i = s.first_wall(); i < s.total(); ++i) {
      f.mobility[i] = f.element[i] = f.metal[i] = 0.0;
      f.partition[i] = 1.0;
    }
  exchange_element(f, f.world.w.fluid());
  foundation::for_all(s.fluid, [&](std::size_t i) { rate[at.c][i] = f.gain[i] / s.m[i]; });
}

template <int D>
void evaluate(fluids<D>& f, liquid::scheme<D>& scheme, std::span<double* const> rate) {
  auto& w = f.world.w;
  const places_of_rates<D> at(f);
  if (f.enthalpy) {
    scheme.recall_density(f.world);
    volume::equation_of_state(w, w.s.fluid);
    find_phases(f);
  }
  scheme.evaluate(f.world, rates_of_scheme(f, at, rate));
  part_heat(f, at, rate);
  if (f.dissolved) exchange_element(f, at, rate);
}

// ---- the problem -----------------------------------------------------------------------------

template <int D>
class problem : public liquid::problem<D> {
 public:
  using base = liquid::problem<D>;
  using base::scheme_;

  // scheme: of a program; none: that of terms.hpp, as the input says.
  problem(problem_kind kind, const options& o, const parameters& p, std::unique_ptr<liquid::scheme<D>> scheme = {})
      : base(f_.world, o.common.balance, std::move(scheme)), f_(kind, o, p, scheme_ != nullptr) {
    if (scheme_) {
      f_.carried = scheme_->carried() == volume::carries::density;
      f_.weighed = scheme_->carried() == volume::carries::weight;
    }
    set_up(f_);
    place_fluid(f_);
    find_reference(f_);
    bounds_ = find_limit(f_);
    f_.world.walls.force = walls::make_boundary_force(f_.world.w.dx, bounds_.fastest_sound);
    if (scheme_) begin_scheme();
    this->about = f_.p.lines;
  }

  std::vector<integrators::field> fields() override {
    auto& s = f_.world.w.s;
    constexpr std::array<const char*, 3> axis{"x", "y", "z"};
    const double fast = 1e-2 * bounds_.fastest_sound;
    const auto& e = f_.o.element;
    std::vector<integrators::field> all;
    for (std::size_t a = 0; a < D; ++a)
      all.push_back({axis[a], s.x[a].data(), 0.0, f_.world.w.dx, 0.0, f_.world.w.frame[a]});
    for (std::size_t a = 0; a < D; ++a) all.push_back({std::string("v") + axis[a], s.v[a].data(), 0.0, fast});
    all.push_back({"u", s.u.data(), 0.0, fast * fast});
    all.push_back({"q", f_.dissipated.data(), 0.0, fast * fast});
    if (f_.weighed) all.push_back({"Y", s.Y.data(), 0.0, f_.p.base->at(0.0).pressure * std::pow(f_.world.w.dx, D)});
    if (f_.carried) all.push_back({"rho", s.rho.data(), 0.0, f_.p.base->at(0.0).density});
    if (f_.warms) all.push_back({"T", s.T.data(), 0.0, f_.o.temperature});
    if (f_.dissolved)
      all.push_back({"c", f_.element.data(), 0.0, std::max(e.concentration_silicate, e.concentration_metal)});
    if (f_.enthalpy) all.push_back({"h", f_.content.data(), 0.0, 1e3 * f_.o.temperature});
    return all;
  }

  void sum_rates(std::span<double* const> rate) override {
    if (scheme_)
      two_fluids::evaluate(f_, *scheme_, rate);
    else
      two_fluids::evaluate(f_, rate);
  }
  // Sound and diffusion over the narrowest kernel.
  integrators::step_limit largest_step() override {
    const double n = narrowest(f_);
    return {bounds_.step.dt * n * n, bounds_.step.name};
  }
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
    if (f_.follows && grown(f_) >= room_to_grow(f_) * (1.0 - 1e-9)) all.numbers[run::apart::at_least] = allowance();
    return all;
  }
  double allowance() const override { return 0.5 * (f_.world.skin - room_to_grow(f_)); }
  std::vector<output::history_column> columns() const override {
    std::vector<output::history_column> all;
    for (const auto& [column, value] : columns_of(f_)) all.push_back(column);
    return all;
  }
  std::vector<double> measure(double t) override {
    next_line(m_, f_, t);
    base::note_density_excess(m_.density_excess);
    std::vector<double> values;
    for (const auto& [column, value] : columns_of(f_)) values.push_back(m_.*value);
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
    add("Material", output::make_array(extra, s.fluid, [&](auto i) { return f_.is_metal(i) ? 1.0 : 0.0; }));
    add("Volume", s.dV.data());
    add("DensityReference", f_.rho_start.data());
    if (f_.dissolved) add("Concentration", f_.element.data());
    if (f_.enthalpy) {
      add("Viscosity", s.eta.data());
      add("MeltFraction", f_.melt.data());
    }
    return {g};
  }

  void save_globals(output::checkpoint_globals& g) const override {
    base::save_globals(g);
    two_fluids::save(m_, f_, g);
  }
  void restore_globals(const output::checkpoint_globals& g) override {
    base::restore_globals(g);
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

 private:
  void begin_scheme() {
    auto& s = f_.world.w.s;
    two_fluids::place_walls(f_);
    scheme_->begin(f_.world);
    for (std::size_t i = 0; i < s.fluid; ++i) s.Y[i] = s.p_eos[i] * s.m[i] / s.rho[i];
  }

  fluids<D> f_;
  measures m_;
  step_bounds bounds_;
  bool settled_ = false;  // the supports of the start
};

}  // namespace tetsuame::two_fluids
