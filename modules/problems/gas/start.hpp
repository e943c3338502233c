// The start: what a particle carries, materials, kernel, box, the particles of a rank in their places, and
// their supports.
#pragma once

#include <gas/evaluation.hpp>
#include <gas/lists.hpp>
#include <run/start_from_file.hpp>

namespace tetsuame::gas {

struct start_state {
  double u, c;  // J/kg, m/s
};

template <int D>
start_state start_of(const world<D>& g, const state& now) {
  if (g.any_eos) {
    const std::size_t k = g.side_of(now.material);
    const eos::caloric& m = g.materials[k];
    const double u = now.energy ? *now.energy
                                : g.internal_energy(now.material, now.rho,
                                                    now.temperature ? *now.temperature : *g.side(k).temperature);
    return {u, m.at(now.rho, u).c};
  }
  const auto [gamma, stiffness] = gas_of(g, now.material);
  return {(now.p + gamma * stiffness) / ((gamma - 1.0) * now.rho), std::sqrt(gamma * (now.p + stiffness) / now.rho)};
}

template <int D>
void make_materials(world<D>& g) {
  if (!g.any_eos) return;
  for (std::size_t k = 0; k < g.sides(); ++k) {
    const side_options& side = g.side(k);
    const eos::caloric& m = g.materials.emplace_back(eos_of(side));
    const double u = m.internal_energy(side.rho, *side.temperature);
    g.stiffening.push_back(m.stiffening(side.rho, u));
    g.start_sound.push_back(m.at(side.rho, u).c);
  }
}

template <int D>
void choose_kernel(world<D>& g) {
  const auto& kernel = g.o.common.kernel;
  g.support_over_h = kernels::find(kernel.name).support_over_h;
  g.support_over_dx = g.support_over_h * kernel.h_over_dx;
  g.w.compute_pairs_in(kernel.single_pairs());
  if (kernel.name == kernels::wendland_c4<D>::name) g.unit = kernels::wendland_c4<D>(1.0);
}

template <int D>
void make_box(world<D>& g) {
  domain::box<D> region;
  for (std::size_t a = 0; a < D; ++a) {
    region.length[a] = g.o.domain.length[a];
    region.periodic[a] = g.o.domain.periodic[a];
    region.open[a] = {g.o.domain.open[a], g.o.domain.open[a]};
  }
  g.w.dx = g.o.domain.dx();
  if constexpr (D > 1) g.w.g[1] = -g.o.shock.gravity;
  g.skin = g.o.common.kernel.skin * g.w.dx;
  g.w.d = domain::decompose<D>(domain::communicator::world(), region, g.support_over_dx * g.w.dx + g.skin,
                               g.o.domain.ranks_x);
  walls::options without_friction;
  without_friction.slip = "free_slip";
  g.walls.sides = walls::make_sides<D>(without_friction, region);
}

// f(x, state, mass over density: m^D) for every particle, in the order of their IDs.
template <int D, class F>
void for_each_start(const setup& t, F&& f) {
  for (const block& b : t.blocks) {
    std::array<double, 3> step{};
    double volume = 1.0;
    std::int64_t count = 1;
    for (std::size_t a = 0; a < D; ++a) {
      step[a] = (b.high[a] - b.low[a]) / static_cast<double>(b.n[a]);
      volume *= step[a];
      count *= b.n[a];
    }
    for (std::int64_t k = 0; k < count; ++k) {
      point x{};
      std::int64_t rest = k;
      for (std::size_t a = 0; a < D; ++a) {
        x[a] = b.low[a] + (static_cast<double>(rest % b.n[a]) + 0.5) * step[a];
        rest /= b.n[a];
      }
      if (!b.holds || b.holds(x)) f(x, t.start(x), volume);
    }
  }
  for (const placed& p : t.particles) f(p.x, p.now, p.mass / p.now.rho);
}

template <int D>
void place_particles(world<D>& g) {
  auto& s = g.w.s;
  struct start {
    std::int64_t id;
    state now;
    point put;
    double volume;
  };
  std::vector<start> mine;
  std::int64_t id = 0;
  double densest = 0.0;
  for_each_start<D>(g.test, [&](const point& x, const state& now, double volume) {
    densest = std::max(densest, now.rho);
    const point put = g.test.moved ? g.test.moved(x) : x;
    std::array<double, D> place;
    std::copy_n(put.begin(), D, place.begin());
    if (g.w.d.within(g.w.d.cell(), place)) mine.push_back({id, now, put, volume});
    ++id;
  });
  g.fluid_total = id;
  g.density_scale = densest;
  particles::allocate(s, mine.size(), 0, 0, 0);
  std::vector<double> sound;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const auto& p = mine[i];
    const state& now = p.now;
    const start_state thermal = start_of(g, now);
    s.id[i] = p.id;
    s.material[i] = now.material;
    s.m[i] = now.rho * p.volume;
    s.u[i] = thermal.u;
    sound.push_back(thermal.c);
    s.rho[i] = g.evolved[i] = now.rho;
    if (g.melts) g.inertia[i] = g.o.melting.inertia(g.largest_viscosity_of(now.material));
    if (g.dissolved) g.concentration[i] = now.dissolved.value_or(g.o.element.start(g.is_metal(now.material)));
    g.start_volume[i] = p.volume;
    g.start_sum[i] = 1.0;
    for (std::size_t a = 0; a < D; ++a) {
      s.x[a][i] = p.put[a];
      s.v[a][i] = now.v[a];
    }
    g.support[i] = g.support_over_dx * std::pow(p.volume, 1.0 / D);
    g.alpha[i] = g.o.shock.switch_of_alpha ? g.o.shock.alpha_min : g.o.shock.alpha;
    if (g.o.self_gravity) g.softening[i] = g.o.softening * g.support[i];
  }
  // Of sound and flow together, in the frame that all are in.
  const auto frame = run::on_all(g.ranks(), run::velocities(g)).template middle<D>();
  double fastest = 0.0;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    double v2 = std::pow(sound[i], 2);
    for (std::size_t a = 0; a < D; ++a) v2 += (s.v[a][i] - frame[a]) * (s.v[a][i] - frame[a]);
    fastest = std::max(fastest, v2);
  }
  g.speed_scale = std::sqrt(g.ranks().maximum(fastest));
  if (g.test.expect_used) g.test.expect_used();
}

