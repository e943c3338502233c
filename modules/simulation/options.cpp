#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <kernels/kernel.hpp>
#include <simulation/options.hpp>
#include <walls/wall_set.hpp>

namespace tetsuame::simulation {

namespace {

constexpr std::array<const char*, 3> axis_names{"x", "y", "z"};

void declare(namelist::schema& schema, domain_options& o) {
  schema.group("domain", "the box and the start lattice");
  schema.add("domain", "dimension", o.dimension, {.minimum = 2, .maximum = 3, .meaning = "of space; y is up"});
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string axis = axis_names[a];
    const std::string only = a == 2 ? " (3-D only)" : "";
    schema.add(
        "domain", "length_" + axis, o.length[a],
        {.unit = "m", .minimum = 0.0, .exclusive_minimum = true, .meaning = "edge of the box along " + axis + only});
    schema.add("domain", "particles_" + axis, o.particles[a],
               {.minimum = 1, .maximum = 1e9, .meaning = "fluid particles along " + axis + only});
    schema.add("domain", "periodic_" + axis, o.periodic[a],
               {.meaning = "the two sides across " + axis + " are one, or else walls" + only});
  }
  simulation::declare(schema, o.ranks_x);
  schema.add("domain", "balance", o.balance,
             {.choices = {"measured", "counted", "off"},
              .meaning = "what the cuts between ranks follow: seconds of computing, pairs of neighbours (the same in "
                         "every run), or nothing"});
}

void declare(namelist::schema& schema, initial_options& o) {
  schema.group("initial", "start state");
  schema.add("initial", "temperature", o.temperature,
             {.unit = "K", .minimum = 0.0, .exclusive_minimum = true, .meaning = "everywhere"});
  schema.add("initial", "pressure", o.pressure,
             {.unit = "Pa",
              .minimum = 0.0,
              .exclusive_minimum = true,
              .meaning = "everywhere, or at the top where the profile is hydrostatic"});
  schema.add(
      "initial", "profile", o.profile,
      {.choices = {"hydrostatic", "uniform"},
       .meaning = "of pressure and density; hydrostatic: exact for the equation of state, uniform without gravity"});
}

void declare(namelist::schema& schema, material_options& o) {
  schema.group("material", "equation of state and transport");
  std::vector<std::string> choices;
  for (const auto name : eos::names()) choices.emplace_back(name);
  schema.add("material", "eos", o.eos.name,
             {.choices = choices, .meaning = "equation of state; its parameters default to the material's own"});
  schema.add("material", "curve", o.eos.curve, {.meaning = "of liquid_silicate: vinet or birch_murnaghan"});
  schema.add("material", "tillotson", o.eos.tillotson, {.meaning = "of tillotson: iron, granite or basalt"});
  for (const auto& p : eos::parameters) {
    const bool positive = p.allowed == eos::parameter::range::positive;
    namelist::key_info info{.unit = std::string(p.unit), .meaning = std::string(p.meaning)};
    if (positive || p.allowed == eos::parameter::range::not_negative) info.minimum = 0.0;
    if (p.allowed == eos::parameter::range::above_one) info.minimum = 1.0;
    info.exclusive_minimum = positive || p.allowed == eos::parameter::range::above_one;
    if (p.key == "reference_pressure") info.meaning += "; of linear: the initial pressure unless given";
    schema.add("material", std::string(p.key), o.eos.*p.member, info);
  }
  schema.add("material", "viscosity", o.viscosity, {.unit = "Pa s", .minimum = 0.0, .meaning = "dynamic viscosity"});
  schema.add("material", "conductivity", o.conductivity,
             {.unit = "W/(m K)", .minimum = 0.0, .meaning = "thermal conductivity"});
}

void declare(namelist::schema& schema, time_options& o) {
  schema.group("time", "time integration (ARKODE)");
  schema.add("time", "method", o.method,
             {.choices = {"euler", "order_2", "order_3", "order_4", "order_5", "ssp_rk3", "rk4", "adaptive"},
              .meaning = "explicit Runge-Kutta with a fixed step, or with error control"});
  schema.add("time", "order", o.order, {.minimum = 2, .maximum = 5, .meaning = "of the adaptive method"});
  schema.add("time", "dt", o.dt,
             {.unit = "s", .minimum = 0.0, .exclusive_minimum = true, .meaning = "time step; adaptive: the first one"});
  schema.add("time", "steps", o.steps,
             {.minimum = 0,
              .maximum = 1e15,
              .meaning = "number of steps at most; adaptive without t_end: runs to steps * dt"});
  schema.add("time", "t_end", o.t_end,
             {.unit = "s", .minimum = 0.0, .stays_open = true, .meaning = "time at the end; not given: steps * dt"});
  schema.add("time", "rtol", o.rtol,
             {.minimum = 1e-14,
              .maximum = 1e-1,
              .meaning = "adaptive: relative error of a step; of positions per particle spacing"});
  const auto positive = [](std::string unit, std::string meaning) {
    return namelist::key_info{
        .unit = std::move(unit), .minimum = 0.0, .exclusive_minimum = true, .meaning = std::move(meaning)};
  };
  schema.add("time", "atol_position", o.atol_position,
             positive("dx", "adaptive: absolute error of positions, in particle spacings"));
  schema.add("time", "atol_velocity", o.atol_velocity, positive("m/s", "adaptive: absolute error of velocities"));
  schema.add("time", "atol_temperature", o.atol_temperature, positive("K", "adaptive: absolute error of temperatures"));
  schema.add("time", "atol_density", o.atol_density, positive("kg/m^3", "adaptive: absolute error of densities"));
  schema.add("time", "atol_weight", o.atol_weight,
             positive("J", "adaptive: absolute error of weights, where Y is integrated"));
  schema.add("time", "atol_energy", o.atol_energy,
             positive("J/kg", "adaptive: absolute error of the internal energy gained"));
  schema.add("time", "cfl", o.cfl, positive("", "largest dt c/dx"));
  schema.add("time", "viscous", o.viscous, positive("", "largest dt eta/(rho dx^2)"));
  schema.add("time", "thermal", o.thermal, positive("", "largest dt k/(rho c_V dx^2)"));
}

void check_box(const namelist::schema& schema, const options& o) {
  const auto& d = o.domain;
  const box_of_particles box{d.dimension, d.length, d.particles, d.periodic};
  check_number(schema, box, expected_particles(o));
  const double dx = o.dx();
  for (std::size_t a = 1; a < static_cast<std::size_t>(d.dimension); ++a) {
    const double spacing = d.length[a] / static_cast<double>(d.particles[a]);
    if (std::abs(spacing - dx) > 1e-9 * dx)
      schema.fail("domain", std::string("particles_") + axis_names[a],
                  "the particle spacing must be the same along x and " + std::string(axis_names[a]) + ": " +
                      std::to_string(dx) + " m and " + std::to_string(spacing) + " m; change particles_" +
                      axis_names[a] + " or length_" + axis_names[a]);
  }
  for (std::size_t a = 0; a < static_cast<std::size_t>(d.dimension); ++a)
    if (d.periodic[a] && 2.0 * o.support() > d.length[a])
      schema.fail("domain", std::string("particles_") + axis_names[a],
                  "the kernel's support, " + std::to_string(2.0 * o.support()) +
                      " m across, is wider than the periodic box, " + std::to_string(d.length[a]) + " m along " +
                      axis_names[a] + ": use more particles or a smaller h_over_dx");
  const bool filled = o.walls.treatment == "virtual_marker" || o.walls.treatment == "frozen";
  check_widths(schema, box, o.halo_width(), filled ? o.support() : 0.0);
}

}  // namespace

