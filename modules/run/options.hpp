// What the input of every program with a time loop holds: groups &time, &kernel, &output, &run, &balancer and &gauges.
#pragma once

#include <balance/balancer.hpp>
#include <cstdint>
#include <gauges/options.hpp>
#include <namelist/schema.hpp>
#include <optional>
#include <output/snapshot.hpp>
#include <string>
#include <vector>

namespace tetsuame::run {

struct time_options {
  std::string method = "rk4";
  std::int64_t order = 3;
  std::optional<double> dt;  // s
  bool error_control = true;
  std::int64_t steps = 1'000'000'000;
  std::optional<double> t_end;  // s; not given: of so many steps dt
  double rtol = 1e-4;
  std::optional<double> cfl, diffusive;  // dt c/dx, dt D/dx^2
  std::int64_t substeps = 1;             // of 'kdk': dt is that of so many, at whose ends slow forces act

  // s; of steps and dt where t_end is not given.
  double end() const { return t_end ? *t_end : static_cast<double>(steps) * *dt; }
  bool has_end() const { return t_end || (dt && steps < time_options{}.steps); }
  // Whether they are all dt long, as far as the input knows, so that it takes so many.
  bool counts_steps(double output_interval) const;
  // Whether steps follow from an error estimate, so that a state may be refused.
  bool controls_error() const;
  bool varies_steps() const;  // by their error, or to what is stable
};

struct kernel_options {
  std::string name = "wendland_c2";
  double h_over_dx = 0.0;  // 0: the kernel's own
  double skin = 0.2;       // of the particle spacing, at least
  std::string precision = "double";

  bool single_pairs() const { return precision == "single"; }
};

struct output_options {
  double interval = 0.0;               // s
  std::int64_t history_interval = 10;  // steps
  std::vector<std::string> fields;     // of snapshots; none: all
  std::string precision = "double";
  bool compress = false;

  output::snapshot_form form() const { return {fields, precision == "single", compress}; }
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

// A snapshot that takes the place of the start lattice.
struct start_options {
  std::string file;      // empty: none
  std::string place;     // where that was said, for the message
  bool is_over = false;  // a checkpoint has taken its place
  double settle = 0.0;   // crossings of the box by sound, of a damped motion before the run

  bool settles() const { return settle > 0.0; }
  bool is_read() const { return !file.empty() && !is_over; }
};

struct common_options {
  start_options start;
  time_options time;
  kernel_options kernel;
  output_options output;
  run_options run;
  balance_options balance;
  gauges::options gauges;
};

// What a problem has room for, and so what is declared.
struct abilities {
  bool particles = true;                  // a kernel and cuts between ranks are worth choosing
  bool single_pairs = false;              // its sums can be computed in single precision
  bool lists_change = true;               // particles move: a skin is worth choosing
  std::vector<std::string> keeping = {};  // of 'ab2', 'kdk': those for which it keeps the rates of the step before
  std::vector<std::string> methods = {};  // of time integration, the only ones it can; none: all, and `keeping`
  bool has_kernel = true;                 // its particles interact by one
  std::vector<std::string> kernels = {};  // those it is compiled for; none: all
  bool diffuses = true;                   // it knows a bound of diffusion's rates, which 'rkl2' and 'rkc2' need
  bool limits_diffusion = true;           // viscosity or conduction limits its steps
  std::string cfl_is = "largest dt c/dx; not given: by the method";
  bool starts_from_file = false;          // a snapshot says enough of its particles
  bool settles = false;                   // a start at rest may come nearer to balance before the run
  std::string reads = "places, velocities, temperatures, densities and masses";  // of that snapshot
};
// With particles &domain must be there.
void declare(namelist::schema& schema, common_options& o, const abilities& of_problem);

// Fills h_over_dx, with which the kernel must reach the nearest neighbours, and the fractions of sound's and
// diffusion's limits that the method stands.
void resolve(const namelist::schema& schema, common_options& o);
// When the end is known: a run writes at most a million snapshots. `fields`: what this run's have beside those that
// every program's have (output::common_fields).
void check_output(const namelist::schema& schema, common_options& o, const std::vector<std::string>& fields);
// And what points of the box are to read of these fields. Of a box that is resolved.
void check_output(const namelist::schema& schema, common_options& o, const domain::options& box,
                  const std::vector<std::string>& fields);
void check_fields(const namelist::schema& schema, output_options& o, const std::vector<std::string>& fields);
void check_interval(const namelist::schema& schema, const output_options& o, double t_end);

double support_over_dx(const kernel_options& o);  // of a resolved one

}  // namespace tetsuame::run
