// The right-hand side as a list of passes. Densities, and the state that follows from them:
//   y, f, z, ∇·v, ∇×v over neighbours (schemes/common.hpp); ρ, and P, c of ρ and u (here of an ideal gas)
//     SSPH, GSPH   P = (γ - 1) ρ u, ρ = y         DISPH, GDISPH   P = (γ - 1) q, q = y; ρ = m q/U
// then gradients, of p, ρ, v for the second order, of u, ρ, v for REMIX; the kernels' corrections (REMIX), the moments
// of gradients by an integral, or the factor of geometric densities; forces and power, with artificial viscosity or
// Riemann problems;
// what the gas itself has of friction and conduction (schemes/molecular.hpp); and
//   dx/dt = v, dv/dt = F/m + g + K, du/dt = power/m + J, dα/dt or dρ/dt where these are integrated
#pragma once

#include <fmt/format.h>

#include <gas/melt_and_element.hpp>
#include <passes/evaluation.hpp>
#include <schemes/density_based.hpp>
#include <schemes/godunov.hpp>
#include <schemes/gradients.hpp>
#include <schemes/remix.hpp>
#include <schemes/viscous.hpp>

namespace tetsuame::gas {

// The sum of term(kernel), for the kernel that the run has.
template <int D, class Term>
void sum_of(world<D>& g, const pairs::row_range& rows, const Term& term) {
  std::visit([&](const auto& unit) { sum(g, rows, term(unit)); }, g.unit);
}

// The largest supports do not follow the density: f = 1, z = 0.
template <int D>
void sum_densities(world<D>& g, const pairs::row_range& rows) {
  sum_of(g, rows, [&]<class Kernel>(const Kernel& unit) { return schemes::density<D, Kernel>{unit, g.fields()}; });
  for (std::size_t i = rows.first; i < rows.last; ++i)
    if (!(g.S[i] < g.largest_support)) {
      g.f[i] = 1.0;
      g.z[i] = 0.0;
    }
}
template <int D>
void sum_gradients(world<D>& g, const pairs::row_range& rows) {
  sum_of(g, rows, [&]<class Kernel>(const Kernel& unit) {
    return schemes::gradients<D, Kernel>{unit, g.fields(), g.evolves_density ? g.w.s.u : g.w.s.p};
  });
}
template <int D>
void sum_corrections(world<D>& g, const pairs::row_range& rows) {
  sum_of(g, rows, [&]<class Kernel>(const Kernel& unit) { return schemes::reproducing<D, Kernel>{unit, g.fields()}; });
}
template <int D>
void sum_moments(world<D>& g, const pairs::row_range& rows) {
  sum_of(g, rows, [&]<class Kernel>(const Kernel& unit) { return schemes::integral<D, Kernel>{unit, g.fields()}; });
}
template <int D>
void sum_geometric_factor(world<D>& g, const pairs::row_range& rows, bool supports_vary) {
  sum_of(g, rows, [&]<class Kernel>(const Kernel& unit) {
    return schemes::geometric_factor<D, Kernel>{unit, g.fields(), supports_vary};
  });
}

// Of the gas itself, added to nothing.
template <int D>
void sum_transport(world<D>& g, const pairs::row_range& rows) {
  const auto& m = g.molecular;
  const auto& s = g.w.s;
  const auto v = pairs::pointers<D>(s.v);
  std::array<double*, D> force;
  const auto clear = [&](particles::array& a) {
    std::fill(a.begin() + static_cast<std::ptrdiff_t>(rows.first), a.begin() + static_cast<std::ptrdiff_t>(rows.last),
              0.0);
    return a.data();
  };
  for (std::size_t a = 0; a < D; ++a) force[a] = clear(g.friction[a]);
  double* const heat = clear(g.heat);
  const double *dV = s.dV.data(), c = m.symmetric();
  const diffusion::uniform_viscosity<D> plain{v, m.viscosity - c, dV, force, heat};
  const diffusion::symmetric_viscous_sum<D, double> symmetric{v, c, dV, force, heat};
  const diffusion::conduction_sum<D, double> conduction{s.T.data(), m.heat_conductivity, dV, heat};
  std::visit(
      [&]<class Kernel>(const Kernel& unit) {
        const auto by = [&]<class Term>(const Term& term) {
          return schemes::of_mean_kernel<D, Kernel, Term>{unit, g.fields(), term};
        };
        if (g.viscosities_differ)
          return sum(g, rows, by(diffusion::symmetric_viscous_sum<D, const double*>{v, s.eta.data(), dV, force, heat}));
        m.conducts() ? sum(g, rows, by(plain), by(symmetric), by(conduction)) : sum(g, rows, by(plain), by(symmetric));
      },
      g.unit);
}

// The sum of forces of the scheme that was asked for.
template <int D>
std::function<void(const pairs::row_range&)> forces_of(world<D>& g) {
  const auto by = [&g](auto term) {
    return [&g, term](const pairs::row_range& rows) {
      sum_of(g, rows, [&](const auto& unit) { return term(unit, g.fields()); });
    };
  };
  const auto& q = g.o.shock;
  const double theta = q.limiter == "minmod" ? 1.0 : 2.0, fading = q.fading, support = g.support_over_dx;
  const bool exact = q.solver == "exact";
  using schemes::fields;
  const auto density_based = [&]<bool Geometric, bool Integral>(std::bool_constant<Geometric>,
                                                                std::bool_constant<Integral>) {
    return by([alpha_u = q.conductivity]<class K>(const K& unit, const fields<D>& all) {
      return schemes::density_based<D, K, Geometric, Integral>{{unit, all}, alpha_u};
    });
  };
  constexpr std::true_type yes;
  constexpr std::false_type no;
  if (g.geometric && g.integral_gradients) return density_based(yes, yes);
  if (g.geometric) return density_based(yes, no);
  if (g.integral_gradients) return density_based(no, yes);
  if (g.o.conducts()) return density_based(no, no);
  if (q.scheme == "ssph")
    return by([]<class K>(const K& unit, const fields<D>& all) { return schemes::ssph<D, K>{unit, all}; });
  if (q.scheme == "disph")
    return by([]<class K>(const K& unit, const fields<D>& all) { return schemes::disph<D, K>{unit, all}; });
  if (q.scheme == "gsph")
    return by([=]<class K>(const K& unit, const fields<D>& all) {
      return schemes::gsph<D, K>{unit, all, theta, exact};
    });
  if (g.o.terms_fade())
    return by([=]<class K>(const K& unit, const fields<D>& all) {
      return schemes::gdisph_of_contacts<D, K>{unit, all, theta, exact, fading};
    });
  if (q.scheme == "gdisph")
    return by([=]<class K>(const K& unit, const fields<D>& all) {
      return schemes::gdisph<D, K>{unit, all, theta, exact};
    });
  return by([=]<class K>(const K& unit, const fields<D>& all) { return schemes::remix<D, K>{unit, all, support}; });
}

template <int D>
class list_of_passes {
 public:
  explicit list_of_passes(world<D>& of) : e(of), densities(of), g_(of) {}
  list_of_passes(const list_of_passes&) = delete;
  list_of_passes& operator=(const list_of_passes&) = delete;

