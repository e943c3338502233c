// Gas with contacts and shocks in a box: the options, the test, the particles with their lists, and an array for every
// quantity that is summed or derived. What is done with them: start.hpp, lists.hpp, rates.hpp, flow.hpp.
#pragma once

#include <bit>
#include <eos/caloric.hpp>
#include <gas/setups.hpp>
#include <gravity/self_gravity.hpp>
#include <limits>
#include <melting/latent_heat.hpp>
#include <memory>
#include <particles/named_fields.hpp>
#include <run/supports.hpp>
#include <schemes/common.hpp>
#include <sources/fields.hpp>
#include <variant>

namespace tetsuame::gas {

template <int D>
using kernel_choice = std::variant<kernels::quintic_spline<D>, kernels::wendland_c4<D>>;

template <int D>
struct world : run::state<D>, schemes::arrays<D> {
  using run::state<D>::w, run::state<D>::walls, run::state<D>::skin;

  const options& o;
  const setup test;
  // What the options say, for loops over particles
  const bool weighs_energy = o.weighs_energy(), weighs_volume = o.weighs_volume(), weighs_power = o.weighs_power();
  const bool any_eos = o.any_eos();
  const bool godunov = o.godunov(), second_order = o.second_order(), evolves_density = o.evolves_density();
  const bool geometric = o.geometric(), integral_gradients = o.integral();
  const bool part_of_star = o.shock.star_pressure == "balsara";
  std::vector<eos::caloric> materials = {};                 // by side; none: gases
  std::vector<double> stiffening = {};                      // K_S' of each
  std::vector<double> start_sound = {};                     // m/s, of each
  kernel_choice<D> unit = kernels::quintic_spline<D>(1.0);  // support 1
  double support_over_dx = 0.0, support_over_h = 0.0;
  double largest_support = std::numeric_limits<double>::infinity();  // m, of any particle
  double speed_scale = 0.0, density_scale = 0.0;

  // Fields that go with the particles.
  particles::array& support = field("Support", "m", "support of the kernel at the start of the step");
  // In open space lists follow the flow. In boxes they keep the frame of all, in which no list ends by where a period
  // or a wall lies.
  const bool lists_follow = in_open_space();
  particles::array& support_growth = particles::declare_if(
      lists_follow, w.s, "SupportGrowth", "m", particles::role::memory, "in the last step, whatever the lists allow");
  particles::array& list_support = field("ListSupport", "m", "what lists let the support grow to");
  run::list_motion<D> motion = {
      particles::declare_vector_if<D>(lists_follow, w.s, "ListVelocity", "m/s", particles::role::memory,
                                      "mean about a particle, while the lists live"),
      particles::declare_if(lists_follow, w.s, "ListRange", "m", particles::role::memory,
                            "how far lists let a particle be from where that takes it")};
  particles::array& alpha = field("Alpha", "1", "of the artificial viscosity", particles::role::integrated);
  particles::array& start_volume = field("StartVolume", "m^D", "mass over density at the start");
  particles::array& start_sum = field("StartSum", "1", "sum of StartVolume W at the start");
  particles::array& power_weight = particles::declare_if(weighs_power, w.s, "PowerWeight", "", particles::role::memory,
                                                         "p^exponent times the volume");
  particles::array& evolved = field("EvolvedDensity", "kg/m^D", "density by continuity", particles::role::integrated);

  // Of self-gravity: it stays, so that the gravitational energy depends on places alone.
  particles::array& softening = particles::declare_if(o.self_gravity.has_value(), w.s, "Softening", "m",
                                                      particles::role::memory, "support of a particle's own field");

  sources::fields<D> sources = {};
  struct no_attraction {};  // of one dimension
  std::unique_ptr<std::conditional_t<(D > 1), gravity::self<D>, no_attraction>> attraction = {};

  particles::array& number_volume = this->derived("NumberVolume", "m^D", "1/n");
  // Of the gas itself, where it has friction or conducts.
  const schemes::transport molecular = o.shock.molecular;
  particles::vector_field<D> friction = this->template derived_vector<D>("Friction", "N", "", molecular.any());
  particles::array& heat = this->derived("HeatOfFriction", "W", "and of conduction", molecular.any());
  const bool viscosities_differ = o.viscosities_differ();

  // Of silicate that melts, and of an element that it exchanges with metal.
  const bool melts = o.melting.melts(), dissolved = o.element.any();
  particles::array& melt = this->derived("MeltFraction", "1", "", melts);
  particles::array& inertia =
      particles::declare_if(melts, w.s, "Inertia", "1", particles::role::memory, "what the acceleration is divided by");
  particles::array& earlier_inertia =
      particles::declare_if(o.melting.inertia_viscosity > 0.0, w.s, "EarlierInertia", "1", particles::role::memory,
                            "at the end of the step before; 0: there was none");
  particles::array& concentration = particles::declare_if(dissolved, w.s, "Concentration", "1",
                                                          particles::role::integrated, "of the element, per mass");
  particles::array& partition = this->derived("PartitionCoefficient", "1", "1 in silicate", dissolved);
  particles::array& mobility = this->derived("ElementMobility", "kg/(m s)", "density times diffusivity", dissolved);
  particles::array& metal = this->derived("Metal", "1", "1 in metal, or 0", dissolved);
  particles::array& gain = this->derived("ElementGain", "kg/s", "", dissolved);

