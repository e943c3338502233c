#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <run/amounts.hpp>
#include <run/plan.hpp>

namespace tetsuame::run {

namespace {

// Of n steps, however a quotient was rounded.
double whole_steps(double n) { return std::ceil(n * (1.0 - 1e-9)); }

struct number_of_steps {
  double steps;
  std::string by;  // how it is known
};

number_of_steps steps_of(const plan_of_run& plan, const common_options& o, const rehearsal& tried) {
  const auto done = static_cast<double>(plan.step), asked = static_cast<double>(plan.asked);
  if (plan.finished) return {done, "as asked for"};
  double on_the_way = 0.0;
  if (tried.course.empty()) {
    on_the_way = done + (plan.last_dt > 0.0 ? std::max(0.0, whole_steps((plan.end - plan.time) / plan.last_dt)) : 0.0);
  } else {
    const bool varies = o.time.varies_steps();
    const double interval = o.output.interval;
    on_the_way = std::ceil(tried.steps(varies ? std::numeric_limits<double>::infinity() : plan.first_dt,
                                       o.time.dt && !varies ? *o.time.dt : 0.0, plan.end) +
                           (interval > 0.0 ? 0.5 * plan.end / interval : 0.0));
  }
  if (plan.asked > 0 && asked <= on_the_way) return {asked, "as asked for"};
  if (tried.course.empty())
    return {on_the_way,
            fmt::format("to t = {:.4g} s with this dt; how dt changes is not known: {}", plan.end, tried.what)};
  if (tried.completed) return {on_the_way, fmt::format("to t = {:.4g} s, as dt changed with {}", plan.end, tried.what)};
  return {on_the_way, fmt::format("to t = {:.4g} s, as dt changed with {} to {:.3g} s; behind that not known", plan.end,
                                  tried.what, tried.course.back().t)};
}

}  // namespace

std::string text_of(const plan_of_run& plan, const common_options& o, const rehearsal& tried) {
  const auto [steps, by] = steps_of(plan, o, tried);
  const auto timed = std::max<std::int64_t>(0, plan.step - 1);
  const auto a_step = [&](auto of_all) {
    return timed > 0 ? static_cast<double>(of_all) / static_cast<double>(timed) : 0.0;
  };
  const double interval = o.output.interval;
  const double snapshots = interval > 0.0 && plan.end > 0.0 ? 1.0 + whole_steps(plan.end / interval) : 2.0;
  std::string text;
  const auto add = [&](const char* name, const std::string& value, const std::string& remark) {
    text += fmt::format("  {:<10} {:<14} {}\n", name, value, remark);
  };
  add("particles", std::to_string(plan.particles), fmt::format("in {} dimensions", plan.dimension));
  add("dt", fmt::format("{:.4g} s", plan.last_dt), fmt::format("{}, after {} steps", plan.limit, plan.step));
  add("steps", fmt::format("{:.4g}", steps), by);
  add("a step", fmt::format("{:.3g} s", a_step(plan.seconds)),
      fmt::format("mean of {}, with {:.3g} right-hand sides, on {} x {} cores", timed, a_step(plan.evaluations),
                  plan.ranks, omp_get_max_threads()));
  double run_time = steps * a_step(plan.seconds);
  if (plan.settling.steps > 0.0) {
    constexpr double evaluations_a_step = 2.0;
    add("settling", fmt::format("{:.0f} steps", plan.settling.steps),
        fmt::format("of {:.4g} s before the run, with {:.0f} right-hand sides each", plan.settling.dt,
                    evaluations_a_step));
    if (plan.evaluations > 0)
      run_time += plan.settling.steps * evaluations_a_step * plan.seconds / static_cast<double>(plan.evaluations);
  }
  add("run time", duration_text(run_time), "without output");
  add("memory", size_text(plan.memory), "of all ranks together");
  add("snapshots", fmt::format("{:.4g}", snapshots),
      fmt::format("of {} each, {} together", size_text(plan.snapshot), size_text(snapshots * plan.snapshot)));
  return text;
}

}  // namespace tetsuame::run
