// What mirror images hold: every field has a rule by which the value of an image follows from its source's.
//
//   even          the source's value: mass, density, volume
//   signed_by_axes   a component of a vector or tensor changes its sign once for each of its axes that lies across the
//                 mirror: the gradient of an even field, the velocity at a wall of free slip
//   velocity      the image of a velocity: at a wall of no slip 2 u_wall - v, at one of free slip the component across
//                 the wall changes its sign
//   temperature   2 T_wall - T where the wall's temperature is fixed, else even
//   odd_temperature   of its Laplacian: changes its sign where the wall's temperature is fixed
//   hydrostatic   a pressure that holds fluid at rest, p + ρ g·(x_image - x_source); a weight Y by m in the place of ρ
//
// Behind an edge or a corner one mirror follows the other.
#pragma once

#include <bit>
#include <initializer_list>
#include <walls/mirror.hpp>

namespace tetsuame::walls {

// An image: its number, its local index and that of its source.
struct image {
  std::size_t number, i, j;
};

// f(image) of the images [first, last).
template <int D, class F>
void for_each_image(const wall_set<D>& set, const particles::particles<D>& s, std::size_t first, std::size_t last,
                    const F& f) {
  const std::size_t images_begin = s.first_wall() + set.body_particles;
  foundation::for_all(last - first, [&](std::size_t k) {
    f(image{first + k, images_begin + first + k, set.source[first + k]});
  });
}
template <int D, class F>
void for_each_image(const wall_set<D>& set, const particles::particles<D>& s, const F& f) {
  for_each_image(set, s, 0, set.source.size(), f);
}

// Bit a: an odd number of mirrors across axis a made the image r.
template <int D>
unsigned axes_across(const wall_set<D>& set, std::size_t r) {
  unsigned axes = 0;
  for_each_mirror(set, r, [&](const side<D>& wall) { axes ^= 1U << wall.axis; });
  return axes;
}

// How a field goes on behind a mirror: one of the rules above, as data.
enum class parity { even, signed_by_axes, velocity, temperature, odd_temperature, hydrostatic };

struct mirrored {
  particles::array* values;
  parity by = parity::even;
  unsigned axes = 0;                          // signed_by_axes: bit a, axis a
  std::size_t component = 0;                  // velocity: along this axis
  bool sticks = true;                         // velocity: at walls of no slip; else all of them let slip
  const particles::array* density = nullptr;  // hydrostatic: kg/m3, or kg
  const double* g = nullptr;                  // hydrostatic: m/s2, a number an axis, looked at when images are filled
  std::array<const particles::array*, 3> accelerations{};  // hydrostatic: in the place of g, where sources differ
};
using mirrored_fields = std::vector<mirrored>;

inline mirrored_fields even(std::initializer_list<particles::array*> fields) {
  mirrored_fields all;
  for (auto* field : fields) all.push_back({field});
  return all;
}
// The components of a vector.
template <class Components>
mirrored_fields vector(Components& components) {
  mirrored_fields all;
  for (std::size_t a = 0; a < components.size(); ++a)
    all.push_back({.values = &components[a], .by = parity::signed_by_axes, .axes = 1U << a});
  return all;
}
template <class Components>
mirrored_fields velocity(Components& components, bool sticks = true) {
  mirrored_fields all;
  for (std::size_t a = 0; a < components.size(); ++a)
    all.push_back({.values = &components[a], .by = parity::velocity, .component = a, .sticks = sticks});
  return all;
}
inline mirrored_fields temperature(particles::array& T) { return {{.values = &T, .by = parity::temperature}}; }
// Of what is odd where the temperature less the wall's is: its Laplacian.
inline mirrored_fields odd_temperature(particles::array& values) {
  return {{.values = &values, .by = parity::odd_temperature}};
}
// p: Pa, or J.
template <std::size_t D>
mirrored_fields hydrostatic(particles::array& p, const particles::array& density, const std::array<double, D>& g) {
  return {{.values = &p, .by = parity::hydrostatic, .density = &density, .g = g.data()}};
}
// By the gravity of the workspace, whichever it has.
template <int D>
mirrored_fields hydrostatic(particles::array& p, const particles::array& density, const pairs::workspace<D>& w) {
  auto all = hydrostatic(p, density, w.g);
  for (std::size_t a = 0; a < D && w.gravity_varies; ++a) all.front().accelerations[a] = &w.accelerations[a];
  return all;
}

// The value of an image, by its source's. A fixed flux of heat counts as none here.
template <int D>
double image_value(const wall_set<D>& set, const particles::particles<D>& s, const mirrored& field, const image& of) {
  double value = (*field.values)[of.j];
  switch (field.by) {
    case parity::even:
      break;
    case parity::signed_by_axes:
      if (std::popcount(axes_across(set, of.number) & field.axes) % 2 != 0) value = -value;
      break;
    case parity::velocity:
      for_each_mirror(set, of.number, [&](const side<D>& wall) {
        value = reflected_component(wall, field.sticks, field.component, value);
      });
      break;
    case parity::temperature:
      value = mirror_temperature(set, of.number, value);
      break;
    case parity::odd_temperature:
      for_each_mirror(set, of.number, [&](const side<D>& wall) {
        if (wall.thermal == heat::fixed_temperature) value = -value;
      });
      break;
    case parity::hydrostatic:
      for (std::size_t a = 0; a < D; ++a) {
        const double g = field.accelerations[a] != nullptr ? (*field.accelerations[a])[of.j] : field.g[a];
        if (g != 0.0) value += (*field.density)[of.j] * g * (s.x[a][of.i] - s.x[a][of.j]);
      }
      break;
  }
  return value;
}

// The images [first, last) of these fields, whose sources are up to date.
template <int D>
void fill_image_range(const wall_set<D>& set, const particles::particles<D>& s, std::size_t first, std::size_t last,
                      const mirrored_fields& fields) {
  for_each_image(set, s, first, last, [&](const image& of) {
    for (const auto& field : fields) (*field.values)[of.i] = image_value(set, s, field, of);
  });
}
template <int D>
void fill_images(const wall_set<D>& set, const particles::particles<D>& s, const mirrored_fields& fields) {
  fill_image_range(set, s, 0, set.source.size(), fields);
}

// Collective. Ghosts of these fields, then images.
template <int D>
void update_ghosts_and_images(const pairs::workspace<D>& w, const wall_set<D>& set, const mirrored_fields& fields) {
  std::vector<double*> arrays;
  for (const auto& field : fields) arrays.push_back(field.values->data());
  domain::exchange<D>(w.d.ranks, w.d.fluid_halo, std::span<double* const>(arrays));
  fill_images(set, w.s, fields);
}

}  // namespace tetsuame::walls
