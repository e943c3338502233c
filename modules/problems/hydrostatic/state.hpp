// The state as the integrator and the snapshots see it.
#pragma once

#include <hydrostatic/setup.hpp>
#include <integrators/explicit_integrator.hpp>
#include <output/snapshot.hpp>
#include <volume/shape.hpp>

namespace tetsuame::hydrostatic {

// Components of the state, in the order of liquid::rates: x, v, T, u, and ρ or Y where carried. The absolute errors
// that steps with error control allow, beside those relative to a value (of positions, to the spacing), are far below
// what a flow has: mm, um/s, uK.
template <int D>
std::vector<integrators::field> state_fields(scene<D>& scene, volume::carries carried) {
  auto& s = scene.w.s;
  std::vector<integrators::field> all;
  constexpr std::array<const char*, 3> axis{"x", "y", "z"};
  for (std::size_t a = 0; a < D; ++a) all.push_back({axis[a], s.x[a].data(), 1e-6 * scene.w.dx, scene.w.dx});
  for (std::size_t a = 0; a < D; ++a) all.push_back({std::string("v") + axis[a], s.v[a].data(), 1e-6, 0.0});
  all.push_back({"T", s.T.data(), 1e-6, 0.0});
  all.push_back({"u", s.u.data(), 1e-3, 0.0});
  if (carried == volume::carries::density) all.push_back({"rho", s.rho.data(), 1e-9, 0.0});
  if (carried == volume::carries::weight) all.push_back({"Y", s.Y.data(), 1e-9, 0.0});
  return all;
}

namespace detail {

inline std::string column_unit(std::string unit, int dimension) {
  if (unit == "m^D") return dimension == 2 ? "m^2" : "m^3";
  return unit;
}

template <int D>
output::particle_group group_of(const particles::particles<D>& s, int type, std::size_t begin, std::size_t n) {
  output::particle_group g{type, n, s.id.data() + begin, {}};
  particles::for_each_field<D>(s, [&](const particles::field_info& field, const auto& components) {
    if (!field.in_snapshot) return;
    output::column c{field.name, column_unit(field.unit, D), field.description, {}, components.size() > 1};
    for (const auto* a : components) c.components.push_back(a->data() + begin);
    g.columns.push_back(std::move(c));
  });
  return g;
}

}  // namespace detail

// Fluid and walls for a snapshot, with the smoothing length and, of the fluid, the displacement and the exact solution
// beside the fields of the table; `extra` holds what is made for the occasion.
template <int D>
std::vector<output::particle_group> snapshot_groups(const scene<D>& scene, double h,
                                                    std::vector<particles::array>& extra) {
  const auto& s = scene.w.s;
  enum : std::size_t { smoothing_length, pressure, density, moved };
  extra.assign(moved + D, particles::array(s.fluid, 0.0));
  extra[smoothing_length].assign(s.total(), h);
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const auto row = start_place(scene, s.id[i])[1];
    extra[pressure][i] = scene.p_exact[row];
    extra[density][i] = scene.rho_exact[row];
    const auto d = displacement(scene, i);
    for (std::size_t a = 0; a < D; ++a) extra[moved + a][i] = d[a];
  }
  std::vector<output::particle_group> groups;
  const auto add = [&](int type, std::size_t begin, std::size_t n) {
    auto g = detail::group_of<D>(s, type, begin, n);
    g.columns.push_back(
        {"SmoothingLength", "m", "smoothing length h", {extra[smoothing_length].data() + begin}, false});
    if (type == 0) {
      g.columns.push_back(
          {"PressureReference", "Pa", "pressure of the exact solution", {extra[pressure].data()}, false});
      g.columns.push_back(
          {"DensityReference", "kg/m^3", "density of the exact solution", {extra[density].data()}, false});
      output::column displacement{"Displacement", "m", "position less start position", {}, true};
      for (std::size_t a = 0; a < D; ++a) displacement.components.push_back(extra[moved + a].data());
      g.columns.push_back(std::move(displacement));
    }
    groups.push_back(std::move(g));
  };
  add(0, 0, s.fluid);
  // Images are the fluid again.
  if (!scene.mirrors() && scene.w.d.ranks.sum(static_cast<std::int64_t>(s.walls)) > 0) add(1, s.first_wall(), s.walls);
  return groups;
}

}  // namespace tetsuame::hydrostatic
