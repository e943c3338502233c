// Virtual markers: the mirror images of wall particles, inside the fluid, whose values are those of the fluid about
// them. What the treatments do with these: treatments.hpp.
#pragma once

#include <algorithm>
#include <bit>
#include <cells/grid.hpp>
#include <diffusion/viscosity.hpp>
#include <foundation/threads.hpp>
#include <type_traits>
#include <walls/interpolation.hpp>
#include <walls/marker_lists.hpp>
#include <walls/turned.hpp>
#include <walls/wall_set.hpp>

namespace tetsuame::walls::detail {

// What markers see, packed: fours of numbers a particle, in the first the position in units of the reach and as many
// fields as have room beside it. Null stands for a field of zeros.
template <int D>
struct marker_records {
  static constexpr std::size_t most = 2, room = 4 - D;  // fours; fields in the first
  std::size_t size;                                     // numbers
  const double* first;

  static constexpr std::size_t fours(std::size_t fields) { return fields > room ? 2 : 1; }

  marker_records(const pairs::workspace<D>& w, const wall_set<D>& set, const marker_rows& rows,
                 std::span<const double* const> fields)
      : size(4 * fours(fields.size())) {
    const std::size_t n = rows.listed.size(), numbers = size;
    const double per_reach = 1.0 / set.reach;
    auto& scratch = w.list.records.doubles;
    if (scratch.size() < n * numbers) scratch.resize(n * numbers);
    double* const all = scratch.data();
    first = all;
    foundation::for_all(n, [&](std::size_t k) {
      const std::size_t j = rows.listed[k];
      double* const record = all + k * numbers;
      for (std::size_t a = 0; a < D; ++a) record[a] = w.s.x[a][j] * per_reach;
      for (std::size_t f = 0; f + D < numbers; ++f)
        record[D + f] = f < fields.size() && fields[f] != nullptr ? fields[f][j] : 0.0;
    });
  }
};

// Fields of which there are sums, side by side in registers of their own.
template <std::size_t N>
struct side_by_side {
  static constexpr std::size_t width = std::min(lanes, std::bit_ceil(N)), registers = (N + width - 1) / width,
                               size = registers * width;
  using part = pairs::stdx::simd<double, pairs::stdx::simd_abi::deduce_t<double, width>>;
  const double* first;

  // all: room, as aligned as a register.
  side_by_side(const marker_rows& rows, const std::array<const double*, N>& fields, double* all) : first(all) {
    foundation::for_all(rows.listed.size(), [&](std::size_t k) {
      for (std::size_t f = 0; f < N; ++f) all[k * size + f] = fields[f][rows.listed[k]];
    });
  }

  // Σ_j φ_j f_j of each field. Neighbour j adds to the sums of lane j modulo their number, whose sum is that of a
  // register (foundation::sum); it does so for all fields at once.
  std::array<double, N> sum(std::span<const std::uint32_t> row, const double* phi) const {
    std::array<std::array<part, registers>, lanes> sums;
    for (auto& of_lane : sums) of_lane.fill(0.0);
    for (std::size_t k = 0; k < row.size(); k += lanes)
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const double* f = first + row[k + lane] * size;
        for (std::size_t g = 0; g < registers; ++g)
          sums[lane][g] += phi[k + lane] * part(f + g * width, pairs::stdx::vector_aligned);
      }
    for (std::size_t half = lanes / 2; half > 0; half /= 2)
      for (std::size_t lane = 0; lane < half; ++lane)
        for (std::size_t g = 0; g < registers; ++g) sums[lane][g] += sums[lane + half][g];
    std::array<double, size> total;
    for (std::size_t g = 0; g < registers; ++g)
      sums[0][g].copy_to(total.data() + g * width, pairs::stdx::element_aligned);
    std::array<double, N> wanted;
    std::copy_n(total.begin(), N, wanted.begin());
    return wanted;
  }
};

// The kernel stretched to the markers' reach, in units of that, and the marker of a row in the same.
template <int D, class Kernel>
struct marker_view {
  const Kernel& kernel;
  real nearest{kernel.smallest_r() * kernel.smallest_r()};
  vec<real, D> x;

  marker_view(const wall_set<D>& set, std::size_t r, const Kernel& in_reaches)
      : kernel(in_reaches), x(vec<real, D>::of([&](std::size_t a) { return set.marker[a][r] * (1.0 / set.reach); })) {}

  // Particles whose records begin with these numbers.
  [[gnu::always_inline]] seen<D> operator()(const std::array<real, 4>& record) const {
    seen<D> j;
    j.offset = vec<real, D>::of([&](std::size_t a) { return record[a] - x[a]; });
    const real r2 = foundation::greater(foundation::dot(j.offset, j.offset), nearest);
    j.weight = kernel.value(foundation::both_roots(r2).r);
    return j;
  }
};

