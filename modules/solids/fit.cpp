#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <solids/fit.hpp>

namespace tetsuame::solids {

namespace {

constexpr std::int64_t radius = 3;  // spacings, of W
constexpr double firm = 0.1;        // λ
constexpr double rounding = 1e-9;
constexpr double nothing = 1e-6;  // spacings: rows that fit stay on the lattice to the last bit

// Whether a surface with this normal runs along the lattice, to 0.08 degrees.
template <int D>
bool along_lattice(const point<D>& normal) {
  return std::ranges::any_of(normal.c, [](double n) { return std::abs(n) > 1.0 - 1e-6; });
}

// Of the distance in radii.
double weight(double q) { return q < 1.0 ? (1.0 - q * q) * (1.0 - q * q) : 0.0; }

}  // namespace

template <int D>
std::size_t fit<D>::hash::operator()(const cell& c) const {
  std::size_t all = 0;
  for (const auto n : c) all = all * 1000003U + static_cast<std::size_t>(n);
  return all;
}

template <int D>
auto fit<D>::look(const cell& c) -> const cut& {
  const auto [place, is_new] = known_.try_emplace(c);
  auto& of = place->second;
  if (!is_new) return of;
  of.any = false;
  of.at = point<D>::of([&](std::size_t a) { return (static_cast<double>(c[a]) + 0.5) * spacing_; });
  const auto surface = of_.at(of.at, 0.5 * std::sqrt(static_cast<double>(D)) * spacing_);
  if (!surface.found) return of;
  of.normal = surface.normal;
  of.width = 0.0;
  for (std::size_t a = 0; a < D; ++a) of.width += spacing_ * std::abs(surface.normal[a]);
  if (std::abs(surface.distance) > 0.5 * of.width * (1.0 + rounding)) return of;
  of.any = along_lattice<D>(surface.normal);
  of.too_few = 0.5 * of.width - surface.distance - (surface.distance < 0.0 ? of.width : 0.0);
  return of;
}

template <int D>
point<D> fit<D>::place(const point<D>& x, double deepest) {
  using matrix = Eigen::Matrix<double, D, D>;
  using vector = Eigen::Matrix<double, D, 1>;
  if (!of_.solid(x)) return x;
  const auto surface = of_.at(x, deepest + spacing_);
  if (!surface.found || !along_lattice<D>(surface.normal)) return x;
  const vector n(surface.normal.c.data());
  matrix M = matrix::Zero();
  vector b = vector::Zero();
  cell first, c;
  std::int64_t cells = 1;
  for (std::size_t a = 0; a < D; ++a) {
    first[a] = std::llround(surface.nearest[a] / spacing_ - 0.5) - radius;
    cells *= 2 * radius + 1;
  }
  for (std::int64_t k = 0; k < cells; ++k) {
    std::int64_t rest = k;
    for (std::size_t a = 0; a < D; ++a) {
      c[a] = first[a] + rest % (2 * radius + 1);
      rest /= 2 * radius + 1;
    }
    const auto& of = look(c);
    if (!of.any) continue;
    const double W = weight(norm<D>(of.at - surface.nearest) / (static_cast<double>(radius) * spacing_)) / of.width;
    const vector n_c(of.normal.c.data());
    M += W * (n_c * n_c.transpose() + firm * (matrix::Identity() - n * n.transpose()));
    b += (W * of.too_few) * n_c;
  }
  if (!(M.trace() > 0.0)) return x;
  const vector S = M.ldlt().solve(b);
  if (S.norm() < nothing * spacing_) return x;
  const auto moved = point<D>::of([&](std::size_t a) { return x[a] + S[static_cast<Eigen::Index>(a)]; });
  return of_.solid(moved) ? moved : x;
}

template class fit<2>;
template class fit<3>;

}  // namespace tetsuame::solids
