#include <cmath>
#include <cstddef>
#include <kernels/lattice.hpp>
#include <numbers>
#include <vector>

namespace tetsuame::kernels {

namespace {

constexpr std::size_t most = 3;  // directions; those beyond D have a single layer

// dx^D W on the lattice points with all coordinates >= 0, each with the number of its
// mirror images as weight.
struct octant {
  std::array<std::size_t, most> size;  // points a direction, from 0
  std::vector<double> weight;          // [x][y][z]

  double transfer(const std::array<double, most>& k_dx) const;
};

template <int D>
octant sample(const any<D>& kernel, double dx) {
  octant o;
  const auto n =
      static_cast<std::size_t>(std::ceil(std::visit([](const auto& k) { return k.support(); }, kernel) / dx));
  for (std::size_t d = 0; d < most; ++d) o.size[d] = d < D ? n + 1 : 1;
  const double volume = D == 1 ? dx : D == 2 ? dx * dx : dx * dx * dx;
  for (std::size_t x = 0; x < o.size[0]; ++x)
    for (std::size_t y = 0; y < o.size[1]; ++y)
      for (std::size_t z = 0; z < o.size[2]; ++z) {
        const double r = dx * std::sqrt(static_cast<double>(x * x + y * y + z * z));
        const double images = (x > 0 ? 2.0 : 1.0) * (y > 0 ? 2.0 : 1.0) * (z > 0 ? 2.0 : 1.0);
        o.weight.push_back(images * volume * std::visit([&](const auto& k) { return k.value(r); }, kernel));
      }
  return o;
}

// The images' cosines add up to the product of one cosine a direction.
double octant::transfer(const std::array<double, most>& k_dx) const {
  std::array<std::vector<double>, most> wave;
  for (std::size_t d = 0; d < most; ++d)
    for (std::size_t x = 0; x < size[d]; ++x) wave[d].push_back(std::cos(static_cast<double>(x) * k_dx[d]));
  double sum = 0.0;
  const double* w = weight.data();
  for (std::size_t x = 0; x < size[0]; ++x)
    for (std::size_t y = 0; y < size[1]; ++y) {
      double row = 0.0;
      for (std::size_t z = 0; z < size[2]; ++z) row += *w++ * wave[2][z];
      sum += wave[0][x] * wave[1][y] * row;
    }
  return sum;
}

// The lattice's symmetry under exchange of directions leaves k_x >= k_y >= k_z.
transfer_extremum least_on_grid(const octant& o, std::size_t directions, std::size_t intervals) {
  transfer_extremum best{o.transfer({}), {}};
  const double step = std::numbers::pi / static_cast<double>(intervals);
  for (std::size_t x = 0; x <= intervals; ++x)
    for (std::size_t y = 0; y <= (directions > 1 ? x : 0); ++y)
      for (std::size_t z = 0; z <= (directions > 2 ? y : 0); ++z) {
        const std::array<double, most> k{static_cast<double>(x) * step, static_cast<double>(y) * step,
                                         static_cast<double>(z) * step};
        const double s = o.transfer(k);
        if (s < best.value) best = {s, k};
      }
  return best;
}

// One step along each direction, halved where none leads down.
void descend(const octant& o, std::size_t directions, double step, transfer_extremum& best) {
  while (step > 1e-8) {
    bool better = false;
    for (std::size_t d = 0; d < directions; ++d)
      for (const double way : {-step, step}) {
        std::array<double, most> k = best.k_dx;
        k[d] = std::clamp(k[d] + way, 0.0, std::numbers::pi);
        const double s = o.transfer(k);
        if (s < best.value) {
          best = {s, k};
          better = true;
        }
      }
    if (!better) step *= 0.5;
  }
}

}  // namespace

template <int D>
double lattice_sum(const any<D>& kernel, double dx) {
  return sample(kernel, dx).transfer({});
}

template <int D>
double transfer(const any<D>& kernel, double dx, const std::type_identity_t<std::array<double, D>>& k) {
  std::array<double, most> k_dx{};
  for (std::size_t d = 0; d < k.size(); ++d) k_dx[d] = k[d] * dx;
  return sample(kernel, dx).transfer(k_dx);
}

template <int D>
transfer_extremum transfer_minimum(const any<D>& kernel, double dx) {
  constexpr std::size_t intervals = D == 3 ? 16 : 24;
  const octant o = sample(kernel, dx);
  transfer_extremum best = least_on_grid(o, D, intervals);
  descend(o, D, 0.5 * std::numbers::pi / static_cast<double>(intervals), best);
  return best;
}

template <int D>
shear_moduli spurious_shear_moduli(const any<D>& of, double dx) {
  // s of the lattice with (x, y) -> (a x + b y, y/a).
  const auto sum_of = [&](const auto& kernel, double a, double b) {
    const int n = static_cast<int>(std::ceil(1.1 * kernel.support() / dx)), depth = D == 3 ? n : 0;
    double s = 0.0;
    for (int x = -n; x <= n; ++x)
      for (int y = -n; y <= n; ++y)
        for (int z = -depth; z <= depth; ++z) {
          const double X = a * x + b * y, Y = y / a;
          s += kernel.value(dx * std::sqrt(X * X + Y * Y + z * z));
        }
    return s;
  };
  const auto sum = [&](double a, double b) { return std::visit([&](const auto& k) { return sum_of(k, a, b); }, of); };
  const auto second = [&](const auto& f) {
    constexpr double e = 0.01;
    return (16.0 * (f(e) + f(-e)) - f(2.0 * e) - f(-2.0 * e) - 30.0 * f(0.0)) / (12.0 * e * e * f(0.0));
  };
  return {second([&](double g) { return sum(1.0, g); }), second([&](double g) { return sum(std::exp(0.5 * g), 0.0); })};
}

#define TETSUAME_INSTANTIATE(D)                                                  \
  template double lattice_sum(const any<D>&, double);                            \
  template double transfer(const any<D>&, double, const std::array<double, D>&); \
  template transfer_extremum transfer_minimum(const any<D>&, double);            \
  template shear_moduli spurious_shear_moduli(const any<D>&, double);
TETSUAME_INSTANTIATE(1)
TETSUAME_INSTANTIATE(2)
TETSUAME_INSTANTIATE(3)
#undef TETSUAME_INSTANTIATE

}  // namespace tetsuame::kernels
