// Two fluids under gravity: what a run holds, as plain data, and names for what is asked of a particle.
#pragma once

#include <integrators/explicit_integrator.hpp>
#include <particles/named_fields.hpp>
#include <rigid/contact.hpp>
#include <run/lists.hpp>
#include <run/start.hpp>
#include <sources/fields.hpp>
#include <tension/between_liquids.hpp>
#include <two_fluids/lattice.hpp>
#include <two_fluids/options.hpp>
#include <walls/boundary_force.hpp>

namespace tetsuame::two_fluids {

template <int D>
class fluids {
 public:
  using point = std::array<double, D>;
  using role = particles::role;

  problem_kind kind;
  const options& o;
  const parameters& p;
  const bool by_program;
  run::state<D> world;

  const bool has_bodies = !p.template bodies_in<D>().empty();
  rigid::bodies<D> bodies{world, rigid::box_of<D>(o.domain, o.common, o.walls), p.template bodies_in<D>(),
                          std::vector<rigid::motion_of_body<D>>(p.template bodies_in<D>().size())};
  std::int64_t placed = 0;  // particles on all ranks: without those that bodies would cover

  // A program's scheme says itself which of the two it carries.
  bool carried = o.scheme.volume == "our_method";  // ρ is integrated
  bool weighed = false;                            // Y is
  const bool smoothed = o.scheme.pressure == "smoothed", follows = o.scheme.supports == "volume";
  const bool warms = o.temperature_law == "adiabatic", enthalpy = o.temperature_law == "enthalpy";
  const bool dissolved = o.element.any(), tense = o.surface_tension > 0.0;

  double h = 0.0;                                       // m
  double reference_floor = 0.0, reference_slope = 0.0;  // Pa, Pa/m
  // kg/m3, of each material the least and the largest density at the pressures of the start.
  std::vector<std::pair<double, double>> density_range = std::vector<std::pair<double, double>>(o.material.size());
  viscous_weights viscous;
  bool second_order = false;  // in the place of the viscous order that was asked for

  // Slowed sound and inertia (slowing.hpp).
  const bool slows = o.slowing.zeta > 1.0;
  const double stiffness = 1.0 / (o.slowing.zeta * o.slowing.zeta);  // 1/ζ²
  const std::vector<double> xi2 =
      of_materials<double>([this](std::size_t n) { return o.slowing.xi_n(n) * o.slowing.xi_n(n); });
  const std::vector<char> metals = of_materials<char>([this](std::size_t n) { return o.material[n].metal ? 1 : 0; });

  // What particles carry beside the usual, where the run has it.
  particles::array& dissipated = field(true, "Dissipated", "J/kg", role::integrated);  // heat of friction
  particles::array& rho_start = field(true, "StartDensity", "kg/m^3", role::constant);
  particles::array& T_start = field(true, "StartTemperature", "K", role::constant);
  particles::array& content = field(enthalpy, "Enthalpy", "J/kg", role::integrated);  // of heat, c T and latent
  particles::array& content_start = field(enthalpy, "StartEnthalpy", "J/kg", role::constant);
  particles::array& element = field(dissolved, "Concentration", "1", role::integrated);  // amount per mass
  particles::array& support = field(follows, "Support", "m", role::memory);              // at the start of the step
  particles::array& list_support = field(follows, "ListSupport", "m", role::memory);     // what lists let it be

  // Where supports follow the volume (supports.hpp): the kernel with support 1, that of the start, those in the sums.
  kernels::any<D> unit = kernels::make<D>("quintic", 1.0);
  double S_0 = 0.0;  // m
  particles::array& S = field(follows, "KernelSupport", "m");
  particles::array& per_S = field(follows, "InverseSupport", "1/m");
  particles::array& count = field(follows, "NeighbourCount", "1");
  particles::array& count_slope = field(follows, "NeighbourCountSlope", "1");
  particles::array& follow_factor = field(follows, "SupportFactor", "1");

  // Sums over neighbours; a program's scheme has its own.
  particles::vector_field<D> force = vector(!by_program, "Force", "N");
  particles::array& stress = field(!by_program, "Stress", "");
  particles::array& compression = field(!by_program, "Compression", "");
  particles::array& heat = field(true, "Heating", "W");
  particles::array& rho_rate = field(!by_program && carried, "DensityRate", "kg/(m^D s)");
  particles::array& conducted = field(o.conducts(), "ConductedHeat", "W");
  particles::array& lift = field(!by_program && slows, "Lift", "N");  // of slowed sound

