// Self-gravity by a sum over all pairs of particles: what the tree is measured against.
#pragma once

#include <cstddef>
#include <gravity/cloud.hpp>

namespace tetsuame::gravity {

// Acceleration (m/s²) and potential (J/kg) of the particles [first, last) of the cloud, written to [0, last - first) of
// `to`; gravitational_constant in m³/(kg s²). Throws as tree does.
template <int D>
void direct(const cloud<D>& particles, double gravitational_constant, std::size_t first, std::size_t last,
            const field<D>& to);

extern template void direct<2>(const cloud<2>&, double, std::size_t, std::size_t, const field<2>&);
extern template void direct<3>(const cloud<3>&, double, std::size_t, std::size_t, const field<3>&);

}  // namespace tetsuame::gravity