void declare(namelist::schema& schema, kernel_options& o, bool lists_change, std::vector<std::string> names) {
  schema.group("kernel", "smoothing kernel and neighbour lists");
  if (names.empty())
    for (const auto& k : kernels::table) names.emplace_back(k.name);
  schema.add("kernel", "name", o.name, {.choices = names, .meaning = "of the kernel"});
  schema.add(
      "kernel", "h_over_dx", o.h_over_dx,
      {.minimum = 0.0, .maximum = 10.0, .meaning = "smoothing length in particle spacings; 0: the kernel's own"});
  if (lists_change)
    schema.add("kernel", "skin", o.skin,
               {.minimum = 0.0,
                .maximum = 2.0,
                .exclusive_minimum = true,
                .meaning = "neighbour lists reach further than the kernel by so many particle spacings"});
}

void resolve(kernel_options& o) {
  if (o.h_over_dx == 0.0) o.h_over_dx = kernels::find(o.name).default_h_over_dx;
}

double support_over_dx(const kernel_options& o) { return kernels::find(o.name).support_over_h * o.h_over_dx; }

double options::support() const { return support_over_dx(kernel) * dx(); }

double options::halo_width() const {
  return support() * std::max(1.0, walls::radius_factor(walls)) + kernel.skin * dx();
}

double lattice_particles(std::int64_t dimension, const std::array<std::int64_t, 3>& particles) {
  double n = 1.0;
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimension); ++a) n *= static_cast<double>(particles[a]);
  return n;
}

double expected_particles(const options& o) { return lattice_particles(o.domain.dimension, o.domain.particles); }

void declare(namelist::schema& schema, domain::rank_columns& o) {
  schema.add("domain", "ranks_x", o.number,
             {.minimum = 0,
              .maximum = 1e6,
              .meaning = "MPI ranks side by side along x, a divisor of their number; 0: as the box's shape suggests"});
}

void resolve(const namelist::schema& schema, domain::rank_columns& o) {
  o.place = schema.where("domain", "ranks_x") + ": &domain ranks_x: ";
}

namespace {

std::string along(const char* what, std::size_t axis) { return std::string(what) + axis_names[axis]; }

}  // namespace

