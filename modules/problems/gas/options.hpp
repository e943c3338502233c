// The input of gas with contacts and shocks:
//   &domain   dimension, length_*, particles_*, periodic_*, ranks_x
//   &shock    test, scheme, state and material on either side, viscosity, Riemann solver, reconstruction
//   &region, &constants   what the start is somewhere (regions/options.hpp)
//   &sources  forces and heat from outside (sources/options.hpp)
//   &time, &kernel, &output, &run   run/options.hpp
#pragma once

#include <algorithm>
#include <array>
#include <elements/options.hpp>
#include <eos/eos.hpp>
#include <gravity/tree.hpp>
#include <melting/options.hpp>
#include <optional>
#include <regions/region.hpp>
#include <run/lists.hpp>
#include <run/options.hpp>
#include <schemes/molecular.hpp>
#include <sources/options.hpp>

namespace tetsuame::gas {

// The gas on the left or inside, or that on the right or outside.
struct side_options {
  double rho, u, p;                        // kg/m3, m/s, Pa
  std::optional<double> gamma = {};        // none: that of all
  double p_infinity = 0.0;                 // Pa; stiffened gas
  std::string eos = "";                    // empty: the gas of gamma and p_infinity
  std::string tillotson = "";              // of 'tillotson', its material; empty: iron
  std::string table = "";                  // of 'table', its file
  std::optional<double> temperature = {};  // K
  std::optional<double> viscosity = {};    // Pa s, of this material; none: that of all
  bool metal = false;                      // it does not melt, and takes up an element
  eos::material_options parameters = {};   // of the equation of state, beside its name, material and file
};

struct shock_options {
  std::string test = "riemann", scheme = "gdisph", masses = "equal_mass", density = "weight";
  std::string weight = "energy", support_terms = "number";
  double exponent = 0.1;  // of the pressure in the weight
  double fading = 20.0;   // of the terms of varying supports
  side_options l{1.0, 0.0, 1.0}, r{0.125, 0.0, 0.1};
  double gamma = 1.4;
  std::int64_t coarser = 0;                   // runs at 1/2, 1/4, … of the resolution before this one
  double middle = 0.5;                        // riemann: where the two sides meet, of the box along x
  double window = 1.0;                        // of the box along x, about its middle: where errors are measured
  double energy = 1.0, blast_radius = 2.0;    // J; in spacings
  bool corner = false;                        // sedov: the centre is in a corner
  double gravity = 0.0;                       // m/s2, towards -y
  double layer = 0.025, perturbation = 0.01;  // m, m/s
  std::int64_t waves = 2;                     // along x
  double radius = 1.0, core = 0.5;            // m; of the radius
  bool tension = true;                        // equations of state: pressures below 0
  std::string solver = "hllc", reconstruction = "second", limiter = "minmod", star_pressure = "full";
  double alpha = 1.0, alpha_min = 0.1;
  bool switch_of_alpha = true, balsara = true;
  std::string gradients = "kernel";  // of ssph and gdf
  double conductivity = 0.0;         // artificial, of ssph and gdf
  schemes::transport molecular;
  std::optional<double> heat_capacity = {};  // J/(kg K), at constant volume
};

struct options {
  domain::options domain{.dimension = 1, .length = {1.0, 0.0, 0.0}, .particles = {400, 0, 0}};
  shock_options shock;
  std::vector<side_options> materials = {};  // by number (program planet); empty: left and right
  regions::options of_regions;               // as the input has them
  regions::all regions;
  sources::options of_sources;
  sources::all sources;
  std::optional<gravity::tree_options> self_gravity = {};
  double softening = 1.0;              // of a particle's own field, over its kernel's support at the start
  double largest_support = 0.0;        // of a kernel, over the largest at the start; 0: any
  tetsuame::melting::options melting;  // of materials that are not metal
  elements::options element;
  run::common_options common;

  bool density_independent() const { return shock.scheme == "disph" || shock.scheme == "gdisph"; }
  bool weighs_energy() const { return density_independent() && shock.weight == "energy"; }
  bool weighs_volume() const { return density_independent() && shock.weight == "volume"; }
  bool weighs_power() const { return density_independent() && shock.weight == "power"; }
  bool godunov() const { return shock.scheme == "gsph" || shock.scheme == "gdisph"; }
  // Of Σ m W, with artificial viscosity: those that have other gradients and dissipation to choose.
  bool density_based() const { return shock.scheme == "ssph" || geometric(); }
  bool geometric() const { return shock.scheme == "gdf"; }
  bool integral() const { return shock.gradients == "integral"; }
  bool conducts() const { return shock.conductivity > 0.0; }
  bool terms_fade() const { return shock.support_terms == "fading"; }
  bool evolves_density() const { return shock.scheme == "remix"; }
  bool any_eos() const { return !shock.l.eos.empty() || !materials.empty(); }
  // Then the bulk viscosity is 5/3 of each (schemes/molecular.hpp).
  bool viscosities_differ() const {
    return melting.viscosity_varies() || std::ranges::any_of(materials, [this](const side_options& m) {
             return m.viscosity && *m.viscosity != shock.molecular.viscosity;
           });
  }
  bool second_order() const { return godunov() && shock.reconstruction == "second"; }
  // Whether the viscosity of each particle has a coefficient of its own.
  bool has_alpha() const { return !godunov() && !evolves_density() && shock.switch_of_alpha; }
};

// Friction and conduction of the gas itself: transport.cpp.
void declare_transport(namelist::schema& schema, shock_options& s);
void check_transport(const namelist::schema& schema, const options& o);

eos::any eos_of(const side_options& side);  // with its own parameters

void declare(namelist::schema& schema, options& o);
void resolve(const namelist::schema& schema, options& o);
// Where it is not given. With 0.25 the errors of shock tubes by kick-drift-kick are those of Runge-Kutta's with 0.4
// (docs/theory/leapfrog.md).
void choose_cfl(run::time_options& o);
// Single precision, where it is the default alone, leaves the square, which is to stay to the last bit, to double; and
// gases whose numbers it does not hold. Refused where it was asked for and cannot be.
void choose_precision(const namelist::schema& schema, options& o);
double expected_particles(const options& o);
void declare_largest_support(namelist::schema& schema, const std::string& group, double& largest);

}  // namespace tetsuame::gas
