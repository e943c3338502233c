// Virtual markers: the mirror images of wall particles, inside the fluid, whose values are those of the fluid about
// them. What the treatments do with these: treatments.hpp.
#pragma once

#include <algorithm>
#include <bit>
#include <cells/grid.hpp>
#include <diffusion/viscosity.hpp>
#include <foundation/threads.hpp>
#include <walls/interpolation.hpp>
#include <walls/marker_lists.hpp>
#include <walls/turned.hpp>
#include <walls/wall_set.hpp>

namespace tetsuame::walls::detail {

// That a thread takes: whole registers of them.
inline constexpr std::size_t markers_at_a_time = 32;

// How places stand in records, and what makes (x_j - x_m)/reach of them.
template <class R>
struct marker_places;

template <>
struct marker_places<real> {
  using number = double;
  using own_type = real;
  double per_reach;  // 1/m

  explicit marker_places(double reach) : per_reach(1.0 / reach) {}
  number number_of(double x) const { return x * per_reach; }
  own_type of_marker(double x) const { return x * per_reach; }
  [[gnu::always_inline]] real offset(const real& x_j, const own_type& x_m) const { return x_j - x_m; }
};

// In steps, whose differences are exact, as those of pairs in single precision.
template <>
struct marker_places<single> {
  using number = float;
  using steps = pairs::positions<single>;
  using own_type = steps::own_type;
  steps place;
  float step;  // of the reach

  explicit marker_places(double reach)
      : place(pairs::unit<single>(reach)), step(static_cast<float>(1.0 / (place.per_step * reach))) {}
  number number_of(double x) const { return place.number_of(x); }
  own_type of_marker(double x) const { return place.steps(x); }
  [[gnu::always_inline]] single offset(const single& x_j, const own_type& x_m) const {
    const auto apart =
        pairs::stdx::static_simd_cast<pairs::stdx::native_simd<std::int32_t>>(std::bit_cast<own_type>(x_j.all()) - x_m);
    return single(pairs::stdx::static_simd_cast<single::lanes_type>(apart) * step);
  }
};

// Room for so many numbers, behind others.
template <class Number, int D>
Number* scratch_of(const pairs::workspace<D>& w, std::size_t numbers, std::size_t behind = 0) {
  auto& scratch = w.list.records.template of<Number>();
  if (scratch.size() < behind + numbers) scratch.resize(behind + numbers);
  return scratch.data() + behind;
}

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

// φ_j of a row in doubles that add up to one; where they are kept in single precision, in a thread's scratch.
inline const double* shapes_of(const marker_rows& rows, std::size_t k, bool in_single, std::vector<double>& scratch) {
  const std::size_t first = rows.near.start[k], n = rows.near.start[k + 1] - first;
  if (!in_single) return rows.phi.doubles.data() + first;
  scratch.resize(n);
  const float* const phi = rows.phi.singles.data() + first;
  for (std::size_t j = 0; j < n; ++j) scratch[j] = rows.scale[k] * static_cast<double>(phi[j]);
  return scratch.data();
}

// What the search for shape functions needs of an evaluation.
template <int D, class R>
struct shape_search {
  const wall_set<D>& set;
  marker_rows& rows;
  kernels::any<D> kernel;  // stretched to the markers' reach, in units of that
  marker_places<R> places;
  // Fours of numbers: the place, and what the kernel is multiplied by. That is ΔV/Δx^D for Shepard's mean, else 1; and
  // 0 of the null particle, which may seem near in `single`.
  const marker_places<R>::number* records;

