// Surface tension of the free surface, a force along its normal alone (docs/theory/water_surface_tension.md):
//   m_i dv_i/dt = … + 2 σ κ_i V_i G_i,   G_i = Σ_j V_j ∇_i W_ij, which points inwards
// The pressure's sum of a uniform pressure p is -2 p V_i G_i: a drop under p = σ κ is at rest, whatever its
// arrangement.
//
// Curvature by the normals of its neighbours, of G smoothed once, g_i = Σ_j V_j W_ij G_j, i among them, n = g/|g|:
//   κ_i = (D-1) Σ_j V_j F_ij g_j·t_ij / Σ_j V_j F_ij |g_j| t_ij²,   t_ij = x_ij - (x_ij·n_i) n_i
// on a sphere exactly that of the neighbours' own distances from its centre. Its mean over V W ψ |g| is what pulls, and
// ψ_i of it: ψ = 1 at the surface, 0 deep in the water, where G is but disorder, which pressure is to even out.
#pragma once

#include <algorithm>
#include <free_surface/sums.hpp>

namespace tetsuame::free_surface {

// ε: G and g below ε/h are none [after J. P. Morris, Int. J. Numer. Methods Fluids 33, 333 (2000)].
inline constexpr double least_normal = 0.05;
// ψ is 1 from |g| = this/h on. The two outermost rows of a lattice have 0.34 and 0.21; places off by 0.1 Δx make 0.03.
inline constexpr double whole_normal = 0.15;

// ψ, of |g| h: a cubic from 0 at least_normal to 1, without a step in its slope.
inline double surface_part(double g_h) {
  const double u = std::clamp((g_h - least_normal) / (whole_normal - least_normal), 0.0, 1.0);
  return u * u * (3.0 - 2.0 * u);
}

inline constexpr schemes::field<struct inward_tag> of_inward;
inline constexpr schemes::field<struct curvature_tag> of_curvature;
inline constexpr schemes::field<struct length_tag> of_length;

template <class R, int D>
foundation::roots<R> roots_of(const pairs::vec<R, D>& v) {
  return foundation::both_roots(foundation::greater(foundation::dot(v, v), R(foundation::tiny<R>)));
}

// g.
template <int D>
struct smoothed_inward {
  using kernels = kernels_of_water<D>;
  const double* V;                 // m^D
  double W0;                       // 1/m^D, W(0)
  std::array<const double*, D> G;  // 1/m
  std::array<double*, D> g;        // 1/m

  template <class R>
  struct me {
    pairs::vec<R, D> g;
  };
  auto reads() const { return std::tuple{pairs::read(pairs::of_volume, V, D), pairs::read(of_inward, G, -1)}; }
  template <class R>
  me<R> begin(const pairs::cluster<R>& i) const {
    const R own = R(W0 * i.lengths.to(D)) * i(V, D);
    return {pairs::vec<R, D>::of([&](std::size_t k) { return own * i(G[k], -1); })};
  }
  void add(auto& a, const auto& ij) const { a.g += (ij(pairs::of_volume) * ij.W) * ij(of_inward); }
  void end(const auto& i, const auto& a) const {
    for (std::size_t k = 0; k < D; ++k) i.set(g[k], a.g[k], -1);
  }
};

// κ, of normals n = g/|g|.
template <int D>
struct curvature {
  using kernels = kernels_of_water<D>;
  const double* V;                 // m^D
  std::array<const double*, D> g;  // 1/m
  double least, most;              // 1/m: of |g|, and of |κ| what is resolved
  double* kappa;                   // 1/m

  template <class R>
  struct me {
    R bend, length;
    pairs::vec<R, D> normal;  // the same for all
  };
  auto reads() const { return std::tuple{pairs::read(pairs::of_volume, V, D), pairs::read(of_inward, g, -1)}; }
  template <class R>
  me<R> begin(const pairs::cluster<R>& i) const {
    const auto mine = pairs::vec<R, D>::of([&](std::size_t k) { return i(g[k], -1); });
    return {R(0.0), R(0.0), roots_of(mine).inverse * mine};
  }
  void add(auto& a, const auto& ij) const {
    const auto t = ij.x_ij - foundation::dot(ij.x_ij, a.normal) * a.normal;
    const auto VF = ij(pairs::of_volume) * ij.F;
    const auto of_j = ij(of_inward);
    a.bend += VF * foundation::dot(of_j, t);
    a.length += VF * roots_of(of_j).r * foundation::dot(t, t);
  }
  void end(const auto& i, const auto& a) const {
    using R = std::remove_cvref_t<decltype(a.bend)>;
    const R bound(most * i.lengths.to(1)), limit(least * i.lengths.to(1));
    const R whole = (D - 1.0) * a.bend / foundation::lesser(a.length, R(-foundation::tiny<R>));
    const R resolved = foundation::lesser(foundation::greater(whole, R(0.0 - bound)), bound);
    const auto mine = pairs::vec<R, D>::of([&](std::size_t k) { return i(g[k], -1); });
    i.set(kappa, foundation::select(limit < roots_of(mine).r, resolved, R(0.0)), -1);
  }
};

// The force, by the mean of κ over ψ |g|.
template <int D>
struct tension {
  using kernels = kernels_of_water<D>;
  const double *V, *kappa, *length;  // m^D, 1/m, 1/m (ψ |g|)
  double W0;                         // 1/m^D, W(0)
  std::array<const double*, D> G;    // 1/m, ψ G
  double sigma;                      // N/m
  std::array<double*, D> force;      // N

