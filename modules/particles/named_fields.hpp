// Fields that one problem adds to the particles. A field is declared once: by the name that errors and checkpoints call
// it, its unit, its role and number of components; the role says whether it moves with the particle and stands in
// checkpoints and hashes (travels()). The table then owns its values: they have room for all four blocks, and are 0 at
// the null particle. What comes back is the field itself, and stays so as long as the particles are there.
//
//   array& p = declare(s, "DynamicPressure", "Pa", role::integrated);                // p[i]
//   const auto force = declare_vector<D>(s, "ViscousForce", "m/s^2", role::memory);  // force[a][i]
//   array& melt = declare_if(melts, s, "MeltFraction", "1", role::derived);          // no values unless the run melts
#pragma once

#include <foundation/threads.hpp>
#include <particles/particles.hpp>
#include <utility>

namespace tetsuame::particles {

// The components of a field that stands elsewhere.
template <std::size_t N>
class vector_field {
 public:
  vector_field() = default;
  explicit vector_field(const std::array<array*, N>& components) : components_(components) {}

  static constexpr std::size_t size() { return N; }
  array& operator[](std::size_t k) const { return *components_[k]; }
  const std::array<array*, N>& fields() const { return components_; }
  // Where the values lie until the next allocate(), to be written or read; null of a field that the run lacks.
  std::array<double*, N> data() const {
    std::array<double*, N> all;
    for (std::size_t k = 0; k < N; ++k) all[k] = components_[k]->data();
    return all;
  }
  std::array<const double*, N> read() const {
    std::array<const double*, N> all;
    for (std::size_t k = 0; k < N; ++k) all[k] = components_[k]->data();
    return all;
  }

 private:
  std::array<array*, N> components_{};
};

// A name is declared once. Values of particles that are there already are 0.
template <int D>
array& declare(particles<D>& s, std::string name, std::string unit, role kind, std::string description = "") {
  for (const auto& e : s.extras)
    if (e.name == name) throw std::logic_error("field " + name + " is declared twice");
  s.extras.push_back({std::move(name), std::move(unit), std::move(description), kind, array(s.id.size(), 0.0)});
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

// A field of some runs. The others have in its place one without values, which nobody may read.
inline array& no_values() {
  static array none;
  return none;
}
template <int D>
array& declare_if(bool needed, particles<D>& s, const char* name, const char* unit, role kind,
                  const char* description = "") {
  return needed ? declare(s, name, unit, kind, description) : no_values();
}
template <std::size_t N, int D>
vector_field<N> declare_vector_if(bool needed, particles<D>& s, const char* name, const char* unit, role kind,
                                  const char* description = "") {
  if (needed) return declare_vector<N>(s, name, unit, kind, description);
  std::array<array*, N> none;
  none.fill(&no_values());
  return vector_field<N>(none);
}

// Sets all derived fields that problems have declared to 0, as after new lists, whose particles are others.
template <int D>
void clear_derived(particles<D>& s) {
  for (auto& e : s.extras)
    if (e.kind == role::derived) foundation::for_all(e.values.size(), [&](std::size_t i) { e.values[i] = 0.0; });
}

}  // namespace tetsuame::particles
