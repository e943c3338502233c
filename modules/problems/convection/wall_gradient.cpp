#include <algorithm>
#include <convection/measures.hpp>
#include <limits>
#include <operators/symmetric.hpp>

namespace tetsuame::convection {

void sort(std::vector<near_wall>& samples) {
  std::sort(samples.begin(), samples.end(),
            [](const near_wall& a, const near_wall& b) { return a.t[0] != b.t[0] ? a.t[0] < b.t[0] : a.id < b.id; });
}

namespace {

template <std::size_t N>
double fitted(const std::vector<near_wall>& samples, const std::array<double, 2>& place, double radius) {
  std::array<std::array<double, N>, N> A{};
  std::array<double, N> b{};
  const auto first = std::lower_bound(samples.begin(), samples.end(), place[0] - radius,
                                      [](const near_wall& s, double t) { return s.t[0] < t; });
  for (auto s = first; s != samples.end() && s->t[0] <= place[0] + radius; ++s) {
    const double y = s->y / radius, t = (s->t[0] - place[0]) / radius, z = (s->t[1] - place[1]) / radius;
    const double left = 1.0 - (y * y + t * t + z * z);
    if (left <= 0.0) continue;
    const double y3 = y * y * y;
    std::array<double, N> P;
    if constexpr (N == 6)
      P = {y, y * t, y * t * t, y3, y3 * t, y3 * y * y};
    else
      P = {y, y * t, y * t * t, y3, y3 * t, y3 * y * y, y * z, y * z * z, y * t * z, y3 * z};
    for (std::size_t k = 0; k < N; ++k) {
      const double weighted = left * left * P[k];
      for (std::size_t l = 0; l <= k; ++l) A[k][l] += weighted * P[l];
      b[k] += weighted * s->excess;
    }
  }
  if (!operators::factorise(A)) return std::numeric_limits<double>::quiet_NaN();
  return operators::solve(A, b)[0] / radius;
}

}  // namespace

double wall_gradient(const std::vector<near_wall>& samples, const std::array<double, 2>& place, double radius,
                     int dimension) {
  return dimension == 2 ? fitted<6>(samples, place, radius) : fitted<10>(samples, place, radius);
}

}  // namespace tetsuame::convection
