// Bodies that move freely: their acceleration and the pressure of their wall particles, each of which follows from the
// other (docs/theory/free_bodies.md).
//
// The pressure of a wall particle is linear in the acceleration A of its body,
//   p_w(A) = p_w(0) + Σ_k G_k A_k,   G_k = -Σ_j share_j ρ_j e_k(½ (x_j + x_w))·(x_w - x_j)/Σ_j share_j
// with e_k the unit motions of a rigid body; so is the force on the body, whose components are Q_k = Q_k(0) - m_kl A_l
// with
//   m_kl = -Σ_i Σ_w e_k(x_i)·V_i V_w ∇_i W_iw G_l
// the water that takes part in its acceleration. With M the body's own mass and inertia, (M + m) A = Q(0) + weight: its
// solution is what both act by, at once, however light the body is. Springs and dampers add to its weight, and what is
// held does not take part.
#pragma once

#include <omp.h>

#include <free_surface/loads.hpp>

namespace tetsuame::free_surface {

inline constexpr schemes::field<struct response_tag> of_response;

// m_kl of one body, of those of its wall particles that have a volume in V_w; images of a body act on it mirrored.
template <int D>
struct added_mass {
  using kernels = kernels_of_water<D>;
  static constexpr std::size_t N = solids::rigid<D>::components;
  using sums = std::array<foundation::exact_sum, N * N>;  // row by row

  const water<D>& f;
  const wall_group<D>& group;
  solids::point<D> centre;                // m, of the body's mass
  const double* V_w;                      // m^D
  std::array<const double*, N> response;  // G: Pa s2/m, Pa s2
  std::vector<sums>& of_threads;

