// Virtual markers: the mirror images of wall particles, inside the fluid, whose values are those of the fluid about
// them. What the treatments do with these: treatments.hpp.
#pragma once

#include <algorithm>
#include <bit>
#include <diffusion/viscosity.hpp>
#include <foundation/threads.hpp>
#include <walls/interpolation.hpp>
#include <walls/turned.hpp>
#include <walls/wall_set.hpp>

namespace tetsuame::walls::detail {

// `listed`: all that some marker sees; from then on the list counts in it. Rows were filled up with `null`.
template <int D>
void count_in_listed(wall_set<D>& set, std::size_t null) {
  constexpr std::uint32_t unseen = 0xffffffff;
  std::vector<std::uint32_t> place(null + 1, unseen);
  place[null] = 0;
  for (const std::uint32_t j : set.near_marker.all) place[j] = 0;
  set.listed.clear();
  for (std::size_t i = 0; i < place.size(); ++i)
    if (place[i] == 0) {
      place[i] = static_cast<std::uint32_t>(set.listed.size());
      set.listed.push_back(static_cast<std::uint32_t>(i));
    }
  for (std::uint32_t& j : set.near_marker.all) j = place[j];
}

// Lists of the fluid near each marker and of the fluid near the walls.
template <int D>
void prepare_markers(pairs::workspace<D>& w, wall_set<D>& set, const cells::grid<D>& grid, double skin) {
  const auto& s = w.s;
  set.reach = radius_factor(set.how) * w.support();
  cells::make_list_of_points<D>(
      set.near_marker, grid, s.walls, set.reach + skin, static_cast<std::uint32_t>(s.null()),
      [&](std::size_t r) { return cells::position<D>(set.marker, r); },
      [&](std::uint32_t j) { return j < s.first_wall(); });
  set.pressure_step.assign(s.walls, 0.0);
  set.weight_step.assign(s.walls, 0.0);
  set.mass.assign(s.walls, 0.0);
  set.steps_due = false;
  set.coefficients.assign(s.walls * terms(polynomial_order(set.how.interpolation), D), 0.0);
  for (const auto& wall : set.sides) set.f[wall.axis].assign(s.total() + 1, 0.0);

  double depth = 0.0;
  for (std::size_t r = 0; r < s.walls; ++r)
    for (const auto& wall : set.sides)
      depth = std::max(depth, (set.marker[wall.axis][r] - wall.position) * wall.inward *
                                  ((set.mirrored[r] >> (&wall - set.sides.data()) & 1U) != 0 ? 1.0 : 0.0));
  depth = w.d.ranks.maximum(depth) + set.reach + skin;
  count_in_listed(set, s.null());
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < s.fluid; ++i)
    for (const auto& wall : set.sides)
      if ((s.x[wall.axis][i] - wall.position) * wall.inward < depth) {
        near.push_back(i);
        break;
      }
  set.near_wall = pairs::choose(w.list, std::move(near), s.total());
}

// Fields of the fluid that markers see, packed: the position, whose components lanes take, and the fields of which
// there are sums, side by side in registers of their own. Null stands for a field of zeros.
template <int D, std::size_t N>
struct marker_records {
  static constexpr std::uint32_t components = 4;  // of a position
  static constexpr std::size_t width = std::min(lanes, std::bit_ceil(N)), registers = (N + width - 1) / width,
                               size = registers * width;
  using part = pairs::stdx::simd<double, pairs::stdx::simd_abi::deduce_t<double, width>>;
  static_assert(D <= components);

  const double *places, *fields;

  marker_records(const pairs::workspace<D>& w, const wall_set<D>& set, const std::array<const double*, N>& arrays) {
    const std::size_t n = set.listed.size(), before = (n * components + lanes - 1) / lanes * lanes;
    auto& scratch = w.list.records.doubles;
    if (scratch.size() < before + n * size) scratch.resize(before + n * size);
    double *x = scratch.data(), *f = x + before;
    places = x;
    fields = f;
    foundation::for_all(n, [&](std::size_t k) {
      const std::size_t j = set.listed[k];
      for (std::size_t a = 0; a < D; ++a) x[k * components + a] = w.s.x[a][j];
      for (std::size_t a = 0; a < N; ++a) f[k * size + a] = arrays[a] != nullptr ? arrays[a][j] : 0.0;
    });
  }
};

