// The smallest eigenvalue of a symmetric matrix, given as xx, xy, yy or xx, xy, xz, yy, yz, zz. Three dimensions: the
// trigonometric solution of the cubic [O. K. Smith, Commun. ACM 4, 168 (1961)].
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace tetsuame::free_surface {

inline double smallest_eigenvalue(const std::array<double, 3>& M) {
  return 0.5 * (M[0] + M[2]) - std::hypot(0.5 * (M[0] - M[2]), M[1]);
}

inline double smallest_eigenvalue(const std::array<double, 6>& M) {
  const double mean = (M[0] + M[3] + M[5]) / 3.0, a = M[0] - mean, d = M[3] - mean, f = M[5] - mean;
  const double b = M[1], c = M[2], e = M[4];
  const double squares = a * a + d * d + f * f + 2.0 * (b * b + c * c + e * e);
  if (!(squares > 0.0)) return mean;
  const double size = std::sqrt(squares / 6.0);
  const double determinant = a * (d * f - e * e) - b * (b * f - c * e) + c * (b * e - c * d);
  const double cosine = std::clamp(0.5 * determinant / (size * size * size), -1.0, 1.0);
  return mean + 2.0 * size * std::cos((std::acos(cosine) + 2.0 * std::numbers::pi) / 3.0);
}

}  // namespace tetsuame::free_surface
