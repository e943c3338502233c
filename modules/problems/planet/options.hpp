// The input of a planet under its own gravity:
//   &planet   mass, radius or fractions, surface, temperature, spin, particles, scheme
//   &layer    a material, from the centre outwards; stands once for each
//   &melting, &element   latent heat and viscosity of layers that are not metal; what these exchange with metal
//   &region   materials, temperatures, velocities of the start somewhere
//   &impact   two settled bodies that meet, in place of a planet
//   &time, &kernel, &output, &run   run/options.hpp
#pragma once

#include <gas/setups.hpp>
#include <nlohmann/json.hpp>
#include <planet/impact.hpp>
#include <planet/mode.hpp>
#include <planet/profile.hpp>

namespace tetsuame::planet {

struct layer_options {  // lists, an element a layer
  std::vector<std::string> name, eos, curve, tillotson, table, metal;
  std::vector<double> fraction, viscosity;
  std::array<std::vector<double>, eos::parameters.size()> parameters;
};

struct options {
  std::int64_t particles = 10000, dimension = 3;
  std::string scheme = "disph";
  std::optional<double> mass;                                  // kg, of a cylinder kg/m
  std::optional<double> radius;                                // m
  double surface_pressure = 1e5, surface_temperature = 300.0;  // Pa, K
  std::string temperature_law = "adiabatic";
  double temperature_exponent = 0.0;
  std::optional<double> spin_period;      // s
  double expansion = 0.0;                 // 1/s
  double viscosity = 0.0;                 // Pa s
  std::int64_t degree = 0;                // of the mode at the start; 0: none
  std::optional<double> amplitude;        // m
  double opening = 0.0, tolerance = 0.0;  // of the tree
  layer_options layer;
  impact_options impact;

  std::vector<std::string> names;  // of the layers, once resolved
  std::vector<eos::material_options> materials;
  std::optional<profile> structure;  // none: an impact
  regions::options of_regions;       // as the input has them
  regions::all regions;
  std::vector<double> viscosities;  // Pa s, of the layers
  std::vector<bool> metals;         // which layers are metal
  std::optional<growing_mode> mode;
  struct bodies {
    body target, impactor;
    encounter start;
  };
  std::optional<bodies> impact_of;
  gas::options gas;  // what the engine takes

  std::int64_t number_of_particles() const {
    return impact_of
               ? static_cast<std::int64_t>(impact_of->target.particles.size() + impact_of->impactor.particles.size())
               : particles;
  }
  // The number of the material of a layer, from 0 in the centre: 0 of the outermost.
  std::int32_t material_of(std::size_t which) const { return static_cast<std::int32_t>(materials.size() - 1 - which); }
  std::size_t layer_of(std::int32_t material) const {
    return materials.size() - 1 - static_cast<std::size_t>(material);
  }
};

inline constexpr const char* layer_group = "layer";
// melting_and_element.cpp: which layers are metal, what melts, what is dissolved; once there is a structure, whether
// the curves reach its pressures; columns of the history and measures of both
void resolve_melting(const namelist::schema& schema, options& o);
void expect_melting_range(const namelist::schema& schema, const options& o);
void follow_melt_and_element(const options& o, gas::setup& t);
// impact_options.cpp
void declare_impact(namelist::schema& schema, impact_options& i);
void resolve_impact(const namelist::schema& schema, options& o);
// mode_options.cpp
void declare_mode(namelist::schema& schema, options& o);
void resolve_mode(const namelist::schema& schema, options& o);
// 1/s, of degree 1 to 8 of a cylinder with friction; null where its boundary layers are too thin for the theory. Empty
// of others.
nlohmann::ordered_json growth_rates(const options& o);

// regions.cpp: once the box is known. Particles keep their volume and pressure, and get the density that follows.
void declare_regions(namelist::schema& schema, options& o);
void resolve_regions(const namelist::schema& schema, options& o);
class changed_by_regions {
 public:
  explicit changed_by_regions(const options& o);
  void apply(const gas::point& from_centre, gas::placed& p);
  void expect_used() const;  // fails where a region holds no particle

 private:
  const options& o_;
  std::vector<eos::any> materials_;  // of the layers
  std::vector<std::int64_t> counts_;
};

void declare(namelist::schema& schema, options& o);
void resolve(const namelist::schema& schema, options& o);
// Particles, their states, and what is measured of them.
gas::setup start_of(const options& o);
gas::setup impact_start(const options& o);
// Lines for the log: radius, centre, core; the mode.
std::string summary(const options& o);
// Of the profile, for --profile: JSON, SI units, with arrays of r, density, pressure, temperature and mass_inside from
// the centre to the surface; of a cylinder with an inverted contact the growth rates by degree.
std::string describe(const options& o);

}  // namespace tetsuame::planet