  passes::evaluation<D> e;
  // The sums for densities alone, of a state that stays.
  passes::evaluation<D> densities;

  // Needs the scales of the start.
  void declare() {
    const double speed = g_.speed_scale;
    g_.sources.declare(g_.o.sources, g_, e);
    if constexpr (D > 1)
      if (g_.o.self_gravity) {
        g_.attraction = std::make_unique<gravity::self<D>>(*g_.o.self_gravity);
        g_.attraction->declare(g_, g_.softening, g_.o.common.time.substeps > 1);
      }
    if (g_.o.common.time.method == "kdk") e.keep_rates(passes::evaluation<D>::kept::all_but_positions);
    e.integrate_motion({0.0, 0.0, speed});
    u_ = e.integrate(s_.u, {"u", 0.0, speed * speed});
    if (g_.o.has_alpha()) extra_ = e.integrate(g_.alpha, {"alpha", 0.0, 1.0});
    if (g_.evolves_density) extra_ = e.integrate(g_.evolved, {"density", 0.0, g_.density_scale});
    if (const auto& c = g_.o.element; g_.dissolved)
      c_ = e.integrate(g_.concentration, {"c", 0.0, std::max(c.concentration_silicate, c.concentration_metal)});
    g_.sources.account(e, speed * speed);
    densities.remembered_motion();
    densities.remembered({s_.u});
    for (auto* list : {&e, &densities}) {
      list->given({s_.m, g_.start_volume, g_.gamma, g_.kind});
      list->remembered({g_.S});
      if (g_.weighs_power) list->remembered({g_.power_weight});
      list->mirrored(walls::vector(s_.v));
      find_densities(*list);
      if (list == &densities) list->complete(passes::behind_walls::images);
    }
    find_state();
    if (g_.evolves_density) find_corrections();
    if (g_.integral_gradients) find_moments();
    if (has_factor_) find_geometric_factor();
    if (g_.second_order || g_.evolves_density) find_gradients();
    find_forces();
    if constexpr (D > 1)
      if (g_.attraction) g_.attraction->declare_pass(e);
    if (g_.molecular.any()) find_transport();
    if (g_.dissolved) find_exchange();
    find_rates();
    e.complete(passes::behind_walls::images);
  }

