// Virtual markers: the mirror images of wall particles, inside the fluid, whose values are those of the fluid about
// them. What the treatments do with these: treatments.hpp.
#pragma once

#include <diffusion/viscosity.hpp>
#include <foundation/threads.hpp>
#include <walls/interpolation.hpp>
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
      set.listed.push_back(i);
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
  for (auto& component : set.f) component.assign(s.total() + 1, 0.0);

  double depth = 0.0;
  for (std::size_t r = 0; r < s.walls; ++r)
    for (const auto& wall : set.sides)
      depth = std::max(depth, (set.marker[wall.axis][r] - wall.position) * wall.inward *
                                  ((set.mirrored[r] >> (&wall - set.sides.data()) & 1U) != 0 ? 1.0 : 0.0));
  depth = w.d.ranks.maximum(depth) + set.reach + skin;
  count_in_listed(set, s.null());
  set.phi.assign(set.near_marker.all.size(), 0.0);
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < s.fluid; ++i)
    for (const auto& wall : set.sides)
      if ((s.x[wall.axis][i] - wall.position) * wall.inward < depth) {
        near.push_back(i);
        break;
      }
  set.near_wall = pairs::choose(w.list, std::move(near), s.total());
}

// The given fields of the fluid that markers see, one record a particle.
template <std::size_t N>
struct marker_records {
  static constexpr std::uint32_t size = (N + 3) / 4 * 4;
  const double* records;

  template <int D>
  marker_records(wall_set<D>& set, const std::array<const double*, N>& fields) {
    const std::size_t n = set.listed.size();
    if (set.records.size() < n * size) set.records.resize(n * size);
    double* out = set.records.data();
#pragma omp parallel for schedule(static) if (n > foundation::values_worth_threads)
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t f = 0; f < N; ++f) out[k * size + f] = fields[f][set.listed[k]];
    records = out;
  }

  // Of as many neighbours as there are lanes.
  std::array<real, size> at(const std::uint32_t* neighbours) const {
    std::array<std::uint32_t, lanes> place;
    for (std::size_t lane = 0; lane < lanes; ++lane) place[lane] = neighbours[lane] * size;
    std::array<real, size> values;
    pairs::detail::load(records, place.data(), values);
    return values;
  }
};

// Σ_j φ_j f_j(x_m) of the fields from number First on, at a marker, in one sweep over its neighbours.
template <std::size_t First = 0, std::size_t N>
[[gnu::flatten]] std::array<double, N - First> at_marker(std::span<const std::uint32_t> row, const double* shape,
                                                         const marker_records<N>& fields) {
  std::array<real, N - First> sums;
  sums.fill(real(0.0));
  for (std::size_t k = 0; k < row.size(); k += lanes) {
    const real phi(shape + k, pairs::stdx::element_aligned);
    const auto values = fields.at(row.data() + k);
    for (std::size_t n = First; n < N; ++n) sums[n - First] += phi * values[n];
  }
  std::array<double, N - First> total;
  for (std::size_t n = 0; n < N - First; ++n) total[n] = foundation::sum(sums[n]);
  return total;
}

// The fluid about the marker of row r, one a lane. Positions lead the records. `flatten`: as in pairs::sum_row.
template <int D, std::size_t N, class Kernel>
[[gnu::flatten]] void see(std::vector<seen<D>>& near, const wall_set<D>& set, std::size_t r,
                          std::span<const std::uint32_t> row, const marker_records<N>& fields, const Kernel& kernel) {
  near.resize(row.size() / lanes);
  vec<real, D> x;
  for (std::size_t a = 0; a < D; ++a) x[a] = real(set.marker[a][r]);
  const real per_reach(1.0 / set.reach);
  const real squeeze(kernel.support() / set.reach);  // the kernel's own radius, stretched to the marker's reach
  const real nearest(kernel.smallest_r() * kernel.smallest_r());
  auto* j = near.data();
  for (std::size_t k = 0; k < row.size(); k += lanes, ++j) {
    const auto values = fields.at(row.data() + k);
    for (std::size_t a = 0; a < D; ++a) j->offset[a] = values[a] - x[a];
    const real r2 = foundation::dot(j->offset, j->offset);
    j->weight = kernel.value(real(foundation::both_roots(foundation::greater(r2, nearest)).r * squeeze));
    for (std::size_t a = 0; a < D; ++a) {
      j->offset[a] *= per_reach;
      // Without weight the place does not matter; the null particle's is too far for powers.
      pairs::stdx::where(j->weight == 0.0, j->offset[a]) = 0.0;
    }
  }
}

