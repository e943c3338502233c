#include <kernels/kernel.hpp>
#include <march/options.hpp>

namespace tetsuame::march {

void declare(namelist::schema& schema, options& o, bool lists_change) {
  schema.group("time", "time integration");
  auto& t = o.time;
  schema.add("time", "method", t.method,
             {.choices = {"euler", "order_2", "order_3", "order_4", "order_5", "ssp_rk3", "rk4", "ab2", "rkl2", "rkc2",
                          "adaptive"},
              .meaning = "explicit; rkl2, rkc2: stabilised for diffusion; adaptive: Runge-Kutta with error control"});
  schema.add("time", "order", t.order, {.minimum = 2, .maximum = 5, .meaning = "of the adaptive method"});
  schema.add("time", "dt", t.dt,
             {.unit = "s",
              .minimum = 0.0,
              .exclusive_minimum = true,
              .meaning = "time step, with error control the first one; not given: by cfl and diffusive"});
  schema.add("time", "error_control", t.error_control,
             {.meaning = "rkl2, rkc2: steps from an error estimate; else the fixed step dt"});
  schema.add("time", "steps", t.steps, {.minimum = 0, .maximum = 1e15, .meaning = "at most"});
  schema.add("time", "t_end", t.t_end, {.unit = "s", .minimum = 0.0, .meaning = "time at the end"});
  schema.add(
      "time", "rtol", t.rtol,
      {.minimum = 1e-14, .maximum = 1e-1, .meaning = "error control: of a step, relative to each field's scale"});
  schema.add("time", "cfl", t.cfl,
             {.minimum = 0.0, .exclusive_minimum = true, .meaning = "largest dt c/dx; not given: by the method"});
  schema.add("time", "diffusive", t.diffusive,
             {.minimum = 0.0,
              .exclusive_minimum = true,
              .meaning = "largest dt D/dx^2 of a diffusivity D; not given: by the method"});
  schema.group("kernel", "smoothing kernel and neighbour lists");
  std::vector<std::string> choices;
  for (const auto& k : kernels::table) choices.emplace_back(k.name);
  schema.add("kernel", "name", o.kernel.name, {.choices = choices, .meaning = "of the kernel"});
  schema.add(
      "kernel", "h_over_dx", o.kernel.h_over_dx,
      {.minimum = 0.0, .maximum = 10.0, .meaning = "smoothing length in particle spacings; 0: the kernel's own"});
  if (lists_change)
    schema.add("kernel", "skin", o.kernel.skin,
               {.minimum = 0.0,
                .maximum = 2.0,
                .exclusive_minimum = true,
                .meaning = "neighbour lists reach further than the kernel by so many particle spacings"});
  schema.group("output", "what is written, and how often");
  schema.add("output", "interval", o.output.interval,
             {.unit = "s", .minimum = 0.0, .meaning = "model time between snapshots; 0: first and last only"});
  schema.add("output", "history_interval", o.output.history_interval,
             {.minimum = 1, .meaning = "steps between lines of history.csv"});
  schema.group("run", "limits and checkpoints");
  schema.add("run", "wall_clock_limit", o.run.wall_clock_limit,
             {.unit = "s", .minimum = 0.0, .meaning = "stop with a checkpoint after so long; 0: no limit"});
  schema.add("run", "checkpoint_interval", o.run.checkpoint_interval,
             {.minimum = 0, .meaning = "steps between checkpoints; 0: by time only"});
  schema.add("run", "checkpoint_seconds", o.run.checkpoint_seconds,
             {.unit = "s", .minimum = 0.0, .meaning = "wall-clock time between checkpoints; 0: none by time"});
}

fractions stable_fractions(const std::string& method) {
  if (method == "euler") return {0.05, 0.2};
  if (method == "ab2") return {0.2, 0.09};
  if (method == "order_2") return {0.4, 0.2};
  if (method == "ssp_rk3" || method == "order_3") return {0.7, 0.25};
  if (method == "rkl2" || method == "rkc2") return {0.5, 1e6};
  return {1.0, 0.3};
}

void resolve(options& o) {
  if (o.kernel.h_over_dx == 0.0) o.kernel.h_over_dx = kernels::find(o.kernel.name).default_h_over_dx;
  const auto f = stable_fractions(o.time.method);
  if (!o.time.cfl) o.time.cfl = f.cfl;
  if (!o.time.diffusive) o.time.diffusive = f.diffusive;
}

}  // namespace tetsuame::march
