// What gauges read on the way: columns of gauges.csv, and how their values are found.
#pragma once

#include <fmt/format.h>

#include <free_surface/budget.hpp>
#include <free_surface/gauges.hpp>
#include <free_surface/measures.hpp>
#include <free_surface/traction.hpp>
#include <functional>
#include <numbers>
#include <output/history.hpp>

namespace tetsuame::free_surface {

// Columns of gauges.csv.
template <int D>
struct probe {
  std::vector<output::history_column> columns;
  std::function<std::vector<double>(water<D>&)> values;  // collective
};

// Forces and moments; what was put back since the last reading counts by its mean.
template <int D>
std::vector<output::history_column> force_columns(std::size_t gauges) {
  std::vector<output::history_column> all;
  for (const auto& name : force_names(gauges, D)) all.push_back({name, name.starts_with("force") ? "N" : "N m"});
  return all;
}
template <int D>
std::vector<double> force_values(water<D>& f) {
  std::vector<double> all;
  const auto loads = read_loads(f);
  for (std::size_t n = 0; n < loads.size(); ++n)
    for (std::size_t k = 0; k < f.counted.put_back[n].size(); ++k)
      all.push_back((k < D ? loads[n].force[k] : loads[n].moment[k - D]) +
                    f.counted.mean(f.counted.put_back[n][k] - f.counted.put_back_read[n][k]));
  return all;
}
// Their impulses since the start, with what was put back.
template <int D>
probe<D> impulse_probe(std::size_t gauges) {
  probe<D> p;
  for (const auto& name : force_names(gauges, D))
    p.columns.push_back({impulse_name(name), name.starts_with("force") ? "N s" : "N m s"});
  p.values = [](water<D>& f) { return count_of(f).impulses; };
  return p;
}

// How far a body has moved from where the input has it, and by how much it has turned: degrees, along x, y, z the
// components of its rotation vector in three dimensions.
template <int D>
probe<D> motion_probe(std::size_t n, std::size_t body) {
  constexpr std::array<const char*, 3> axis{"x", "y", "z"};
  probe<D> p;
  for (std::size_t a = 0; a < D; ++a) p.columns.push_back({fmt::format("motion_{}_{}", n, axis[a]), "m"});
  for (std::size_t a = 0; a < (D == 2 ? 1 : 3); ++a)
    p.columns.push_back({D == 2 ? fmt::format("angle_{}", n) : fmt::format("angle_{}_{}", n, axis[a]), "degrees"});
  p.values = [body](water<D>& f) {
    const auto* b = f.mover(static_cast<std::int32_t>(body));
    const solids::pose<D> pose = b != nullptr ? b->now : solids::pose<D>{};
    std::vector<double> all(pose.shift.c.begin(), pose.shift.c.end());
    for (const double angle : solids::rotation_vector<D>(pose.turned).c)
      all.push_back(angle * 180.0 / std::numbers::pi);
    return all;
  };
  return p;
}

template <int D>
std::vector<probe<D>> probes_of(const options& o, const parameters& p) {
  std::vector<probe<D>> all;
  const auto& g = o.gauges;
  const auto add = [&](const std::string& name, const char* unit, std::function<double(const water<D>&)> value) {
    all.push_back({{{name, unit}}, [value = std::move(value)](water<D>& f) { return std::vector{value(f)}; }});
  };
  const auto place = [](const std::array<std::vector<double>, 3>& of, std::size_t n) {
    point x{};
    for (std::size_t a = 0; a < D; ++a)
      if (n < of[a].size()) x[a] = of[a][n];
    return x;
  };
  if (g.front) add("front", "m", [](const water<D>& f) { return front_of(f); });
  if (o.flow.start == "standing_wave") add("wave", "1", [](const water<D>& f) { return wave_of_now(f); });
  if (o.flow.start == "drop") {
    add("semi_axis_x", "m", [](const water<D>& f) { return semi_axes_of(f).a; });
    add("semi_axis_y", "m", [](const water<D>& f) { return semi_axes_of(f).b; });
  }
  for (std::size_t n = 0; n < g.height[0].size(); ++n)
    add(fmt::format("height_{}", n + 1), "m", [x = place(g.height, n)](const water<D>& f) { return depth_at(f, x); });
  for (std::size_t n = 0; n < g.pressure[0].size(); ++n)
    add(fmt::format("pressure_{}", n + 1), "Pa", [x = place(g.pressure, n), n](const water<D>& f) {
      return pressure_at(f, x) + f.counted.mean(f.counted.on_gauges[n]);
    });
  for (std::size_t n = 0; n < g.discharge.size(); ++n)
    add(fmt::format("discharge_{}", n + 1), D == 2 ? "m^2/s" : "m^3/s",
        [x = g.discharge[n]](const water<D>& f) { return discharge_at(f, x); });
  if (!p.force.empty()) {
    all.push_back({force_columns<D>(p.force.size()), force_values<D>});
    all.push_back(impulse_probe<D>(p.force.size()));
  }
  for (std::size_t n = 0; n < p.motion.size(); ++n) all.push_back(motion_probe<D>(n + 1, p.motion[n]));
  return all;
}

}  // namespace tetsuame::free_surface