// f(order as a constant).
template <class F>
void with_order(const options& how, F&& f) {
  const int order = polynomial_order(how.interpolation);
  if (order == 0) f(std::integral_constant<int, 0>{});
  if (order == 1) f(std::integral_constant<int, 1>{});
  if (order == 2) f(std::integral_constant<int, 2>{});
}

// The fluid about a marker, one a lane. `flatten`: as in pairs::sum_row.
template <int D, class Kernel>
[[gnu::flatten]] void see(std::vector<seen<D>>& near, std::span<const std::uint32_t> row, const double* places,
                          const marker_view<D, Kernel>& view) {
  near.resize(row.size() / lanes);
  const std::uint32_t* of_lane = row.data();
  for (auto& j : near) {
    j = view(turned(places, of_lane));
    of_lane += lanes;
  }
}

// Σ_j φ_j f_j of the fields in the records, which are so many fours of numbers, by the coefficients c of φ.
template <int D, int Order, std::size_t fours, class Kernel>
[[gnu::flatten]] std::array<double, 4 * fours - D> interpolate(std::span<const std::uint32_t> row, const double* first,
                                                               const double* c, const marker_view<D, Kernel>& view) {
  constexpr std::size_t fields = 4 * fours - D;
  std::array<real, fields> sums;
  foundation::for_each_of<fields>([&](std::size_t f) { sums[f] = 0.0; });
  for (std::size_t k = 0; k < row.size(); k += lanes) {
    const auto record = turned<4 * fours>(first, row.data() + k);
    const auto phi = detail::shape_function<D, Order>(view(record), c);
    foundation::for_each_of<4 - D>([&](std::size_t f) { sums[f] += phi * record[D + f]; });
    if constexpr (fours > 1) {
      const auto more = turned<4 * fours>(first + 4, row.data() + k);
      foundation::for_each_of<4>([&](std::size_t f) { sums[4 - D + f] += phi * more[f]; });
    }
  }
  std::array<double, fields> total;
  for (std::size_t f = 0; f < fields; ++f) total[f] = foundation::sum(sums[f]);
  return total;
}

// With the first sweep over the markers of an evaluation: finds the coefficients of the shape functions.
// f(r, values) for the marker of each wall particle r, with the values of these fields at it, Σ_j φ_j f_j(x_m).
template <int D, std::size_t N, class F>
void find_shapes(const pairs::workspace<D>& w, const wall_set<D>& set, marker_rows& rows,
                 const std::array<const double*, N>& fields, F&& f) {
  const std::size_t of_places = (rows.listed.size() * 4 + lanes - 1) / lanes * lanes;
  auto& scratch = w.list.records.doubles;
  const std::size_t needed = of_places + rows.listed.size() * side_by_side<N>::size;
  if (scratch.size() < needed) scratch.resize(needed);
  const marker_records<D> records(w, set, rows, {});
  const side_by_side<N> values(rows, fields, scratch.data() + of_places);
  const int order = polynomial_order(set.how.interpolation);
  const std::size_t n = rows.near.rows();
  std::visit(
      [&]<class Kernel>(const Kernel&) {
        const Kernel kernel(1.0);
#pragma omp parallel if (n > foundation::rows_worth_threads)
        {
          std::vector<seen<D>> near;
          std::vector<double> phi;
#pragma omp for schedule(static)
          for (std::size_t k = 0; k < n; ++k) {
            const auto row = rows.near.row(k);
            see(near, row, records.first, marker_view<D, Kernel>(set, rows.of[k], kernel));
            double* const c = rows.coefficients.data() + k * terms(order, D);
            coefficients<D>(near, order, c);
            phi.resize(near.size() * lanes);
            shape_functions<D>(near, order, c, phi.data());
            f(rows.of[k], values.sum(row, phi.data()));
          }
        }
      },
      w.kernel);
}

