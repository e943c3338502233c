#include <fmt/format.h>
#include <omp.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <run/amounts.hpp>
#include <run/plan.hpp>

namespace tetsuame::run {

namespace {

std::int64_t resident_bytes() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return std::int64_t{1024} * used.ru_maxrss;
}

std::string line(const char* name, const std::string& value, const std::string& remark) {
  return fmt::format("  {:<10} {:<14} {}\n", name, value, remark);
}

}  // namespace

std::string plan_text(const domain::communicator& ranks, const trial& of_steps, const extent& whole) {
  const auto memory = static_cast<double>(ranks.sum(resident_bytes()));
  const auto snapshot = static_cast<double>(ranks.sum(of_steps.bytes_of_snapshot));
  const double left = of_steps.dt > 0.0 ? std::ceil((whole.t_end - whole.t) / of_steps.dt * (1.0 - 1e-9)) : 0.0;
  const double steps =
      whole.steps > 0 ? static_cast<double>(whole.steps) : static_cast<double>(of_steps.steps) + std::max(0.0, left);
  const double each = of_steps.steps_timed > 0 ? of_steps.seconds / static_cast<double>(of_steps.steps_timed) : 0.0;
  const double snapshots = whole.output_interval > 0.0 && whole.t_end > 0.0
                               ? 1.0 + std::ceil(whole.t_end / whole.output_interval * (1.0 - 1e-9))
                               : 2.0;
  return line("particles", fmt::format("{}", of_steps.particles), fmt::format("in {} dimensions", of_steps.dimension)) +
         line("dt", fmt::format("{:.4g} s", of_steps.dt),
              fmt::format("{}, after {} steps", of_steps.dt_is, of_steps.steps)) +
         line("steps", fmt::format("{:.4g}", steps),
              whole.steps > 0 ? "as asked for" : fmt::format("to t = {:.4g} s with this dt", whole.t_end)) +
         line("a step", fmt::format("{:.3g} s", each),
              fmt::format("mean of {}, with {:.3g} right-hand sides, on {} x {} cores", of_steps.steps_timed,
                          of_steps.evaluations_per_step, ranks.size, omp_get_max_threads())) +
         line("run time", duration_text(steps * each), "without output") +
         line("memory", size_text(memory), "of all ranks together") +
         line("snapshots", fmt::format("{:.4g}", snapshots),
              fmt::format("of {} each, {} together", size_text(snapshot), size_text(snapshots * snapshot)));
}

}  // namespace tetsuame::run
