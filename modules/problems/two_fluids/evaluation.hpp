// The right-hand side of two fluids as a list of passes; the sums are those of terms.hpp:
//   1. ΔV and ρ, the pressure of the equation of state; temperature, melt, partition by them
//   2. the pressure in the forces
//   3. sums over neighbours: pressure and friction, continuity, conduction, exchange
//   4. rates of what is integrated
// or, in the place of volumes, pressure and forces, the passes of a program's scheme (liquid/evaluation.hpp).
#pragma once

#include <liquid/scheme.hpp>
#include <two_fluids/behind_bodies.hpp>
#include <two_fluids/slowing.hpp>
#include <two_fluids/sums.hpp>

namespace tetsuame::two_fluids {

// Temperature and melt of particle i out of its heat content, at the pressure of the equation of state; viscosity and
// inertia by them.
template <int D>
void find_phase(fluids<D>& f, std::size_t i) {
  auto& s = f.world.w.s;
  const auto& law = f.melting_of(i);
  const auto here = contents(f, i, s.p_eos[i]).at(f.content[i]);
  s.T[i] = here.temperature;
  f.melt[i] = law.curve == "none" ? 0.0 : here.melt_fraction;
  if (law.viscosity_varies()) s.eta[i] = melting::viscosity(law, s.T[i], f.melt[i]);
  f.inertia[i] = law.inertia(s.eta[i]);
}

// Partition coefficient, ρ times diffusivity, material.
template <int D>
void find_partition(fluids<D>& f, std::size_t i) {
  const auto& s = f.world.w.s;
  const auto& e = f.o.element;
  const bool metal = f.is_metal(i);
  f.metal[i] = metal ? 1.0 : 0.0;
  f.partition[i] = metal ? elements::partition_coefficient(e, s.p_eos[i], s.T[i]) : 1.0;
  f.mobility[i] = s.rho[i] * e.diffusivity(metal);
}

// ---- the list ---------------------------------------------------------------------------------

template <int D>
class list_of_passes {
 public:
  // scheme: of a program; null: the sums of terms.hpp.
  list_of_passes(fluids<D>& of, liquid::scheme<D>* scheme) : e(of.world), f_(of), scheme_(scheme) {}
  list_of_passes(const list_of_passes&) = delete;
  list_of_passes& operator=(const list_of_passes&) = delete;

  // fast: m/s, the scale of velocities. pressure, density: of the floor.
  void declare(double fast, const place& floor) {
    f_.sources.declare(f_.p.sources, f_.world, e);
    integrate(fast, floor);
    f_.sources.account(e, fast * fast);
    e.given({s_.m, s_.k});
    if (!viscosity_changes()) e.given({s_.eta});
    if (f_.enthalpy) e.remembered({s_.T});
    if (scheme_ != nullptr) return declare_scheme();
    e.mirrored(rules_at_sides(f_));
    find_volumes();
    find_pressures();
    f_.tension.declare(e);
    find_stress();
    sum_over_neighbours();
    find_rates();
    e.complete(passes::behind<D>(f_.world));
  }

  passes::evaluation<D> e;

 private:
  bool viscosity_changes() const { return f_.enthalpy && f_.o.melting.viscosity_varies(); }
  passes::fields material() { return {s_.p_eos, s_.K_T, s_.alpha, s_.c_V, s_.c}; }
  double* rate(std::size_t of, std::size_t a = 0) const { return e.rate(of + a); }

  void integrate(double fast, const place& floor) {
    const auto& element = f_.o.element;
    e.integrate_motion({0.0, 0.0, fast});
    u_ = e.integrate(s_.u, {"u", 0.0, fast * fast});
    q_ = e.integrate(f_.dissipated, {"q", 0.0, fast * fast});
    if (f_.weighed) density_ = e.integrate(s_.Y, {"Y", 0.0, floor.pressure * std::pow(w_.dx, D)});
    if (f_.carried) density_ = e.integrate(s_.rho, {"rho", 0.0, floor.density});
    if (f_.warms) T_ = e.integrate(s_.T, {"T", 0.0, f_.o.temperature});
    if (f_.isothermal()) e.given({s_.T});
    if (f_.dissolved)
      c_ = e.integrate(f_.element, {"c", 0.0, std::max(element.concentration_silicate, element.concentration_metal)});
    if (f_.enthalpy) h_ = e.integrate(f_.content, {"h", 0.0, 1e3 * f_.o.temperature});
  }

