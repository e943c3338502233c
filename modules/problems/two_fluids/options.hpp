// The input of two fluids under gravity, of programs rti and drop:
//   &domain   domain/options.hpp
//   &rti or &drop   shape, its two materials, start, formulation
//   &material each further one
//   &walls    walls/options.hpp; pressure
//   &solids   bodies of any shape that stand still (solids/options.hpp)
//   &region, &constants   what the start is somewhere (regions/options.hpp)
//   &sources  forces and heat from outside (sources/options.hpp)
//   &melting  solidus and liquidus of the lower (outer) material, viscosity by melt fraction
//   &element  what is dissolved in both
//   &time, &kernel, &output, &run   run/options.hpp
#pragma once

#include <deque>
#include <elements/options.hpp>
#include <eos/eos.hpp>
#include <melting/melting.hpp>
#include <melting/options.hpp>
#include <memory>
#include <regions/region.hpp>
#include <rigid/box.hpp>
#include <run/options.hpp>
#include <sources/options.hpp>
#include <tuple>
#include <two_fluids/column.hpp>
#include <volume/options.hpp>
#include <walls/options.hpp>

namespace tetsuame::two_fluids {

enum class problem_kind { rayleigh_taylor, drop };

struct material_options {
  std::string name{};  // lower, upper; outside, drop; those of &material
  std::string eos = "linear";
  std::string table = "";               // of eos = 'table': its file
  double density = 7000.0;              // kg/m3, linear: at zero pressure
  double viscosity = 6e11;              // Pa s
  std::optional<double> bulk_modulus;   // Pa, linear; not given: the common one
  std::optional<double> heat_capacity;  // J/(kg K); not given: the equation of state's own
  std::optional<double> conductivity;   // W/(m K); not given: the common one
  eos::material_options parameters;     // of the equation of state: those that have no key above
  std::optional<double> temperature{};  // K, at the start, law 'enthalpy'; not given: the common one
  bool metal = false;                   // or silicate
  bool melts = false;                   // by &melting, but for what is given here:
  std::optional<double> solidus{}, liquidus{}, latent_heat{};  // K, K, J/kg
};

// Group &material: an element of each list for each material; a number that is not finite is not given.
struct more_materials {
  std::vector<std::string> name, eos, curve, tillotson, table, metal, melts;
  std::vector<double> density, viscosity, conductivity, temperature, solidus, liquidus, latent_heat;
  std::array<std::vector<double>, eos::parameters.size()> parameters;
};

struct scheme_options {
  std::string volume = "number_density", pressure = "non_smoothed";
  std::string reference_pressure = "auto";
  std::string supports = "fixed";
  std::string rows = "lattice";  // of rti
  double delta = 0.1;
  std::int64_t viscous_order = 0;  // of the run: 2 or 4
};

// Sound and inertia, both as they are by default.
struct slowing_options {
  double zeta = 1.0, xi = 1.0;
  std::array<std::optional<double>, 2> xi_of{};  // lower, upper; outside, drop
  double xi_n(std::size_t n) const { return n < xi_of.size() ? xi_of[n].value_or(xi) : xi; }
  bool any() const { return zeta > 1.0 || xi_n(0) > 1.0 || xi_n(1) > 1.0; }
  double of_sound() const { return zeta * std::max(xi_n(0), xi_n(1)); }  // what it takes longer by
};

struct options {
  domain::options domain{.length = {1.5e6, 1.5e6, 1.5e6}, .particles = {48, 48, 48}};
  walls::options walls;
  solids::options solids;
  regions::options regions;
  sources::options sources;
  std::deque<material_options> material{2};  // lower, upper; of a drop: outside, drop; then those of &material
  more_materials more;
  double bulk_modulus = 5e11;   // Pa
  double gravity = 10.0;        // m/s2
  double p_top = 1e5;           // Pa
  double temperature = 3000.0;  // K, at the top
  std::string temperature_law = "isothermal";
  double conductivity = 0.0;           // W/(m K), of both
  double surface_tension = 0.0;        // N/m, between the materials
  tetsuame::melting::options melting;  // of the lower (outer) material, where temperature_law is 'enthalpy'
  elements::options element;           // dissolved in both
  // of rti
  std::optional<double> interface, wavelength;  // m
  double wavelength_z = 0.0;                    // m; 0: no change along z
  double amplitude = 750.0;                     // m
  std::string start = "eigenmode", masses = "equal_spacing";
  double shear = 0.0;                                 // m/s, of the upper layer against the lower, along x
  std::optional<double> pond_top, cover_temperature;  // m, K: above, the lower material again
  // of drop
  double radius = 1.5e5;                          // m
  std::array<std::optional<double>, 3> centre{};  // m
  double measure_at = 0.7;                        // of the height
  std::string shape = "round";
  double elongation = 1.0;  // along y, over that across
  std::int64_t drops = 1, seed = 1;
  std::optional<double> least_gap;                    // m
  std::array<std::vector<double>, 3> places{};        // m, of given drops
  std::optional<double> measure_from, measure_until;  // s, of several drops

