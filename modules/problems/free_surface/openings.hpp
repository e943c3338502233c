// Water that enters and leaves [A. Tafuni, J. M. Domínguez, R. Vacondio, A. J. C. Crespo, Comput. Methods Appl. Mech.
// Eng. 342, 604 (2018); I. Federico, S. Marrone, A. Colagrossi, F. Aristodemo, M. Antuono, Eur. J. Mech. B/Fluids 34,
// 35 (2012)] (docs/theory/inflow_and_outflow.md). Before each section of &inflow and &outflow lies a zone as long as
// the kernel reaches, whose particles do not follow the equations of motion:
//
//   inflow    v = u(y, z, t) n, n inwards; ρ of still water at that depth beneath the level. A particle that has
//             gone the zone's length L becomes water, and another one begins a length L behind it
//   outflow   v = u n, n outwards, u the mean of v·n about it of what comes behind,
//               u_i = Σ_j V_j W_ij v_j·n / Σ_j V_j W_ij  over j with (x_i - x_j)·n > 0,   at least 0
//             ρ of still water beneath the level, or by the mean pressure of the same, less the weight up to there. A
//             particle that comes to the side is taken away
//
// Particles enter and leave where neighbour lists are made anew: by places alone, whatever ranks there are. A new
// particle has the ID of the one before it and the number of all places of inflows more: each place gives each ID once.
#pragma once

#include <fmt/format.h>

#include <free_surface/sums.hpp>
#include <output/history.hpp>

namespace tetsuame::free_surface {

// ---- the start ----------------------------------------------------------------------------------------

// The lattices of inflows' zones, numbered from first_id on.
template <int D>
std::vector<run::lattice_block<D>> lattices_of_inflows(const water<D>& f, std::int64_t first_id) {
  std::vector<run::lattice_block<D>> all;
  for (const auto& e : f.p.openings) {
    if (!e.enters) continue;
    run::lattice_block<D> lattice;
    for (std::size_t a = 0; a < D; ++a) {
      lattice.number[a] = std::llround((e.high[a] - e.low[a]) / f.dx());
      lattice.corner[a] = e.low[a];
      lattice.spacing[a] = f.dx();
    }
    lattice.first_id = first_id;
    first_id += lattice.particles();
    all.push_back(lattice);
  }
  return all;
}

// The density of still water beneath a level.
template <int D>
double density_beneath(const water<D>& f, double level, std::size_t i) {
  return f.p.water.density_beneath(f.gravity() * std::max(0.0, level - f.world.w.s.x[1][i]));
}

// Sets the velocity of a particle of a zone: `speed` (m/s) along the opening's axis, towards `to` (inwards: 1).
template <int D>
void move_along(water<D>& f, const opening& e, std::size_t i, double speed, double to) {
  for (std::size_t a = 0; a < D; ++a) f.world.w.s.v[a][i] = a == e.axis ? to * e.inward * speed : 0.0;
}

// Water that stands in an outflow's zone, or has come there.
template <int D>
void take_into_outflows(water<D>& f) {
  const auto& s = f.world.w.s;
  for (std::size_t n = 0; n < f.p.openings.size(); ++n) {
    const auto& e = f.p.openings[n];
    if (e.enters) continue;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      if (f.zone[i] != 0.0 || !e.holds(f.place(i))) continue;
      f.zone[i] = -static_cast<double>(n + 1);
      move_along(f, e, i, std::max(0.0, -e.inward * s.v[e.axis][i]), -1.0);
      if (e.level) f.world.w.s.rho[i] = density_beneath(f, *e.level, i);
    }
  }
}

// The particles of the start from first_id on are those of inflows' zones.
template <int D>
void fill_inflows(water<D>& f, std::int64_t first_id) {
  auto& s = f.world.w.s;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    if (s.id[i] < first_id) continue;
    const auto at = std::ranges::find_if(f.p.openings, [&](const auto& e) { return e.enters && e.holds(f.place(i)); });
    f.zone[i] = static_cast<double>(at - f.p.openings.begin() + 1);
    s.rho[i] = density_beneath(f, *at->level, i);
    s.m[i] = s.rho[i] * std::pow(f.dx(), D);
    move_along(f, *at, i, at->speed(f.place(i), 0.0), 1.0);
  }
}

// ---- after each step ----------------------------------------------------------------------------------

// The mean of what comes behind: the weight of the neighbours there, and the sums of their velocity (m/s) less the
// particle's own, and of their pressure (Pa) with the weight of water from there.
template <int D>
struct upstream {
  using kernels = kernels_of_water<D>;
  std::array<const double*, D> v;
  const double *p, *V, *rho;
  std::array<double, D> outwards;
  double g;
  double *weight, *speed, *pressure;

