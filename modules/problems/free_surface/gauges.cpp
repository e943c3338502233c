#include <fmt/format.h>

#include <algorithm>
#include <free_surface/gauges.hpp>
#include <run/summary.hpp>

namespace tetsuame::free_surface {

namespace {

std::string times_of(const series& s) {
  return s.empty() ? "no time" : fmt::format("{:.6g} to {:.6g} s", s.time.front(), s.time.back());
}

void put(nlohmann::ordered_json& metrics, const std::string& name, std::optional<double> value,
         const std::string& reason) {
  metrics[name] = run::or_null(value);
  if (!value) metrics[name + "_reason"] = reason;
}

void put_difference(nlohmann::ordered_json& metrics, const std::string& name, std::optional<double> value,
                    const series& run, const series& reference) {
  put(metrics, name, value,
      fmt::format("the measured curve, {}, and the run, {}, have no time in common", times_of(reference),
                  times_of(run)));
}

// Over all of the span, or not at all: what is held against it is.
template <class Impulse>
void put_impulse_by(nlohmann::ordered_json& metrics, const std::string& name, const series& s,
                    std::optional<double> from, double until, const Impulse& impulse) {
  if (!from) return put(metrics, name, {}, "the water has not arrived");
  const bool known = *from < until && covers(s, *from, until);
  put(metrics, name, known ? std::optional(impulse(*from, until)) : std::nullopt,
      fmt::format("asked for from {:.6g} to {:.6g} s, and known from {}", *from, until, times_of(s)));
}
void put_impulse(nlohmann::ordered_json& metrics, const std::string& name, const series& s, std::optional<double> from,
                 double until) {
  put_impulse_by(metrics, name, s, from, until, [&](double a, double b) { return integral(s, a, b); });
}

}  // namespace

void report_pressure(const options& o, const std::string& name, const series& run, const series& reference,
                     nlohmann::ordered_json& metrics) {
  const auto& g = o.gauges;
  const auto report = [&](const series& s, const std::string& end) {
    if (s.empty()) return;
    const auto arrival = first_above(s, g.arrival);
    const auto largest = std::ranges::max_element(s.value);
    const double until = g.impulse_until.value_or(run.time.back());
    metrics[name + "_arrival" + end] = run::or_null(arrival);
    metrics[name + "_largest" + end] = *largest;
    metrics[name + "_largest_time" + end] = s.time[static_cast<std::size_t>(largest - s.value.begin())];
    const auto from = g.impulse_from ? g.impulse_from : arrival;
    put_impulse(metrics, name + "_impulse" + end, s, from, until);
  };
  report(run, "");
  report(reference, "_reference");
}

void report_height(const std::string& name, const series& run, const series& reference,
                   nlohmann::ordered_json& metrics) {
  const auto largest = std::ranges::max_element(run.value);
  metrics[name + "_largest"] = *largest;
  if (reference.empty()) return;
  put_difference(metrics, name + "_mean_error", mean_difference(run, reference), run, reference);
  metrics[name + "_largest_reference"] = std::ranges::max(reference.value);
}

std::vector<std::string> force_names(std::size_t gauges, int dimension) {
  constexpr std::array<const char*, 3> axis{"x", "y", "z"};
  std::vector<std::string> all;
  for (std::size_t n = 1; n <= gauges; ++n) {
    for (int a = 0; a < dimension; ++a) all.push_back(fmt::format("force_{}_{}", n, axis[static_cast<std::size_t>(a)]));
    if (dimension == 2) all.push_back(fmt::format("moment_{}", n));
    for (int a = 0; dimension == 3 && a < 3; ++a)
      all.push_back(fmt::format("moment_{}_{}", n, axis[static_cast<std::size_t>(a)]));
  }
  return all;
}

std::string impulse_name(const std::string& force) { return force + "_impulse"; }

void report_force(const options& o, const std::string& name, const series& run, const series& impulse,
                  const series& reference, nlohmann::ordered_json& metrics) {
  const auto& g = o.gauges;
  const double from = g.impulse_from.value_or(run.time.front()), until = g.impulse_until.value_or(run.time.back());
  const auto between = [&](double a, double b) {
    const auto at = [&](double t) {
      return *value_at(impulse, std::clamp(t, impulse.time.front(), impulse.time.back()));
    };
    return at(b) - at(a);
  };
  const auto report = [&](const series& s, const std::string& end) {
    if (s.empty()) return;
    const auto largest = std::ranges::max_element(s.value, {}, [](double v) { return std::abs(v); });
    metrics[name + "_largest" + end] = *largest;
    metrics[name + "_largest_time" + end] = s.time[static_cast<std::size_t>(largest - s.value.begin())];
  };
  report(run, "");
  put_impulse_by(metrics, name + "_impulse", run, from, until, between);
  report(reference, "_reference");
  if (!reference.empty()) put_impulse(metrics, name + "_impulse_reference", reference, from, until);
  if (!reference.empty())
    put_difference(metrics, name + "_mean_error", mean_difference(run, reference), run, reference);
}

void report_front(const parameters& p, const series& run, nlohmann::ordered_json& metrics) {
  metrics["front_largest"] = std::ranges::max(run.value);
  if (p.measured.front.empty()) return;
  const auto rms = rms_difference(run, p.measured.front);
  put_difference(metrics, "front_rms", rms, run, p.measured.front);
  metrics["front_rms_over_height"] = run::or_null(rms ? std::optional(*rms / p.height) : std::nullopt);
}

}  // namespace tetsuame::free_surface
