// Wall particles inside of bodies, and a marker for each; and what cannot be: bodies that are too thin, or too near to
// each other, for the kernel.
//
// Wall particles stand on the lattice of the fluid, (n + 1/2) Δx, inside of bodies as deep as the kernel reaches. The
// marker of one is its mirror image in the point of the surface that is nearest to it [M11: ghost points of a body of
// any shape],
//
//   x_m = 2 x_s − x = x − 2 φ ∇φ
//
// At a plane this is what walls/wall_set.hpp has; in a corner of the fluid too, where the nearest point is the corner
// and the image the one in both walls. Where the image lies in a wall again (an acute corner of the fluid), the marker
// stands half way through the fluid along ∇φ, or from the corner itself along its middle: nearer to the surface than
// the wall particle is.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <solids/motion.hpp>

namespace tetsuame::solids {

template <int D>
struct wall_particles {
  std::vector<point<D>> x, marker;    // m
  std::vector<point<D>> normal;       // into the fluid, at the nearest point of the surface
  std::vector<double> depth, height;  // m, of the particle below and of its marker above the surface
  std::vector<std::uint32_t> body;    // whose surface is nearest
  std::vector<std::int64_t> place;    // number on the lattice, the first axis the fastest: the same on any ranks
  std::size_t shortened = 0;          // markers that are nearer to the surface than their particle
};

// What belongs to one wall particle.
template <int D>
struct marked {
  point<D> marker, normal, nearest;  // m; nearest: of the surface
  double depth, height;              // m
};
// Of a wall particle at x, less deep in them than `depth` (m); none where there is no surface so near.
template <int D>
std::optional<marked<D>> mark(const body<D>& all, const point<D>& x, double depth);

// The box that solids stand in, and the lattice in it.
template <int D>
struct lattice {
  point<D> length;                 // m; the box is [0, length)
  double spacing = 1.0;            // m
  std::array<bool, D> periodic{};  // axes
};

// m, by what a place comes into the box across periodic sides.
template <int D>
point<D> shift_into(const point<D>& x, const point<D>& length, const std::array<bool, D>& periodic) {
  return point<D>::of([&](std::size_t a) { return periodic[a] ? -length[a] * std::floor(x[a] / length[a]) : 0.0; });
}

// A part of space, such as a rank's cell: [lower, upper), m.
template <int D>
struct part_of_space {
  std::array<double, D> lower = filled(-std::numeric_limits<double>::infinity());
  std::array<double, D> upper = filled(std::numeric_limits<double>::infinity());

  bool holds(const point<D>& x) const {
    for (std::size_t a = 0; a < D; ++a)
      if (!(x[a] >= lower[a] && x[a] < upper[a])) return false;
    return true;
  }

 private:
  static std::array<double, D> filled(double value) {
    std::array<double, D> all;
    all.fill(value);
    return all;
  }
};

// depth: m, at most. markers: where those stand whose wall particles are wanted. In a box with periodic sides bodies
// come with their images (repeated() in bounds.hpp), and wall particles stand where their markers are in the box.
// fitted: they fit the surfaces (fit.hpp); else they stand on the lattice.
template <int D>
wall_particles<D> fill_with_wall_particles(const std::vector<body<D>>& bodies, const lattice<D>& box, double depth,
                                           const part_of_space<D>& markers = {}, bool fitted = false);

// Each body, and each piece of one, has a place of the lattice inside of it, and leaves one to the fluid. Else an error
// of status bad_input says which does not. Of a piece one of the images will do.
template <int D>
void expect_in_box(const std::vector<body<D>>& bodies, const lattice<D>& box);

// Neither a wall nor a gap between walls is thinner than the kernel's reach (m): through a thin wall particles would
// feel those behind it, and in a thin gap the markers of one wall lie in the other. Along the normal at places of the
// surface as dense as the lattice; surfaces count as opposite where their normals are within 30° of that, so that a
// corner is no gap. The message names the place.
template <int D>
void expect_thick(const std::vector<body<D>>& bodies, const lattice<D>& box, double reach);

// No particle stands inside a body: the message names the first, how many do, and how deep it is.
template <int D>
void expect_dry(const std::vector<body<D>>& bodies, const std::vector<point<D>>& particles);

}  // namespace tetsuame::solids
