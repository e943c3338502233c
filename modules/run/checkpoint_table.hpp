// Particles as checkpoints see them.
#pragma once

#include <foundation/error.hpp>
#include <output/checkpoint.hpp>
#include <particles/storage.hpp>

namespace tetsuame::run {

// Every travelling field of the fluid, as a checkpoint's table. Component names: Velocities_0, …
template <int D>
output::table_view checkpoint_table(const particles::particles<D>& s, std::vector<std::int64_t>& materials) {
  output::table_view t{"fluid", s.fluid, s.id.data(), {}, {}};
  particles::for_each_field<D>(s, [&](const particles::field_info& field, const auto& components) {
    if (!particles::travels(field.kind)) return;
    for (std::size_t k = 0; k < components.size(); ++k)
      t.reals.emplace_back(std::string(field.name) + "_" + std::to_string(k), components[k]->data());
  });
  materials.assign(s.material.begin(), s.material.begin() + static_cast<std::ptrdiff_t>(s.fluid));
  t.integers.emplace_back("Material", materials.data());
  return t;
}

// The reverse: fluid as the checkpoint's rows lie, the walls kept. may_lack(name): of a field that is zero where the
// checkpoint lacks it, as one that was written with another method of time integration does.
template <int D>
void fluid_from_checkpoint(
    const output::table& t, particles::particles<D>& s,
    bool (*may_lack)(std::string_view) = [](std::string_view) { return false; }) {
  particles::allocate(s, t.ids.size(), 0, s.walls, 0);
  std::copy(t.ids.begin(), t.ids.end(), s.id.begin());
  particles::for_each_field<D>(s, [&](const particles::field_info& field, const auto& components) {
    if (!particles::travels(field.kind)) return;
    for (std::size_t k = 0; k < components.size(); ++k) {
      const auto found = t.reals.find(std::string(field.name) + "_" + std::to_string(k));
      if (found != t.reals.end())
        std::copy(found->second.begin(), found->second.end(), components[k]->begin());
      else if (may_lack(field.name))
        std::fill_n(components[k]->begin(), s.fluid, 0.0);
      else
        foundation::fail_file(std::string("the checkpoint has no field ") + field.name);
    }
  });
  const auto& materials = t.integers.at("Material");
  for (std::size_t i = 0; i < materials.size(); ++i) s.material[i] = static_cast<std::int32_t>(materials[i]);
}

}  // namespace tetsuame::run
