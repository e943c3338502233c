// A material whose internal energy holds latent heat of fusion: u = u_EOS(ρ, T) + L f, with the melt fraction f between
// solidus and liquidus at the pressure of ρ and u - L f. Its pressure and sound are the equation of state's at that
// energy: melt has the density of the solid, and sound passes before anything melts.
#pragma once

#include <eos/caloric.hpp>
#include <melting/options.hpp>

namespace tetsuame::melting {

// J/kg. rho kg/m3, T K.
double internal_energy(const eos::caloric& material, const options& o, double rho, double T);

// Of rho (kg/m3) and u (J/kg), to 1e-12. Not a number where the equation of state has no such state, or the liquidus is
// not above the solidus at its pressure.
double melt_fraction(const eos::caloric& material, const options& o, double rho, double u);

}  // namespace tetsuame::melting
