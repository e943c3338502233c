// What mirror images hold: every field has a rule by which the value of an image follows from its source's.
//
//   even          the source's value: mass, density, volume
//   signed        a component of a vector or tensor changes its sign once for each of its axes that lies across the
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

// Fields that change their sign for each axis of `along` (bits) that lies across the mirror.
struct signed_field {
  double* values;
  unsigned along;
};
struct signed_fields {
  std::vector<signed_field> all;

  template <int D>
  void operator()(const wall_set<D>& set, const particles::particles<D>&, const image& of) const {
    const unsigned across = axes_across(set, of.number);
    for (const auto& f : all) {
      const double value = f.values[of.j];
      f.values[of.i] = std::popcount(across & f.along) % 2 == 0 ? value : -value;
    }
  }
  template <class F>
  void each_array(const F& f) const {
    for (const auto& one : all) f(one.values);
  }
};
inline signed_fields even(std::initializer_list<particles::array*> fields) {
  signed_fields rule;
  for (auto* field : fields) rule.all.push_back({field->data(), 0});
  return rule;
}
// The components of a vector.
template <class Components>
signed_fields vector(Components& components) {
  signed_fields rule;
  for (std::size_t a = 0; a < components.size(); ++a) rule.all.push_back({components[a].data(), 1U << a});
  return rule;
}

// sticks: at walls of no slip; else all of them let slip.
template <int D>
struct velocity {
  std::array<double*, D> v;
  bool sticks = true;

  template <class Components>
  explicit velocity(Components& components, bool with_no_slip = true) : sticks(with_no_slip) {
    for (std::size_t a = 0; a < D; ++a) v[a] = components[a].data();
  }
  void operator()(const wall_set<D>& set, const particles::particles<D>&, const image& of) const {
    std::array<double, D> value;
    for (std::size_t a = 0; a < D; ++a) value[a] = v[a][of.j];
    for_each_mirror(set, of.number, [&](const side<D>& wall) { reflect_velocity<D>(wall, sticks, value); });
    for (std::size_t a = 0; a < D; ++a) v[a][of.i] = value[a];
  }
  template <class F>
  void each_array(const F& f) const {
    for (double* component : v) f(component);
  }
};

struct temperature {
  double* T;  // K

  template <int D>
  void operator()(const wall_set<D>& set, const particles::particles<D>&, const image& of) const {
    T[of.i] = mirror_temperature(set, of.number, T[of.j]);
  }
  template <class F>
  void each_array(const F& f) const {
    f(T);
  }
};

// What is odd where the temperature less the wall's is: its Laplacian.
struct odd_temperature {
  double* values;

  template <int D>
  void operator()(const wall_set<D>& set, const particles::particles<D>&, const image& of) const {
    double value = values[of.j];
    for_each_mirror(set, of.number, [&](const side<D>& wall) {
      if (wall.thermal == heat::fixed_temperature) value = -value;
    });
    values[of.i] = value;
  }
  template <class F>
  void each_array(const F& f) const {
    f(values);
  }
};

template <int D>
struct hydrostatic {
  double* p;                // Pa, or J
  const double* density;    // kg/m3, or kg
  std::array<double, D> g;  // m/s2

  void operator()(const wall_set<D>&, const particles::particles<D>& s, const image& of) const {
    double value = p[of.j];
    for (std::size_t a = 0; a < D; ++a)
      if (g[a] != 0.0) value += density[of.j] * g[a] * (s.x[a][of.i] - s.x[a][of.j]);
    p[of.i] = value;
  }
  template <class F>
  void each_array(const F& f) const {
    f(p);
  }
};

// The images [first, last) of these fields, whose sources are up to date. Rules that read each other's images, or
// places, stand behind them.
template <int D, class... Rules>
void fill_image_range(const wall_set<D>& set, const particles::particles<D>& s, std::size_t first, std::size_t last,
                      const Rules&... rules) {
  for_each_image(set, s, first, last, [&](const image& of) { (rules(set, s, of), ...); });
}
template <int D, class... Rules>
void fill_images(const wall_set<D>& set, const particles::particles<D>& s, const Rules&... rules) {
  fill_image_range(set, s, 0, set.source.size(), rules...);
}

// Collective. Ghosts of these fields, then images.
template <int D, class... Rules>
void update_ghosts_and_images(const pairs::workspace<D>& w, const wall_set<D>& set, const Rules&... rules) {
  std::vector<double*> fields;
  (rules.each_array([&](double* a) { fields.push_back(a); }), ...);
  domain::exchange<D>(w.d.ranks, w.d.fluid_halo, std::span<double* const>(fields));
  fill_images(set, w.s, rules...);
}

}  // namespace tetsuame::walls