// The fluid about the marker of row r, one a lane. `flatten`: as in pairs::sum_row.
template <int D, class Kernel>
[[gnu::flatten]] void see(std::vector<seen<D>>& near, const wall_set<D>& set, std::size_t r, const double* places,
                          const Kernel& kernel) {
  const auto row = set.near_marker.row(r);
  near.resize(row.size() / lanes);
  vec<real, D> x;
  for (std::size_t a = 0; a < D; ++a) x[a] = real(set.marker[a][r]);
  const real per_reach(1.0 / set.reach);
  const real squeeze(kernel.support() / set.reach);  // the kernel's own radius, stretched to the marker's reach
  const real nearest(kernel.smallest_r() * kernel.smallest_r());
  const std::uint32_t* of_lane = row.data();
  for (auto& j : near) {
    const auto values = turned(places, of_lane);
    for (std::size_t a = 0; a < D; ++a) j.offset[a] = values[a] - x[a];
    const real r2 = foundation::dot(j.offset, j.offset);
    j.weight = kernel.value(real(foundation::both_roots(foundation::greater(r2, nearest)).r * squeeze));
    for (std::size_t a = 0; a < D; ++a) j.offset[a] *= per_reach;
    of_lane += lanes;
  }
}

// Σ_j φ_j f_j of each field. Neighbour j adds to the sums of lane j modulo their number, whose sum is that of a
// register (foundation::sum); it does so for all fields at once.
template <int D, std::size_t N>
std::array<double, N> sum_fields(std::span<const std::uint32_t> row, const double* phi,
                                 const marker_records<D, N>& records) {
  using of = marker_records<D, N>;
  std::array<std::array<typename of::part, of::registers>, lanes> sums;
  for (auto& of_lane : sums) of_lane.fill(0.0);
  for (std::size_t k = 0; k < row.size(); k += lanes)
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const double* f = records.fields + row[k + lane] * of::size;
      for (std::size_t g = 0; g < of::registers; ++g)
        sums[lane][g] += phi[k + lane] * typename of::part(f + g * of::width, pairs::stdx::vector_aligned);
    }
  for (std::size_t half = lanes / 2; half > 0; half /= 2)
    for (std::size_t lane = 0; lane < half; ++lane)
      for (std::size_t g = 0; g < of::registers; ++g) sums[lane][g] += sums[lane + half][g];
  std::array<double, of::size> all;
  for (std::size_t g = 0; g < of::registers; ++g)
    sums[0][g].copy_to(all.data() + g * of::width, pairs::stdx::element_aligned);
  std::array<double, N> total;
  std::copy_n(all.begin(), N, total.begin());
  return total;
}

// When the coefficients of the shape functions are found: with the first sweep over the markers of an evaluation.
enum class shapes { found, as_found };

// f(r, values) for each marker, with the values of these fields at it, Σ_j φ_j f_j(x_m). Each sweep makes the φ_j anew:
// kept, they would take as much memory as the fluid's own lists, and as long to read.
template <int D, std::size_t N, class F>
void for_each_marker(const pairs::workspace<D>& w, wall_set<D>& set, shapes when,
                     const std::array<const double*, N>& arrays, F&& f) {
  const marker_records<D, N> records(w, set, arrays);
  const int order = polynomial_order(set.how.interpolation);
  const std::size_t n = set.near_marker.rows();
  std::visit(
      [&](const auto& kernel) {
#pragma omp parallel if (n > foundation::rows_worth_threads)
        {
          std::vector<seen<D>> near;
          std::vector<double> phi;
#pragma omp for schedule(static)
          for (std::size_t r = 0; r < n; ++r) {
            see(near, set, r, records.places, kernel);
            double* const c = set.coefficients.data() + r * terms(order, D);
            if (when == shapes::found) coefficients<D>(near, order, c);
            phi.resize(near.size() * lanes);
            shape_functions<D>(near, order, c, phi.data());
            f(r, sum_fields(set.near_marker.row(r), phi.data(), records));
          }
        }
      },
      w.kernel);
}

// The fluid at the markers, mirrored. Transport: viscosity and conductivity too; without, all particles share them.
template <bool Transport, int D>
void marker_kinematics(pairs::workspace<D>& w, wall_set<D>& set) {
  auto& s = w.s;
  constexpr std::size_t N = D + 4 + (Transport ? 2 : 0);
  std::array<const double*, N> arrays;
  std::copy_n(pairs::pointers<D>(s.v).begin(), D, arrays.begin());
  const std::array<const double*, 6> scalars{s.T.data(), s.rho.data(), s.dV.data(),
                                             s.m.data(), s.eta.data(), s.k.data()};
  std::copy_n(scalars.begin(), N - D, arrays.begin() + D);
  for_each_marker<D>(w, set, shapes::found, arrays, [&](std::size_t r, const auto& values) {
    const std::size_t i = s.first_wall() + r;
    std::array<double, D> v;
    std::copy_n(values.begin(), D, v.begin());
    mirror_velocity<D>(set, r, v);
    for (std::size_t a = 0; a < D; ++a) s.v[a][i] = v[a];
    s.T[i] = mirror_temperature(set, r, values[D]);
    s.rho[i] = values[D + 1];
    s.dV[i] = values[D + 2];
    set.mass[r] = values[D + 3];
    if constexpr (Transport) s.eta[i] = values[D + 4], s.k[i] = values[D + 5];
  });
  if constexpr (Transport)
    w.exchange_walls(s.v, {s.T.data(), s.rho.data(), s.eta.data(), s.k.data(), s.dV.data()});
  else
    w.exchange_walls(s.v, {s.T.data(), s.rho.data(), s.dV.data()});
}