// The same in the sweeps that follow, which make the φ_j anew: kept, they would take as much memory as the fluid's own
// lists.
template <int D, class F>
void for_each_marker(const pairs::workspace<D>& w, const wall_set<D>& set, const marker_rows& rows,
                     std::span<const double* const> fields, F&& f) {
  const marker_records<D> records(w, set, rows, fields);
  const std::size_t n = rows.near.rows();
  const auto sweep = [&](auto fours, auto order, const auto& view_of) {
    constexpr int Order = decltype(order)::value;
#pragma omp parallel for schedule(static) if (n > foundation::rows_worth_threads)
    for (std::size_t k = 0; k < n; ++k)
      f(rows.of[k],
        interpolate<D, Order, decltype(fours)::value>(
            rows.near.row(k), records.first, rows.coefficients.data() + k * terms(Order, D), view_of(rows.of[k])));
  };
  std::visit(
      [&]<class Kernel>(const Kernel&) {
        const Kernel kernel(1.0);
        const auto view_of = [&](std::size_t r) { return marker_view<D, Kernel>(set, r, kernel); };
        with_order(set.how, [&](auto order) {
          if (records.size == 4)
            sweep(std::integral_constant<std::size_t, 1>{}, order, view_of);
          else
            sweep(std::integral_constant<std::size_t, 2>{}, order, view_of);
        });
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
  set.unread.reset();
  if (set.complete) find_unread(w, set);
  for_all_rows(set, [&](marker_rows& rows) {
    find_shapes<D>(w, set, rows, arrays, [&](std::size_t r, const auto& values) {
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

// Axes that have walls.
template <int D>
std::vector<std::size_t> walled_axes(const wall_set<D>& set) {
  std::vector<std::size_t> axes;
  for (std::size_t a = 0; a < D; ++a)
    if (!set.f[a].empty()) axes.push_back(a);
  return axes;
}

// Σ of the viscous forces (N) on these rows, of N components.
template <int D, std::size_t N>
void viscous_forces(const pairs::workspace<D>& w, const pairs::chosen& rows, const std::array<const double*, N>& v,
                    const std::array<double*, N>& force) {
  using diffusion::viscous_sum;
  const auto& s = w.s;
  if (w.uniform_transport)
    w.sum(rows, viscous_sum<D, double, N, false>{v, *w.uniform_transport, s.dV.data(), force});
  else
    w.sum(rows, viscous_sum<D, const double*, N, false>{v, s.eta.data(), s.dV.data(), force});
}

// f = ν∇²v + g of the fluid near the walls, ghosts included, along axes that have walls. Along one alone it takes a
// third less.
template <int D>
void nonpressure_acceleration(pairs::workspace<D>& w, wall_set<D>& set) {
  auto& s = w.s;
  const auto axes = walled_axes(set);
  std::vector<double*> wanted;
  for (const std::size_t a : axes) wanted.push_back(set.f[a].data());
  for_all_rows(set, [&](const marker_rows& of) {
    const auto& rows = of.near_wall.rows;
    for (double* f : wanted) foundation::for_all(rows.size(), [&](std::size_t k) { f[rows[k]] = 0.0; });
    if (axes.size() == 1) {
      viscous_forces<D, 1>(w, of.near_wall, {s.v[axes[0]].data()}, {wanted[0]});
    } else {
      // Along axes without walls nobody reads it.
      std::array<double*, D> f;
      particles::array unread(axes.size() < D ? s.total() + 1 : 0);
      for (std::size_t a = 0; a < D; ++a) f[a] = set.f[a].empty() ? unread.data() : set.f[a].data();
      viscous_forces<D, D>(w, of.near_wall, pairs::pointers<D>(s.v), f);
    }
    for (std::size_t n = 0; n < axes.size(); ++n)
      foundation::for_all(rows.size(), [&](std::size_t k) {
        double& f = wanted[n][rows[k]];
        f = f / s.m[rows[k]] + w.g[axes[n]];
      });
  });
  domain::exchange<D>(w.d.ranks, w.d.fluid_halo, std::span<double* const>(wanted));
}

// put(i, values) for each wall particle i, with the values of these fields at its marker. Where the momentum balance's
// steps are due, the same sweep makes them: a pressure and a weight that grow from marker to wall particle,
// linear in the fluid's values. Both lie apart along axes that have walls.
template <int D, class Put>
void at_markers(const pairs::workspace<D>& w, wall_set<D>& set, std::vector<const double*> fields, Put&& put) {
  const auto& s = w.s;
  const std::size_t n = fields.size();
  const auto axes = set.steps_due ? walled_axes(set) : std::vector<std::size_t>{};
  for (const std::size_t a : axes) fields.push_back(set.f[a].data());
  for_all_rows(set, [&](const marker_rows& rows) {
    for_each_marker<D>(w, set, rows, fields, [&](std::size_t r, const auto& values) {
      const std::size_t i = s.first_wall() + r;
      if (set.steps_due) {
        double f_dx = 0.0;
        for (std::size_t k = 0; k < axes.size(); ++k)
          f_dx += values[n + k] * (s.x[axes[k]][i] - set.marker[axes[k]][r]);
        set.pressure_step[r] = s.rho[i] * f_dx;
        set.weight_step[r] = set.mass[r] * f_dx;
      }
      put(i, values);
    });
  });
  set.steps_due = false;
}

template <int D>
void marker_weights(pairs::workspace<D>& w, wall_set<D>& set) {
  auto& s = w.s;
  at_markers<D>(w, set, {s.Y.data()},
                [&](std::size_t i, const auto& values) { s.Y[i] = values[0] + set.weight_step[i - s.first_wall()]; });
  w.exchange_walls({s.Y.data()});
}

template <int D>
void marker_pressures(pairs::workspace<D>& w, wall_set<D>& set) {
  auto& s = w.s;
  at_markers<D>(w, set, {s.p.data(), s.dV.data()}, [&](std::size_t i, const auto& values) {
    s.p[i] = values[0] + set.pressure_step[i - s.first_wall()];
    s.dV[i] = values[1];
  });
  w.exchange_walls({s.p.data(), s.dV.data()});
}

}  // namespace tetsuame::walls::detail