  template <class R>
  struct me {
    R kappa, all;
  };
  auto reads() const {
    using namespace pairs;
    return std::tuple{read(of_volume, V, D), read(of_curvature, kappa, -1), read(of_length, length, -1)};
  }
  template <class R>
  me<R> begin(const pairs::cluster<R>& i) const {
    const R own = R(W0 * i.lengths.to(D)) * i(V, D) * i(length, -1);
    return {own * i(kappa, -1), own};
  }
  void add(auto& a, const auto& ij) const {
    const auto share = ij(pairs::of_volume) * ij.W * ij(of_length);
    a.kappa += share * ij(of_curvature);
    a.all += share;
  }
  void end(const auto& i, const auto& a) const {
    using R = std::remove_cvref_t<decltype(a.all)>;
    const R scale = (2.0 * sigma) * i(V, D) * a.kappa / foundation::greater(a.all, R(foundation::tiny<R>));
    for (std::size_t k = 0; k < D; ++k) i.set(force[k], scale * i(G[k], -1), D - 2);
  }
};

// Collective, after the water's sums, which leave G. Forces of surface tension.
template <int D>
void find_tension(water<D>& f) {
  auto& w = f.world.w;
  auto& s = w.s;
  const foundation::stage timed(w.times, "tension");
  const double least = least_normal / f.p.smoothing_length;
  foundation::for_all(s.fluid, [&](std::size_t i) {
    const bool inside = length_of<D>(f.inward, i) < least;
    for (std::size_t a = 0; a < D; ++a) {
      if (inside) f.inward[a][i] = 0.0;
      f.normal_within[a][i] = f.tension[a][i] = 0.0;
    }
    f.curvature[i] = 0.0;
  });
  share_vectors<D>(f, f.inward);
  const auto G = f.inward.read();
  const auto has_inward = [&](std::size_t i) {
    return std::ranges::any_of(G, [i](const double* component) { return component[i] != 0.0; });
  };
  const double W0 = std::visit([](const auto& k) { return k.self(); }, w.kernel);
  // Of all other clusters g is 0.
  w.sum(clusters_where(w, true, has_inward), smoothed_inward<D>{s.dV.data(), W0, G, f.normal_within.data()});
  share_vectors<D>(f, f.normal_within);
  foundation::for_all(s.fluid, [&](std::size_t i) {
    const double length = length_of<D>(f.normal_within, i), part = surface_part(length * f.p.smoothing_length);
    f.surface_weight[i] = part * length;
    for (std::size_t a = 0; a < D; ++a) f.inward[a][i] *= part;
  });
  w.sum(clusters_where(w, false, [&](std::size_t i) { return f.surface_weight[i] > 0.0; }),
        curvature<D>{s.dV.data(), f.normal_within.read(), least, (D - 1.0) / f.dx(), f.curvature.data()});
  w.exchange_fluid({f.curvature.data(), f.surface_weight.data()});
  const auto& walls = f.world.walls;
  for (auto* values : {&f.curvature, &f.surface_weight}) {
    std::fill_n(values->begin() + static_cast<std::ptrdiff_t>(s.first_wall()), walls.body_particles, 0.0);
    walls::fill_images(walls, s, walls::even({values}));
  }
  w.sum(clusters_where(w, false, has_inward), tension<D>{s.dV.data(), f.curvature.data(), f.surface_weight.data(), W0,
                                                         G, f.o.flow.surface_tension, f.tension.data()});
}

// J, collective: σ times the area of the surface, Σ 2 |G| V.
template <int D>
double surface_energy(water<D>& f) {
  if (!f.has_tension()) return 0.0;
  auto& w = f.world.w;
  refresh(f);
  w.sum(w.fluid(), inward<D>{w.s.dV.data(), f.inward.data()});
  const double least = least_normal / f.p.smoothing_length;
  foundation::exact_sum area;
  for (std::size_t i = 0; i < w.s.fluid; ++i)
    if (const double G = length_of<D>(f.inward, i); G >= least) area.add(2.0 * G * w.s.dV[i]);
  return f.o.flow.surface_tension * f.ranks().exact(area);
}

}  // namespace tetsuame::free_surface