 private:
  double* rate(std::size_t of, std::size_t a = 0) const { return e.rate(of + a); }
  // What follows from the sums, of ghosts and images too.
  passes::fields found() {
    passes::fields all{g_.correction, s_.rho, s_.p, s_.c, s_.dV, g_.per_S, g_.slope, g_.dissipation};
    if (g_.any_eos) all.add({g_.stiffness});
    return all;
  }

  void find_densities(passes::evaluation<D>& list) {
    passes::access uses{.reads = {s_.m, s_.u, g_.start_volume}, .writes = {g_.weight}};
    if (g_.weighs_power) uses.reads.add({g_.power_weight});
    list.each(
        "densities", uses,
        [this](std::size_t i) {
          g_.weight[i] = g_.weighs_energy   ? s_.m[i] * s_.u[i]
                         : g_.weighs_volume ? g_.start_volume[i]
                         : g_.weighs_power  ? g_.power_weight[i]
                                            : s_.m[i];
        },
        true);
    list.sum(
        "densities",
        {.reads = {g_.S},
         .at_neighbours = {g_.weight, s_.m, s_.v},
         .writes = {g_.y, g_.f, g_.z, g_.divergence, g_.curl, g_.number, g_.mass_density, g_.count, g_.count_slope}},
        [this](const pairs::row_range& rows) { sum_densities(g_, rows); });
  }

  // ---- the state that follows -------------------------------------------------------------

  void find_state() {
    passes::fields remembered{g_.start_sum, g_.softening};
    if (!g_.o.has_alpha()) remembered.add({g_.alpha});
    if (!g_.evolves_density) remembered.add({g_.evolved});
    e.remembered(remembered);
    if (!g_.any_eos) e.given({g_.stiffness});
    e.check(
        "densities", {g_.y, s_.u, g_.evolved}, [this](std::size_t i) { return fault_of_sums(i).empty(); },
        [this](std::size_t i) { return fault_of_sums(i); });
    passes::access uses{.reads = {g_.y, g_.f, g_.z, g_.number, g_.divergence, g_.curl, g_.S, g_.weight, g_.start_sum,
                                  g_.alpha, g_.evolved, g_.gamma, s_.u, s_.m},
                        .writes = {found(), s_.T, g_.number_volume}};
    if (g_.melts) uses.writes.add({g_.melt, g_.inertia});
    if (viscosity_varies_) uses.writes.add({s_.eta});
    e.each("densities", uses, [this](std::size_t i) { find_state(i); });
    if (g_.melts)
      e.check(
          "densities", {g_.melt}, [this](std::size_t i) { return std::isfinite(g_.melt[i]); },
          [this](std::size_t i) {
            return fmt::format(
                "no melt fraction at {:.4g} kg/m^3 and {:.4g} J/kg: the state is beyond the equation of "
                "state, or the solidus passes the liquidus at its pressure",
                s_.rho[i], s_.u[i]);
          });
    if (g_.any_eos)
      e.check(
          "densities", {s_.c}, [this](std::size_t i) { return s_.c[i] > 0.0; },
          [this](std::size_t i) {
            return fmt::format("no sound at {:.4g} kg/m^3 and {:.4g} J/kg, where '{}' does not reach", s_.rho[i],
                               s_.u[i], eos::about(g_.caloric_of(i).material()).name);
          });
  }
  // What no state follows from; empty: nothing.
  std::string fault_of_sums(std::size_t i) const {
    const auto text = [](const char* what, double value, const char* unit) {
      return fmt::format("the {} is {:.3g} {}, not above 0", what, value, unit);
    };
    if (g_.evolves_density && !(g_.evolved[i] > 0.0)) return text("density", g_.evolved[i], "kg/m^D");
    if (!(s_.u[i] > 0.0 || g_.any_eos)) return text("internal energy", s_.u[i], "J/kg");
    if (!(g_.y[i] > 0.0 && std::isfinite(g_.y[i]))) return text("sum for the density", g_.y[i], "in SI units");
    return {};
  }
  // ρ, p, T, c of y and u. dU = -p dV with V = k w/y.
  void find_pressure(std::size_t i, double k) {
    s_.rho[i] = g_.evolves_density ? g_.evolved[i]
                : g_.weighs_energy ? g_.y[i] / s_.u[i]
                : by_volume_       ? s_.m[i] * g_.y[i] / (k * g_.weight[i])
                                   : g_.y[i];
    if (g_.any_eos) {
      if (g_.melts) find_melt(g_, i);
      const eos::caloric_state now = g_.state_of(i);
      s_.p[i] = now.p;
      s_.T[i] = now.T;
      s_.c[i] = now.c;
      // The stiffened gas with K_S and K_S' (riemann/exact.hpp); where vapour is softer than that, a gas
      g_.stiffness[i] = std::max(s_.rho[i] * now.c * now.c / g_.gamma[i] - now.p, 0.0);
      return;
    }
    s_.p[i] = (g_.gamma[i] - 1.0) * (g_.weighs_energy ? g_.y[i] : s_.rho[i] * s_.u[i]) - g_.gamma[i] * g_.stiffness[i];
    s_.c[i] = g_.sound_speed(i);
    if (g_.molecular.conducts()) s_.T[i] = (s_.u[i] - g_.stiffness[i] / s_.rho[i]) / *g_.o.shock.heat_capacity;
  }
  // What the pair takes of the viscosity, or of the star pressure.
  double dissipation_of(std::size_t i) const {
    const bool switched = g_.o.shock.balsara || g_.part_of_star || g_.evolves_density;
    const double balsara =
        switched ? schemes::balsara_factor(g_.divergence[i], g_.curl[i], s_.c[i], g_.S[i] / g_.support_over_h) : 1.0;
    return g_.evolves_density ? balsara : !g_.godunov ? g_.alpha[i] * balsara : g_.part_of_star ? balsara : 1.0;
  }
  void find_state(std::size_t i) {
    const double k = g_.weighs_volume ? g_.start_sum[i] : 1.0;
    find_pressure(i, k);
    if (g_.melts) find_viscosity(g_, i);
    g_.number_volume[i] = 1.0 / g_.number[i];
    s_.dV[i] = volumes_by_density_ ? s_.m[i] / s_.rho[i] : g_.number_volume[i];
    g_.per_S[i] = 1.0 / g_.S[i];
    g_.slope[i] = fades_ ? std::sqrt(k) / g_.y[i]
                         : (with_f_ ? g_.f[i] : 1.0) * (g_.godunov ? 1.0 : s_.p[i]) * k / (g_.y[i] * g_.y[i]);
    g_.correction[i] = with_z_ ? g_.z[i] : 0.0;
    g_.dissipation[i] = dissipation_of(i);
  }