  particles::array& melt = field(enthalpy, "MeltFraction", "1");
  particles::array& inertia = field(enthalpy, "Inertia", "1");  // what ξ² has of the viscosity

  particles::array& partition = field(dissolved, "PartitionCoefficient", "1");
  particles::array& mobility = field(dissolved, "ElementMobility", "kg/(m s)");  // ρ D
  particles::array& gain = field(dissolved, "ElementGain", "kg/s");
  particles::array& metal = field(dissolved || tense, "Metal", "1");  // 1 in metal, or 0

  tension::between_liquids<D> tension{world, o.surface_tension, metal};
  sources::fields<D> sources;

  // by_program: a program's scheme makes the sums.
  fluids(problem_kind kind_, const options& o_, const parameters& p_, bool by_program_ = false)
      : kind(kind_), o(o_), p(p_), by_program(by_program_) {
    world.w.s.keeps_start = true;
  }
  fluids(const fluids&) = delete;  // its fields are the state's
  fluids& operator=(const fluids&) = delete;

  const domain::communicator& ranks() const { return world.w.d.ranks; }
  std::size_t material_of(std::size_t i) const { return static_cast<std::size_t>(world.w.s.material[i]); }
  bool is_metal(std::size_t i) const { return metals[material_of(i)] != 0; }
  const tetsuame::melting::options& melting_of(std::size_t i) const { return p.melting[material_of(i)]; }
  bool isothermal() const { return !warms && !enthalpy; }
  bool is_drop() const { return kind == problem_kind::drop; }
  bool many() const { return is_drop() && p.places.size() > 1; }
  double number_of_drops() const { return static_cast<double>(p.places.size()); }
  double inertia_of(std::size_t i) const {  // ξ²
    return xi2[material_of(i)] * (enthalpy ? inertia[i] : 1.0);
  }
  double latent(std::size_t i) const { return melting_of(i).latent_heat; }  // J/kg
  double speed2(std::size_t i) const {
    double v2 = 0.0;
    for (std::size_t a = 0; a < D; ++a) v2 += world.w.s.v[a][i] * world.w.s.v[a][i];
    return v2;
  }
  double reference_pressure(double y) const { return reference_floor + reference_slope * y; }  // Pa

  // The viscous sum of fourth order takes energy from every wave of the lattice, but may give some to particles in
  // disorder. Where the energy dissipated falls, that of second order, which cannot, takes its place.
  bool fourth_order() const { return o.scheme.viscous_order == 4 && !second_order; }

 private:
  template <class T, class Of>
  std::vector<T> of_materials(const Of& value) const {
    std::vector<T> all;
    for (std::size_t n = 0; n < o.material.size(); ++n) all.push_back(value(n));
    return all;
  }
  particles::array& field(bool needed, const char* name, const char* unit_of, role kind_of = role::derived) {
    return particles::declare_if(needed, world.w.s, name, unit_of, kind_of);
  }
  particles::vector_field<D> vector(bool needed, const char* name, const char* unit_of) {
    return particles::declare_vector_if<D>(needed, world.w.s, name, unit_of, role::derived);
  }
};

// A material by itself: isotherm or adiabat through the lid's pressure and temperature.
template <int D>
barotropic curve_of(const fluids<D>& f, std::size_t n) {
  return {&(*f.p.material)[n], f.o.p_top, f.o.temperature, f.warms};
}
template <int D>
place on_curve(const fluids<D>& f, std::size_t n, double pressure) {
  return at_pressure(curve_of(f, n), pressure);
}

template <int D>
melting::heat_content contents(const fluids<D>& f, std::size_t i, double p) {
  const auto& law = f.melting_of(i);
  if (law.curve == "none") return {f.world.w.s.c_V[i], 0.0};
  const auto [T_s, T_l] = melting::range(law, p);
  return {f.world.w.s.c_V[i], law.latent_heat, T_s, T_l};
}

// m^2D, what the pressure has in the forces: A of terms.hpp over p.
template <int D>
double element_of_work(const fluids<D>& f, std::size_t i) {
  const auto& w = f.world.w;
  const double scale = f.carried ? 1.0 : 1.0 / w.lattice_sum;
  return scale * w.s.dV[i] * w.s.dV[i];
}

}  // namespace tetsuame::two_fluids
