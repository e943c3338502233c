// Fields of particles at other places: least squares of a polynomial of second degree about the place,
//   f(x) = a + b·(x - place) + (x - place)·c (x - place),  weights (1 - r²/radius²)²;  a is the value
// Ghosts and images take part, with the values that they have: what a wall asks of a field the interpolated one has
// too. Sums run in the order of cells and IDs, so that the result does not depend on ranks.
#pragma once

#include <cells/grid.hpp>
#include <operators/symmetric.hpp>
#include <optional>
#include <particles/storage.hpp>
#include <vector>

namespace tetsuame::convection {

template <int D>
class interpolation {
 public:
  // radius: m; no more than the width in which ghosts and images stand.
  interpolation(const particles::particles<D>& s, double radius)
      : s_(s), radius_(radius), grid_(cells::make_grid<D>(s.x, s.id, s.total(), cells::cell_edge(radius))) {}

  // Values of the fields f, which reach over fluid, ghosts and images, at the place; none where too few particles are
  // near.
  template <std::size_t K>
  std::optional<std::array<double, K>> operator()(const std::array<double, D>& place,
                                                  const std::array<const double*, K>& f) const {
    std::array<std::array<double, terms>, terms> A{};
    std::array<std::array<double, terms>, K> b{};
    std::vector<std::uint32_t> near;
    cells::for_each_near<D>(grid_, place, radius_, [&](std::uint32_t k, std::uint32_t bits) {
      for (; bits != 0; bits &= bits - 1U) near.push_back(grid_.members[k + std::countr_zero(bits)]);
    });
    for (const std::uint32_t j : near) {
      std::array<double, D> r;
      double left = 1.0;
      for (std::size_t a = 0; a < D; ++a) {
        r[a] = (s_.x[a][j] - place[a]) / radius_;
        left -= r[a] * r[a];
      }
      if (left <= 0.0) continue;
      std::array<double, terms> P;
      P[0] = 1.0;
      std::size_t n = 1;
      for (std::size_t a = 0; a < D; ++a) P[n++] = r[a];
      for (std::size_t a = 0; a < D; ++a)
        for (std::size_t c = a; c < D; ++c) P[n++] = r[a] * r[c];
      for (std::size_t k = 0; k < terms; ++k) {
        const double weighted = left * left * P[k];
        for (std::size_t l = 0; l <= k; ++l) A[k][l] += weighted * P[l];
        for (std::size_t m = 0; m < K; ++m) b[m][k] += weighted * f[m][j];
      }
    }
    if (!operators::factorise(A)) return std::nullopt;
    std::array<double, K> values;
    for (std::size_t m = 0; m < K; ++m) values[m] = operators::solve(A, b[m])[0];
    return values;
  }

 private:
  static constexpr std::size_t terms = 1 + D + operators::symmetric_terms(D);

  const particles::particles<D>& s_;
  double radius_;
  cells::grid<D> grid_;
};

}  // namespace tetsuame::convection
