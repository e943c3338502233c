// What the files of tests share.
#pragma once

#include <gas/setups.hpp>

namespace tetsuame::gas {

// An even lattice of about this spacing.
block lattice(const options& o, const point& low, const point& high, double spacing);
block whole_box(const options& o);
// The spacing with which gas of density rho has particles of the mass they have on the start lattice at rho_lattice.
double spacing_of(const options& o, double rho, double rho_lattice);
double distance(const point& a, const point& b);

// What a test of a growing wave tells: the rate of theory and its own, of the wave k (1/m) near the layers at these
// heights (m).
void compare_growth(double growth, double k, std::vector<double> heights, setup& t);

// The same with heavy liquid over light liquid, and displacement η: velocity (perturbation) cos kx S(d) of the wave of
// an incompressible sharp interface at half the height H, S = sinh k(H/2 - |d|)/sinh kH/2, η = velocity/growth.
struct interface_wave {
  double k, H, speed, growth;  // 1/m, m, m/s, 1/s
  struct motion {
    double u, v, displacement;  // m/s, m/s, m
  };
  motion at(const point& x) const;
};
double wave_number(const options& o);

// Tests of materials with equations of state: setups_of_materials.cpp.
setup overturn(const options& o);
setup shear(const options& o);
setup impact(const options& o);

// setup_of_collapse.cpp
setup collapse(const options& o);
void resolve_collapse(const namelist::schema& schema, options& o);  // checks, open sides, and G = 1

// setup_of_viscous_shock.cpp
setup viscous_shock(const options& o);

// setup_of_regions.cpp: a start that &region changes, and what such a start has no more.
setup with_regions(const options& o, setup test);
void forget_solution(setup& test);

}  // namespace tetsuame::gas
