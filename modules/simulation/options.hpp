// The input of the hydrostatic programs: what each group holds, and the checks that
// take more than one key.
#pragma once

#include <array>
#include <balance/balancer.hpp>
#include <cstdint>
#include <eos/eos.hpp>
#include <namelist/schema.hpp>
#include <optional>
#include <string>
#include <volume/hosono_options.hpp>
#include <volume/shape.hpp>
#include <walls/options.hpp>

namespace tetsuame::simulation {

struct domain_options {
  std::int64_t dimension = 2;
  std::array<double, 3> length{1e5, 1e5, 1e5};  // m
  std::array<std::int64_t, 3> particles{20, 20, 20};
  std::array<bool, 3> periodic{true, false, true};
  domain::rank_columns ranks_x;
  std::string balance = "measured";  // what cuts between ranks follow: measured or counted cost, or off
};

struct initial_options {
  double temperature = 2500.0;          // K
  double pressure = 1e10;               // Pa; with gravity: at the top
  std::string profile = "hydrostatic";  // uniform where there is no gravity
};

struct time_options {
  std::string method = "euler";
  std::int64_t order = 3;
  double dt = 1e-3;  // s
  std::int64_t steps = 1000;
  std::optional<double> t_end;  // s; not given: of so many steps dt
  double rtol = 1e-4;
  double atol_position = 1e-6;                                                // of the particle spacing
  double atol_velocity = 1e-6, atol_temperature = 1e-6, atol_density = 1e-9;  // m/s, K, kg/m3
  double atol_weight = 1e-9, atol_energy = 1e-3;                              // J, J/kg
  double cfl = 0.5, viscous = 0.25, thermal = 0.25;  // fractions of Δx/c, ρ Δx²/η, ρ c_V Δx²/k

  double end() const { return t_end ? *t_end : static_cast<double>(steps) * dt; }  // s
  // `steps` has done its work by setting the end where steps are not all dt long.
  std::int64_t last_step(double output_interval) const;
};

struct kernel_options {
  std::string name = "quintic";
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

struct material_options {
  eos::material_options eos;
  double viscosity = 1.0;     // Pa s
  double conductivity = 0.0;  // W/(m K)
};

struct options {
  domain_options domain;
  initial_options initial;
  double g = 0.0;  // m/s2, along -y
  material_options material;
  time_options time;
  kernel_options kernel;
  walls::options walls;
  volume::smoothing_options smoothing;
  volume::hosono_options hosono;
  balance::balancer_options balancer;
  std::int64_t balance_interval = 20;  // steps
  output_options output;
  run_options run;

  double dx() const { return domain.length[0] / static_cast<double>(domain.particles[0]); }
  double support() const;     // m, of the kernel
  double halo_width() const;  // m, what a particle, or a marker, reaches
};

// The groups that every program with a time loop has. lists_change: whether particles move, so that a skin is worth
// choosing. names: of the kernels there are; none: all.
void declare(namelist::schema& schema, kernel_options& o, bool lists_change, std::vector<std::string> names = {});
void resolve(kernel_options& o);
double support_over_dx(const kernel_options& o);  // of a resolved one
void declare(namelist::schema& schema, output_options& o);
void declare(namelist::schema& schema, run_options& o);
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

// Declares every group; all programs read the same inputs, so that one file runs on all of them.
void declare(namelist::schema& schema, options& o);

double expected_particles(const options& o);  // fluid

// Fills what the input left to us (h_over_dx, t_end, EOS parameters) and checks what takes more
// than one key: throws bad_input with file and line.
void resolve(const namelist::schema& schema, options& o);

}  // namespace tetsuame::simulation
