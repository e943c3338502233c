// The input of grains: materials, contacts, where grains start, walls and bodies.
#pragma once

#include <dem/materials.hpp>
#include <dem/walls.hpp>
#include <domain/options.hpp>
#include <namelist/lists.hpp>
#include <run/options.hpp>
#include <solids/options.hpp>

namespace tetsuame::granular {

inline constexpr std::size_t most_materials = 16, most_grains = 4096, most_packings = 64;

struct material_lists {
  std::vector<std::string> name;
  std::vector<double> density, young_modulus, poisson_ratio, restitution, friction, rolling_friction, adhesion;
};
struct pair_lists {
  std::vector<std::string> first, second;
  std::vector<double> restitution, friction, rolling_friction, adhesion;
};
// Single grains.
struct grain_lists {
  std::vector<std::string> material;
  std::vector<double> radius;
  std::array<std::vector<double>, 3> place, velocity, spin;

  std::size_t number() const { return namelist::longest(material, radius, place[0], place[1], place[2]); }
};
// Boxes that are filled with grains on a lattice.
struct packing_lists {
  std::vector<std::string> material;
  std::vector<double> radius, radius_max, spacing, jitter, random_velocity;
  std::array<std::vector<double>, 3> low, high, velocity;

  std::size_t number() const {
    return namelist::longest(material, radius, low[0], low[1], low[2], high[0], high[1], high[2]);
  }
};

struct options {
  domain::options domain{.length = {1.0, 1.0, 1.0}, .particles = {1, 1, 1}};
  double g = 9.81, incline = 0.0;  // m/s2; degrees
  std::string contact = "hertz_mindlin", rolling = "none";
  double stiffness = 0.0, tangential_part = 2.0 / 7.0, rolling_damping = 0.3;
  double overlap_limit = 0.05;  // of the smaller radius, at the start
  double rest_speed = 0.0;      // m/s; 0: the run goes on to its end
  double flux_height = 0.0;     // m; 0: nothing is counted
  std::int64_t seed = 0;
  material_lists materials_given;
  pair_lists pairs_given;
  grain_lists grains_given;
  packing_lists packings_given;
  std::array<std::string, 6> boundary{"wall", "wall", "wall", "wall", "wall", "wall"};
  std::string wall_material;
  solids::options solids;
  solids::motion_options motions;
  std::string gate_body;
  std::array<double, 3> gate_velocity{};  // m/s
  double gate_rest = 0.05;                // m/s
  std::optional<double> gate_distance;    // m
  run::common_options common;

  // Resolved.
  dem::contact_table table;
  std::size_t material_of_walls = 0;
  dem::wall_set<2> flat;
  dem::wall_set<3> deep;
  double largest_radius = 0.0;  // m
  double step_limit = 0.0;      // s, of Rayleigh's wave, or a quarter of a contact
  std::string step_limit_is;

  template <int D>
  const dem::wall_set<D>& walls() const {
    if constexpr (D == 2)
      return flat;
    else
      return deep;
  }
};

// A grain of the start.
struct grain {
  std::int64_t id = 0;
  std::int32_t material = 0;
  double radius = 0.0;                     // m
  std::array<double, 3> x{}, v{}, spin{};  // m, m/s, 1/s; in two dimensions the last component of the spin counts
};

// f(grain) of all grains of the start, in the order of their IDs.
void for_each_grain(const options& o, const std::function<void(const grain&)>& f);
std::int64_t number_of_grains(const options& o);

void declare(namelist::schema& schema, options& o);
void resolve(const namelist::schema& schema, options& o);

}  // namespace tetsuame::granular
