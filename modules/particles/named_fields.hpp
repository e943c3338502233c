// Fields that one problem adds to the particles, each declared once: by name, unit, role and number of components. What
// comes back is the field itself, and stays so as long as the particles are there; nobody counts places.
//
//   array& p = declare(s, "DynamicPressure", "Pa", role::integrated);               // p[i]
//   const auto force = declare_vector<D>(s, "ViscousForce", "m/s^2", role::memory);  // force[a][i]
#pragma once

#include <particles/particles.hpp>
#include <utility>

namespace tetsuame::particles {

// The components of a field that stands elsewhere.
template <std::size_t N>
class vector_field {
 public:
  vector_field() = default;
  explicit vector_field(const std::array<array*, N>& components) : components_(components) {}

  array& operator[](std::size_t k) const { return *components_[k]; }
  // Of the values, where they now lie: allocate() moves them.
  std::array<double*, N> data() const {
    std::array<double*, N> all;
    for (std::size_t k = 0; k < N; ++k) all[k] = components_[k]->data();
    return all;
  }

 private:
  std::array<array*, N> components_{};
};

// Before the first particle is there. A name is declared once.
template <int D>
array& declare(particles<D>& s, std::string name, std::string unit, role kind, std::string description = "") {
  for (const auto& e : s.extras)
    if (e.name == name) throw std::logic_error("field " + name + " is declared twice");
  s.extras.push_back({std::move(name), std::move(unit), std::move(description), kind, {}});
  return s.extras.back().values;
}

// Components are called name_0, name_1, …
template <std::size_t N, int D>
vector_field<N> declare_vector(particles<D>& s, const std::string& name, const std::string& unit, role kind,
                               const std::string& description = "") {
  std::array<array*, N> all;
  for (std::size_t k = 0; k < N; ++k) all[k] = &declare(s, name + "_" + std::to_string(k), unit, kind, description);
  return vector_field<N>(all);
}

}  // namespace tetsuame::particles