  // all: room for the records.
  shape_search(const pairs::workspace<D>& w, const wall_set<D>& of, marker_rows& some, marker_places<R>::number* all)
      : set(of), rows(some), kernel(w.kernel), places(of.reach), records(all) {
    std::visit([]<class Kernel>(Kernel& k) { k = Kernel(1.0); }, kernel);
    const bool by_volume = of.how.interpolation == "shepard";
    const auto& volume = of.volumes(w.s);
    const double cell = std::pow(w.dx, D);
    foundation::for_all(rows.listed.size(), [&](std::size_t k) {
      const std::size_t j = rows.listed[k];
      for (std::size_t a = 0; a < D; ++a) all[4 * k + a] = places.number_of(w.s.x[a][j]);
      const double factor = j == w.s.null() ? 0.0 : by_volume ? volume[j] / cell : 1.0;
      all[4 * k + 3] = static_cast<marker_places<R>::number>(factor);
    });
  }
};

// The fluid about marker r, one a lane, and its moments. `flatten`: as in pairs::sum_row.
template <int D, class R, int Order, class Kernel>
[[gnu::flatten]] moments<D, Order, R> see(const shape_search<D, R>& search, std::size_t r,
                                          std::span<const std::uint32_t> row, seen<D, R>* near) {
  const Kernel& kernel = std::get<Kernel>(search.kernel);
  const R nearest(kernel.smallest_r() * kernel.smallest_r());
  std::array<typename marker_places<R>::own_type, D> x;
  for (std::size_t a = 0; a < D; ++a) x[a] = search.places.of_marker(search.set.marker[a][r]);
  moments<D, Order, R> sums;
  for (std::size_t k = 0; k < row.size(); k += R::size()) {
    const auto record = turned(search.records, row.data() + k);
    seen<D, R> j;
    j.offset = vec<R, D>::of([&](std::size_t a) { return search.places.offset(record[a], x[a]); });
    const R r2 = foundation::greater(foundation::dot(j.offset, j.offset), nearest);
    j.weight = kernel.value(foundation::both_roots(r2).r);
    if constexpr (std::is_same_v<R, single> || Order == 0) j.weight *= record[3];
    sums.add(j);
    *near++ = j;
  }
  return sums;
}

// The shape functions of the markers [first, last), no more than a register of doubles has lanes: their systems are
// solved side by side.
template <int D, class R, int Order, class Kernel>
void find_some(const shape_search<D, R>& search, std::size_t first, std::size_t last, std::vector<seen<D, R>>& near) {
  auto& rows = search.rows;
  const std::size_t begin = rows.near.start[first];
  near.resize((rows.near.start[last] - begin) / R::size());
  const auto of_row = [&](std::size_t k) { return near.data() + (rows.near.start[k] - begin) / R::size(); };
  systems<D, Order> some;
  for (std::size_t k = first; k < last; ++k)
    some.put(k - first, see<D, R, Order, Kernel>(search, rows.of[k], rows.near.row(k), of_row(k)));
  const auto c = some.coefficients(std::is_same_v<R, single> ? 3e-6 : 1e-10);
  for (std::size_t k = first; k < last; ++k) {
    auto* phi = rows.phi.template of<typename marker_places<R>::number>().data() + rows.near.start[k];
    [[maybe_unused]] R total(0.0);
    for (const seen<D, R>*j = of_row(k), *end = of_row(k + 1); j != end; ++j, phi += R::size()) {
      const R value = shape_function<D, Order>(*j, c[k - first]);
      if constexpr (std::is_same_v<R, single>) {
        total += value;
        value.all().copy_to(phi, pairs::stdx::element_aligned);
      } else {
        value.copy_to(phi, pairs::stdx::element_aligned);
      }
    }
    if constexpr (std::is_same_v<R, single>) {
      const double sum = foundation::sum(total);
      rows.scale[k] = sum != 0.0 ? 1.0 / sum : 0.0;
    }
  }
}

template <int D, class R>
auto finder(const pairs::workspace<D>& w, const wall_set<D>& set) {
  void (*some)(const shape_search<D, R>&, std::size_t, std::size_t, std::vector<seen<D, R>>&) = nullptr;
  std::visit(
      [&]<class Kernel>(const Kernel&) {
        with_order(set.how.interpolation, [&](auto order) { some = &find_some<D, R, decltype(order)::value, Kernel>; });
      },
      w.kernel);
  return some;
}

// The first sweep over the markers of an evaluation: finds the shape functions, and sums with them as long as they are
// near: f(r, values) for the marker of each wall particle r, with the values of these fields at it, Σ_j φ_j f_j(x_m).
template <int D, class R, std::size_t N, class F>
void find_shapes(const pairs::workspace<D>& w, const wall_set<D>& set, marker_rows& rows,
                 const std::array<const double*, N>& fields, const F& f) {
  using number = marker_places<R>::number;
  const std::size_t listed = rows.listed.size(), of_places = (4 * listed + lanes - 1) / lanes * lanes;
  const std::size_t before = std::is_same_v<R, single> ? 0 : of_places;  // of the doubles
  const side_by_side<N> values(rows, fields, scratch_of<double>(w, listed * side_by_side<N>::size, before));
  const shape_search<D, R> search(w, set, rows, scratch_of<number>(w, of_places));
  const auto find = finder<D, R>(w, set);
  const std::size_t n = rows.near.rows();
  foundation::for_chunks(
      n, markers_at_a_time, n > foundation::rows_worth_threads, [&](std::size_t from, std::size_t to) {
        std::vector<seen<D, R>> near;
        std::vector<double> scratch;
        for (std::size_t first = from; first < to; first += lanes) {
          const std::size_t last = std::min(to, first + lanes);
          find(search, first, last, near);
          for (std::size_t k = first; k < last; ++k)
            f(rows.of[k], values.sum(rows.near.row(k), shapes_of(rows, k, w.single_pairs(), scratch)));
        }
      });
}

// The sweeps that follow, with the same functions.
template <int D, std::size_t N, class F>
void for_each_marker(const pairs::workspace<D>& w, const marker_rows& rows, const std::array<const double*, N>& fields,
                     const F& f) {
  const side_by_side<N> values(rows, fields, scratch_of<double>(w, rows.listed.size() * side_by_side<N>::size));
  const std::size_t n = rows.near.rows();
  foundation::for_chunks(n, markers_at_a_time, n > foundation::rows_worth_threads,
                         [&](std::size_t from, std::size_t to) {
                           std::vector<double> scratch;
                           for (std::size_t k = from; k < to; ++k)
                             f(rows.of[k], values.sum(rows.near.row(k), shapes_of(rows, k, w.single_pairs(), scratch)));
                         });
}

// The fluid at the markers, mirrored. Transport: viscosity and conductivity too; without, all particles share them.
template <bool Transport, int D>
void marker_kinematics(pairs::workspace<D>& w, wall_set<D>& set) {
  auto& s = w.s;
  constexpr std::size_t N = D + 4 + (Transport ? 2 : 0);
  std::array<const double*, N> arrays;
  std::copy_n(pairs::pointers<D>(s.v).begin(), D, arrays.begin());
  auto &density = set.densities(s), &volume = set.volumes(s);
  const std::array<const double*, 6> scalars{s.T.data(), density.data(), volume.data(),
                                             s.m.data(), s.eta.data(),   s.k.data()};
  std::copy_n(scalars.begin(), N - D, arrays.begin() + D);
  set.unread.reset();
  if (set.complete) find_unread(w, set);
  for_all_rows(set, [&](marker_rows& rows) {
    const auto mirror = [&](std::size_t r, const auto& values) {
      const std::size_t i = s.first_wall() + r;
      std::array<double, D> v;
      std::copy_n(values.begin(), D, v.begin());
      mirror_velocity<D>(set, r, v);
      for (std::size_t a = 0; a < D; ++a) s.v[a][i] = v[a];
      s.T[i] = mirror_temperature(set, r, values[D]);
      density[i] = values[D + 1];
      volume[i] = values[D + 2];
      set.mass[r] = values[D + 3];
      if constexpr (Transport) s.eta[i] = values[D + 4], s.k[i] = values[D + 5];
    };
    w.single_pairs() ? find_shapes<D, single>(w, set, rows, arrays, mirror)
                     : find_shapes<D, real>(w, set, rows, arrays, mirror);
  });
  if constexpr (Transport)
    w.exchange_walls(s.v, {s.T.data(), density.data(), s.eta.data(), s.k.data(), volume.data()});
  else
    w.exchange_walls(s.v, {s.T.data(), density.data(), volume.data()});
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
    if (set.f[a] != nullptr) axes.push_back(a);
  return axes;
}

// Σ of the viscous forces (N) on these rows, of N components, and other terms' sums over the same neighbours.
template <int D, std::size_t N, class... Added>
void viscous_forces(const pairs::workspace<D>& w, const particles::array& V, const pairs::row_subset& rows,
                    const std::array<const double*, N>& v, const std::array<double*, N>& force, const Added&... added) {
  using diffusion::viscous_sum;
  const auto& s = w.s;
  constexpr bool shared = sizeof...(Added) > 0;
  const auto sum = [&](const auto& viscous) {
    if constexpr (shared)
      w.sum_in_common(rows, viscous, added...);
    else
      w.sum(rows, viscous);
  };
  if (w.uniform_transport)
    sum(viscous_sum<D, double, N, false, shared>{v, *w.uniform_transport, V.data(), force});
  else
    sum(viscous_sum<D, const double*, N, false, shared>{v, s.eta.data(), V.data(), force});
}

// f = ν∇²v + g of these rows, along axes that have walls. Along one alone it takes a third less.
template <int D, class... Added>
void sum_acceleration(pairs::workspace<D>& w, wall_set<D>& set, const pairs::row_subset& near, const Added&... added) {
  const auto& s = w.s;
  const auto& V = set.volumes(w.s);
  const auto axes = walled_axes(set);
  for (const std::size_t a : axes)
    foundation::for_all(near.rows.size(), [&](std::size_t k) { (*set.f[a])[near.rows[k]] = 0.0; });
  // Where other sums share the pass, most of it is theirs.
  const foundation::stage timed(w.times, sizeof...(Added) > 0 ? "pressure" : "walls");
  if (axes.size() == 1) {
    viscous_forces<D, 1>(w, V, near, {s.v[axes[0]].data()}, {set.f[axes[0]]->data()}, added...);
  } else {
    // Along axes without walls nobody reads it.
    std::array<double*, D> f;
    particles::array unread(axes.size() < D ? s.total() + 1 : 0);
    for (std::size_t a = 0; a < D; ++a) f[a] = set.f[a] == nullptr ? unread.data() : set.f[a]->data();
    viscous_forces<D, D>(w, V, near, pairs::pointers<D>(s.v), f, added...);
  }
  for (const std::size_t a : axes)
    foundation::for_all(near.rows.size(), [&](std::size_t k) {
      double& f = (*set.f[a])[near.rows[k]];
      f = f / s.m[near.rows[k]] + w.gravity(a, near.rows[k]);
    });
}

// f of the fluid near the walls, ghosts included. Beside it, and over the same neighbours, other terms' sums of the
// fluid that markers in use see.
template <int D, class... Added>
void nonpressure_acceleration(pairs::workspace<D>& w, wall_set<D>& set, const Added&... added) {
  sum_acceleration(w, set, set.read.near_wall, added...);
  if (set.unread) sum_acceleration(w, set, set.unread->near_wall);
  std::vector<double*> wanted;
  for (const std::size_t a : walled_axes(set)) wanted.push_back(set.f[a]->data());
  domain::exchange<D>(w.d.ranks, w.d.fluid_halo, std::span<double* const>(wanted));
}

// put(i, values) for each wall particle i, with the values of these fields at its marker. Where the momentum balance's
// steps are due, the same sweep makes them: a pressure and a weight that grow from marker to wall particle,
// linear in the fluid's values. Both lie apart along axes that have walls.
template <int D, std::size_t N, class Put>
void at_markers(const pairs::workspace<D>& w, wall_set<D>& set, const std::array<const double*, N>& fields, Put&& put) {
  const auto& s = w.s;
  const auto& density = set.density != nullptr ? *set.density : s.rho;
  const auto axes = walled_axes(set);
  const auto sweep = [&]<std::size_t Axes>(std::integral_constant<std::size_t, Axes>) {
    std::array<const double*, N + Axes> all;
    std::copy(fields.begin(), fields.end(), all.begin());
    for (std::size_t k = 0; k < Axes; ++k) all[N + k] = set.f[axes[k]]->data();
    for_all_rows(set, [&](const marker_rows& rows) {
      for_each_marker(w, rows, all, [&](std::size_t r, const auto& values) {
        const std::size_t i = s.first_wall() + r;
        if constexpr (Axes > 0) {
          double f_dx = 0.0;
          for (std::size_t k = 0; k < Axes; ++k) f_dx += values[N + k] * (s.x[axes[k]][i] - set.marker[axes[k]][r]);
          set.pressure_step[r] = density[i] * f_dx;
          set.weight_step[r] = set.mass[r] * f_dx;
        }
        put(i, values);
      });
    });
  };
  const std::size_t due = set.steps_due ? axes.size() : 0;
  if (due == 0) sweep(std::integral_constant<std::size_t, 0>{});
  if (due == 1) sweep(std::integral_constant<std::size_t, 1>{});
  if (due == 2) sweep(std::integral_constant<std::size_t, 2>{});
  if constexpr (D == 3)
    if (due == 3) sweep(std::integral_constant<std::size_t, 3>{});
  set.steps_due = false;
}

template <int D>
void marker_weights(pairs::workspace<D>& w, wall_set<D>& set) {
  auto& s = w.s;
  at_markers(w, set, std::array<const double*, 1>{s.Y.data()},
             [&](std::size_t i, const auto& values) { s.Y[i] = values[0] + set.weight_step[i - s.first_wall()]; });
  w.exchange_walls({s.Y.data()});
}

template <int D>
void marker_pressures(pairs::workspace<D>& w, wall_set<D>& set) {
  auto& s = w.s;
  at_markers(w, set, std::array<const double*, 2>{s.p.data(), s.dV.data()}, [&](std::size_t i, const auto& values) {
    s.p[i] = values[0] + set.pressure_step[i - s.first_wall()];
    s.dV[i] = values[1];
  });
  w.exchange_walls({s.p.data(), s.dV.data()});
}

}  // namespace tetsuame::walls::detail
