// The group &melting: where silicate melts, and what its viscosity is by temperature and melt fraction.
#pragma once

#include <array>
#include <namelist/schema.hpp>
#include <string>

namespace tetsuame::melting {

struct options {
  std::string curve = "none";
  std::string composition = "peridotitic";
  double solidus = 1661.2, liquidus = 1982.1;  // K, curve 'constant'
  double latent_heat = 4e5;                    // J/kg
  std::string viscosity_law = "blended";
  double viscosity_min = 1e11, viscosity_max = 1e16;  // Pa s
  double inertia_viscosity = 0.0;                     // Pa s; 0: inertia as it is

  bool melts() const { return curve != "none"; }
  bool viscosity_varies() const { return melts() && viscosity_law != "constant"; }
  // What the acceleration is divided by, ξ² (docs/theory/melting.md).
  double inertia(double viscosity) const {
    return inertia_viscosity > 0.0 && viscosity > inertia_viscosity ? viscosity / inertia_viscosity : 1.0;
  }
};

// of: which materials melt, in a phrase.
void declare(namelist::schema& schema, const std::string& of, options& o);
// Refuses keys that mean nothing here. Where nothing melts there is no latent heat then, and no law of viscosity.
void check(const namelist::schema& schema, options& o);

// Solidus and liquidus (K) at p (Pa); below 0 Pa, where the fits end, those of 0.
std::array<double, 2> range(const options& o, double p);
// Pa s, of law 'blended' or 'suspension' between its limits; T in K.
double viscosity(const options& o, double T, double melt_fraction);

}  // namespace tetsuame::melting