  template <class R>
  struct me {
    std::array<pairs::vec<R, D>, N> sum;
  };
  auto reads() const { return std::tuple{pairs::read(pairs::of_volume, V_w, D), pairs::read(of_response, response)}; }
  template <class R>
  me<R> begin(const pairs::cluster<R>&) const {
    me<R> a;
    for (auto& sum : a.sum) sum = foundation::zero<R, D>();
    return a;
  }
  void add(auto& a, const auto& ij) const {
    const auto slope = (ij(pairs::of_volume) * ij.F) * ij.x_ij;
    const auto G = ij(of_response);
    foundation::for_each_of<N>([&](std::size_t k) { a.sum[k] += G[k] * slope; });
  }
  void end(const auto& i, const auto& a) const {
    auto& mine = of_threads[static_cast<std::size_t>(omp_get_thread_num())];
    i.each([&](std::size_t n, const auto& of) {
      const double V = f.world.w.s.dV[n];
      for (std::size_t l = 0; l < N; ++l) {
        auto x = of_solids<D>(f.place(n)) - group.image;
        auto taken = solids::point<D>::of([&](std::size_t c) { return -V * of(a.sum[l][c], -1); });
        mirror_load(f, group, x, taken);
        const auto turning = solids::moment<D>(x - centre, taken);
        for (std::size_t k = 0; k < N; ++k) mine[N * k + l].add(k < D ? taken[k] : turning[k - D]);
      }
    });
  }
};

// m/s2, at x, of a body whose acceleration has this component alone, and is one.
template <int D>
solids::point<D> unit_motion(std::size_t component, const solids::point<D>& from_centre) {
  solids::rigid<D> e;
  e[component] = 1.0;
  return e.linear + solids::cross<D>(e.turning, from_centre);
}

// Collective. G of the wall particles of free bodies, and of their images.
template <int D>
void find_responses(water<D>& f) {
  constexpr std::size_t N = solids::rigid<D>::components;
  auto& w = f.world.w;
  const auto& s = w.s;
  const auto& walls = f.world.walls;
  const auto response = [&](std::size_t j, std::size_t i) {
    std::array<double, N> G{};
    const auto* b = f.mover(s.material[i]);
    if (b == nullptr || !b->free) return G;
    const auto x_i = of_solids<D>(f.place(i)), x_j = of_solids<D>(f.place(j));
    const auto middle = 0.5 * (x_i + x_j) - f.image_at(b->body, x_i) - b->rate.centre;
    for (std::size_t k = 0; k < N; ++k) G[k] = -s.rho[j] * foundation::dot(unit_motion<D>(k, middle), x_i - x_j);
    return G;
  };
  walls::at_bodies<N, 0>(w, walls, response, [&](std::size_t i, const auto&, double, const auto& mean) {
    for (std::size_t k = 0; k < N; ++k) f.response[k][i] = mean[k];
  });
  const auto fields = f.response.data();
  domain::exchange<D>(w.d.ranks, w.d.wall_halo, std::span<double* const>(fields));
  for (std::size_t k = 0; k < N; ++k)
    walls::fill_image_range(walls, s, walls.images_of_fluid, walls.source.size(), walls::even({&f.response[k]}));
}

// Collective, after find_responses(). Of each free body, by exact sums.
template <int D>
std::vector<solids::rigid_matrix<D>> find_added_masses(water<D>& f) {
  constexpr std::size_t N = solids::rigid<D>::components;
  const auto& s = f.world.w.s;
  std::fill(f.volume_in_bodies.begin(), f.volume_in_bodies.end(), 0.0);
  std::vector<solids::rigid_matrix<D>> all;
  for (const auto& b : f.moving) {
    if (!b.free) continue;
    std::vector<typename added_mass<D>::sums> of_threads(static_cast<std::size_t>(omp_get_max_threads()));
    for (const auto& group : f.groups) {
      if (group.body != b.body) continue;
      for (const std::size_t i : group.members) f.volume_in_bodies[i] = s.dV[i];
      f.world.w.sum(f.rows_near_bodies,
                    added_mass<D>{f, group, b.rate.centre, f.volume_in_bodies.data(), f.response.read(), of_threads});
      for (const std::size_t i : group.members) f.volume_in_bodies[i] = 0.0;
    }
    for (std::size_t t = 1; t < of_threads.size(); ++t)
      for (std::size_t k = 0; k < N * N; ++k) of_threads[0][k].add(of_threads[t][k]);
    const auto total = f.ranks().exact(std::span(of_threads[0]));
    solids::rigid_matrix<D> m;
    for (std::size_t k = 0; k < N; ++k)
      std::copy_n(total.begin() + static_cast<std::ptrdiff_t>(N * k), N, m[k].begin());
    all.push_back(m);
  }
  return all;
}

// m/s2, where its centre is.
template <int D>
solids::point<D> gravity_on(const water<D>& f, const moving_body<D>& b) {
  point x{};
  const auto centre = b.centre_of_mass();
  for (std::size_t a = 0; a < D; ++a) x[a] = centre[a];
  return solids::point<D>::of([&](std::size_t a) { return f.world.w.g[a] + f.sources.force_at(a, x); });
}

// N, and N m about its pivot, of springs, dampers and of the weight about a hinge.
template <int D>
solids::rigid<D> pulls_on(const water<D>& f, const moving_body<D>& b) {
  auto all = b.pulled();
  if (b.free->hinged())
    all.turning += solids::moment<D>(b.centre_of_mass() - b.rate.centre, b.free->mass * gravity_on(f, b));
  return all;
}

// Collective, after the water's sums, for which free bodies had no acceleration but that of their spin: their
// acceleration, and the sums of the water beside bodies with it. What it does to each body then.
template <int D>
std::vector<load<D>> accelerate_free_bodies(water<D>& f) {
  std::vector<std::size_t> bodies;
  std::vector<solids::point<D>> about;
  for (const auto& b : f.moving)
    if (b.free) {
      bodies.push_back(b.body);
      about.push_back(b.rate.centre);
    }
  const auto before = loads_on(f, bodies, about);
  find_responses(f);
  const auto added = find_added_masses(f);
  std::size_t n = 0;
  for (auto& b : f.moving) {
    if (!b.free) continue;
    const auto pulled = pulls_on(f, b);
    const auto A = b.free->acceleration(b.now.turned, gravity_on(f, b),
                                        {before[n].force + pulled.linear, before[n].moment + pulled.turning}, added[n],
                                        held_components(f, b));
    b.rate.acceleration = A.linear;
    b.rate.angular_acceleration = A.turning;
    ++n;
  }
  mirror(f);
  sum_over_neighbours(f, f.rows_near_bodies);
  auto loads = loads_on(f, bodies, about);
  for (std::size_t k = 0; k < loads.size(); ++k) {
    const auto held = held_turns(f, bodies[k]);
    for (std::size_t turn = 0; turn < held.size(); ++turn)
      if (held[turn]) loads[k].moment[turn] = 0.0;
  }
  return loads;
}
template <int D>
void forget_accelerations(water<D>& f) {
  for (auto& b : f.moving)
    if (b.free) b.rate.acceleration = {}, b.rate.angular_acceleration = {};
}

// Rates of the free bodies' state, on rank 0, an array a component.
template <int D>
void find_rates_of_bodies(const water<D>& f, const std::vector<load<D>>& loads, std::span<double* const> rate) {
  if (f.ranks().rank != 0) return;
  constexpr std::size_t angles = moving_body<D>::angles, turns = moving_body<D>::turns;
  std::size_t n = 0;
  for (const auto& b : f.moving) {
    if (!b.free) continue;
    const auto pulled = pulls_on(f, b);
    const auto held = held_components(f, b);
    for (std::size_t a = 0; a < D; ++a) {
      rate[a][n] = b.rate.velocity[a];
      rate[D + a][n] = held[a] ? 0.0 : (loads[n].force[a] + pulled[a]) / b.free->mass + gravity_on(f, b)[a];
    }
    const auto& w = b.rate.angular;
    if constexpr (D == 2) {
      rate[2 * D][n] = w[0];
    } else {  // q' = (0, ω) q/2
      const auto q = [&](std::size_t k) { return f.free.state[2 * D + k][n]; };
      rate[2 * D][n] = -0.5 * (w[0] * q(1) + w[1] * q(2) + w[2] * q(3));
      rate[2 * D + 1][n] = 0.5 * (w[0] * q(0) + w[1] * q(3) - w[2] * q(2));
      rate[2 * D + 2][n] = 0.5 * (w[1] * q(0) + w[2] * q(1) - w[0] * q(3));
      rate[2 * D + 3][n] = 0.5 * (w[2] * q(0) + w[0] * q(2) - w[1] * q(1));
    }
    for (std::size_t a = 0; a < turns; ++a)
      rate[2 * D + angles + a][n] = held[D + a] ? 0.0 : (loads[n].moment[a] + pulled[D + a]) / b.spin_scale();
    ++n;
  }
}

}  // namespace tetsuame::free_surface