  // ---- volumes, pressure ------------------------------------------------------------------

  void find_volumes() {
    if (f_.carried) {
      e.each("volumes", {.reads = {s_.m, s_.rho}, .writes = {s_.dV}},
             [this](std::size_t i) { s_.dV[i] = s_.m[i] / s_.rho[i]; });
    } else if (f_.follows) {
      e.sum("volumes", {.writes = {f_.count, f_.count_slope}},
            [this](const pairs::row_range& rows) { count_neighbours(f_, rows); });
      e.each("volumes", {.reads = {f_.count, f_.count_slope}, .writes = {s_.dV, f_.follow_factor}},
             [this](std::size_t i) { volume_by_count(f_, i); });
    } else {
      e.sum("volumes", {.writes = {s_.dV}}, [this](const pairs::row_range& rows) { sum_volumes(f_, rows); });
    }
    // A ghost's ρ has the bits of its source's: ΔV gives it there too.
    if (!f_.carried)
      e.each("volumes", {.reads = {s_.m, s_.dV}, .writes = {s_.rho}},
             [this](std::size_t i) { s_.rho[i] = s_.m[i] / s_.dV[i]; });
  }

  void find_pressures() {
    passes::access uses{.reads = {s_.rho, s_.T}, .writes = {material()}};
    if (f_.slows) {
      uses.reads.add({s_.x, s_.m, s_.dV});
      uses.writes.add({f_.lift});
    }
    e.each("equation of state", uses, [this](std::size_t first, std::size_t last) {
      volume::equation_of_state(w_, first, last);
      if (!f_.slows) return;
      for (std::size_t i = first; i < last; ++i) {
        f_.lift[i] = find_lift(f_, i, s_.dV[i]);
        slow_pressure(f_, i);
      }
    });
    if (f_.enthalpy) find_phases();
    if (f_.dissolved) find_partitions();
    if (f_.has_bodies) {
      const passes::fields all{s_.v, s_.p_eos, s_.rho, s_.dV, s_.eta, s_.T};
      e.walls("walls", {.at_neighbours = {all, passes::of_gravity(f_.world)}, .gives = all},
              [this] { stand_behind_walls(f_); });
    }
    if (!f_.smoothed) return;
    // p̂ as Σ Y W over Σ ΔV W.
    e.each(
        "smoothing", {.reads = {s_.p_eos, s_.dV}, .writes = {s_.Y}},
        [this](std::size_t i) { s_.Y[i] = s_.p_eos[i] * s_.dV[i]; }, true);
    e.sum("smoothing", {.at_neighbours = {s_.Y, s_.dV}, .writes = {s_.p}},
          [this](const pairs::row_range& rows) { volume::smooth(w_, s_.dV, true, rows); });
    if (f_.has_bodies)
      e.walls("walls", {.at_neighbours = {s_.p, s_.rho, s_.dV, passes::of_gravity(f_.world)}, .gives = {s_.p}},
              [this] { smooth_behind_walls(f_); });
  }
  void find_phases() {
    passes::access uses{.reads = {s_.p_eos, f_.content}, .writes = {f_.melt, f_.inertia}, .updates = {s_.T}};
    if (viscosity_changes()) {
      e.remembered({s_.eta});
      uses.updates.add({s_.eta});
    }
    e.each("phases", uses, [this](std::size_t i) { find_phase(f_, i); });
  }
  void find_partitions() {
    passes::access uses{.reads = {s_.p_eos, s_.T, s_.rho}, .writes = {f_.partition, f_.mobility}};
    if (!f_.tense) uses.writes.add({f_.metal});
    e.each("element", uses, [this](std::size_t i) { find_partition(f_, i); });
  }

