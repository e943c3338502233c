// Regions of the start as the input gives them: group &region, which may stand several times, one for each piece, with
// the pieces' shapes of &solids; and group &constants, names for numbers in expressions.
//
//   &constants  name = 'R', 'bumps'  value = 2e5, 5 /
//   &region  material = 'lower' /                                            ! everywhere
//   &region  material = 'upper'  temperature = 2500  shape = 'sphere'  radius = 2e5  centre_x = 7.5e5  centre_y = 1e6 /
//   &region  temperature = '1500 + 200*sin(2*pi*x/length_x)'  condition = 'y > 0.5*length_y' /
//
// Pieces of one name are one region: where it is, by the operations of the pieces, and where all of its conditions are
// true. A region gives what is said of it; one behind it, in the order of the input, overrides it.
#pragma once

#include <map>
#include <solids/options.hpp>

namespace tetsuame::regions {

// What a problem takes of regions.
struct abilities {
  std::vector<std::string> materials = {};  // by name; none: there is but one
  bool more_materials = false;              // the input names further ones, known once it is read
  std::string named_by = "&material";       // the group that does
  std::string origin = "";                  // of x, y, z, in words; empty: the box's corner
  bool temperature = false, velocity = false, density = false, pressure = false, energy = false;
  bool above_0 = true;  // temperatures, which count from where they may

  bool has_materials() const { return !materials.empty() || more_materials; }
};

// Of group &constants: names for numbers in expressions.
struct constants {
  std::vector<std::string> names;
  std::vector<double> values;
};

struct options : constants {
  solids::options pieces;
  std::vector<std::string> condition, material, temperature, density, pressure, energy;
  std::array<std::vector<std::string>, 3> velocity;

  std::size_t pieces_given() const;
  bool any() const { return pieces_given() > 0; }
};

// With &constants.
void declare(namelist::schema& schema, const abilities& of_problem, options& o);
void declare(namelist::schema& schema, constants& o);
// By name. variables: names that expressions give another meaning.
std::map<std::string, double> named(const namelist::schema& schema, const constants& o,
                                    const std::vector<std::string>& variables);

}  // namespace tetsuame::regions