  template <class R>
  struct me {
    R weight, speed, pressure;
    pairs::vec<R, D> n;
    R g;  // as n the same for all
  };
  auto reads() const {
    using namespace pairs;
    return std::tuple{read(of_velocity, v), read(of_pressure, p), read(of_volume, V, D), read(of_density, rho)};
  }
  template <class R>
  me<R> begin(const pairs::cluster<R>& i) const {
    return {R(0.0), R(0.0), R(0.0), pairs::vec<R, D>::of([&](std::size_t k) { return R(outwards[k]); }),
            R(g * i.lengths.to(1))};
  }
  void add(auto& a, const auto& ij) const {
    using namespace pairs;
    using R = std::remove_cvref_t<decltype(ij.W)>;
    const R share = foundation::select(0.0 < foundation::dot(a.n, ij.x_ij), R(ij(of_volume) * ij.W), R(0.0));
    a.weight += share;
    a.speed -= share * foundation::dot(a.n, ij.difference(of_velocity));
    a.pressure += share * (ij(of_pressure) - a.g * ij(of_density) * ij.x_ij[1]);
  }
  void end(const auto& i, const auto& a) const {
    i.set(weight, a.weight);
    i.set(speed, a.speed);
    i.set(pressure, a.pressure);
  }
};

// Collective. Zones of outflows follow what comes behind them.
template <int D>
void guide_outflows(water<D>& f) {
  if (std::ranges::all_of(f.p.openings, &opening::enters)) return;
  auto& w = f.world.w;
  auto& s = w.s;
  const foundation::stage timed(w.times, "outflow");
  refresh(f);
  for (std::size_t n = 0; n < f.p.openings.size(); ++n) {
    const auto& e = f.p.openings[n];
    if (e.enters) continue;
    const auto is_there = [&](std::size_t i) { return f.zone[i] == -static_cast<double>(n + 1); };
    std::array<double, D> outwards{};
    outwards[e.axis] = -e.inward;
    w.sum(clusters_where(w, false, is_there),
          upstream<D>{pairs::pointers<D>(s.v), s.p.data(), s.dV.data(), s.rho.data(), outwards, f.gravity(),
                      f.behind[0].data(), f.behind[1].data(), f.behind[2].data()});
    foundation::for_all(s.fluid, [&](std::size_t i) {
      if (!is_there(i)) return;
      const double weight = f.behind[0][i], own = -e.inward * s.v[e.axis][i];
      move_along(f, e, i, std::max(0.0, weight > 0.0 ? own + f.behind[1][i] / weight : own), -1.0);
      if (e.level)
        s.rho[i] = density_beneath(f, *e.level, i);
      else if (weight > 0.0)
        s.rho[i] = f.p.water.density_at(f.behind[2][i] / weight);
    });
  }
}

// Collective. Velocities of entering water at a time (s), where they change with it.
template <int D>
void guide_inflows(water<D>& f, double t) {
  if (std::ranges::none_of(f.p.openings, &opening::changes_with_time)) return;
  std::string fault;
  for (std::size_t i = 0; i < f.world.w.s.fluid; ++i) {
    if (!(f.zone[i] > 0.0)) continue;
    const auto& e = f.p.openings[static_cast<std::size_t>(f.zone[i]) - 1];
    const double u = e.speed(f.place(i), t);
    if (!(u >= 0.0) || !std::isfinite(u))
      fault = fmt::format("&inflow velocity = '{}' is {:.6g} m/s at t = {:.6g} s: expected 0 or more, inwards", e.text,
                          u, t);
    move_along(f, e, i, u, 1.0);
  }
  foundation::agree(f.ranks().comm, fault, foundation::exit_status::calculation_failed);
}

// ---- with new lists -----------------------------------------------------------------------------------

// Adds to sums what a particle brings or takes: 1, kg, J, N s.
template <int D>
void count_passing(const water<D>& f, std::size_t i, std::span<foundation::exact_sum> sums) {
  const auto& s = f.world.w.s;
  using counted = passed_through<D>;
  sums[counted::number].add(1.0);
  sums[counted::mass].add(s.m[i]);
  sums[counted::energy].add(0.5 * s.m[i] * f.speed2(i));
  sums[counted::energy].add(s.m[i] * f.gravity() * s.x[1][i]);
  sums[counted::energy].add(s.m[i] * f.p.water.elastic_energy(s.rho[i]));
  for (std::size_t a = 0; a < D; ++a) sums[counted::momentum + a].add(s.m[i] * s.v[a][i]);
}

