// The input of thermal convection between a hot bottom and a cold top: &domain, that of module relaxation, and
//   &convection  numbers that override the dimensional values, slowing, density, scheme
//   &initial     perturbation, half_waves, file
//   &region, &constants   temperatures of the start (regions/options.hpp)
//   &sources     forces beside buoyancy, heat beside that from inside (sources/options.hpp)
//   &walls       walls/options.hpp
//   &time, &kernel, &output, &run   run/options.hpp
#pragma once

#include <convection/gravity_density.hpp>
#include <convection/viscosity.hpp>
#include <memory>
#include <regions/region.hpp>
#include <relaxation/options.hpp>
#include <run/lists.hpp>
#include <run/options.hpp>
#include <run/simulation.hpp>
#include <sources/options.hpp>

namespace tetsuame::convection {

inline const domain::demands demands{
    .walls_below_and_above = "heat comes from the bottom and leaves at the top: these are walls", .jitters = false};

struct convection_options {
  std::optional<double> rayleigh, prandtl;
  bool viscous_heating = false, adiabatic_heating = false;
  double heating = 0.0;  // W/kg

  std::string target = "auto";
  double steady_tolerance = 2e-4;
  std::int64_t levels = -1;           // coarser ones before; -1: chosen
  std::optional<double> steady_mach;  // not given: by the viscosity's law

  std::string gravity_density = "boussinesq";
  std::string eos = "linear";  // of gravity_density = 'equation_of_state'
  std::string eos_table;       // of eos = 'table': its file
  double p_top = 0.0;          // Pa
  bool eos_dynamic_pressure = true;

  std::string viscosity_law = "constant";
  std::string viscosity_file;                         // of the 'table' law
  double viscosity_min = 1e19, viscosity_max = 1e23;  // Pa s, of the 'melt' law
  std::string composition = "peridotitic";            // of the 'melt' law
  std::string melt_viscosity = "suspension";          // of the 'melt' law
  double temperature_exponent = 0.0, depth_exponent = 0.0;
  std::optional<double> viscosity_ramp;  // s; not given: chosen

  std::optional<double> pressure_diffusion;  // not given: chosen
  double remap_diffusion = 0.5, shifting = 1.5;
};

// Spacings, of the fit of the heat through a wall (measures.hpp).
inline constexpr double fit_radius = 3.5;

struct initial_options {
  double perturbation = 0.05;      // of the difference in temperature
  std::int64_t half_waves = 1;     // along x
  double temperature_noise = 0.0;  // of the difference in temperature
  std::int64_t noise_seed = 1;
};

inline const regions::abilities of_regions{.temperature = true, .above_0 = false};

struct options {
  domain::options domain{.length = {1e6, 1e6, 1e6}, .particles = {100, 100, 100}};  // y is up: length[1] is the height
  relaxation::options physics;
  convection_options convection;
  initial_options initial;
  regions::options of_regions;
  sources::options of_sources;
  walls::options walls;
  run::common_options common;

  // Whether heat comes and goes through left and right alone: they hold temperatures, bottom and top are adiabatic.
  bool heated_from_a_side() const;
  // Of the walls between which heat goes, by their numbers in walls::side_names: bottom and top, or of left and right
  // the hotter and the colder.
  std::size_t hot_side() const;
  std::size_t cold_side() const;
  double temperature_hot() const { return walls.sides[hot_side()].temperature; }    // K
  double temperature_cold() const { return walls.sides[cold_side()].temperature; }  // K
};

// What the run computes with, all SI; the slowing is that of the present lattice and viscosity.
struct parameters {
  regions::all regions;
  sources::all sources;
  relaxation::fluid_layer fluid;
  // K: T_ref = T_bottom - dT_reference y/L, which carries no flow; heated from a side the mean of both sides.
  double T_bottom, dT_reference;
  // The way of heat: axis, m from wall to wall, +1 or -1 along the axis.
  std::size_t heat_axis;
  double heat_length, heat_sign;
  double conductivity;   // W/(m K)
  double heat_capacity;  // J/(kg K), at the top
  double heating;        // K/s, from inside
  viscosity_law law;     // over the top's viscosity, which is that of `fluid` when the law is reached
  double nu;             // m2/s, the top's now
  double reached;        // share of the law's logarithm that is there
  // By an equation of state; null: by the Boussinesq law.
  std::shared_ptr<const gravity_density> weighed;
  double compressibility;     // what of p/K_0 gravity feels: 0, 1 or zeta²
  double dissipation_number;  // alpha g L/c_p; with an equation of state the mean of alpha rho/rho_0 on its adiabat

  relaxation::recommendation slowing;  // by the note's rules, or as given
  bool steady;                         // only the steady state is right: artificial inertia vanishes there
  double c_eff;                        // m/s, slowed sound c_0/(zeta xi)
  double c_end;                        // m/s, c_eff at the end of the viscosity's ramp
  double ramp, start;                  // s, of the viscosity; so many times as high at first
  double sonic_share;                  // nu_eff = max(sonic_share c_eff dx, kappa); 0: nu_eff does not follow dx
  double lid;                          // m/s, of the fastest wall
  double nu_eff;                       // m2/s, nu/xi²: where steady everywhere, else at the reference viscosity
  // The viscous force is that of a velocity which relaxes to v; instant: no waves of shear, instant_share 1.
  bool relaxed;
  double shear_speed;      // m/s, of waves of shear
  double relaxation_time;  // s
  double instant_share;    // of nu_eff, which answers at once

  std::vector<std::string> lines;  // what was chosen, and why
};

// Of the input's dimension (programs/convection/flow.cpp). Options and parameters outlive the problem.
std::unique_ptr<run::simulation> make(const options& o, const parameters& p);

void declare(namelist::schema& schema, options& o);
// Makes the overridden values consistent, fills what was left open, checks.
parameters resolve(const namelist::schema& schema, options& o);

// Of these: the density that gravity weighs, if it is that of an equation of state (gravity_density.cpp), and the law
// of viscosity, with the top's viscosity where a table has it (viscosity.cpp).
void resolve_gravity(const namelist::schema& schema, const options& o, parameters& p);
void resolve_viscosity(const namelist::schema& schema, options& o, parameters& p);
// Particles along each axis with `level` coarser spacings to come, each twice the one before.
std::array<std::int64_t, 3> particles_of_level(const options& o, std::int64_t level);
// Sets what of the slowing and of the viscous response follows the spacing dx (m), and the viscosity while that is not
// yet what it is at the end.
void follow(parameters& p, double dx);

}  // namespace tetsuame::convection
