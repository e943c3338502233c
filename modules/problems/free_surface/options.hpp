// The input of water with a free surface:
//   &domain   dimension, length_*, particles_*, periodic_*, ranks_x, jitter
//   &flow     blocks of water, how they start, the liquid, gravity, shifting
//   &gauges   what is measured on the way, and the files that it is held against
//   &walls    slip and no slip; an open top
//   &inflow, &outflow   sections of the sides through which water enters and leaves (opening.hpp)
//   &solids   bodies of any shape; &motions: how they move (solids/options.hpp)
//   &region, &constants   where blocks have no water, and what the start is somewhere (regions/options.hpp)
//   &sources  forces from outside, as those in a tank that is shaken (sources/options.hpp)
//   &time, &kernel, &output, &run   run/options.hpp
#pragma once

#include <algorithm>
#include <array>
#include <domain/options.hpp>
#include <free_surface/liquid.hpp>
#include <free_surface/opening.hpp>
#include <gauges/series.hpp>
#include <kernels/kernel.hpp>
#include <optional>
#include <regions/region.hpp>
#include <rigid/motion.hpp>
#include <run/options.hpp>
#include <solids/options.hpp>
#include <sources/options.hpp>
#include <string>
#include <tuple>
#include <vector>
#include <walls/options.hpp>

namespace tetsuame::free_surface {

// Those that an input may name. Sums over water are compiled for no other.
template <int D>
using kernels_of_water =
    std::variant<kernels::quintic_spline<D>, kernels::wendland_c2<D>, kernels::wendland_c4<D>, kernels::wendland_c6<D>>;

using point = std::array<double, 3>;  // m; z is 0 in two dimensions

using rigid::images_of_body, rigid::motion_of_body;

// Whose sums over neighbours (docs/theory/water_schemes.md).
enum class scheme { delta, riemann };

struct flow_options {
  std::string scheme = "delta";
  std::string start = "rest";
  std::array<std::vector<double>, 3> low, high;  // m, of blocks of water; none: the box's edges
  double gravity = 9.81;                         // m/s2, towards -y
  double density = 1000.0;                       // kg/m3, at zero pressure
  std::int64_t exponent = 7;
  double sound_factor = 10.0;                            // of sqrt(g H)
  std::optional<double> sound_speed = {};                // m/s
  double viscosity = 0.0;                                // Pa s
  double alpha = 0.02, delta = 0.1;                      // of artificial viscosity, of the density's diffusion
  std::optional<double> shifting = {};                   // 0: none
  double surface_tension = 0.0;                          // N/m, of the free surface
  double wavelength = 0.0, amplitude = 0.0;              // m, of a standing wave
  double strain_rate = 0.0;                              // 1/s, of a drop
  bool around_bodies = false;                            // blocks of water leave out what bodies cover
  double beach_rate = 0.0;                               // 1/s; 0: no beach
  std::optional<double> beach_from = {}, beach_to = {};  // m, along x

  // 1/s, γ: by how much a beach that waves run out on slows the water at x (m). It rises as the square of the way in.
  double on_beach(double x) const {
    if (!(beach_rate > 0.0)) return 0.0;
    const double in = std::clamp((x - *beach_from) / (*beach_to - *beach_from), 0.0, 1.0);
    return beach_rate * in * in;
  }
};

struct gauge_options {
  double interval = 0.0;  // s; 0: every step
  bool front = false;
  std::array<std::vector<double>, 3> height, pressure;                           // m, places; heights have no y
  std::vector<double> discharge;                                                 // m, along x
  std::string file = "";                                                         // of measured curves; empty: none
  std::string front_column = "";                                                 // there; empty: none
  std::vector<std::string> height_columns, pressure_columns, discharge_columns;  // one a gauge; empty: none
  double time_unit = 1.0, length_unit = 1.0, stress_unit = 1.0;                  // s, m, Pa: what is 1 in the file
  double arrival = 0.0;                                                          // Pa
  std::vector<std::string> force, motion;                                        // names of bodies
  std::array<std::vector<double>, 3> moment;                                     // m, one a force; empty: about centres
  std::vector<std::string> force_columns;                       // of the file, one for each of the forces' columns
  double force_unit = 1.0, moment_unit = 1.0;                   // N, N m
  std::optional<double> impulse_from = {}, impulse_until = {};  // s
};

struct options {
  domain::options domain{.dimension = 2, .length = {1.0, 1.0, 1.0}, .particles = {50, 50, 50}};
  flow_options flow;
  gauge_options gauges;
  opening_options inflow, outflow;
  walls::options walls;
  solids::options solids;
  solids::motion_options motions;
  regions::options of_regions;
  sources::options of_sources;
  run::common_options common;

  bool open_top() const { return walls.sides[3].slip == "free_surface"; }
};

// m
struct block {
  point low{}, high{};
  bool holds(const point& x) const;
};

using gauges::series;

// Of the file, in SI units; empty where there is none.
struct references {
  series front;
  std::vector<series> height, pressure, discharge;  // one a gauge
  std::vector<series> force;                        // one a column of gauges.csv
};

// Whose force is read, and about which point its moment.
struct force_gauge {
  std::size_t body;
  std::optional<point> about;  // m; none: about the body's centre, where it is then
  point centre;                // m, of the body at rest
};

// What follows from the input.
struct parameters {
  std::vector<block> blocks;
  double height = 0.0;  // m, from the lowest to the highest water
  liquid water;
  double smoothing_length = 0.0;  // m
  scheme by = scheme::delta;
  double kinematic_viscosity = 0.0;  // m2/s, physical and artificial
  double density_diffusivity = 0.0;  // m2/s
  double shifting = 0.0;
  references measured;
  // Of the box's dimension.
  std::tuple<std::vector<solids::body<2>>, std::vector<solids::body<3>>> bodies;
  std::tuple<std::vector<motion_of_body<2>>, std::vector<motion_of_body<3>>> motions;  // one a body
  std::vector<force_gauge> force;
  std::vector<std::size_t> motion;  // bodies whose motion is read
  regions::all regions;
  sources::all sources;
  std::vector<opening> openings;  // inflows, then outflows

  template <int D>
  const std::vector<solids::body<D>>& bodies_in() const {
    return std::get<D - 2>(bodies);
  }
  template <int D>
  const std::vector<motion_of_body<D>>& motions_in() const {
    return std::get<D - 2>(motions);
  }
};

template <int D>
rigid::box<D> box_of(const options& o);
void declare(namelist::schema& schema, options& o);
parameters resolve(const namelist::schema& schema, options& o);

}  // namespace tetsuame::free_surface
