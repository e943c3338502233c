#include <algorithm>
#include <cmath>
#include <foundation/error.hpp>
#include <solids/motion.hpp>

namespace tetsuame::solids {

namespace {

// Sums over cells of a body: of their volume, first and second moments, about an origin near the body.
template <int D>
struct moments {
  const body<D>& of;
  point<D> origin;
  double spacing;  // m, of the smallest cells
  double volume = 0.0;
  point<D> first = foundation::zero<double, D>();
  std::array<point<D>, D> second{};

  // This part of a cell, all over it.
  void add(const point<D>& centre, const point<D>& edge, double part) {
    double V = part;
    for (std::size_t a = 0; a < D; ++a) V *= edge[a];
    const auto r = centre - origin;
    volume += V;
    first += V * r;
    for (std::size_t a = 0; a < D; ++a) {
      for (std::size_t b = 0; b < D; ++b) second[a][b] += V * r[a] * r[b];
      second[a][a] += V * edge[a] * edge[a] / 12.0;
    }
  }

  // Of a smallest cell, what lies behind the plane that touches the surface.
  double part_inside(const point<D>& centre, const point<D>& edge, double half) const {
    const auto surface = of.at(centre, half);
    // A seam of pieces is no surface, though the level there may be zero: a little beside it.
    if (!surface.found) return of.solid(centre + 1e-6 * edge) ? 1.0 : 0.0;
    double width = 0.0;  // of the cell, along the normal
    for (std::size_t a = 0; a < D; ++a) width += edge[a] * std::abs(surface.normal[a]);
    return width > 0.0 ? std::clamp(0.5 - surface.distance / width, 0.0, 1.0) : 0.5;
  }

  void add_cell(const point<D>& centre, const point<D>& edge) {
    const double half = 0.5 * norm<D>(edge), level = of.level(centre);
    if (level >= half) return;
    if (level <= -half) return add(centre, edge, 1.0);
    const auto longest = static_cast<std::size_t>(std::ranges::max_element(edge.c) - edge.c.begin());
    if (edge[longest] <= spacing) return add(centre, edge, part_inside(centre, edge, half));
    auto shorter = edge;
    shorter[longest] *= 0.5;
    for (const double side : {-0.5, 0.5}) add_cell(centre + (side * shorter[longest]) * unit<D>(longest), shorter);
  }
};

}  // namespace

template <int D>
free_body<D> filled(const body<D>& of, double density, const bounds<D>& where, double spacing) {
  double longest = 0.0;
  for (std::size_t a = 0; a < D; ++a) longest = std::max(longest, where.length(a));
  constexpr double least = D == 2 ? 512.0 : 64.0, most = D == 2 ? 16384.0 : 512.0;  // cells along it
  moments<D> sums{of, 0.5 * (where.low + where.high), std::clamp(spacing, longest / most, longest / least)};
  if (!where.empty()) sums.add_cell(sums.origin, where.high - where.low);
  if (!(sums.volume > 0.0))
    foundation::fail_input("body '" + of.name() + "' has no volume where its mass is asked for");
  const auto centre = (1.0 / sums.volume) * sums.first;
  free_body<D> b;
  b.mass = density * sums.volume;
  b.now.pivot = sums.origin + centre;
  // About the centre; of these the moments of inertia.
  for (std::size_t a = 0; a < D; ++a)
    for (std::size_t c = 0; c < D; ++c) sums.second[a][c] -= sums.volume * centre[a] * centre[c];
  double trace = 0.0;
  for (std::size_t a = 0; a < D; ++a) trace += sums.second[a][a];
  if constexpr (D == 2)
    b.inertia[0][0] = density * trace;
  else
    for (std::size_t a = 0; a < D; ++a)
      for (std::size_t c = 0; c < D; ++c) b.inertia[a][c] = density * ((a == c ? trace : 0.0) - sums.second[a][c]);
  return b;
}

template free_body<2> filled<2>(const body<2>&, double, const bounds<2>&, double);
template free_body<3> filled<3>(const body<3>&, double, const bounds<3>&, double);

}  // namespace tetsuame::solids
