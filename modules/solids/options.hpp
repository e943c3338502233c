// Solids and their motion as the input gives them. Group &solids holds a list for each property, with an element for
// each piece; pieces of one name are one body, in their order. Group &motions holds lists with an element for each body
// that moves.
//
//   &solids
//     body(1) = 'tank'      shape(1) = 'box'     solid(1) = 'outside'
//     centre_x(1) = 0.5     centre_y(1) = 0.5    length_x(1) = 0.8  length_y(1) = 0.6  angle_z(1) = 10
//     body(2) = 'pillar'    shape(2) = 'sphere'  centre_x(2) = 0.5  centre_y(2) = 0.4  radius(2) = 0.05
//   /
#pragma once

#include <namelist/schema.hpp>
#include <solids/restraint.hpp>
#include <solids/wall_particles.hpp>

namespace tetsuame::solids {

inline constexpr std::size_t most_pieces = 64, most_motions = 16;
inline constexpr std::array<const char*, 7> shapes{"plane", "box", "sphere", "cylinder", "cone", "bowl", "file"};

// What a group of pieces is called, and its keys for what a piece belongs to and for the side of its surface.
struct words {
  const char *group, *whole, *side;
};
inline constexpr words of_solids{"solids", "body", "solid"};

struct options {
  std::vector<std::string> body, shape, operation, solid, file;
  std::array<std::vector<double>, 3> centre, length, angle;
  std::vector<double> radius, height, thickness, scale;
};

struct motion_options {
  std::vector<std::string> body, kind, file;
  std::vector<double> period, phase, amplitude_angle;
  std::array<std::vector<double>, 3> amplitude, pivot, axis;
  std::vector<double> density, mass;  // of free bodies
  std::array<std::vector<double>, 3> gyration;
  restraint_options restraint;
};

// A body that moves freely: of its density it has its mass and inertia, unless these are given.
struct free_options {
  double density = 0.0, mass = 0.0;  // kg/m3, kg (kg/m in two dimensions); one of them is given
  std::array<double, 3> gyration{};  // m, about principal axes; 0: as of one density
  std::optional<point<3>> hinge;     // m, that it turns about; none: its centre of mass
  restraint<2> in_plane;             // of two dimensions
  restraint<3> in_space;             // of three
};

// The keys of pieces, `shapes` among them, in a group that is declared.
void declare_pieces(namelist::schema& schema, const words& of, const std::vector<std::string>& shapes, options& o);
// Declares group &solids.
void declare(namelist::schema& schema, options& o);
// And group &motions.
void declare(namelist::schema& schema, options& o, motion_options& m);

// What cannot be is an error of status bad_input, at its key and with the number of
// the piece. One body for each name, in the order in which names appear.
template <int D>
std::vector<body<D>> make_bodies(const namelist::schema& schema, const options& o, const words& of = of_solids);
// expect_in_box and expect_thick (wall_particles.hpp), placed at &solids.
template <int D>
void expect_sound(const namelist::schema& schema, const std::vector<body<D>>& bodies, const lattice<D>& box,
                  double reach);
// Of each body; those that no motion names are at rest, as those that move freely.
template <int D>
std::vector<prescribed<D>> make_motions(const namelist::schema& schema, const motion_options& o,
                                        const std::vector<body<D>>& bodies);
// Of each body; none of those that do not move freely.
std::vector<std::optional<free_options>> make_free(const namelist::schema& schema, const motion_options& o,
                                                   int dimension, const std::vector<std::string>& names);

}  // namespace tetsuame::solids