  // What the forces have of the pressure.
  void find_stress() {
    passes::access uses{.reads = {s_.x, s_.dV}, .writes = {f_.stress}};
    if (has_factor(f_)) uses.reads.add({f_.follow_factor});
    if (f_.smoothed)
      uses.reads.add({s_.p});
    else
      uses.reads.add({s_.p_eos}), uses.writes.add({s_.p});
    e.each(
        "forces", uses,
        [this](std::size_t i) {
          if (!f_.smoothed) s_.p[i] = s_.p_eos[i];
          f_.stress[i] = (s_.p[i] - f_.reference_pressure(s_.x[1][i])) * element_of_work(f_, i);
          if (has_factor(f_)) f_.stress[i] *= f_.follow_factor[i];
        },
        true);
  }

  // ---- sums and rates ---------------------------------------------------------------------

  void sum_over_neighbours() {
    e.sum("forces", {.at_neighbours = {s_.v, f_.stress, s_.dV, s_.eta}, .writes = {f_.force, f_.compression, f_.heat}},
          [this](const pairs::row_range& rows) {
            f_.p.symmetric_stress ? sum_forces<D, true>(f_, rows) : sum_forces<D, false>(f_, rows);
          });
    if (f_.carried)
      e.sum("continuity", {.reads = {s_.c}, .at_neighbours = {s_.v, s_.dV, s_.p_eos, s_.rho}, .writes = {f_.rho_rate}},
            [this](const pairs::row_range& rows) { sum_density_rate(f_, rows); });
    if ((f_.carried || f_.warms) && !f_.follows && f_.world.walls.any_no_slip()) add_slip_to_continuity();
    if (f_.o.conducts())
      e.sum("conduction", {.at_neighbours = {s_.T, s_.k, s_.dV}, .writes = {f_.conducted}},
            [this](const pairs::row_range& rows) { conduct(f_, rows); });
    if (!f_.dissolved) return;
    if (f_.has_bodies) {
      const passes::fields all{f_.element, f_.mobility, f_.metal, f_.partition};
      e.walls("element", {.at_neighbours = all, .gives = all}, [this] { dissolve_nothing_in_bodies(f_); });
    }
    add_element_exchange();
  }
  // Beside walls of no slip (walls/slip_continuity.hpp).
  void add_slip_to_continuity() {
    f_.world.walls.asks_near_no_slip = true;
    slip_ = particles::declare_vector<D>(s_, "WallSlip", "m/s", particles::role::derived);
    auto& dlnrho = particles::declare(s_, "LogDensityRateOfSlip", "1/s", particles::role::derived);
    const auto& near = f_.world.walls.near_no_slip;
    if (f_.carried)
      e.walls("continuity", {.reads = {s_.rho}, .at_neighbours = {s_.v, s_.dV}, .updates = {f_.rho_rate}},
              [this, &dlnrho, &near] {
                sum_slip<gradient::continuity<D>>(dlnrho);
                for (const std::size_t i : near.rows) f_.rho_rate[i] += s_.rho[i] * dlnrho[i];
              });
    if (f_.warms)
      e.walls("continuity", {.at_neighbours = {s_.v, s_.dV}, .updates = {f_.compression}}, [this, &dlnrho, &near] {
        sum_slip<gradient::own_continuity<D>>(dlnrho);
        for (const std::size_t i : near.rows) f_.compression[i] += dlnrho[i] / s_.dV[i];
      });
  }
  template <class Continuity>
  void sum_slip(particles::array& dlnrho) {
    for (const std::size_t i : f_.world.walls.near_no_slip.rows) dlnrho[i] = 0.0;
    walls::add_continuity_of_slip<D, Continuity>(w_, f_.world.walls, slip_, s_.dV, dlnrho);
  }
  void add_element_exchange() {
    e.sum("element", {.at_neighbours = {f_.element, f_.partition, f_.mobility, f_.metal, s_.dV}, .writes = {f_.gain}},
          [this](const pairs::row_range& rows) { exchange_element(f_, rows); });
  }