template <int D>
void marker_kinematics(pairs::workspace<D>& w, wall_set<D>& set) {
  w.uniform_transport ? marker_kinematics<false>(w, set) : marker_kinematics<true>(w, set);
}

// f = ν∇²v + g of the fluid near the walls, ghosts included, along axes that have walls.
template <int D>
void nonpressure_acceleration(pairs::workspace<D>& w, wall_set<D>& set) {
  auto& s = w.s;
  const auto& rows = set.near_wall.rows;
  std::array<double*, D> f;
  std::vector<double*> wanted;
  for (std::size_t a = 0; a < D; ++a) {
    f[a] = set.f[a].empty() ? nullptr : set.f[a].data();
    if (f[a] == nullptr) continue;
    wanted.push_back(f[a]);
    foundation::for_all(rows.size(), [&](std::size_t k) { f[a][rows[k]] = 0.0; });
  }
  const auto v = pairs::pointers<D>(s.v);
  if (w.uniform_transport)
    w.sum(set.near_wall, diffusion::uniform_viscosity<D>{v, *w.uniform_transport, s.dV.data(), f, nullptr});
  else
    w.sum(set.near_wall, diffusion::viscosity<D>{v, s.eta.data(), s.dV.data(), f, nullptr});
  for (std::size_t a = 0; a < D; ++a)
    if (f[a] != nullptr)
      foundation::for_all(rows.size(), [&](std::size_t k) { f[a][rows[k]] = f[a][rows[k]] / s.m[rows[k]] + w.g[a]; });
  domain::exchange<D>(w.d.ranks, w.d.fluid_halo, std::span<double* const>(wanted));
}

// put(i, values) for each wall particle i, with the values of these fields at its marker. Where the momentum balance's
// steps are due, the same sweep makes them: a pressure and a weight that grow from marker to wall particle,
// linear in the fluid's values. Both lie apart along axes that have walls.
template <int D, std::size_t N, class Put>
void at_markers(const pairs::workspace<D>& w, wall_set<D>& set, const std::array<const double*, N>& arrays, Put&& put) {
  const auto& s = w.s;
  if (!set.steps_due)
    return for_each_marker<D>(w, set, shapes::as_found, arrays,
                              [&](std::size_t r, const auto& values) { put(s.first_wall() + r, values); });
  set.steps_due = false;
  std::array<const double*, N + D> all;
  std::copy_n(arrays.begin(), N, all.begin());
  for (std::size_t a = 0; a < D; ++a) all[N + a] = set.f[a].empty() ? nullptr : set.f[a].data();
  for_each_marker<D>(w, set, shapes::as_found, all, [&](std::size_t r, const auto& values) {
    const std::size_t i = s.first_wall() + r;
    double f_dx = 0.0;
    for (std::size_t a = 0; a < D; ++a) f_dx += values[N + a] * (s.x[a][i] - set.marker[a][r]);
    set.pressure_step[r] = s.rho[i] * f_dx;
    set.weight_step[r] = set.mass[r] * f_dx;
    put(i, values);
  });
}

template <int D>
void marker_weights(pairs::workspace<D>& w, wall_set<D>& set) {
  auto& s = w.s;
  at_markers<D, 1>(w, set, {s.Y.data()}, [&](std::size_t i, const auto& values) {
    s.Y[i] = values[0] + set.weight_step[i - s.first_wall()];
  });
  w.exchange_walls({s.Y.data()});
}

template <int D>
void marker_pressures(pairs::workspace<D>& w, wall_set<D>& set) {
  auto& s = w.s;
  at_markers<D, 2>(w, set, {s.p.data(), s.dV.data()}, [&](std::size_t i, const auto& values) {
    s.p[i] = values[0] + set.pressure_step[i - s.first_wall()];
    s.dV[i] = values[1];
  });
  w.exchange_walls({s.p.data(), s.dV.data()});
}

}  // namespace tetsuame::walls::detail
