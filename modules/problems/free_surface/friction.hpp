// The viscous part of the force of the water on a body, of the sums that are the same in both schemes:
//   -2 (D+2) Σ_i Σ_w η V_i V_w (v_iw·x_iw)/|x_iw|² ∇_i W_iw
#pragma once

#include <omp.h>

#include <free_surface/loads.hpp>

namespace tetsuame::free_surface {

// Of those wall particles of one image of a body that have a volume in V_w.
template <int D>
struct friction {
  using kernels = kernels_of_water<D>;
  static constexpr std::size_t N = solids::rigid<D>::components;
  using sums = std::array<foundation::exact_sum, N>;

  const water<D>& f;
  const wall_group<D>& group;
  solids::point<D> centre;         // m
  const double* V_w;               // m^D
  std::array<const double*, D> v;  // m/s, of the viscous sum
  double eta;                      // Pa s
  std::vector<sums>& of_threads;

  template <class R>
  struct me {
    pairs::vec<R, D> sum;
    R viscous;  // 2 (D+2) η: the same for all
  };
  auto reads() const { return std::tuple{pairs::read(pairs::of_volume, V_w, D), pairs::read(pairs::of_velocity, v)}; }
  template <class R>
  me<R> begin(const pairs::cluster<R>& i) const {
    return {foundation::zero<R, D>(), R(2.0 * (D + 2.0) * eta * i.lengths.to(-1))};
  }
  void add(auto& a, const auto& ij) const {
    const auto closing = ij.along(pairs::of_velocity) * ij.per_r * ij.per_r;
    a.sum += (ij(pairs::of_volume) * ij.F * a.viscous * closing) * ij.x_ij;
  }
  void end(const auto& i, const auto& a) const {
    auto& mine = of_threads[static_cast<std::size_t>(omp_get_thread_num())];
    i.each([&](std::size_t n, const auto& of) {
      const double V = f.world.w.s.dV[n];
      auto x = of_solids<D>(f.place(n)) - group.image;
      auto by = solids::point<D>::of([&](std::size_t c) { return -V * of(a.sum[c], -1); });
      mirror_load(f, group, x, by);
      const auto turning = solids::moment<D>(x - centre, by);
      for (std::size_t k = 0; k < N; ++k) mine[k].add(k < D ? by[k] : turning[k - D]);
    });
  }
};

// Collective, after the water's sums. On a body that moves, about its centre.
template <int D>
load<D> friction_on(water<D>& f, const moving_body<D>& b) {
  constexpr std::size_t N = solids::rigid<D>::components;
  const auto& s = f.world.w.s;
  const auto v = f.two_velocities ? f.viscous_velocity.read() : pairs::pointers<D>(s.v);
  const double eta = f.o.flow.density * f.p.kinematic_viscosity;
  std::fill(f.volume_in_bodies.begin(), f.volume_in_bodies.end(), 0.0);
  std::vector<typename friction<D>::sums> of_threads(static_cast<std::size_t>(omp_get_max_threads()));
  for (const auto& group : f.groups) {
    if (group.body != b.body) continue;
    for (const std::size_t i : group.members) f.volume_in_bodies[i] = s.dV[i];
    f.world.w.sum(f.rows_near_bodies,
                  friction<D>{f, group, b.rate.centre, f.volume_in_bodies.data(), v, eta, of_threads});
    for (const std::size_t i : group.members) f.volume_in_bodies[i] = 0.0;
  }
  for (std::size_t t = 1; t < of_threads.size(); ++t)
    for (std::size_t k = 0; k < N; ++k) of_threads[0][k].add(of_threads[t][k]);
  const auto total = f.ranks().exact(std::span(of_threads[0]));
  load<D> all;
  for (std::size_t k = 0; k < N; ++k) (k < D ? all.force[k] : all.moment[k - D]) = total[k];
  return all;
}

}  // namespace tetsuame::free_surface