  void find_rates() {
    passes::access uses{
        .reads = {s_.m, s_.v, s_.p, s_.dV, s_.rho, material(), f_.force, f_.compression, f_.heat, f_.conducted,
                  f_.tension.force, f_.lift, f_.inertia, f_.rho_rate, f_.gain, passes::of_sources(f_.world)},
        .rates = {s_.x, s_.u, f_.dissipated}};
    (f_.has_bodies ? uses.accumulates : uses.rates).add({s_.v});
    if (has_factor(f_)) uses.reads.add({f_.follow_factor});
    if (f_.carried) uses.rates.add({s_.rho});
    if (f_.warms) uses.rates.add({s_.T});
    if (f_.dissolved) uses.rates.add({f_.element});
    if (f_.enthalpy) uses.rates.add({f_.content});
    e.each("rates", uses, [this](std::size_t i) { combine(i); });
    if (f_.has_bodies) e.whole("rates", {.reads = {s_.x, f_.inertia}, .rates = {s_.v}}, [this] { push_off_bodies(); });
  }
  void combine(std::size_t i) {
    const auto& s = s_;
    const double per_m = 1.0 / s.m[i];
    const double compression = has_factor(f_) ? f_.compression[i] * f_.follow_factor[i] : f_.compression[i];
    double heat = f_.heat[i] + (f_.o.conducts() ? f_.conducted[i] : 0.0);
    if (w_.heating != nullptr) heat += s.m[i] * (*w_.heating)[i];
    for (std::size_t a = 0; a < D; ++a) {
      const double gravity = w_.gravity(a, i);
      rate(0, a)[i] = s.v[a][i];
      double force = f_.tense ? f_.force[a][i] + f_.tension.force[a][i] : f_.force[a][i];
      if (a == 1) force -= f_.reference_slope * s.dV[i];
      if (a == 1 && f_.slows) force += f_.lift[i];
      rate(D, a)[i] = (per_m * force + gravity) / f_.inertia_of(i);
    }
    walls::push_off(f_.world.walls.force, f_.world.walls.sides, s, i,
                    [&](std::size_t axis, double a) { rate(D, axis)[i] += a / f_.inertia_of(i); });
    rate(u_)[i] = per_m * s.p[i] * element_of_work(f_, i) * compression;
    if (f_.slows) rate(u_)[i] -= per_m * f_.lift[i] * s.v[1][i];
    rate(q_)[i] = per_m * f_.heat[i];
    double dlnrho = compression * s.dV[i] / w_.lattice_sum;
    if (f_.carried) {
      rate(density_)[i] = f_.rho_rate[i];
      dlnrho = f_.rho_rate[i] / s.rho[i];
    }
    if (f_.warms) {
      const double gamma = s.alpha[i] * s.K_T[i] / (s.rho[i] * s.c_V[i]);
      rate(T_)[i] = gamma * s.T[i] * dlnrho + per_m * heat / s.c_V[i];
    }
    if (f_.dissolved) rate(c_)[i] = per_m * f_.gain[i];
    if (f_.enthalpy) rate(h_)[i] = per_m * heat;
  }

  // As combine() has it of the sides.
  void push_off_bodies() {
    for (const std::uint32_t i : f_.bodies.beside_bodies) {
      const auto in = rigid::depth_of(f_.bodies, i);
      if (!(in.depth > 0.0)) continue;
      const double a = f_.world.walls.force.stiffness * in.depth / f_.inertia_of(i);
      for (std::size_t k = 0; k < D; ++k) rate(D, k)[i] += a * in.normal[k];
    }
  }

  // ---- by the scheme of a program -----------------------------------------------------------

