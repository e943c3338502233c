// Momentum and energy that the water and bodies give each other, to the last term: impulses of the forces that gauges
// read, and the work of bodies that move, integrated with the state by its stages and weights,
//   dJ/dt = F,  dL/dt = M,   dA/dt = -(F·u + M·ω)   (u, ω: of the body's centre)
// and what is put back after a step (rigid/contact.hpp), which no force has. Of A friction is the viscous sum's part.
#pragma once

#include <free_surface/free_bodies.hpp>
#include <free_surface/friction.hpp>
#include <free_surface/traction.hpp>

namespace tetsuame::free_surface {

// A body, and the point (m) about which moments on it count.
template <int D>
struct loaded {
  std::size_t body;
  solids::point<D> about;
};

// Those of gauges of forces.
template <int D>
std::vector<loaded<D>> loaded_by_gauges(const water<D>& f) {
  std::vector<loaded<D>> all;
  for (const auto& g : f.p.force) {
    const auto* b = f.mover(static_cast<std::int32_t>(g.body));
    const auto centre = of_solids<D>(g.centre);
    all.push_back({g.body, g.about ? of_solids<D>(*g.about) : b != nullptr ? b->now.to_space(centre) : centre});
  }
  return all;
}

// Collective, after an evaluation's sums; those on free bodies are known.
template <int D>
std::vector<load<D>> find_loads(water<D>& f, const std::vector<loaded<D>>& on) {
  std::vector<load<D>> all(on.size());
  std::vector<std::size_t> bodies, places;
  std::vector<solids::point<D>> about;
  for (std::size_t k = 0; k < on.size(); ++k) {
    const auto* b = f.mover(static_cast<std::int32_t>(on[k].body));
    if (b != nullptr && b->free) {
      const auto n =
          std::count_if(std::as_const(f.moving).data(), b, [](const auto& other) { return other.free.has_value(); });
      all[k] = f.free_loads[static_cast<std::size_t>(n)];
      all[k].moment += solids::moment<D>(b->rate.centre - on[k].about, all[k].force);
      continue;
    }
    bodies.push_back(on[k].body);
    about.push_back(on[k].about);
    places.push_back(k);
  }
  if (bodies.empty()) return all;
  const auto others = loads_on(f, bodies, about);
  for (std::size_t k = 0; k < places.size(); ++k) all[places[k]] = others[k];
  return all;
}

// Forces on what is held, at the state in the arrays, after its sums.
template <int D>
void find_pushes(water<D>& f) {
  f.pushes.clear();
  if (f.held.empty()) return;
  std::array<std::vector<double>, D> acceleration;
  std::array<double*, D> places;
  for (std::size_t a = 0; a < D; ++a) {
    acceleration[a].resize(f.world.w.s.fluid);
    places[a] = acceleration[a].data();
    for (const auto& h : f.held) {
      acceleration[a][h.i] = f.force[a][h.i] / f.world.w.s.m[h.i] + f.world.w.gravity(a, h.i);
      if (f.has_tension()) acceleration[a][h.i] += f.tension[a][h.i] / f.world.w.s.m[h.i];
    }
  }
  hold(f, std::span<double* const>(places));
}

// Collective. On those bodies whose force a gauge reads, at the state in the arrays.
template <int D>
std::vector<load<D>> read_loads(water<D>& f) {
  forget_accelerations(f);
  refresh(f);
  sum_over_neighbours(f, f.rows_near_bodies);
  if (!f.free.empty()) f.free_loads = accelerate_free_bodies(f);
  find_pushes(f);
  return find_loads(f, loaded_by_gauges(f));
}

// ---- integrated with the state --------------------------------------------------------------------------

// On rank 0 an element a gauge, or one; none on others.
template <int D>
std::vector<std::vector<double>*> counted_numbers(water<D>& f) {
  std::vector<std::vector<double>*> all;
  const std::size_t here = f.ranks().rank == 0 ? 1 : 0;
  for (auto& component : f.counted.impulse) {
    component.resize(here * f.p.force.size());
    if (!f.p.force.empty()) all.push_back(&component);
  }
  for (auto& part : f.counted.work) {
    part.resize(f.counts_work ? here : 0);
    if (f.counts_work) all.push_back(&part);
  }
  return all;
}

// W: what a body with this load about its centre does on the water.
template <int D>
double power_of(const moving_body<D>& b, const load<D>& of) {
  return -foundation::dot(of.force, b.rate.velocity) - foundation::dot(of.moment, b.rate.angular);
}

// Collective, at the end of an evaluation. Their rates, an array each.
template <int D>
void find_rates_of_loads(water<D>& f, std::span<double* const> rate) {
  const std::size_t gauges = f.p.force.size();
  auto on = loaded_by_gauges(f);
  for (const auto& b : f.moving)
    if (f.counts_work) on.push_back({b.body, b.rate.centre});
  const auto loads = find_loads(f, on);
  double power = 0.0, by_friction = 0.0;
  for (std::size_t n = gauges; n < on.size(); ++n) {
    const auto& b = f.moving[n - gauges];
    power += power_of<D>(b, loads[n]);
    by_friction += power_of<D>(b, friction_on(f, b));
  }
  if (f.ranks().rank != 0) return;
  std::size_t k = 0;
  for (std::size_t c = 0; gauges > 0 && c < water<D>::counted_loads::components; ++c, ++k)
    for (std::size_t n = 0; n < gauges; ++n) rate[k][n] = c < D ? loads[n].force[c] : loads[n].moment[c - D];
  if (!f.counts_work) return;
  rate[k][0] = power - by_friction;
  rate[k + 1][0] = by_friction;
}

// ---- put back after a step --------------------------------------------------------------------------------

// Pa s: what an impact of the water does to the pressure about a gauge, as a pair whose line crosses the plane does
// (traction.hpp).
template <int D>
double on_gauge(const std::vector<plane<D>>& planes, const rigid::impact<D>& of, double dx) {
  double all = 0.0;
  for (const auto& p : planes) {
    const double above = p.height(of.x.c);
    if (std::abs(above) > 0.5 * dx) continue;
    double away2 = -above * above, along = 0.0;
    for (std::size_t a = 0; a < D; ++a) {
      away2 += (of.x[a] - p.at[a]) * (of.x[a] - p.at[a]);
      along += of.momentum[a] * p.normal[a];
    }
    all += along * gauge_weight<D>(std::sqrt(std::max(0.0, away2)), gauge_radius * dx);
  }
  return all;
}

// The planes of a gauge on a surface, with their images; none of one in the water.
template <int D>
std::vector<plane<D>> surface_of_gauge(const water<D>& f, std::size_t gauge) {
  point place{};
  for (std::size_t a = 0; a < D; ++a) place[a] = f.o.gauges.pressure[a][gauge];
  const auto planes = planes_of_gauge(f, place);
  return planes.size() == 1 ? with_images(f, planes.front()) : std::vector<plane<D>>{};
}

// Collective, after particles were put back.
template <int D>
void count_put_back(water<D>& f) {
  constexpr std::size_t N = water<D>::counted_loads::components;
  if (!f.counts_impacts || !(f.ranks().maximum(static_cast<double>(f.impacts.size())) > 0.0)) return;
  const auto on = loaded_by_gauges(f);
  const std::size_t gauges = f.counted.on_gauges.size();
  std::vector<foundation::exact_sum> sums(N * on.size() + gauges + 1);
  for (const auto& of : f.impacts)
    for (std::size_t n = 0; n < on.size(); ++n) {
      if (of.body != on[n].body) continue;
      const auto turning = solids::moment<D>(of.x - of.image - on[n].about, of.momentum);
      for (std::size_t k = 0; k < N; ++k) sums[N * n + k].add(k < D ? -of.momentum[k] : -turning[k - D]);
    }
  for (std::size_t n = 0; n < gauges; ++n) {
    const auto planes = surface_of_gauge(f, n);
    for (const auto& of : f.impacts) sums[N * on.size() + n].add(on_gauge<D>(planes, of, f.dx()));
  }
  for (const double energy : f.energy_of_impacts) sums.back().add(energy);
  const auto total = f.ranks().exact(std::span(sums));
  for (std::size_t n = 0; n < on.size(); ++n)
    for (std::size_t k = 0; k < N; ++k) f.counted.put_back[n][k] += total[N * n + k];
  for (std::size_t n = 0; n < gauges; ++n) f.counted.on_gauges[n] += total[N * on.size() + n];
  f.counted.energy += total.back();
}

// ---- what is told of it -----------------------------------------------------------------------------------

// Collective, on all ranks: N s and N m s of each gauge, with what was put back; J, of pressure and of friction.
struct counted_so_far {
  std::vector<double> impulses, work;
};
template <int D>
counted_so_far count_of(water<D>& f) {
  constexpr std::size_t N = water<D>::counted_loads::components;
  const std::size_t gauges = f.p.force.size();
  std::vector<double> all;
  for (const auto* numbers : counted_numbers(f)) all.insert(all.end(), numbers->begin(), numbers->end());
  all.resize(N * gauges + (f.counts_work ? 2 : 0));
  MPI_Bcast(all.data(), static_cast<int>(all.size()), MPI_DOUBLE, 0, f.ranks().comm);
  counted_so_far so_far;
  for (std::size_t n = 0; n < gauges; ++n)
    for (std::size_t k = 0; k < N; ++k) so_far.impulses.push_back(all[k * gauges + n] + f.counted.put_back[n][k]);
  so_far.work.assign(all.begin() + static_cast<std::ptrdiff_t>(N * gauges), all.end());
  return so_far;
}

// Checkpoints; rank 0's is written.
template <int D>
std::vector<double> saved_loads(const water<D>& f) {
  std::vector<double> all;
  for (const auto& component : f.counted.impulse) all.insert(all.end(), component.begin(), component.end());
  for (const auto& part : f.counted.work) all.insert(all.end(), part.begin(), part.end());
  for (const auto* put_back : {&f.counted.put_back, &f.counted.put_back_read})
    for (const auto& of_gauge : *put_back) all.insert(all.end(), of_gauge.begin(), of_gauge.end());
  all.insert(all.end(), f.counted.on_gauges.begin(), f.counted.on_gauges.end());
  all.push_back(f.counted.energy);
  all.push_back(f.counted.read_at);
  return all;
}
template <int D>
void restore_loads(water<D>& f, const std::vector<double>& saved) {
  auto from = saved.begin();
  const bool here = f.ranks().rank == 0;
  const auto take = [&](std::vector<double>& to, std::size_t number) {
    if (here) std::copy_n(from, number, to.begin());
    from += static_cast<std::ptrdiff_t>(number);
  };
  for (auto& component : f.counted.impulse) take(component, f.p.force.size());
  for (auto& part : f.counted.work) take(part, f.counts_work ? 1 : 0);
  for (auto* put_back : {&f.counted.put_back, &f.counted.put_back_read})
    for (auto& of_gauge : *put_back)
      for (double& value : of_gauge) value = *from++;
  for (double& value : f.counted.on_gauges) value = *from++;
  f.counted.energy = *from++;
  f.counted.read_at = *from;
}

}  // namespace tetsuame::free_surface