void check_number(const namelist::schema& schema, const box_of_particles& box, double expected) {
  if (expected <= 1e12) return;
  const auto first = box.particles.begin();
  const auto most = std::max_element(first, first + box.dimension);
  schema.fail("domain", along("particles_", static_cast<std::size_t>(most - first)),
              fmt::format("expected at most 1e12 particles in the box, found {:.3g}", expected));
}

void check_widths(const namelist::schema& schema, const box_of_particles& box, double halo, double support) {
  for (std::size_t a = 0; a < static_cast<std::size_t>(box.dimension); ++a) {
    if (box.periodic[a] && halo > box.length[a] * (1.0 - 2e-6))
      schema.fail(
          "domain", along("particles_", a),
          fmt::format("the periodic box is too narrow along {}: {:.6g} m, less than the halo's {:.6g} m (kernel "
                      "support, marker radius and list skin); use more particles, a smaller h_over_dx or a "
                      "smaller skin",
                      axis_names[a], box.length[a], halo));
    if (!box.periodic[a] && support > box.length[a] * (1.0 + 1e-9))
      schema.fail("domain", along("particles_", a),
                  fmt::format("the box is narrower along {}, {:.6g} m, than the kernel reaches, {:.6g} m: use more "
                              "particles or a smaller h_over_dx",
                              axis_names[a], box.length[a], support));
  }
}

void check_interval(const namelist::schema& schema, const output_options& o, double t_end) {
  constexpr double most = 1e6;
  if (o.interval > 0.0 && t_end / o.interval > most)
    schema.fail(
        "output", "interval",
        fmt::format("would write {:.3g} snapshots until t = {:.6g} s: expected 0 or at least {:.3g} s, for {:.0e} "
                    "of them",
                    t_end / o.interval, t_end, t_end / most, most));
}

void declare(namelist::schema& schema, output_options& o) {
  schema.group("output", "what is written, and how often");
  schema.add("output", "interval", o.interval,
             {.unit = "s", .minimum = 0.0, .meaning = "model time between snapshots; 0: first and last only"});
  schema.add("output", "history_interval", o.history_interval,
             {.minimum = 1, .meaning = "steps between lines of history.csv"});
}

void declare(namelist::schema& schema, run_options& o) {
  schema.group("run", "limits and checkpoints");
  schema.add("run", "wall_clock_limit", o.wall_clock_limit,
             {.unit = "s", .minimum = 0.0, .meaning = "stop with a checkpoint after so long; 0: no limit"});
  schema.add("run", "checkpoint_interval", o.checkpoint_interval,
             {.minimum = 0, .meaning = "steps between checkpoints; 0: by time only"});
  schema.add("run", "checkpoint_seconds", o.checkpoint_seconds,
             {.unit = "s", .minimum = 0.0, .meaning = "wall-clock time between checkpoints; 0: none by time"});
}

void declare(namelist::schema& schema, options& o) {
  declare(schema, o.domain);
  declare(schema, o.initial);
  schema.group("gravity", "uniform gravity");
  schema.add("gravity", "g", o.g, {.unit = "m/s^2", .minimum = 0.0, .meaning = "acceleration, towards -y"});
  declare(schema, o.material);
  declare(schema, o.time);
  declare(schema, o.kernel, true);
  walls::declare(schema, 3, o.walls);
  volume::declare(schema, o.smoothing);
  volume::declare(schema, o.hosono);
  balance::declare(schema, o.balancer);
  schema.add("balancer", "interval", o.balance_interval,
             {.minimum = 1,
              .maximum = 1e9,
              .meaning = "steps between decisions at least; one waits up to four times as long for new lists"});
  declare(schema, o.output);
  declare(schema, o.run);
}

void resolve(const namelist::schema& schema, options& o) {
  resolve(o.kernel);
  resolve(schema, o.domain.ranks_x);
  check_box(schema, o);
  if (o.g == 0.0) o.initial.profile = "uniform";
  if (o.initial.profile == "hydrostatic" && o.domain.periodic[1])
    schema.fail("domain", "periodic_y",
                "a hydrostatic profile needs walls at the bottom and the top: set periodic_y = .false.");
  if (o.material.eos.name == "linear" && !o.material.eos.reference_pressure)
    o.material.eos.reference_pressure = o.initial.pressure;
  o.material.eos = schema.placed("material", "eos", [&] { return eos::resolve(o.material.eos); });
  check_interval(schema, o.output, o.time.end());
}

std::int64_t time_options::last_step(double output_interval) const {
  constexpr std::int64_t unlimited = std::int64_t{1} << 50;
  if (t_end) return steps;
  const double steps_between = output_interval / dt;
  const bool all_equal = std::abs(steps_between - std::round(steps_between)) <= 1e-6;
  return method == "adaptive" || !all_equal ? unlimited : steps;
}

}  // namespace tetsuame::simulation
