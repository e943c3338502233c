#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <kernels/kernel.hpp>
#include <namelist/text.hpp>
#include <run/options.hpp>

namespace tetsuame::run {

namespace {

void declare(namelist::schema& schema, kernel_options& o, const abilities& of_problem) {
  std::vector<std::string> names = of_problem.kernels;
  schema.group("kernel", of_problem.has_kernel ? "smoothing kernel and neighbour lists" : "neighbour lists");
  if (names.empty())
    for (const auto& k : kernels::table) names.emplace_back(k.name);
  if (of_problem.has_kernel) {
    schema.add("kernel", "name", o.name, {.choices = names, .meaning = "of the kernel"});
    schema.add(
        "kernel", "h_over_dx", o.h_over_dx,
        {.minimum = 0.0, .maximum = 10.0, .meaning = "smoothing length in particle spacings; 0: the kernel's own"});
  }
  if (of_problem.single_pairs)
    schema.add(
        "kernel", "precision", o.precision,
        {.choices = {"double", "single"},
         .meaning = std::string("of what is computed for a pair of particles; states and their steps are double") +
                    (o.single_pairs() ? "; not given: double where single is not good enough" : "")});
  if (of_problem.lists_change)
    schema.add("kernel", "skin", o.skin,
               for_expert(namelist::up_to(2.0,
                                          "neighbour lists reach further than the kernel by so many particle spacings, "
                                          "or more where else a step would outrun them")));
}

void resolve(const namelist::schema& schema, kernel_options& o) {
  const auto& kernel = kernels::find(o.name);
  if (o.h_over_dx == 0.0) o.h_over_dx = kernel.default_h_over_dx;
  if (support_over_dx(o) < 1.0)
    schema.fail("kernel", "h_over_dx",
                fmt::format("expected at least {:.3g}, with which the {} kernel reaches the nearest neighbours, or 0",
                            1.0 / kernel.support_over_h, o.name));
}

void declare(namelist::schema& schema, output_options& o) {
  schema.group("output", "what is written, and how often");
  schema.add("output", "interval", o.interval,
             {.unit = "s",
              .minimum = 0.0,
              .may_change = true,
              .meaning = "model time between snapshots; 0: first and last only"});
  schema.add("output", "history_interval", o.history_interval,
             {.minimum = 1, .may_change = true, .meaning = "steps between lines of history.csv"});
  schema.add("output", "fields", o.fields,
             {.may_change = true,
              .meaning = "of snapshots, by name, beside Coordinates and ParticleIDs; not given: all "
                         "that the program has"});
  schema.add("output", "precision", o.precision,
             {.choices = {"double", "single"},
              .may_change = true,
              .meaning = "of numbers in snapshots; Coordinates stay double"});
  schema.add("output", "compress", o.compress,
             {.may_change = true, .meaning = "snapshots, by deflate; one process does it"});
}

void declare(namelist::schema& schema, balance_options& o) {
  schema.add("domain", "balance", o.follows,
             {.choices = {"measured", "counted", "off"},
              .may_change = true,
              .meaning = "what the cuts between ranks follow: seconds of computing, pairs of neighbours (the same in "
                         "every run), or nothing"});
  balance::declare(schema, o.how);
  schema.add("balancer", "interval", o.interval,
             {.minimum = 1,
              .maximum = 1e9,
              .may_change = true,
              .expert = true,
              .expert_name = "balancer_interval",
              .meaning = "steps between decisions at least; one waits up to four times as long for new lists"});
}

void declare(namelist::schema& schema, run_options& o) {
  schema.group("run", "limits and checkpoints");
  schema.add("run", "wall_clock_limit", o.wall_clock_limit,
             {.unit = "s",
              .minimum = 0.0,
              .may_change = true,
              .meaning = "stop with a checkpoint after so long; 0: no limit"});
  schema.add("run", "checkpoint_interval", o.checkpoint_interval,
             {.minimum = 0, .may_change = true, .meaning = "steps between checkpoints; 0: by time only"});
  schema.add("run", "checkpoint_seconds", o.checkpoint_seconds,
             {.unit = "s",
              .minimum = 0.0,
              .may_change = true,
              .meaning = "wall-clock time between checkpoints; 0: none by time"});
}

void declare(namelist::schema& schema, time_options& o, const abilities& of_problem) {
  schema.group("time", "time integration (ARKODE)");
  std::vector<std::string> methods{"euler", "order_2", "order_3", "order_4", "order_5", "ssp_rk3", "rk4"};
  if (of_problem.diffuses) methods.insert(methods.end(), {"rkl2", "rkc2"});
  methods.emplace_back("adaptive");
  methods.insert(methods.end(), of_problem.keeping.begin(), of_problem.keeping.end());
  if (!of_problem.methods.empty()) methods = of_problem.methods;
  const bool has_kdk = std::ranges::count(methods, "kdk") > 0;
  const std::string stabilised = of_problem.diffuses ? "; rkl2, rkc2: stabilised for diffusion" : "";
  schema.add(
      "time", "method", o.method,
      {.choices = methods,
       .may_change = true,
       .meaning =
           "explicit, with a fixed step" + stabilised + "; adaptive: Runge-Kutta with error control" +
           (has_kdk ? "; kdk: kick-drift-kick (leapfrog), one evaluation a step, of the length that is stable" : "")});
  schema.add("time", "order", o.order,
             {.minimum = 2,
              .maximum = 5,
              .may_change = true,
              .expert = true,
              .expert_name = "time_order",
              .meaning = "of the adaptive method"});
  schema.add("time", "dt", o.dt,
             namelist::changing(namelist::positive(
                 "s", "time step, with error control the first one; not given: " +
                          std::string(of_problem.limits_diffusion ? "by cfl and diffusive" : "by cfl"))));
  if (of_problem.diffuses)
    schema.add("time", "error_control", o.error_control,
               {.may_change = true,
                .expert = true,
                .expert_name = "time_error_control",
                .meaning = "rkl2, rkc2: steps from an error estimate; else the fixed step dt"});
  schema.add("time", "steps", o.steps, {.minimum = 0, .maximum = 1e15, .may_change = true, .meaning = "at most"});
  schema.add("time", "t_end", o.t_end,
             {.unit = "s",
              .minimum = 0.0,
              .stays_open = true,
              .may_change = true,
              .meaning = "time at the end; not given: steps * dt, where both are given"});
  schema.add("time", "rtol", o.rtol,
             {.minimum = 1e-14,
              .maximum = 1e-1,
              .may_change = true,
              .meaning = "error control: of a step, relative to each field's scale"});
  schema.add("time", "cfl", o.cfl,
             {.minimum = 1e-9, .stays_open = !o.cfl, .may_change = true, .meaning = of_problem.cfl_is});
  if (of_problem.limits_diffusion)
    schema.add("time", "diffusive", o.diffusive,
               {.minimum = 1e-9,
                .stays_open = !o.diffusive,
                .may_change = true,
                .expert = true,
                .expert_name = "time_diffusive",
                .meaning = "largest dt D/dx^2 of a diffusivity D; not given: by the method"});
}

void declare(namelist::schema& schema, start_options& o, const abilities& of_problem) {
  schema.group("initial", "start state");
  schema.add("initial", "file", o.file,
             {.may_change = true,  // its path; what is in it is held to the hash in the checkpoint
              .file = namelist::file_of::start,
              .meaning = "a snapshot of the same box, of this program or another: " + of_problem.reads +
                         " are those of its particles, as many as it has"});
  if (of_problem.settles)
    schema.add("initial", "settle", o.settle,
               namelist::for_expert(namelist::between(0.0, 1e3,
                                                      "a start at rest first moves, with its motion damped, for so "
                                                      "many crossings of the box by sound; 0: it does not")));
}

// Largest dt c/dx and dt D/dx^2 (D: m2/s, the largest diffusivity) with a margin of a third or so: those of the
// methods' stability on the lattice, where |eigenvalue| <= 2.2 c/dx for sound and 8 D/dx^2 for diffusion in 2-D, 12 in
// 3-D.
struct fractions {
  double cfl, diffusive;
};
fractions stable_fractions(const std::string& method) {
  if (method == "euler") return {0.05, 0.2};
  if (method == "ab2") return {0.2, 0.09};
  if (method == "order_2") return {0.4, 0.2};
  if (method == "ssp_rk3" || method == "order_3") return {0.7, 0.25};
  if (method == "rkl2" || method == "rkc2") return {0.5, 1e6};
  return {1.0, 0.3};
}

// With those that every program's have.
std::vector<std::string> fields_of_snapshots(const std::vector<std::string>& of_problem) {
  std::vector<std::string> all(output::common_fields.begin(), output::common_fields.end());
  all.insert(all.end(), of_problem.begin(), of_problem.end());
  return all;
}

}  // namespace

double support_over_dx(const kernel_options& o) { return kernels::find(o.name).support_over_h * o.h_over_dx; }

bool time_options::counts_steps(double output_interval) const {
  if (t_end) return steps < time_options{}.steps;
  const double steps_between = output_interval / *dt;
  return method != "adaptive" && std::abs(steps_between - std::round(steps_between)) <= 1e-6;
}

bool time_options::controls_error() const {
  return method == "adaptive" || ((method == "rkl2" || method == "rkc2") && error_control);
}
bool time_options::varies_steps() const { return controls_error() || (method == "kdk" && !dt); }

void declare(namelist::schema& schema, common_options& o, const abilities& of_problem) {
  if (of_problem.starts_from_file) declare(schema, o.start, of_problem);
  declare(schema, o.time, of_problem);
  if (of_problem.particles) declare(schema, o.kernel, of_problem);
  declare(schema, o.output);
  declare(schema, o.run);
  if (!of_problem.particles) return;
  declare(schema, o.balance);
  gauges::declare(schema, o.gauges);
}

void resolve(const namelist::schema& schema, common_options& o) {
  resolve(schema, o.kernel);
  if (!o.start.file.empty()) o.start.place = schema.where("initial", "file") + ": &initial file: ";
  const auto f = stable_fractions(o.time.method);
  if (!o.time.cfl) o.time.cfl = f.cfl;
  if (!o.time.diffusive) o.time.diffusive = f.diffusive;
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

void check_fields(const namelist::schema& schema, output_options& o, const std::vector<std::string>& fields) {
  const auto known = fields_of_snapshots(fields);
  for (auto& name : o.fields) {
    const auto meant = namelist::nearest(name, known);
    if (namelist::lower(name) != namelist::lower(meant))
      schema.fail(
          "output", "fields",
          fmt::format("{} is no field of this run's snapshots; the nearest is {}; there are {}",
                      namelist::quote(namelist::excerpt(name)), namelist::quote(meant), fmt::join(known, ", ")));
    name = meant;
  }
}

void check_output(const namelist::schema& schema, common_options& o, const std::vector<std::string>& fields) {
  check_fields(schema, o.output, fields);
  check_interval(schema, o.output, o.time.has_end() ? o.time.end() : 0.0);
}

void check_output(const namelist::schema& schema, common_options& o, const domain::options& box,
                  const std::vector<std::string>& fields) {
  check_output(schema, o, fields);
  gauges::resolve(schema, o.gauges, box, fields_of_snapshots(fields));
}

}  // namespace tetsuame::run