  scheme_options scheme;
  slowing_options slowing;
  // Where a program's own scheme takes its place: what it is told.
  bool by_program = false, integrates_volume = true, integrates_weight = false, remembers_density = true,
       by_number = false;
  volume::options liquid;
  run::common_options common;

  options() { material[0].density = 3000.0; }
  double conductivity_of(std::size_t n) const { return material[n].conductivity.value_or(conductivity); }
  bool conducts() const {
    for (std::size_t n = 0; n < material.size(); ++n)
      if (conductivity_of(n) > 0.0) return true;
    return false;
  }
  bool equally_viscous() const {
    for (const auto& m : material)
      if (m.viscosity != material[0].viscosity) return false;
    return true;
  }
  // From material to material, or by temperature and melt.
  bool viscosities_differ() const { return melting.viscosity_varies() || !equally_viscous(); }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& m : material) all.push_back(m.name);
    return all;
  }
  bool has_bodies() const { return !solids.shape.empty(); }
  bool open_lid() const { return walls.sides[3].slip == "free_surface"; }
};

// Rows and columns of a layer's start lattice, and what a particle of it takes up.
struct layer_lattice {
  double low = 0.0;                      // m, its lower edge
  std::array<std::int64_t, 3> number{};  // particles along each axis
  std::array<double, 3> spacing{};       // m
  double volume = 0.0;                   // m^D
};

// What a run computes with, SI.
struct parameters {
  double dx;
  double halo;                                      // m, what a particle, or a marker, reaches
  std::unique_ptr<std::vector<eos::any>> material;  // lower or outside, upper or drop, those of &material
  double interface;                                 // m, on an edge between rows
  std::array<layer_lattice, 2> layers;              // lower, upper; of equal masses each has its own spacing
  std::unique_ptr<column> base;                     // the column at rest
  std::vector<double> temperature;                  // K, at the start, law 'enthalpy', of each material
  std::vector<tetsuame::melting::options> melting;  // of each material
  double pond_top, cover_temperature;               // m, K; pond_top is the lid where nothing covers the pond
  std::optional<double> melt_conducted;             // melt fraction at t_end if nothing flowed (theory/stefan.hpp)
  double k_x = 0.0, k_z = 0.0;                      // 1/m
  bool symmetric_stress;                            // viscous: with the transpose of the gradient (terms.hpp)
  double spurious_modulus;                          // largest |mu/p| of the start lattice
  double density_difference;  // kg/m3, at the interface (of a drop: where its velocity is measured)
  // rti: of the liquids as they are, of the run with its slowed sound and inertia, and with K infinite; nothing where
  // the waves do not separate. The mode is the run's.
  std::optional<double> growth, growth_slowed, growth_incompressible;
  std::optional<theory::mode> mode;
  std::optional<double> theory_fall;             // drop: m/s, downward
  std::vector<std::array<double, 3>> places;     // m, centres of the drops
  std::optional<double> fall_alone, fall_array;  // m/s, of several: one of them in this box, a regular array of them
  std::optional<double> hindered;                // Richardson and Zaki's factor
  double oscillation_period = 0.0, bond_number = 0.0;  // drop with surface tension: s, 1
  std::string theory_about;
  std::vector<std::string> lines;
  // Of the box's dimension, with their images across periodic sides.
  std::tuple<std::vector<solids::body<2>>, std::vector<solids::body<3>>> bodies;
  regions::all regions;
  sources::all sources;

  template <int D>
  const std::vector<solids::body<D>>& bodies_in() const {
    return std::get<D - 2>(bodies);
  }
};

void declare(namelist::schema& schema, problem_kind kind, options& o);
// Linear theory of the layers over each other, at rest as the input has them; nothing slowed.
theory::two_layers layers(const options& o, const parameters& p, bool compressible);
// Those of a program's scheme: density is tied by crossings of sound as it is slowed.
volume::options liquid_options(const options& o);

theory::two_layers slowed_layers(const options& o, const parameters& p, const slowing_options& slowed);
parameters resolve(const namelist::schema& schema, problem_kind kind, options& o);
double particles_at_start(const options& o, const parameters& p);
// What --theory prints.
std::string theory_text(problem_kind kind, const options& o, const parameters& p);

}  // namespace tetsuame::two_fluids
