// Numbers that are none: looked for at one place, for all problems alike. In what is integrated over time and its
// rates, in the fields that each problem declares (particle_simulation.hpp); in any field of the particles' table, by
// its name there.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <integrators/explicit_integrator.hpp>
#include <pairs/workspace.hpp>
#include <particles/named_fields.hpp>
#include <span>
#include <string>
#include <vector>

namespace tetsuame::run {

// Whether the first n values of each array are finite.
bool all_finite(std::span<const double* const> arrays, std::size_t n);

// A component of a field of the table.
struct table_field {
  std::string name;
  const double* values;
  particles::role kind;
};
template <int D>
std::vector<table_field> fields_of_table(const particles::particles<D>& s) {
  std::vector<table_field> all;
  particles::for_each_field<D>(s, [&](const particles::field_info& field, const auto& components) {
    for (std::size_t k = 0; k < components.size(); ++k)
      all.push_back({components.size() == 1 ? field.name : fmt::format("{}_{}", field.name, k), components[k]->data(),
                     field.kind});
  });
  return all;
}

namespace detail {

// Of the values of one field: `before` says what they are, the field itself or its rate.
inline std::string not_finite_text(const std::string& before, const std::string& name, double value) {
  return fmt::format("{}{} is {}, not a finite number", before, name, value);
}

// The derived fields that have such a value at this particle: what its rates follow from.
template <int D>
std::string not_finite_beside(const particles::particles<D>& s, std::size_t i) {
  std::string names;
  for (const auto& [name, values, kind] : fields_of_table(s))
    if (!particles::travels(kind) && !std::isfinite(values[i])) names += (names.empty() ? "" : ", ") + name;
  return names.empty() ? "" : "; nor are its " + names;
}

// The fault of the owned particle of the lowest ID that has such a value.
template <int D>
void report_particle(pairs::workspace<D>& w, std::span<const integrators::field> fields,
                     std::span<const double* const> values, const std::string& before) {
  const auto& s = w.s;
  std::size_t worst = s.fluid, of = 0;
  for (std::size_t k = 0; k < fields.size(); ++k)
    for (std::size_t i = 0; !fields[k].number && i < s.fluid; ++i)
      if (!std::isfinite(values[k][i]) && (worst == s.fluid || s.id[i] < s.id[worst])) worst = i, of = k;
  if (worst == s.fluid) return;
  w.first_fault.report(s.id[worst], not_finite_text(before, fields[of].name, values[of][worst]) + ": " +
                                        pairs::describe_position(s, worst) +
                                        (before.empty() ? "" : not_finite_beside(s, worst)));
}

}  // namespace detail

// values[k]: of field k, itself or its rate, which `before` says. What is not a particle's goes before particles, whose
// motion may follow from it.
template <int D>
void report_not_finite(pairs::workspace<D>& w, std::span<const integrators::field> fields,
                       std::span<const double* const> values, const std::string& before) {
  std::vector<const double*> of_particles;
  for (std::size_t k = 0; k < fields.size(); ++k) {
    if (!fields[k].number) {
      of_particles.push_back(values[k]);
      continue;
    }
    for (std::size_t n = 0; n < *fields[k].number; ++n)
      if (!std::isfinite(values[k][n]))
        w.first_fault.report(0, detail::not_finite_text(before, fields[k].name, values[k][n]));
  }
  if (!all_finite(of_particles, w.s.fluid)) detail::report_particle(w, fields, values, before);
}

// The same of the fields of the table whose role which(role) takes.
template <int D, class Which>
void report_not_finite_in_table(pairs::workspace<D>& w, const Which& which) {
  std::vector<integrators::field> fields;
  std::vector<const double*> values;
  for (const auto& field : fields_of_table(w.s)) {
    if (!which(field.kind)) continue;
    fields.push_back({field.name, nullptr});
    values.push_back(field.values);
  }
  report_not_finite<D>(w, fields, values, "");
}

}  // namespace tetsuame::run
