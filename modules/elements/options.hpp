// The group &element: an element that metal and silicate exchange where they touch (docs/theory/partition.md).
#pragma once

#include <namelist/schema.hpp>
#include <string>

namespace tetsuame::elements {

struct options {
  std::string name = "none";
  double partition_coefficient = 10.0;
  double iron_ratio = 14.0;                                    // X_Fe in the metal over X_FeO in the silicate
  double diffusivity_silicate = 1e7, diffusivity_metal = 1e7;  // m2/s
  double concentration_silicate = 1.0, concentration_metal = 0.0;

  bool any() const { return name != "none"; }
  double diffusivity(bool metal) const { return metal ? diffusivity_metal : diffusivity_silicate; }
  double start(bool metal) const { return metal ? concentration_metal : concentration_silicate; }
};

void declare(namelist::schema& schema, options& o);
// Refuses keys that mean nothing here, and an element of which there is nothing.
void check(const namelist::schema& schema, const options& o);

// Metal over silicate at equilibrium, at p (Pa) and T (K) of the metal. Below 1000 K, far from the fits' data, it is
// that of 1000 K.
double partition_coefficient(const options& o, double p, double T);

}  // namespace tetsuame::elements