// J/kg: as the file has it, or by its pressures, or temperatures with an equation of state.
template <int D>
std::vector<double> energies_of(const world<D>& g, const run::start_file& file, const std::vector<double>& rho,
                                const std::vector<std::int32_t>& material) {
  const bool by_energy = file.has("InternalEnergy");
  if (by_energy && (!g.any_eos || file.is_of_this_program())) return file.energies();
  if (by_energy)
    file.fail(
        ": InternalEnergy is not of this program, and energies of equations of state begin at another zero "
        "elsewhere: leave it out, and give Temperature");
  if (!file.has(g.any_eos ? "Temperature" : "Pressure"))
    file.fail(g.any_eos ? " has neither InternalEnergy nor Temperature" : " has neither InternalEnergy nor Pressure");
  auto values = g.any_eos ? file.temperatures(true) : file.pressures();
  for (std::size_t n = 0; n < values.size(); ++n) {
    state now{rho[n], values[n], {}, material[n]};
    if (g.any_eos) now.temperature = values[n];
    values[n] = start_of(g, now).u;
  }
  return values;
}

// Collective. A snapshot's particles in the place of those of the test, whose scales of speed and density stay.
template <int D>
void take_from_file(world<D>& g) {
  auto& s = g.w.s;
  const run::start_file file(g.o.common.start, run::start_box_of(g.w),
                             {"Coordinates", "Velocities", "Density", "Masses"});
  const auto x = file.places(), v = file.velocities(), rho = file.densities(), m = file.masses();
  if (g.o.common.start.settles()) file.expect_at_rest(v);
  const auto number = static_cast<std::int32_t>(g.sides());
  const bool differ = g.any_eos ? number > 1 : gas_of(g, 0) != gas_of(g, 1);
  if (differ && !file.has("Material")) file.fail(" has no field Material");
  const auto material = file.has("Material") ? file.materials(number) : std::vector<std::int32_t>(rho.size(), 0);
  const auto u = energies_of(g, file, rho, material);
  const auto dissolved = g.dissolved && file.has("Concentration") ? file.concentrations() : std::vector<double>();
  std::vector<double> volume(rho.size()), reach(rho.size());
  for (std::size_t n = 0; n < rho.size(); ++n) {
    volume[n] = m[n] / rho[n];
    reach[n] = g.support_over_dx * std::pow(volume[n], 1.0 / D);
    const auto stiffness = gas_of(g, material[n]).second;
    if (!g.any_eos && !(u[n] * rho[n] > stiffness))
      file.fail_at(n, fmt::format("its InternalEnergy is {:.6g} J/kg, and its gas has no pressure then", u[n]));
  }
  file.check_packing(x, volume);
  // Around a planet a particle may have flown far from all others.
  if (!g.o.self_gravity) file.check_neighbours(x, volume, reach, false);
  run::lay_out_file<D>(g, x);
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const auto n = static_cast<std::size_t>(s.id[i]);
    s.material[i] = material[n];
    s.m[i] = m[n];
    s.u[i] = u[n];
    s.rho[i] = g.evolved[i] = rho[n];
    if (g.melts) g.inertia[i] = g.o.melting.inertia(g.largest_viscosity_of(material[n]));
    if (g.dissolved) g.concentration[i] = dissolved.empty() ? g.o.element.start(g.is_metal(material[n])) : dissolved[n];
    g.start_volume[i] = volume[n];
    g.start_sum[i] = 1.0;
    for (std::size_t a = 0; a < D; ++a) {
      s.x[a][i] = x[D * n + a];
      s.v[a][i] = v[D * n + a];
    }
    g.support[i] = reach[n];
    g.alpha[i] = g.o.shock.switch_of_alpha ? g.o.shock.alpha_min : g.o.shock.alpha;
    if (g.o.self_gravity) g.softening[i] = g.o.softening * g.support[i];
  }
}

