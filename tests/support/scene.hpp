// Small boxes of particles for unit tests: the run's own start (hydrostatic::set_up, rebuild)
// without an input file, with positions and fields disturbed by numbers that depend on the
// particle's ID alone, so that every decomposition sees the same particles.
#pragma once

#include <boost/test/unit_test.hpp>
#include <cmath>
#include <cstdint>
#include <hydrostatic/setup.hpp>
#include <string>
#include <vector>

#include "numbers.hpp"

namespace tetsuame::test {

inline constexpr double epsilon = std::numeric_limits<double>::epsilon();

// n[a] particles of spacing 1 m along axis a; linear EOS, p = p0 = 1e10 Pa at rho0 = 7000 kg/m3, K_T = 1e11 Pa.
template <int D>
hydrostatic::options box(std::array<std::int64_t, D> n, bool periodic, const std::string& treatment = "none",
                         const std::string& kernel = "quintic") {
  hydrostatic::options o;
  o.domain.dimension = D;
  for (std::size_t a = 0; a < D; ++a) {
    o.domain.particles[a] = n[a];
    o.domain.length[a] = static_cast<double>(n[a]);
    o.domain.periodic[a] = periodic;
  }
  o.initial.profile = "uniform";
  o.kernel.name = kernel;
  o.kernel.h_over_dx = kernels::find(kernel).default_h_over_dx;
  o.walls.treatment = treatment;
  o.material.eos.reference_pressure = o.initial.pressure;
  return o;
}

// Moves every fluid particle: x = at(id, x of the lattice); what left a periodic box is wrapped.
template <int D, class At>
hydrostatic::scene<D> make_scene(const hydrostatic::options& o, const domain::communicator& ranks, At&& at) {
  hydrostatic::scene<D> scene;
  hydrostatic::set_up<D>(o, ranks, scene);
  auto& s = scene.w.s;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const auto x = at(s.id[i], cells::position<D>(s.x, i));
    for (std::size_t a = 0; a < D; ++a) s.x[a][i] = x[a];
  }
  domain::wrap<D>(scene.w.d.region, s);
  hydrostatic::rebuild<D>(scene);
  return scene;
}

// The lattice with every coordinate moved by up to `jitter` spacings.
template <int D>
hydrostatic::scene<D> make_scene(const hydrostatic::options& o, const domain::communicator& ranks,
                                 double jitter = 0.0) {
  return make_scene<D>(o, ranks, [&](std::int64_t id, std::array<double, D> x) {
    for (std::size_t a = 0; a < D; ++a) x[a] += jitter * o.domain.dx() * noise(id, 100 + a);
    return x;
  });
}

// f = value(i) for the owned fluid, then for its ghosts.
template <int D, class Value>
void fill(const pairs::workspace<D>& w, particles::array& f, Value&& value) {
  for (std::size_t i = 0; i < w.s.fluid; ++i) f[i] = value(i);
  w.exchange_fluid({f.data()});
}
// f between low and high, by ID.
template <int D>
void randomise(const pairs::workspace<D>& w, particles::array& f, std::uint64_t salt, double low, double high) {
  fill<D>(w, f, [&](std::size_t i) { return low + (high - low) * 0.5 * (1.0 + noise(w.s.id[i], salt)); });
}

// Values of the block [begin, begin + n) by ID, on all ranks; IDs from `first` on. What no rank has is zero.
inline std::vector<double> by_id(const domain::communicator& ranks, const std::vector<std::int64_t>& id,
                                 std::size_t begin, std::size_t n, const particles::array& f, std::int64_t first,
                                 std::int64_t total) {
  std::vector<double> all(static_cast<std::size_t>(total), 0.0);
  for (std::size_t i = begin; i < begin + n; ++i) all[static_cast<std::size_t>(id[i] - first)] = f[i];
  MPI_Allreduce(MPI_IN_PLACE, all.data(), static_cast<int>(total), MPI_DOUBLE, MPI_SUM, ranks.comm);
  return all;
}
template <int D>
std::vector<double> fluid_by_id(const hydrostatic::scene<D>& scene, const particles::array& f) {
  const auto& w = scene.w;
  return by_id(w.d.ranks, w.s.id, 0, w.s.fluid, f, 0, scene.fluid_total);
}
template <int D>
std::vector<double> walls_by_id(const hydrostatic::scene<D>& scene, const particles::array& f) {
  const auto& w = scene.w;
  const auto total = w.d.ranks.sum(static_cast<std::int64_t>(w.s.walls));
  // IDs of the walls count lattice places, those of the fluid among them: leave room.
  return by_id(w.d.ranks, w.s.id, w.s.first_wall(), w.s.walls, f, scene.fluid_total, total + scene.fluid_total);
}

// Sum over all owned fluid of all ranks, rounded once, and of the absolute values.
struct totals {
  double sum, magnitude;
};
template <int D, class Value>
totals total(const pairs::workspace<D>& w, Value&& value) {
  foundation::exact_sum sum, magnitude;
  for (std::size_t i = 0; i < w.s.fluid; ++i) {
    sum.add(value(i));
    magnitude.add(std::abs(value(i)));
  }
  return {w.d.ranks.exact(sum), w.d.ranks.exact(magnitude)};
}

// The pair loop with one kernel type, which keeps tests light to compile.
template <int D, class Kernel = kernels::quintic_spline<D>, class... Terms>
void sum(const pairs::workspace<D>& w, const Terms&... terms) {
  pairs::sum_over<D>(w.fluid(), w.list, w.x(), std::get<Kernel>(w.kernel), terms...);
}

// f(j, x_ij, r) for the neighbours of i in reach of the kernel, found without lists: all
// local particles, one after the other.
template <int D, class F>
void neighbours_of(const pairs::workspace<D>& w, std::size_t i, F&& f) {
  const auto& s = w.s;
  for (std::size_t j = 0; j < s.total(); ++j) {
    if (j == i) continue;
    std::array<double, D> x_ij;
    double r2 = 0.0;
    for (std::size_t a = 0; a < D; ++a) {
      x_ij[a] = s.x[a][i] - s.x[a][j];
      r2 += x_ij[a] * x_ij[a];
    }
    if (r2 < w.support() * w.support()) f(j, x_ij, std::sqrt(r2));
  }
}

}  // namespace tetsuame::test
