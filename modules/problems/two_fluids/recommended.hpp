// How far sound and inertia of two layers may be slowed: by linear theory, whose growth rate with both is known
// (docs/theory/slowed_layers.md).
#pragma once

#include <two_fluids/options.hpp>

namespace tetsuame::two_fluids {

// What rules it, of the layers as they are.
struct slowing_scales {
  double dynamic_pressure;              // Δρ g L/2K: of the overturn, over the smaller modulus at the contact
  std::array<double, 2> inertia_share;  // γ ρ/(η k²), lower and upper: inertia over friction in the growing mode
  double speed;                         // m/s, some L γ/4
  double sound;                         // m/s, the faster one at the contact
};
slowing_scales slowing_scales_of(const options& o, const parameters& p);

// Of the growth rate, by slowed sound and inertia: 0 where neither is.
double growth_error(const options& o, const parameters& p, const slowing_options& slowed);

struct recommended_slowing {
  slowing_options slowing;
  double error, error_of_sound, error_of_inertia;  // of the growth rate: both, each by itself
  double step, step_as_is;                         // s, explicit, on the input's lattice
  double sound_as_is, viscous_as_is;               // s, what each by itself allows where nothing is slowed
};

// Each by itself as far as the tolerance goes, a common ξ.
slowing_options widest_slowing(const options& o, const parameters& p, double tolerance);

// The longest step of the input's method (stabilised ones take steps of sound) with errors of the growth rate by sound
// and by inertia, of whatever sign, that make no more than `tolerance` together. A common ξ where viscosities are
// equal, else that by which both materials have the same η/(ξ²ρ). fail_input where there is no growth rate.
recommended_slowing recommend_slowing(const options& o, const parameters& p, double tolerance);

}  // namespace tetsuame::two_fluids
