// What the tests of water share: an input as a scene of its own.
#pragma once

#include <cmath>
#include <cstdint>
#include <free_surface/passes.hpp>
#include <namelist/document.hpp>
#include <optional>
#include <string>

#include "../support/mpi.hpp"

namespace tetsuame::free_surface {

using test::mpi_environment;

// An input, and what begins with it, with lists.
template <int D>
struct scene {
  options o;
  parameters p;
  std::optional<water<D>> f;

  explicit scene(const std::string& text) {
    namelist::schema schema;
    declare(schema, o);
    schema.read(namelist::parse_text(text, "test.nml"));
    p = resolve(schema, o);
    f.emplace(o, p);
    set_up(*f);
    free_surface::declare(*f);
    rebuild();
  }
  void rebuild() {
    place_bodies_for_lists(*f, false);
    run::rebuild(f->world, false);
    particles::clear_derived(particles());
    find_beside_bodies(*f);
    find_rows_beside(*f);
    group_walls(*f);
  }
  particles::particles<D>& particles() { return f->world.w.s; }

  // Rates of x, v, ρ, of free bodies, and of what is counted of loads.
  std::vector<particles::array> rates() {
    std::vector<particles::array> all(2 * D + 1, particles::array(particles().fluid, 0.0));
    for (const auto& component : f->free.state)
      if (!f->free.empty()) all.emplace_back(component.size(), 0.0);
    for (const auto* numbers : counted_numbers(*f)) all.emplace_back(numbers->size(), 0.0);
    std::vector<double*> places;
    for (auto& a : all) places.push_back(a.data());
    f->rates.run(places);
    return all;
  }
  template <class Value>
  double sum(Value&& value) {
    foundation::exact_sum all;
    for (std::size_t i = 0; i < particles().fluid; ++i) all.add(value(i));
    return f->ranks().exact(all);
  }
};

// Two metres square, of forty spacings.
inline std::string tank(const std::string& flow, const std::string& more = "") {
  return "&domain length_x = 2.0 length_y = 2.0 particles_x = 40 particles_y = 40 " + more + "/ &flow " + flow +
         " / &time t_end = 1.0 /";
}

// Within [-1, 1], of a particle's number.
inline double noise(std::int64_t id, int salt) { return std::sin(static_cast<double>(id) * 12.9898 + 78.233 * salt); }

// Velocities of some m/s, densities some per cent apart.
inline void disturb(scene<2>& scene) {
  auto& s = scene.particles();
  for (std::size_t i = 0; i < s.fluid; ++i) {
    for (std::size_t a = 0; a < 2; ++a) s.v[a][i] = noise(s.id[i], static_cast<int>(a) + 1);
    s.rho[i] *= 1.0 + 0.02 * noise(s.id[i], 3);
  }
}

}  // namespace tetsuame::free_surface
