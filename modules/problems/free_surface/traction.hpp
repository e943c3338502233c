// The pressure that a gauge reads (docs/theory/pressure_gauges.md): the force by which pressure acts through a plane,
// over an area about a point. As momentum is exchanged pair by pair (terms.hpp) that is, with the normal n into the
// water, and 2 p* for p_i + p_j where pairs have Riemann problems (riemann_terms.hpp),
//   p(X) = Σ_{i before, j behind the plane} (p_i + p_j) V_i V_j (-F_ij) (x_ij·n) w(|c_ij - X|)
// where x_ij crosses the plane at c_ij, and w, a cone or in two dimensions a hat, has the integral 1 over the plane. So
// a wall's readings add up to the force on it, whether water lies on the wall densely or as spray.
#pragma once

#include <algorithm>
#include <free_surface/across.hpp>
#include <free_surface/riemann_terms.hpp>
#include <free_surface/start.hpp>
#include <numbers>

namespace tetsuame::free_surface {

inline constexpr double gauge_radius = 2.0;  // spacings

template <int D>
struct plane {
  std::array<double, D> at, normal;
  double height(const std::array<double, D>& x) const {
    double above = 0.0;
    for (std::size_t a = 0; a < D; ++a) above += (x[a] - at[a]) * normal[a];
    return above;
  }
};

// 1/m^(D-1)
template <int D>
double gauge_weight(double distance, double radius) {
  const double hat = std::max(0.0, 1.0 - distance / radius) / radius;
  return D == 2 ? hat : 3.0 / (std::numbers::pi * radius) * hat;
}

// All of this rank about a place, by whether the plane lies behind or before it.
template <int D>
struct about_plane {
  std::vector<std::uint32_t> fluid_before, behind;

  about_plane(const water<D>& f, const plane<D>& p, double reach) {
    const auto& s = f.world.w.s;
    for (std::size_t i = 0; i < s.total(); ++i) {
      std::array<double, D> x;
      double r2 = 0.0;
      for (std::size_t a = 0; a < D; ++a) {
        x[a] = s.x[a][i];
        r2 += (x[a] - p.at[a]) * (x[a] - p.at[a]);
      }
      if (!(r2 < reach * reach) || !(s.dV[i] > 0.0)) continue;
      if (p.height(x) < 0.0)
        behind.push_back(static_cast<std::uint32_t>(i));
      else if (i < s.fluid)
        fluid_before.push_back(static_cast<std::uint32_t>(i));
    }
  }
};

// Pa, twice the pressure between a pair.
template <int D>
double pressures_between(const water<D>& f, std::size_t i, std::size_t j, const std::array<double, D>& x_ij,
                         double r2) {
  const auto& s = f.world.w.s;
  if (f.p.by == scheme::delta) return s.p[i] + s.p[j];
  double closing = 0.0;
  for (std::size_t a = 0; a < D; ++a) closing += (s.v[a][i] - s.v[a][j]) * x_ij[a];
  const auto star = contact_of_pair(s.rho[i], s.rho[j], s.p[i], s.p[j], closing, 1.0 / std::sqrt(r2),
                                    f.gravity() * x_ij[1], f.p.water.sound);
  return 2.0 * star.p;
}

// Pa; of pairs whose nearer one is this rank's.
template <int D>
void add_traction(const water<D>& f, const plane<D>& p, foundation::exact_sum& sum) {
  const auto& w = f.world.w;
  const auto& s = w.s;
  const double support = w.support(), radius = gauge_radius * f.dx();
  const about_plane<D> near(f, p, support + radius);
  const auto place = [&](std::size_t i) {
    std::array<double, D> x;
    for (std::size_t a = 0; a < D; ++a) x[a] = s.x[a][i];
    return x;
  };
  for (const std::size_t i : near.fluid_before)
    for (const std::size_t j : near.behind) {
      const auto x_i = place(i), x_j = place(j);
      const double above = p.height(x_i), across = above - p.height(x_j);
      double r2 = 0.0, distance2 = 0.0;
      std::array<double, D> x_ij;
      for (std::size_t a = 0; a < D; ++a) {
        x_ij[a] = x_i[a] - x_j[a];
        const double from_gauge = x_i[a] - above / across * x_ij[a] - p.at[a];
        r2 += x_ij[a] * x_ij[a];
        distance2 += from_gauge * from_gauge;
      }
      if (!(r2 < support * support) || !(distance2 < radius * radius)) continue;
      const double F = std::visit([&](const auto& k) { return k.gradient_over_r(std::sqrt(r2)); }, w.kernel);
      sum.add(-pressures_between<D>(f, i, j, x_ij, r2) * s.dV[i] * s.dV[j] * F * across *
              gauge_weight<D>(std::sqrt(distance2), radius));
    }
}

// With its images across periodic sides, and its mirror images in the others: what crosses the plane from behind a side
// is the image of what crosses it from before.
template <int D>
std::vector<plane<D>> with_images(const water<D>& f, const plane<D>& p) {
  const double reach = f.world.w.support() + gauge_radius * f.dx();
  point place{};
  for (std::size_t a = 0; a < D; ++a) place[a] = p.at[a];
  std::vector<plane<D>> all;
  for_each_across(f, place, reach, [&](const point& x) {
    all.push_back(p);
    for (std::size_t a = 0; a < D; ++a) all.back().at[a] = x[a];
  });
  for (const auto& side : f.world.walls.sides) {
    const bool along = std::abs(p.normal[side.axis]) > 0.99;
    if (along || !(side.distance(p.at[side.axis]) < reach)) continue;
    for (std::size_t n = all.size(); n > 0; --n) {
      plane<D> image = all[n - 1];
      image.at[side.axis] = 2.0 * side.position - image.at[side.axis];
      image.normal[side.axis] = -image.normal[side.axis];
      all.push_back(image);
    }
  }
  return all;
}

// The planes of a gauge: that of the wall that it is on, within half a spacing; else one across each axis.
template <int D>
std::vector<plane<D>> planes_of_gauge(const water<D>& f, const point& place) {
  plane<D> p{};
  for (std::size_t a = 0; a < D; ++a) p.at[a] = place[a];
  double nearest = 0.5 * f.dx();
  bool on_wall = false;
  for (const auto& side : f.world.walls.sides) {
    const double distance = side.distance(p.at[side.axis]);
    if (!(distance < nearest)) continue;
    nearest = distance;
    on_wall = true;
    p.normal = {};
    p.normal[side.axis] = side.inward;
    for (std::size_t a = 0; a < D; ++a) p.at[a] = place[a];
    p.at[side.axis] = side.position;
  }
  if (f.world.walls.bodies.any()) {
    const auto surface = f.solid.at(of_solids<D>(place), nearest);
    if (surface.found && std::abs(surface.distance) < nearest) return {{surface.nearest.c, surface.normal.c}};
  }
  if (on_wall) return {p};
  std::vector<plane<D>> across;
  for (std::size_t a = 0; a < D; ++a) {
    p.normal = {};
    p.normal[a] = 1.0;
    across.push_back(p);
  }
  return across;
}

// Pa; collective. Pressures and volumes are those of now, of what stands behind walls too (refresh() in
// water.hpp).
template <int D>
double pressure_at(const water<D>& f, const point& place) {
  const auto planes = planes_of_gauge(f, place);
  foundation::exact_sum sum;
  for (const auto& p : planes)
    for (const auto& image : with_images(f, p)) add_traction(f, image, sum);
  return f.ranks().exact(sum) / static_cast<double>(planes.size());
}

}  // namespace tetsuame::free_surface
