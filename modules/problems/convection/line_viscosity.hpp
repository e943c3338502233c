// Viscosity of the line between two particles. Its fluidity 1/ν_ij is the mean of 1/ν along the line, by Simpson's rule
// with (ν_i ν_j)^½ in the middle:
//   6/ν_ij = 1/ν_i + 4/(ν_i ν_j)^½ + 1/ν_j
// A stress that is common to the line then shears it as it should: with the mean itself the sum of forces is right for
// every stress that grows linearly across an exponential ν, whatever the contrast. And ν_ij/ν_i stays below 6, while
// with ν_ij = (ν_i ν_j)^½ a single stiff neighbour outweighs all the others.
#pragma once

namespace tetsuame::convection {

// ν_ij/ν_i, of ν^½ of i and of j.
template <class real>
inline real line_viscosity(const real& mine, const real& other) {
  const real nu_j = other * other;
  return 6.0 * nu_j / (mine * mine + 4.0 * mine * other + nu_j);
}

}  // namespace tetsuame::convection
