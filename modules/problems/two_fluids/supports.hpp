// Supports that follow the volume, and neighbour lists: S_i = S_0 (ΔV_i/ΔV_0)^(1/d), so that a particle keeps its
// neighbours when its liquid expands (docs/theory/core_formation.md#supports). They stay during a step.
//
//   our_method        ΔV = m/ρ; every sum has the mean of both kernels, F̄_ij = ½[F(S_i) + F(S_j)]
//   number_density    ΔV_i = s/n_i, n_i = Σ_j W_ij(S_i): S_i^d n_i is one number for all.
//                     Pressure: -Σ_j [f_i A_i F_i + f_j A_j F_j] x_ij, A = (p - p_r) ΔV²/s, f_i = -d n_i/Σ_j r
//                     W'_ij(S_i), and compression takes up f_i A_i Σ_j v_ij·∇_iW_ij(S_i). Friction and conduction have
//                     F̄.
//
// The viscous sum's a₀ - a₁ r² is of the start lattice: r² in units of S_i S_j/S_0².
#pragma once

#include <run/supports.hpp>
#include <schemes/common.hpp>
#include <two_fluids/fluids.hpp>
#include <two_fluids/terms.hpp>

namespace tetsuame::two_fluids {

// A pair whose kernels are its ends' own.
template <class Pair>
struct pair_with_supports : Pair {
  pairs::real F_i, F_j;     // 1/m^(D+2), of the pressure force
  pairs::real r2_of_start;  // m2
};

// A term over such pairs. `own_slopes`: the pressure force has either end's, or else the mean.
template <int D, class Kernel, class Term>
struct with_supports {
  Kernel unit;
  const double* per_S;  // 1/m
  double S_0;           // m
  bool own_slopes;
  Term term;

  auto reads() const { return std::tuple_cat(std::tuple{pairs::read(schemes::of_per_support, per_S)}, term.reads()); }
  auto begin(const pairs::cluster<>& i) const { return term.begin(i); }
  void add(auto& sums, const auto& pair) const {
    pair_with_supports<std::remove_cvref_t<decltype(pair)>> ij{pair, {}, {}, {}};
    const auto F = schemes::slopes_of<D>(unit, pair);
    ij.F = 0.5 * (F.i + F.j);
    ij.F_i = own_slopes ? F.i : ij.F;
    ij.F_j = own_slopes ? F.j : ij.F;
    ij.r2_of_start = pair.r2 * (S_0 * S_0 * pair.own(schemes::of_per_support)) * pair(schemes::of_per_support);
    term.add(sums, ij);
  }
  void end(const pairs::cluster<>& i, const auto& sums) const { term.end(i, sums); }
};

// A sum over the neighbours of these rows, with the one kernel or with everyone's own.
template <int D, class Term>
void sum(const fluids<D>& f, const pairs::row_range& rows, const Term& term) {
  const auto& w = f.world.w;
  if (!f.follows) {
    w.sum(rows, term);
    return;
  }
  const schemes::distances_only none{1e-9 * f.S_0};
  std::visit(
      [&](const auto& unit) {
        pairs::sum_over<D>(
            rows, w.list, w.x(), none,
            with_supports<D, std::remove_cvref_t<decltype(unit)>, Term>{unit, f.per_S.data(), f.S_0, !f.carried, term});
      },
      f.unit);
}

// n_i S_i^d, and the same of r² F.
template <class Kernel>
struct number_density {
  Kernel unit;
  const double* S;
  double *count, *slope;

