// What the input of every program with a time loop holds: groups &time, &kernel, &output, &run and &balancer, and the
// checks that all boxes of particles have in common.
#pragma once

#include <array>
#include <balance/balancer.hpp>
#include <cstdint>
#include <domain/decomposition.hpp>
#include <namelist/schema.hpp>
#include <optional>
#include <string>
#include <vector>

namespace tetsuame::run {

struct box_options {
  std::array<double, 3> length{};  // m
  std::array<std::int64_t, 3> particles{};
  std::array<bool, 3> periodic{};
  domain::rank_columns ranks_x;
};

struct time_options {
  std::string method = "rk4";
  std::int64_t order = 3;
  std::optional<double> dt;  // s
  bool error_control = true;
  std::int64_t steps = 1'000'000'000;
  std::optional<double> t_end;  // s; not given: of so many steps dt
  double rtol = 1e-4;
  std::optional<double> cfl, diffusive;  // dt c/dx, dt D/dx^2

  double end() const { return t_end ? *t_end : static_cast<double>(steps) * *dt; }  // s
  // Whether they are all dt long, as far as the input knows, so that it takes so many.
  bool counts_steps(double output_interval) const;
  // Whether steps follow from an error estimate, so that a state may be refused.
  bool controls_error() const;
};

struct kernel_options {
  std::string name = "wendland_c2";
  double h_over_dx = 0.0;  // 0: the kernel's own
  double skin = 0.2;       // of the particle spacing
};

struct output_options {
  double interval = 0.0;               // s
  std::int64_t history_interval = 10;  // steps
};

struct run_options {
  double wall_clock_limit = 0.0;         // s
  std::int64_t checkpoint_interval = 0;  // steps
  double checkpoint_seconds = 600.0;     // s
};

// What the cuts between ranks follow: measured or counted cost, or nothing.
struct balance_options {
  std::string follows = "measured";
  std::int64_t interval = 20;  // steps
  balance::balancer_options how;
};

struct common_options {
  time_options time;
  kernel_options kernel;
  output_options output;
  run_options run;
  balance_options balance;
};

// What a problem has room for, and so what is declared.
struct abilities {
  bool lists_change = true;               // particles move: a skin is worth choosing
  bool keeps_rate = false;                // it has arrays for the rate of the step before, which 'ab2' needs
  std::vector<std::string> kernels = {};  // those it is compiled for; none: all
  bool diffuses = true;                   // it knows a bound of diffusion's rates, which 'rkl2' and 'rkc2' need
  bool ends_by_steps = false;             // t_end may follow from steps and dt
};
// &domain must be there.
void declare(namelist::schema& schema, common_options& o, const abilities& of_problem);

// Fills h_over_dx, and the fractions of sound's and diffusion's limits that the method stands (below).
void resolve(const namelist::schema& schema, common_options& o);
// When the end is known.
void check_output(const namelist::schema& schema, const common_options& o);

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

void declare(namelist::schema& schema, kernel_options& o, bool lists_change, std::vector<std::string> names = {});
// Fills h_over_dx; the kernel must reach the nearest neighbours.
void resolve(const namelist::schema& schema, kernel_options& o);
double support_over_dx(const kernel_options& o);  // of a resolved one
void declare(namelist::schema& schema, output_options& o);
void declare(namelist::schema& schema, run_options& o);
// In group &domain, which must be there, and &balancer.
void declare(namelist::schema& schema, balance_options& o);
// In group &domain, which must be there; resolve() notes where the number came from.
void declare(namelist::schema& schema, domain::rank_columns& o);
void resolve(const namelist::schema& schema, domain::rank_columns& o);

// What every program's input must hold, each placed at its key: fail with exit 2.
struct box_of_particles {
  std::int64_t dimension;
  const std::array<double, 3>& length;  // m
  const std::array<std::int64_t, 3>& particles;
  const std::array<bool, 3>& periodic;
};
double lattice_particles(std::int64_t dimension, const std::array<std::int64_t, 3>& particles);
// No more than 1e12 particles: beyond that an ID times a number of images, or a file's offset, would overflow.
void check_number(const namelist::schema& schema, const box_of_particles& box, double expected);
// A periodic box is as wide as the halo, so that no particle meets two images of another; between walls there is room
// for the kernel's support, where what stands behind them is made of the fluid's particles. halo, support: m.
void check_widths(const namelist::schema& schema, const box_of_particles& box, double halo, double support);
// A run writes at most a million snapshots.
void check_interval(const namelist::schema& schema, const output_options& o, double t_end);

}  // namespace tetsuame::run