  world(const options& o_, setup test_)
      : schemes::arrays<D>(w.s, {.slopes = o_.godunov() || o_.evolves_density(),
                                 .corrects = o_.evolves_density(),
                                 .integral = o_.integral(),
                                 .geometric = o_.geometric() && !o_.integral(),
                                 .counts = o_.common.time.method == "kdk"}),
        o(o_),
        test(std::move(test_)) {}

  particles::array& field(const char* name, const char* of_unit, const char* about,
                          particles::role role = particles::role::memory) {
    return particles::declare(w.s, name, of_unit, role, about);
  }
  const domain::communicator& ranks() const { return w.d.ranks; }
  // Nothing stands at any side: momentum and angular momentum are kept.
  bool in_open_space() const {
    for (std::size_t a = 0; a < D; ++a)
      if (!o.domain.open[a]) return false;
    return D > 1;
  }
  schemes::fields<D> fields() { return {w.s, *this}; }

  // weight = 'power': of V = w/y and u, with y of the last sums.
  double power_pressure(std::size_t i) const {
    return (this->gamma[i] - 1.0) * w.s.m[i] * w.s.u[i] * this->y[i] / power_weight[i];
  }
  const particles::array& told_density() const { return o.shock.density == "mass" ? this->mass_density : w.s.rho; }
  // A part of the skin is for supports to grow, the rest for particles to move.
  double room_to_grow() const { return 0.25 * skin; }

  point place(std::size_t i) const {
    point x{};
    for (std::size_t a = 0; a < D; ++a) x[a] = w.s.x[a][i];
    return x;
  }
  // Sides are the left and the right one, or the materials by number.
  std::size_t sides() const { return o.materials.empty() ? 2 : o.materials.size(); }
  const side_options& side(std::size_t k) const {
    return !o.materials.empty() ? o.materials[k] : k == 0 ? o.shock.l : o.shock.r;
  }
  std::size_t side_of(std::int32_t material) const {
    if (!o.materials.empty()) return static_cast<std::size_t>(material);
    return material == test.material_l ? 0 : 1;
  }
  double viscosity_of(std::int32_t material) const {  // Pa s
    return side(side_of(material)).viscosity.value_or(molecular.viscosity);
  }
  const eos::caloric& caloric_of(std::size_t i) const { return materials[side_of(w.s.material[i])]; }
  bool is_metal(std::int32_t material) const { return side(side_of(material)).metal; }
  bool melts_by_law(std::int32_t material) const { return melts && !is_metal(material); }
  // Pa s: no state of the material is more viscous. What limits steps before the first evaluation.
  double largest_viscosity_of(std::int32_t material) const {
    return o.melting.viscosity_varies() && melts_by_law(material) ? o.melting.viscosity_max : viscosity_of(material);
  }
  double inertia_of(std::size_t i) const { return melts ? inertia[i] : 1.0; }
  double latent_heat(std::size_t i) const { return melts ? o.melting.latent_heat * melt[i] : 0.0; }  // J/kg
  double internal_energy(std::int32_t material, double rho, double T) const {                        // J/kg
    const eos::caloric& m = materials[side_of(material)];
    return melts_by_law(material) ? melting::internal_energy(m, o.melting, rho, T) : m.internal_energy(rho, T);
  }
  // By its equation of state; without tension p is not below 0, and sound, which an expanded solid may lack, not below
  // a tenth of that at the start.
  eos::caloric_state state_of(std::size_t i) const {
    eos::caloric_state now = caloric_of(i).at(w.s.rho[i], w.s.u[i] - latent_heat(i));
    if (o.shock.tension || !std::isfinite(now.p)) return now;
    const double slowest = 0.1 * start_sound[side_of(w.s.material[i])];
    now.p = std::max(now.p, 0.0);
    if (!(now.c > slowest)) now.c = slowest;
    return now;
  }
  // c² = γ (p + p_inf)/ρ = γ (γ - 1)(u - p_inf/ρ)
  double sound_speed(std::size_t i) const {
    if (any_eos) return state_of(i).c;
    const double p_infinity = this->stiffness[i], adiabatic = this->gamma[i];
    const double thermal = p_infinity > 0.0 ? w.s.u[i] - p_infinity / w.s.rho[i] : w.s.u[i];
    return std::sqrt(adiabatic * (adiabatic - 1.0) * std::max(thermal, 0.0));
  }
};

// gamma and p_infinity; with an equation of state K_S' of the start, and p_infinity follows the state
template <int D>
std::pair<double, double> gas_of(const world<D>& g, std::int32_t material) {
  const std::size_t k = g.side_of(material);
  if (g.any_eos) return {g.stiffening[k], 0.0};
  return {*g.side(k).gamma, g.side(k).p_infinity};
}

// The pair sum of terms over the neighbours of these rows, in the precision that the run chose. The unit of length of
// single precision is near the largest reach of a pair.
template <int D, class... Terms>
void sum(world<D>& g, const pairs::row_range& rows, const Terms&... terms) {
  const double nearest = 1e-9 * g.support_over_dx * g.w.dx;
  if constexpr ((pairs::takes<Terms, pairs::single> && ...))
    if (g.w.single_pairs()) {
      const pairs::unit<pairs::single> lengths(g.w.d.width);
      return pairs::sum_in<D>(lengths, rows, g.w.list, {g.w.x(), g.w.frame},
                              schemes::distances_only{nearest * lengths.to(-1)}, terms...);
    }
  pairs::sum_over<D>(rows, g.w.list, {g.w.x(), g.w.frame}, schemes::distances_only{nearest}, terms...);
}

}  // namespace tetsuame::gas