  struct me {
    pairs::real S, per_S, count, slope;
  };
  me begin(const pairs::cluster<>& i) const {
    const pairs::real S_i = i(S);
    return {S_i, 1.0 / S_i, 0.0, 0.0};
  }
  void add(me& a, const auto& ij) const {
    const auto s = schemes::shape_of(unit, ij, a.S, a.per_S);
    a.count += s.W;
    a.slope += s.q * s.q * s.F;
  }
  void end(const pairs::cluster<>& i, const me& a) const {
    i.set(count, unit.self() + a.count);
    i.set(slope, a.slope);
  }
};

// n_i S_i^d and its slope in S_i.
template <int D>
void count_neighbours(fluids<D>& f, const pairs::row_range& rows) {
  const auto& w = f.world.w;
  std::visit(
      [&](const auto& unit) {
        pairs::sum_over<D>(rows, w.list, w.x(), schemes::distances_only{1e-9 * f.S_0},
                           number_density<std::remove_cvref_t<decltype(unit)>>{unit, f.S.data(), f.count.data(),
                                                                               f.count_slope.data()});
      },
      f.unit);
}

// The volume of particle i by the number density, and f_i.
template <int D>
void volume_by_count(fluids<D>& f, std::size_t i) {
  f.world.w.s.dV[i] = f.world.w.lattice_sum * std::pow(f.S[i], D) / f.count[i];
  f.follow_factor[i] = -static_cast<double>(D) * f.count[i] / f.count_slope[i];
}

template <int D>
bool has_factor(const fluids<D>& f) {
  return f.follows && !f.carried;
}

// Of the skin, the part that supports may take before lists are made again.
template <int D>
double room_to_grow(const fluids<D>& f) {
  return f.follows ? 0.25 * f.world.skin : 0.0;
}

// By no more than the lists allow.
template <int D>
void next_supports(fluids<D>& f) {
  const auto& s = f.world.w.s;
  const double target = f.world.w.lattice_sum * std::pow(f.S_0 / f.world.w.dx, D);
  foundation::for_all(s.fluid, [&](std::size_t i) {
    const double next = f.carried ? f.S_0 / f.world.w.dx * std::pow(s.m[i] / s.rho[i], 1.0 / D)
                                  : schemes::next_support(f.support[i], f.count[i], f.count_slope[i], target);
    f.support[i] = std::min(next, f.list_support[i]);
  });
}

// Those in the sums, of fluid, ghosts and images.
template <int D>
void take_supports(fluids<D>& f) {
  auto& w = f.world.w;
  auto& s = w.s;
  std::copy_n(f.support.begin(), s.fluid, f.S.begin());
  walls::update_ghosts_and_images(f.world.w, f.world.walls, walls::even({&f.S}));
  foundation::for_all(s.total(), [&](std::size_t i) { f.per_S[i] = 1.0 / f.S[i]; });
  f.per_S[s.null()] = 0.0;
}

template <int D>
void follow_volumes(fluids<D>& f) {
  next_supports(f);
  take_supports(f);
}

template <int D>
run::growing_supports supports(fluids<D>& f) {
  return {f.S_0 / f.world.w.dx, f.support, f.list_support, room_to_grow(f)};
}

// The smallest support over that of the start, which steps are for.
template <int D>
double narrowest(const fluids<D>& f) {
  if (!f.follows) return 1.0;
  const double least = foundation::smallest_of(f.world.w.s.fluid, f.S_0, [&](std::size_t i) { return f.support[i]; });
  return -f.ranks().maximum(-least) / f.S_0;
}

// Neighbour lists, and what of a particle stays while they hold: transport coefficients, supports.
template <int D>
void make_lists(fluids<D>& f, bool as_they_were) {
  auto& w = f.world.w;
  auto& s = w.s;
  if (f.follows)
    run::rebuild_with_supports(f.world, as_they_were, supports(f));
  else
    run::rebuild(f.world, as_they_were);
  if (f.isothermal()) {
    w.exchange_fluid({s.m.data(), s.T.data()});
    walls::fill_images(f.world.walls, s, walls::even({&s.T}));
  } else {
    w.exchange_fluid({s.m.data()});
  }
  for (std::size_t i = 0; i < s.total(); ++i) {
    const bool of_body = f.has_bodies && rigid::is_of_body(f.world, i);  // no heat goes there
    const auto n = static_cast<std::size_t>(s.material[i]);
    s.eta[i] = of_body ? 0.0 : f.o.material[n].viscosity;
    s.k[i] = of_body ? 0.0 : f.o.conductivity_of(n);
  }
  if (f.has_bodies) rigid::find_beside_bodies(f.bodies);
  if (f.tense)
    for (std::size_t i = 0; i < s.total(); ++i) f.metal[i] = f.is_metal(i) ? 1.0 : 0.0;
  if (f.dissolved) f.partition[s.null()] = 1.0;
  if (f.follows) take_supports(f);
}

// Those of the start lattice are not yet the displaced particles'.
template <int D>
void settle_supports(fluids<D>& f) {
  for (int round = 0; round < 5; ++round) {
    if (!f.carried) count_neighbours(f, f.world.w.fluid());
    follow_volumes(f);
  }
}

}  // namespace tetsuame::two_fluids
