// Particles as a structure of arrays, one array a scalar component, and the table
// that says of each field what it is. A new field is one member and one line of the
// table: sorting, migration, checkpoints and snapshots go by the table.
//
// Local order:   [0, fluid)            fluid this rank owns: the state of the time integration
//                [.., + fluid_ghosts)  copies of fluid beyond the rank's or the periodic border
//                [.., + walls)         wall particles this rank owns
//                [.., + wall_ghosts)   copies of wall particles
//                one null particle     pads neighbour lists: far away, with no volume
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace tetsuame::particles {

// Cache-line aligned, so that loops over whole arrays start on a full SIMD register.
template <class T>
struct aligned_allocator {
  using value_type = T;
  static constexpr std::align_val_t alignment{64};
  aligned_allocator() = default;
  template <class U>
  aligned_allocator(const aligned_allocator<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), alignment)); }
  void deallocate(T* p, std::size_t) { ::operator delete(p, alignment); }
  template <class U>
  bool operator==(const aligned_allocator<U>&) const {
    return true;
  }
};

using array = std::vector<double, aligned_allocator<double>>;

enum class role {
  integrated,  // part of the state the time integration carries
  constant,    // given at the start, travels with the particle
  memory,      // travels with the particle from one evaluation to the next (start values of an iteration)
  derived,     // recomputed in every evaluation
};

// A field that only one problem has, beside those below: what declare() is told of it, and its values.
struct extra_field {
  std::string name, unit, description;
  role kind = role::memory;
  array values;  // of all particles and the null particle
};

template <int D>
struct particles {
  std::size_t fluid = 0, fluid_ghosts = 0, walls = 0, wall_ghosts = 0;

  std::vector<std::int64_t> id;        // global; fluid first, wall particles after them
  std::vector<std::int32_t> material;  // index into the materials of the run

  std::array<array, D> x;  // m
  std::array<array, D> v;  // m/s
  array rho;               // kg/m3
  array T;                 // K
  array Y;                 // J, DISPH weight p dV
  array u;                 // J/kg, internal energy gained since the start

  array m;                       // kg
  array eta;                     // Pa s
  array k;                       // W/(m K)
  std::array<array, D> x_list;   // m, where the particle was when the neighbour lists were made
  std::array<array, D> x_start;  // m, moved along when a periodic border is crossed; where keeps_start is set
  bool keeps_start = false;      // set before the first particle is there

  array p_eos;  // Pa, p^(rho, T), straight from the equation of state
  array p;      // Pa, what the forces use: smoothed, or p^
  array dV;     // m^D, volume element Y/p
  array K_T;    // Pa
  array alpha;  // 1/K
  array c_V;    // J/(kg K)
  array c;      // m/s, sound speed

  // Declared by the problem (named_fields.hpp), and stay where they are; not in snapshots.
  std::deque<extra_field> extras;

  std::size_t first_wall() const { return fluid + fluid_ghosts; }
  std::size_t total() const { return fluid + fluid_ghosts + walls + wall_ghosts; }
  std::size_t null() const { return total(); }
};

template <int D>
std::array<double, D> position(const std::array<array, D>& x, std::size_t i) {
  std::array<double, D> point;
  for (std::size_t a = 0; a < D; ++a) point[a] = x[a][i];
  return point;
}

// The problem's own field of that name, which must be there.
template <class P>
auto& extra(P& s, std::string_view name) {
  for (auto& e : s.extras)
    if (e.name == name) return e.values;
  throw std::logic_error("field " + std::string(name) + " is not declared");
}

struct field_info {
  const char* name;  // in checkpoints
  role kind;
};

// Visits every field: f(field_info, arrays of its components).
template <int D, class P, class F>
void for_each_field(P& s, F&& f) {
  using list = std::vector<decltype(&s.rho)>;
  const auto components = [](auto& a) {
    list all;
    for (auto& component : a) all.push_back(&component);
    return all;
  };
  using enum role;
  f(field_info{"Coordinates", integrated}, components(s.x));
  f(field_info{"Velocities", integrated}, components(s.v));
  f(field_info{"Density", integrated}, list{&s.rho});
  f(field_info{"Temperature", integrated}, list{&s.T});
  f(field_info{"Weight", integrated}, list{&s.Y});
  f(field_info{"InternalEnergyGain", integrated}, list{&s.u});
  f(field_info{"Masses", constant}, list{&s.m});
  f(field_info{"Viscosity", constant}, list{&s.eta});
  f(field_info{"Conductivity", constant}, list{&s.k});
  if (s.keeps_start) f(field_info{"StartCoordinates", constant}, components(s.x_start));
  f(field_info{"ListCoordinates", memory}, components(s.x_list));
  f(field_info{"PressureEOS", derived}, list{&s.p_eos});
  f(field_info{"Pressure", derived}, list{&s.p});
  f(field_info{"Volume", derived}, list{&s.dV});
  f(field_info{"BulkModulus", derived}, list{&s.K_T});
  f(field_info{"ThermalExpansivity", derived}, list{&s.alpha});
  f(field_info{"HeatCapacity", derived}, list{&s.c_V});
  f(field_info{"SoundSpeed", derived}, list{&s.c});
  for (auto& e : s.extras) f(field_info{e.name.c_str(), e.kind}, list{&e.values});
}

// A particle's own data: what moves with it between ranks and stands in a checkpoint.
inline bool travels(role kind) { return kind != role::derived; }

}  // namespace tetsuame::particles
