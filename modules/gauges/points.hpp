// What points read of the fluid about them (docs/theory/gauges.md): the fit of first order to the particles whose
// supports hold the point X,
//   f(X) = f̄ - (x̄ - X)·C⁻¹ c,   weights w_j = V_j W(|x_j - X|, h_j), V_j = m_j/ρ_j
// with the weighted means f̄ of the field and x̄ of the places, the covariances C of the places, c of places and field.
// A field that is linear is read as it is, beside walls as within. Where so few particles are near that they do not
// determine the slope, it is f̄; 0 where there are none.
//
// The sums are exact: the same bits on any number of ranks.
#pragma once

#include <domain/decomposition.hpp>
#include <gauges/options.hpp>
#include <kernels/kernel.hpp>
#include <output/groups.hpp>

namespace tetsuame::gauges {

// Collective. fluid: as in snapshots. Without Masses or Density in it volumes are equal, without SmoothingLength h is
// the kernel's.
template <int D>
std::vector<double> read(const options& o, const output::particle_group& fluid, const domain::box<D>& region,
                         const kernels::any<D>& kernel, const domain::communicator& ranks);

}  // namespace tetsuame::gauges