  void declare_scheme() {
    if (f_.enthalpy) find_phases_before_scheme();
    passes::fields rates{s_.x, f_.dissipated};
    if (f_.carried) rates.add({s_.rho});
    if (f_.weighed) rates.add({s_.Y});
    if (f_.warms) rates.add({s_.T});
    scheme_->declare(f_.world, e, rates, viscosity_changes(), [this] { return rates_of_scheme(); });
    f_.tension.declare(e);
    passes::access uses{
        .reads = {s_.x, s_.v, s_.m, s_.T, s_.rho, f_.inertia, f_.tension.force, passes::of_sources(f_.world)},
        .rates = {s_.u, s_.v}};
    if (f_.enthalpy) uses.rates.add({f_.content});
    e.each("rates", uses, [this](std::size_t i) { part_heat(i); });
    if (f_.dissolved) exchange_element_beside_scheme();
    e.complete(passes::behind<D>(f_.world));
  }
  // By the density that is carried or remembered; the pressure is the scheme's to find afterwards.
  void find_phases_before_scheme() {
    passes::access uses{.reads = {s_.x, f_.content}, .writes = {f_.melt, f_.inertia}, .updates = {s_.T}};
    if (viscosity_changes()) {
      e.remembered({s_.eta});
      uses.updates.add({s_.eta});
    }
    e.whole("phases", uses, [this] {
      scheme_->recall_density(f_.world);
      volume::equation_of_state(w_, 0, s_.fluid, scheme_->rule);
      foundation::for_all(s_.fluid, [&](std::size_t i) { find_phase(f_, i); });
    });
  }
  // Where the scheme puts its rates; those that nobody integrates, where nothing reads them.
  liquid::rates<D> rates_of_scheme() const {
    liquid::rates<D> out;
    for (std::size_t a = 0; a < D; ++a) {
      out.dx[a] = rate(0, a);
      out.dv[a] = rate(D, a);
    }
    out.du = rate(u_);
    out.friction = rate(q_);
    if (f_.o.conducts()) out.conducted = f_.conducted.data();
    if (f_.carried || f_.weighed) out.volume = rate(density_);
    out.dT = f_.warms ? rate(T_) : f_.heat.data();
    return out;
  }
  // u is of compression alone; the heat of friction, conduction and sources stands apart.
  void part_heat(std::size_t i) {
    const double conducted = f_.o.conducts() ? f_.conducted[i] / s_.m[i] : 0.0;
    double heating = rate(q_)[i] + conducted;
    if (w_.heating != nullptr) heating += (*w_.heating)[i];
    rate(u_)[i] -= heating;
    if (f_.enthalpy) rate(h_)[i] = heating;
    for (std::size_t a = 0; a < D && f_.tense; ++a) rate(D, a)[i] += f_.tension.force[a][i] / s_.m[i];
    if (f_.slows) {
      const double lift = find_lift(f_, i, s_.m[i] / s_.rho[i]) / s_.m[i];
      rate(D, 1)[i] += lift;
      rate(u_)[i] -= lift * s_.v[1][i];
    }
    const double inertia = f_.inertia_of(i);
    if (inertia == 1.0) return;
    for (std::size_t a = 0; a < D; ++a) rate(D, a)[i] /= inertia;
  }
  // Nothing dissolved in what stands behind walls takes part.
  void exchange_element_beside_scheme() {
    find_partitions();
    if (passes::behind<D>(f_.world) == passes::behind_walls::particles)
      e.walls("element", {.gives = {f_.mobility, f_.element, f_.metal, f_.partition}}, [this] {
        for (std::size_t i = s_.first_wall(); i < s_.total(); ++i) {
          f_.mobility[i] = f_.element[i] = f_.metal[i] = 0.0;
          f_.partition[i] = 1.0;
        }
      });
    add_element_exchange();
    e.each("rates", {.reads = {s_.m, f_.gain}, .rates = {f_.element}},
           [this](std::size_t i) { rate(c_)[i] = f_.gain[i] / s_.m[i]; });
  }

  fluids<D>& f_;
  liquid::scheme<D>* scheme_;
  pairs::workspace<D>& w_ = f_.world.w;
  particles::particles<D>& s_ = w_.s;
  particles::vector_field<D> slip_;
  std::size_t u_ = 0, q_ = 0, density_ = 0, T_ = 0, c_ = 0, h_ = 0;  // places of rates; of x from 0, of v from D on
};

}  // namespace tetsuame::two_fluids
