#include <march/options.hpp>

namespace tetsuame::march {

void declare(namelist::schema& schema, options& o, abilities of_problem) {
  schema.group("time", "time integration");
  auto& t = o.time;
  std::vector<std::string> methods{"euler",   "order_2", "order_3", "order_4", "order_5",
                                   "ssp_rk3", "rk4",     "rkl2",    "rkc2",    "adaptive"};
  if (of_problem.keeps_rate) methods.emplace_back("ab2");
  schema.add("time", "method", t.method,
             {.choices = methods,
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
             {.minimum = 0.0,
              .exclusive_minimum = true,
              .stays_open = true,
              .meaning = "largest dt c/dx; not given: by the method"});
  schema.add("time", "diffusive", t.diffusive,
             {.minimum = 0.0,
              .exclusive_minimum = true,
              .stays_open = true,
              .meaning = "largest dt D/dx^2 of a diffusivity D; not given: by the method"});
  simulation::declare(schema, o.kernel, of_problem.lists_change, of_problem.kernels);
  simulation::declare(schema, o.output);
  simulation::declare(schema, o.run);
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
  simulation::resolve(o.kernel);
  const auto f = stable_fractions(o.time.method);
  if (!o.time.cfl) o.time.cfl = f.cfl;
  if (!o.time.diffusive) o.time.diffusive = f.diffusive;
}

void check_output(const namelist::schema& schema, const options& o) {
  simulation::check_interval(schema, o.output, o.time.t_end.value_or(0.0));
}

std::string method_of(const std::string& input) {
  const auto document = namelist::parse_text(input, "the checkpoint's input");
  for (const auto& group : document.groups())
    for (const auto& from : group.assignments)
      if (group.name == "time" && from.key == "method") return from.values.front().content;
  return {};
}

}  // namespace tetsuame::march
