// The box that bodies stand in, as the input has it, and bodies of the input that may stand in it
// (docs/theory/solids.md).
#pragma once

#include <domain/options.hpp>
#include <run/options.hpp>
#include <solids/bounds.hpp>
#include <solids/options.hpp>
#include <walls/options.hpp>

namespace tetsuame::rigid {

template <int D>
struct box {
  solids::lattice<D> lattice;  // the fluid's
  bool open_top = false;
  double support = 0.0, skin = 0.0;  // m, of the kernel and of lists
  gauges::options gauges = {};       // that stand beside bodies

  bool is_open(std::size_t axis) const { return axis == 1 && open_top; }  // at its upper end
};
// Of options that are resolved.
template <int D>
box<D> box_of(const domain::options& of, const run::common_options& common, const walls::options& sides);

template <int D>
solids::period<D> period_of(const box<D>& of);
// What lies beyond the sides; an open top and periodic sides have nothing there.
template <int D>
solids::body<D> tank_of(const box<D>& of);
// These bodies and what lies beyond the sides as one.
template <int D>
solids::body<D> solid_of(const box<D>& of, std::vector<solids::body<D>> bodies);

// Checks of bodies, and the search for places inside of them, go through the whole lattice on every rank.
inline constexpr double most_places = 1e8;
template <int D>
void expect_countable(const namelist::schema& schema, const box<D>& of);

// A body with its images across periodic sides; why it cannot have them is a fault of this key. most: lengths of the
// box (solids::fault_across).
template <int D>
solids::body<D> with_images(const namelist::schema& schema, const char* group, const char* key,
                            const solids::body<D>& of, const solids::period<D>& period, double most);
inline constexpr double longest_at_rest = 4.0;  // boxes, of a body that stands still

// What bodies, their images included, must be to have wall particles: in the box, without filling it, and no thinner
// than the kernel reaches, nor with gaps that are; and without gauges inside.
template <int D>
void expect_sound(const namelist::schema& schema, const std::vector<solids::body<D>>& bodies, const box<D>& of);

// The bodies of &solids, with their images, where all of them stand still.
template <int D>
std::vector<solids::body<D>> bodies_at_rest(const namelist::schema& schema, const solids::options& o, const box<D>& of);

}  // namespace tetsuame::rigid