  // ---- sums and rates ---------------------------------------------------------------------

  // Components [first, end): the gradients of two even fields, and that of a vector.
  template <std::size_t N>
  void mirror_gradients(const particles::vector_field<N>& all, std::size_t first) {
    for (std::size_t n = first; n < N; ++n) {
      const std::size_t k = (n - first) / D, b = (n - first) % D;
      const unsigned along = (k < 2 ? 0U : 1U << (k - 2)) ^ 1U << b;
      e.mirrored({{.values = &all[n], .by = walls::parity::signed_by_axes, .axes = along}});
    }
  }
  // A tensor's component b, c changes sign in a wall across one of the two.
  void find_moments() {
    for (std::size_t b = 0; b < D; ++b)
      for (std::size_t c = b; c < D; ++c)
        e.mirrored({{.values = &g_.integral[operators::symmetric_place(b, c, D)],
                     .by = walls::parity::signed_by_axes,
                     .axes = 1U << b ^ 1U << c}});
    e.sum("corrections", {.reads = {g_.S}, .at_neighbours = {found()}, .writes = {g_.integral}},
          [this](const pairs::row_range& rows) { sum_moments(g_, rows); });
  }
  void find_geometric_factor() {
    e.sum("corrections", {.reads = {g_.S, g_.f}, .at_neighbours = {found()}, .writes = {g_.factor}},
          [this](const pairs::row_range& rows) { sum_geometric_factor(g_, rows, with_f_); });
  }
  void find_corrections() {
    mirror_gradients(g_.reproducing, 2);
    e.sum("corrections", {.at_neighbours = {found(), s_.v, s_.m, g_.weight}, .writes = {g_.reproducing}},
          [this](const pairs::row_range& rows) { sum_corrections(g_, rows); });
  }
  void find_gradients() {
    mirror_gradients(g_.gradient, 0);
    e.sum("gradients", {.at_neighbours = {found(), s_.v, s_.u}, .writes = {g_.gradient}},
          [this](const pairs::row_range& rows) { sum_gradients(g_, rows); });
  }
  void find_forces() {
    passes::access uses{.at_neighbours = {found(), s_.v, s_.u, s_.m, g_.weight, g_.gamma, g_.stiffness, g_.kind},
                        .writes = {g_.force, g_.power, g_.signal, g_.density_rate}};
    if (g_.second_order || g_.evolves_density) uses.at_neighbours.add({g_.gradient});
    if (g_.evolves_density) uses.at_neighbours.add({g_.reproducing});
    if (g_.integral_gradients) uses.at_neighbours.add({g_.integral});
    if (has_factor_) uses.at_neighbours.add({g_.factor});
    e.sum("forces", uses, forces_of(g_));
  }
  void find_transport() {
    passes::fields neighbours{found(), s_.v};
    if (g_.molecular.conducts()) neighbours.add({s_.T});
    if (g_.viscosities_differ) {
      if (!viscosity_varies_) e.given({s_.eta});
      neighbours.add({s_.eta});
    }
    e.sum("friction", {.at_neighbours = neighbours, .writes = {g_.friction, g_.heat}},
          [this](const pairs::row_range& rows) { sum_transport(g_, rows); });
  }
  void find_exchange() {
    e.each("element", {.reads = {s_.p, s_.T, s_.rho}, .writes = {g_.partition, g_.mobility, g_.metal}},
           [this](std::size_t i) { find_partition(g_, i); });
    e.sum("element",
          {.reads = {g_.S},
           .at_neighbours = {g_.concentration, g_.partition, g_.mobility, g_.metal, s_.dV, g_.per_S},
           .writes = {g_.gain}},
          [this](const pairs::row_range& rows) { sum_exchange(g_, rows); });
  }
  void find_rates() {
    passes::access uses{.reads = {s_.m, s_.v, s_.c, g_.force, g_.power, g_.density_rate, g_.divergence, g_.S, g_.alpha,
                                  passes::of_sources<D>(g_)},
                        .rates = {s_.x, s_.v, s_.u}};
    if (g_.molecular.any()) uses.reads.add({g_.friction, g_.heat});
    if (g_.o.has_alpha()) uses.rates.add({g_.alpha});
    if (g_.evolves_density) uses.rates.add({g_.evolved});
    if (g_.melts) uses.reads.add({g_.inertia});
    if (g_.dissolved) {
      uses.reads.add({g_.gain});
      uses.rates.add({g_.concentration});
    }
    e.each("rates", uses, [this](std::size_t i) { combine(i); });
  }
  void combine(std::size_t i) {
    const auto& q = g_.o.shock;
    for (std::size_t a = 0; a < D; ++a) {
      rate(0, a)[i] = s_.v[a][i];
      rate(D, a)[i] = g_.force[a][i] / s_.m[i] + g_.w.gravity(a, i);
    }
    rate(u_)[i] = g_.power[i] / s_.m[i];
    if (g_.molecular.any()) {
      for (std::size_t a = 0; a < D; ++a) rate(D, a)[i] += g_.friction[a][i] / s_.m[i];
      rate(u_)[i] += g_.heat[i] / s_.m[i];
    }
    if (g_.melts)
      for (std::size_t a = 0; a < D; ++a) rate(D, a)[i] /= g_.inertia[i];
    if (g_.dissolved) rate(c_)[i] = g_.gain[i] / s_.m[i];
    if (g_.w.heating != nullptr) rate(u_)[i] += (*g_.w.heating)[i];
    if (g_.evolves_density) rate(extra_)[i] = g_.density_rate[i];
    if (g_.o.has_alpha())
      rate(extra_)[i] = schemes::alpha_rate(g_.alpha[i], q.alpha_min, q.alpha, g_.divergence[i], s_.c[i],
                                            g_.S[i] / g_.support_over_h);
  }

  world<D>& g_;
  particles::particles<D>& s_ = g_.w.s;
  const bool fades_ = g_.o.terms_fade();
  const bool with_z_ = g_.o.density_independent() && (g_.o.shock.support_terms == "number" || fades_);
  const bool with_f_ = !with_z_ && g_.o.shock.scheme != "gsph" && g_.o.shock.support_terms != "none";
  const bool by_volume_ = g_.weighs_volume || g_.weighs_power;  // V = k w/y
  const bool volumes_by_density_ = g_.evolves_density || g_.geometric || g_.integral_gradients;
  const bool has_factor_ = g_.geometric && !g_.integral_gradients;
  const bool viscosity_varies_ = g_.o.melting.viscosity_varies();
  std::size_t u_ = 0, extra_ = 0, c_ = 0;  // places of rates
};

}  // namespace tetsuame::gas