// Those of this rank that have come to their outflow's side leave; the order of the others stays. Until lists are made
// again who stays does not pass the side.
template <int D>
void take_away(water<D>& f, std::span<foundation::exact_sum> sums) {
  auto& s = f.world.w.s;
  const double near = std::max(0.5 * f.world.skin, 0.25 * f.dx());
  std::vector<std::uint32_t> stay;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const bool leaves =
        f.zone[i] < 0.0 && f.p.openings[static_cast<std::size_t>(-f.zone[i]) - 1].distance(f.place(i)) < near;
    if (leaves)
      count_passing(f, i, sums);
    else
      stay.push_back(static_cast<std::uint32_t>(i));
  }
  if (stay.size() == s.fluid) return;
  particles::reorder(s, 0, std::span<const std::uint32_t>(stay));
  particles::allocate(s, stay.size(), 0, s.walls, 0);
}

// Those of this rank that leave their inflow's zone become water, and others begin.
template <int D>
void let_in(water<D>& f, std::span<foundation::exact_sum> sums) {
  auto& s = f.world.w.s;
  std::vector<std::size_t> before;
  for (std::size_t i = 0; i < s.fluid; ++i)
    if (f.zone[i] > 0.0) {
      const auto& e = f.p.openings[static_cast<std::size_t>(f.zone[i]) - 1];
      if (e.distance(f.place(i)) >= e.length) before.push_back(i);
    }
  if (before.empty()) return;
  const std::size_t first = s.fluid;
  particles::allocate(s, first + before.size(), 0, s.walls, 0);
  particles::for_each_field<D>(s, [&](const particles::field_info& field, const auto& components) {
    if (!particles::travels(field.kind)) return;
    for (auto* values : components)
      for (std::size_t k = 0; k < before.size(); ++k) (*values)[first + k] = (*values)[before[k]];
  });
  for (std::size_t k = 0; k < before.size(); ++k) {
    const std::size_t i = first + k, j = before[k];
    const auto& e = f.p.openings[static_cast<std::size_t>(f.zone[j]) - 1];
    s.id[i] = s.id[j] + f.inflow_places;
    s.material[i] = s.material[j];
    double& x = s.x[e.axis][i];
    x -= e.inward * e.length;
    x = std::clamp(x, 0.0, f.o.domain.length[e.axis]);
    f.zone[j] = 0.0;
    count_passing(f, i, sums);
  }
}

// Collective, before new lists. Whether particles have come or gone, on any rank.
template <int D>
bool pass_openings(water<D>& f) {
  if (f.p.openings.empty()) return false;
  using counted = passed_through<D>;
  std::array<foundation::exact_sum, 2 * counted::size> sums;
  const std::span<foundation::exact_sum> all(sums);
  take_away(f, all.subspan(counted::size));
  let_in(f, all.first(counted::size));
  take_into_outflows(f);
  std::string fault;
  const auto& s = f.world.w.s;
  for (std::size_t i = 0; i < s.fluid && fault.empty(); ++i)
    if (s.id[i] >= most_numbers) fault = "more water has entered than particles can be numbered";
  foundation::agree(f.ranks().comm, fault, foundation::exit_status::calculation_failed);
  const auto total = f.ranks().exact(all);
  f.entered.add(std::span(total).first(counted::size));
  f.left.add(std::span(total).subspan(counted::size));
  return total[counted::number] + total[counted::size + counted::number] > 0.0;
}

// ---- what has passed ----------------------------------------------------------------------------------

// Columns of history.csv, and metrics: what has entered, then what has left.
template <int D>
std::vector<output::history_column> columns_of_openings() {
  std::vector<output::history_column> all;
  for (const char* way : {"in", "out"}) {
    all.push_back({fmt::format("mass_{}", way), D == 2 ? "kg/m" : "kg"});
    all.push_back({fmt::format("energy_{}", way), "J"});
    for (std::size_t a = 0; a < D; ++a) all.push_back({fmt::format("momentum_{}_{}", way, "xyz"[a]), "N s"});
  }
  return all;
}
template <int D>
std::vector<double> values_of_openings(const water<D>& f) {
  std::vector<double> all;
  for (const auto* passed : {&f.entered, &f.left})
    for (std::size_t k = passed_through<D>::mass; k < passed_through<D>::size; ++k) all.push_back((*passed)[k]);
  return all;
}

}  // namespace tetsuame::free_surface
