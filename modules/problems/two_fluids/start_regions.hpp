// A start that &region changes: what each particle is made of, its temperature and velocity; and with these the
// pressure of every row of the lattice, as the weight of all that lies above, so that nothing but what differs along a
// row moves.
#pragma once

#include <fmt/format.h>

#include <foundation/exact_sum.hpp>
#include <regions/apply.hpp>
#include <two_fluids/fluids.hpp>

namespace tetsuame::two_fluids {

// Collective. Fails where a &material has no particle, and where the start is of metal or silicate alone: it has no
// contact, and no metal to follow.
template <int D>
void expect_all_materials(const fluids<D>& f, const std::string& where) {
  const auto names = f.o.names();
  std::vector<std::int64_t> number(names.size(), 0);
  for (std::size_t i = 0; i < f.world.w.s.fluid; ++i) ++number[f.material_of(i)];
  std::int64_t metal = 0, all = 0;
  for (std::size_t n = 0; n < names.size(); ++n) {
    number[n] = f.ranks().sum(number[n]);
    metal += f.metals[n] != 0 ? number[n] : 0;
    all += number[n];
  }
  for (std::size_t n = 2; n < names.size(); ++n)
    if (number[n] == 0)
      foundation::fail_input(
          fmt::format("{}: none of the {} particles of the start is of material {} ('{}')", where, all, n, names[n]));
  if (metal != 0 && metal != all) return;
  const char* only = names.size() > 2 ? (metal == 0 ? "silicate, and none is metal" : "metal, and none is silicate")
                     : metal == 0     ? "material 0 (lower, outside)"
                                      : "material 1 (upper, drop)";
  foundation::fail_input(
      fmt::format("{}: all {} particles of the start are of {}: expected some of both", where, all, only));
}

// By the density and temperature of particle i, of the enthalpy law.
template <int D>
void take_up_heat(fluids<D>& f, std::size_t i) {
  auto& s = f.world.w.s;
  const auto& material = (*f.p.material)[f.material_of(i)];
  s.c_V[i] = eos::evaluate(material, s.rho[i], s.T[i]).c_V;
  f.content[i] = f.content_start[i] = contents(f, i, eos::pressure(material, s.rho[i], s.T[i])).enthalpy(s.T[i]);
}

template <int D>
void start_element(fluids<D>& f, std::size_t i) {
  f.element[i] = f.o.element.start(f.is_metal(i));
}

// Of one particle: what its density follows from.
struct asked_for {
  std::optional<double> temperature, density, pressure;  // K, kg/m3, Pa
};

// A row's state of each material (at_pressure).
using states_of_row = std::vector<place>;

// The materials by themselves, as the rows of the start have them (start.hpp).
template <int D>
std::vector<barotropic> curves_of_rows(const fluids<D>& f) {
  std::vector<barotropic> all{f.p.base->lower(), f.is_drop() ? curve_of(f, 1) : f.p.base->upper()};
  for (std::size_t n = all.size(); n < f.o.material.size(); ++n) all.push_back(curve_of(f, n));
  return all;
}

// By the row's states and its pressure.
template <int D>
place state_in_row(const fluids<D>& f, const std::vector<barotropic>& curves, std::size_t i, const asked_for& asked,
                   const states_of_row& row) {
  const std::size_t n = f.material_of(i);
  const auto& material = (*f.p.material)[n];
  place here = row[n];
  if (asked.pressure) here.pressure = *asked.pressure;
  if (asked.temperature) here.temperature = *asked.temperature;
  if (asked.density)
    here.density = *asked.density;
  else if (asked.pressure && !asked.temperature)
    here = at_pressure(curves[n], here.pressure);
  else if (asked.pressure || asked.temperature)
    here.density = eos::density(material, here.pressure, here.temperature);
  return here;
}

// Collective. Of every row, each material at the pressure in its middle: that of the lid, and the weight of half the
// row and of those above, found by repeated substitution, as densities follow from pressures.
template <int D>
std::vector<states_of_row> weighed_rows(const fluids<D>& f, const std::vector<barotropic>& curves,
                                        const std::vector<std::size_t>& row_of, const std::vector<asked_for>& asked) {
  constexpr int most = 200;
  constexpr double tolerance = 1e-12;  // of the largest pressure
  const auto number = static_cast<std::size_t>(f.o.domain.particles[1]);
  const double in_row = static_cast<double>(f.world.fluid_total) / static_cast<double>(number), dx = f.world.w.dx;
  std::vector<double> pressure(number), mean(number);
  for (std::size_t r = 0; r < number; ++r) pressure[r] = f.p.base->at((static_cast<double>(r) + 0.5) * dx).pressure;
  std::vector<states_of_row> rows(number, states_of_row(curves.size()));
  for (int k = 0; k < most; ++k) {
    for (std::size_t r = 0; r < number; ++r)
      for (std::size_t n = 0; n < curves.size(); ++n) rows[r][n] = at_pressure(curves[n], pressure[r]);
    std::vector<foundation::exact_sum> sums(number);
    for (std::size_t i = 0; i < row_of.size(); ++i)
      sums[row_of[i]].add(state_in_row(f, curves, i, asked[i], rows[row_of[i]]).density / in_row);
    foundation::sum_over_ranks(f.ranks().comm, sums, mean);
    double above = f.o.p_top, changed = 0.0, largest = 0.0;  // Pa
    for (std::size_t r = number; r-- > 0;) {
      const double half = 0.5 * dx * f.o.gravity * mean[r], next = above + half;
      changed = std::max(changed, std::abs(next - pressure[r]));
      largest = std::max(largest, std::abs(next));
      pressure[r] = next;
      above = next + half;
    }
    if (changed <= tolerance * largest) return rows;
  }
  foundation::fail_input(
      "&region: the weight above the rows and their densities do not come to agree: they are too soft");
}

// What the densities of the start may be (run/doubts.hpp).
template <int D>
void widen_density_range(fluids<D>& f, const std::vector<states_of_row>& rows) {
  auto& s = f.world.w.s;
  for (std::size_t n = 0; n < f.o.material.size(); ++n) {
    double least = std::numeric_limits<double>::infinity(), largest = 0.0;
    for (const auto& row : rows) {
      least = std::min(least, row[n].density);
      largest = std::max(largest, row[n].density);
    }
    for (std::size_t i = 0; i < s.fluid; ++i) {
      if (f.material_of(i) != n) continue;
      least = std::min(least, s.rho[i]);
      largest = std::max(largest, s.rho[i]);
    }
    f.density_range[n] = {f.ranks().minimum(least), f.ranks().maximum(largest)};
  }
}

template <int D>
void shape_by_regions(fluids<D>& f) {
  auto& s = f.world.w.s;
  std::vector<asked_for> asked(s.fluid);
  std::vector<std::size_t> row_of(s.fluid);
  regions::apply(f.ranks(), f.p.regions, s, [&](std::size_t i, const regions::values& v) {
    row_of[i] = static_cast<std::size_t>(s.x[1][i] / f.world.w.dx);
    asked[i] = {v.temperature, v.density, v.pressure};
    if (v.material) s.material[i] = *v.material;
    if (f.enthalpy && !v.temperature)
      asked[i].temperature = v.material ? f.p.temperature[static_cast<std::size_t>(*v.material)] : s.T[i];
    for (std::size_t a = 0; a < D; ++a)
      if (v.velocity[a]) s.v[a][i] = *v.velocity[a];
  });
  expect_all_materials(f, "&region");
  const auto curves = curves_of_rows(f);
  const auto rows = weighed_rows(f, curves, row_of, asked);
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const place here = state_in_row(f, curves, i, asked[i], rows[row_of[i]]);
    s.rho[i] = f.rho_start[i] = here.density;
    s.m[i] = here.density * std::pow(f.world.w.dx, D);
    s.T[i] = f.T_start[i] = here.temperature;
    if (f.dissolved) start_element(f, i);
    if (f.enthalpy) take_up_heat(f, i);
  }
  widen_density_range(f, rows);
}

}  // namespace tetsuame::two_fluids