// The fluid at the markers, mirrored. Transport: viscosity and conductivity too; without, all particles share them.
template <bool Transport, int D>
void marker_kinematics(pairs::workspace<D>& w, wall_set<D>& set) {
  auto& s = w.s;
  constexpr std::size_t N = 2 * D + 4 + (Transport ? 2 : 0);
  std::array<const double*, N> arrays;
  std::copy_n(pairs::pointers<D>(s.x).begin(), D, arrays.begin());
  std::copy_n(pairs::pointers<D>(s.v).begin(), D, arrays.begin() + D);
  const std::array<const double*, 6> scalars{s.T.data(), s.rho.data(), s.dV.data(),
                                             s.m.data(), s.eta.data(), s.k.data()};
  std::copy_n(scalars.begin(), N - 2 * D, arrays.begin() + 2 * D);
  const marker_records<N> fields(set, arrays);
  const int order = polynomial_order(set.how.interpolation);
  std::visit(
      [&](const auto& kernel) {
#pragma omp parallel if (s.walls > foundation::rows_worth_threads)
        {
          std::vector<seen<D>> near;
#pragma omp for schedule(static)
          for (std::size_t r = 0; r < s.walls; ++r) {
            const auto row = set.near_marker.row(r);
            double* const phi = set.phi.data() + set.near_marker.start[r];
            see(near, set, r, row, fields, kernel);
            shape_functions<D>(near, order, phi);
            const std::size_t i = s.first_wall() + r;
            const auto f = at_marker<D>(row, phi, fields);
            std::array<double, D> v;
            std::copy_n(f.begin(), D, v.begin());
            mirror_velocity<D>(set, r, v);
            for (std::size_t a = 0; a < D; ++a) s.v[a][i] = v[a];
            s.T[i] = mirror_temperature(set, r, f[D]);
            s.rho[i] = f[D + 1];
            s.dV[i] = f[D + 2];
            set.mass[r] = f[D + 3];
            if constexpr (Transport) s.eta[i] = f[D + 4], s.k[i] = f[D + 5];
          }
        }
      },
      w.kernel);
  if constexpr (Transport)
    w.exchange_walls(s.v, {s.T.data(), s.rho.data(), s.eta.data(), s.k.data(), s.dV.data()});
  else
    w.exchange_walls(s.v, {s.T.data(), s.rho.data(), s.dV.data()});
}

template <int D>
void marker_kinematics(pairs::workspace<D>& w, wall_set<D>& set) {
  w.uniform_transport ? marker_kinematics<false>(w, set) : marker_kinematics<true>(w, set);
}

// f = ν∇²v + g of the fluid near the walls, ghosts included.
template <int D>
void nonpressure_acceleration(pairs::workspace<D>& w, wall_set<D>& set) {
  auto& s = w.s;
  std::array<double*, D> f;
  for (std::size_t a = 0; a < D; ++a) {
    f[a] = set.f[a].data();
    for (const std::size_t i : set.near_wall.rows) set.f[a][i] = 0.0;
  }
  const auto v = pairs::pointers<D>(s.v);
  if (w.uniform_transport)
    w.sum(set.near_wall, diffusion::uniform_viscosity<D>{v, *w.uniform_transport, s.dV.data(), f, nullptr});
  else
    w.sum(set.near_wall, diffusion::viscosity<D>{v, s.eta.data(), s.dV.data(), f, nullptr});
  for (std::size_t a = 0; a < D; ++a)
    for (const std::size_t i : set.near_wall.rows) f[a][i] = f[a][i] / s.m[i] + w.g[a];
  domain::exchange<D>(w.d.ranks, w.d.fluid_halo, std::span<double* const>(f));
}

// f(r, values) for each marker, with the values of these fields at it.
template <int D, std::size_t N, class F>
void for_each_marker(wall_set<D>& set, const std::array<const double*, N>& arrays, F&& f) {
  const marker_records<N> fields(set, arrays);
  const std::size_t n = set.near_marker.rows();
#pragma omp parallel for schedule(static) if (n > foundation::rows_worth_threads)
  for (std::size_t r = 0; r < n; ++r)
    f(r, at_marker(set.near_marker.row(r), set.phi.data() + set.near_marker.start[r], fields));
}

// put(i, values) for each wall particle i, with the values of these fields at its marker. Where the momentum balance's
// steps are due, the same sweep makes them: a pressure and a weight that grow from marker to wall particle,
// linear in the fluid's values.
template <int D, std::size_t N, class Put>
void at_markers(const pairs::workspace<D>& w, wall_set<D>& set, const std::array<const double*, N>& arrays, Put&& put) {
  const auto& s = w.s;
  if (!set.steps_due)
    return for_each_marker<D>(set, arrays, [&](std::size_t r, const auto& values) { put(s.first_wall() + r, values); });
  set.steps_due = false;
  std::array<const double*, N + D> all;
  std::copy_n(arrays.begin(), N, all.begin());
  std::copy_n(pairs::pointers<D>(set.f).begin(), D, all.begin() + N);
  for_each_marker<D>(set, all, [&](std::size_t r, const auto& values) {
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
