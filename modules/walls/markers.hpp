// Virtual markers: the mirror images of wall particles, inside the fluid, whose values are those of the fluid about
// them. What the treatments do with these: treatments.hpp.
#pragma once

#include <diffusion/viscosity.hpp>
#include <foundation/threads.hpp>
#include <walls/interpolation.hpp>
#include <walls/wall_set.hpp>

namespace tetsuame::walls::detail {

// Lists of the fluid near each marker and of the fluid near the walls.
template <int D>
void prepare_markers(pairs::workspace<D>& w, wall_set<D>& set, const cells::grid<D>& grid, double skin) {
  const auto& s = w.s;
  set.reach = radius_factor(set.how) * w.support();
  cells::make_list<D>(
      set.near_marker, grid, s.walls, set.reach + skin, s.null(),
      [&](std::size_t r) { return cells::position<D>(set.marker, r); },
      [&](std::size_t, std::uint32_t j) { return j < s.first_wall(); });
  set.phi.assign(set.near_marker.neighbours.size(), 0.0);
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
  // From here on the list counts in `listed`.
  std::vector<std::int32_t> place(s.null() + 1, -1);
  for (const auto j : set.near_marker.neighbours) place[static_cast<std::size_t>(j)] = 0;
  set.listed.clear();
  for (std::size_t i = 0; i < place.size(); ++i)
    if (place[i] == 0) {
      place[i] = static_cast<std::int32_t>(set.listed.size());
      set.listed.push_back(i);
    }
  for (auto& j : set.near_marker.neighbours) j = place[static_cast<std::size_t>(j)];
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < s.fluid; ++i)
    for (const auto& wall : set.sides)
      if ((s.x[wall.axis][i] - wall.position) * wall.inward < depth) {
        near.push_back(i);
        break;
      }
  set.near_wall = pairs::choose(w.list, std::move(near));
}

// The given fields of the fluid that markers see, in the pair loop's records: one a particle.
template <std::size_t N>
struct marker_records {
  static constexpr std::size_t size = (N + 3) / 4 * 4;
  const double* records;
  const std::int32_t* neighbours;

  template <int D>
  marker_records(wall_set<D>& set, const std::array<const double*, N>& fields)
      : neighbours(set.near_marker.neighbours.data()) {
    const std::size_t n = set.listed.size();
    if (set.records.size() < n * size) set.records.resize(n * size);
    double* out = set.records.data();
#pragma omp parallel for schedule(static) if (n > foundation::values_worth_threads)
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t f = 0; f < N; ++f) out[k * size + f] = fields[f][set.listed[k]];
    records = out;
  }

  // Of the neighbours at [k, k + lanes) of the list.
  std::array<real, size> at(std::size_t k) const {
    std::array<real, size> values;
    pairs::detail::load(records, neighbours + k, values);
    return values;
  }
};

// Σ_j φ_j f_j(x_m) of the fields from number First on, at the marker of row r, in one sweep over its neighbours.
template <std::size_t First = 0, int D, std::size_t N>
[[gnu::flatten]] std::array<double, N - First> at_marker(const wall_set<D>& set, std::size_t r,
                                                         const marker_records<N>& fields) {
  std::array<real, N - First> sums;
  sums.fill(real(0.0));
  const std::size_t end = set.near_marker.start[r + 1];
  for (std::size_t k = set.near_marker.start[r]; k < end; k += lanes) {
    const real phi(set.phi.data() + k, pairs::stdx::element_aligned);
    const auto values = fields.at(k);
    for (std::size_t n = First; n < N; ++n) sums[n - First] += phi * values[n];
  }
  std::array<double, N - First> total;
  for (std::size_t n = 0; n < N - First; ++n) total[n] = foundation::sum(sums[n]);
  return total;
}

// The fluid about the marker of row r, one a lane. Positions lead the records. `flatten`: as in pairs::sum_row.
template <int D, std::size_t N, class Kernel>
[[gnu::flatten]] void see(std::vector<seen<D>>& near, const wall_set<D>& set, std::size_t r,
                          const marker_records<N>& fields, const Kernel& kernel) {
  const std::size_t begin = set.near_marker.start[r], end = set.near_marker.start[r + 1];
  near.resize((end - begin) / lanes);
  vec<real, D> x;
  for (std::size_t a = 0; a < D; ++a) x[a] = real(set.marker[a][r]);
  const real per_reach(1.0 / set.reach);
  const real squeeze(kernel.support() / set.reach);  // the kernel's own radius, stretched to the marker's reach
  const real nearest(kernel.smallest_r() * kernel.smallest_r());
  auto* j = near.data();
  for (std::size_t k = begin; k < end; k += lanes, ++j) {
    const auto values = fields.at(k);
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
            see(near, set, r, fields, kernel);
            shape_functions<D>(near, order, set.phi.data() + set.near_marker.start[r]);
            const std::size_t i = s.first_wall() + r;
            const auto f = at_marker<D>(set, r, fields);
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

// set(i, values) for each wall particle i, with the values of these fields at its marker. Where the momentum balance's
// steps are due, the same sweep makes them: a pressure and a weight that grow from marker to wall particle,
// linear in the fluid's values.
template <int D, std::size_t N, class Set>
void at_markers(const pairs::workspace<D>& w, wall_set<D>& set, const std::array<const double*, N>& arrays, Set&& put) {
  const auto& s = w.s;
  if (!set.steps_due) {
    const marker_records<N> fields(set, arrays);
#pragma omp parallel for schedule(static) if (s.walls > foundation::rows_worth_threads)
    for (std::size_t r = 0; r < s.walls; ++r) put(s.first_wall() + r, at_marker(set, r, fields));
    return;
  }
  set.steps_due = false;
  std::array<const double*, N + D> all;
  std::copy_n(arrays.begin(), N, all.begin());
  std::copy_n(pairs::pointers<D>(set.f).begin(), D, all.begin() + N);
  const marker_records<N + D> fields(set, all);
#pragma omp parallel for schedule(static) if (s.walls > foundation::rows_worth_threads)
  for (std::size_t r = 0; r < s.walls; ++r) {
    const std::size_t i = s.first_wall() + r;
    const auto values = at_marker(set, r, fields);
    double f_dx = 0.0;
    for (std::size_t a = 0; a < D; ++a) f_dx += values[N + a] * (s.x[a][i] - set.marker[a][r]);
    set.pressure_step[r] = s.rho[i] * f_dx;
    set.weight_step[r] = set.mass[r] * f_dx;
    put(i, values);
  }
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
