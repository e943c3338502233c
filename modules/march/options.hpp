// Input that every march in time shares: groups &time, &kernel, &output and &run.
#pragma once

#include <cstdint>
#include <namelist/schema.hpp>
#include <optional>
#include <simulation/options.hpp>
#include <string>

namespace tetsuame::march {

struct time_options {
  std::string method = "rk4";
  std::int64_t order = 3;
  std::optional<double> dt;  // s
  bool error_control = true;
  std::int64_t steps = 1'000'000'000;
  std::optional<double> t_end;  // s
  double rtol = 1e-4;
  std::optional<double> cfl, diffusive;  // dt c/dx, dt D/dx^2
};

struct options {
  time_options time;
  simulation::kernel_options kernel{.name = "wendland_c2"};
  simulation::output_options output;
  simulation::run_options run;
};

// What a problem has room for, and so what is declared.
struct abilities {
  bool lists_change = true;               // particles move: a skin is worth choosing
  bool keeps_rate = false;                // it has arrays for the rate of the step before, which 'ab2' needs
  std::vector<std::string> kernels = {};  // those it is compiled for; none: all
};
void declare(namelist::schema& schema, options& o, abilities of_problem);

// Fills h_over_dx, and the fractions of sound's and diffusion's limits that the method stands (below).
void resolve(options& o);
// When the end is known.
void check_output(const namelist::schema& schema, const options& o);

// The method that a checkpoint's input, as resolved, was run with: a fixed step that was chosen for it says nothing
// about another.
std::string method_of(const std::string& input);

// Largest dt c/dx and dt D/dx^2 (D: m2/s, the largest diffusivity) with a margin of a third or so: those of the
// methods' stability on the lattice, where |eigenvalue| <= 2.2 c/dx for sound and 8 D/dx^2 for diffusion in 2-D, 12 in
// 3-D.
struct fractions {
  double cfl, diffusive;
};
fractions stable_fractions(const std::string& method);

}  // namespace tetsuame::march
