// The input of a plate or half space that cools from its top.
#pragma once

#include <regions/region.hpp>
#include <run/options.hpp>
#include <run/start.hpp>
#include <sources/options.hpp>

namespace tetsuame::conduction {

// The body has a temperature but for a constant.
inline const regions::abilities of_regions{.temperature = true, .above_0 = false};

// Defaults: [S2]'s 2500 particles and diffusivity. With 0.2 m, Euler's limit dx²/(4 kappa) is its 4 s.
struct options {
  domain::options domain{.length = {0.2, 0.2, 0.2}, .particles = {50, 50, 50}, .periodic = {true, false, true}};
  double kappa = 1e-6;  // m2/s
  double start = 1.0;   // K
  std::string reference = "plate";
  std::string scheme = "consistent";
  walls::options walls;
  bool by_program = false;         // a program's kernel, walls and sum
  std::vector<std::string> lines;  // for the log and the terminal
  regions::options of_regions;     // as the input has them
  regions::all regions;
  double heat_capacity = 1000.0;  // J/(kg K), of the sources' heat
  sources::options of_sources;
  sources::all sources;
  run::common_options common;

  double halo() const {  // m, what a particle, or a marker, reaches
    return run::support_over_dx(common.kernel) * domain.dx() * (by_program ? walls::radius_factor(walls) : 1.0);
  }
  double temperature_top() const { return walls.sides[3].temperature; }
};

void declare(namelist::schema& schema, options& o);
void resolve(const namelist::schema& schema, options& o);

}  // namespace tetsuame::conduction
