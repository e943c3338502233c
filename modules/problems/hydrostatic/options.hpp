// The input of a box at rest: &domain, &initial, &gravity, &region, &sources, &constants, &material, &walls,
// &smoothing, &hosono, and the groups that all programs have (run/options.hpp).
#pragma once

#include <eos/eos.hpp>
#include <regions/region.hpp>
#include <run/options.hpp>
#include <sources/options.hpp>
#include <volume/options.hpp>
#include <walls/options.hpp>

namespace tetsuame::hydrostatic {

inline const regions::abilities of_regions{.temperature = true, .velocity = true};

struct initial_options {
  double temperature = 2500.0;          // K
  double pressure = 1e10;               // Pa; with gravity: at the top
  std::string profile = "hydrostatic";  // uniform where there is no gravity
};

struct material_options {
  eos::material_options eos;
  double viscosity = 1.0;     // Pa s
  double conductivity = 0.0;  // W/(m K)
};

// Of the notes: Euler's method, the quintic spline. cfl 0.5 and diffusive 0.25 are theirs too [S0 (9)-(11)].
struct options : run::common_options {
  domain::options domain{.length = {1e5, 1e5, 1e5}, .particles = {20, 20, 20}, .periodic = {true, false, true}};
  initial_options initial;
  double g = 0.0;  // m/s2, along -y
  material_options material;
  walls::options walls;
  volume::options scheme;
  regions::options of_regions;  // as the input has them
  regions::all regions;
  sources::options of_sources;  // as the input has them
  sources::all sources;

  options() {
    time = {.method = "euler", .dt = 1e-3, .steps = 1000, .t_end = {}, .cfl = 0.5, .diffusive = 0.25};
    kernel.name = "quintic";
    walls.treatment = "virtual_marker";
  }
  double support() const;  // m, of the kernel
  double halo() const;     // m, what a particle, or a marker, reaches
};

// Declares every group; all six programs read the same inputs, so that one file runs on all of them.
void declare(namelist::schema& schema, options& o);

// Fills what the input left to us (h_over_dx, t_end, EOS parameters) and checks what takes more
// than one key: throws bad_input with file and line.
void resolve(const namelist::schema& schema, options& o);

}  // namespace tetsuame::hydrostatic