template <int D>
void set_up(world<D>& g) {
  make_materials(g);
  choose_kernel(g);
  make_box(g);
  place_particles(g);
  if (g.o.common.start.is_read()) take_from_file(g);
  if (g.o.largest_support > 0.0)
    g.largest_support = g.o.largest_support * g.ranks().maximum(foundation::largest_of(
                                                  g.w.s.fluid, 0.0, [&](std::size_t i) { return g.support[i]; }));
}

// The weights of the start, to 1e-4: a pass leaves 1 - exponent at most (lists.hpp).
template <int D>
void settle_weights(world<D>& g, passes::evaluation<D>& densities) {
  const auto& s = g.w.s;
  const double exponent = g.o.shock.exponent;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const double p = (g.gamma[i] - 1.0) * g.evolved[i] * s.u[i];
    g.power_weight[i] = std::pow(p, exponent) * g.start_volume[i];
  }
  const int rounds = 1 + static_cast<int>(std::log(1e-4) / std::log1p(-std::min(exponent, 0.9999)));
  for (int k = 0; k < rounds; ++k) {
    densities.run({});
    next_weights(g);
  }
}

// After the first lists. The start lattice's supports are those of an endless lattice: next to a jump they are not yet
// the right ones.
template <int D>
void settle(world<D>& g, passes::evaluation<D>& densities) {
  for (int round = 0; round < 4; ++round) {
    for (int k = 0; k < 5; ++k) {
      densities.run({});
      next_supports(g);
    }
    make_lists(g, false);
  }
  if (g.weighs_power) settle_weights(g, densities);
  if (!g.weighs_volume) return;
  // With the sums of the start a particle's density is at first what the input says, at contacts too.
  densities.run({});
  std::copy_n(g.y.begin(), g.w.s.fluid, g.start_sum.begin());
}

}  // namespace tetsuame::gas
