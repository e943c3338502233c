// What the schemes for liquids have in common, compiled once a dimension and width of SIMD registers, in the library
// liquid_passes: a program that includes this compiles what is its own. A module that is not named here needs no more
// than its header: its sums are compiled in the programs that list it.
#pragma once

#include <gradient/pattern_1.hpp>
#include <gradient/pattern_2.hpp>
#include <liquid/rates.hpp>
#include <run/passes.hpp>
#include <volume/hosono_iteration.hpp>
#include <walls/slip_continuity.hpp>

#define TETSUAME_LIQUID_FORCES(where, D, form)                                                                   \
  where template void tetsuame::liquid::sum_forces<tetsuame::gradient::form, D>(run::state<D>&, const rates<D>&, \
                                                                                const pairs::row_range&, bool)

#define TETSUAME_SLIP(where, D, form)                                                                       \
  where template void tetsuame::walls::add_continuity_of_slip<D, tetsuame::gradient::form<D>>(              \
      const pairs::workspace<D>&, const wall_set<D>&, particles::vector_field<D>&, const particles::array&, \
      particles::array&)

// What walls with markers do with the fluid about these, in D dimensions: fields at the markers, and the fluid's
// acceleration. where: extern, it is elsewhere; nothing: here.
#define TETSUAME_MARKER_PASSES(where, D)                                                              \
  where template void tetsuame::walls::detail::marker_kinematics(pairs::workspace<D>&, wall_set<D>&); \
  where template void tetsuame::walls::detail::marker_weights(pairs::workspace<D>&, wall_set<D>&);    \
  where template void tetsuame::walls::detail::marker_pressures(pairs::workspace<D>&, wall_set<D>&)
#define TETSUAME_WALL_PASSES(where, D)                                                                        \
  where template void tetsuame::walls::detail::nonpressure_acceleration(pairs::workspace<D>&, wall_set<D>&);  \
  where template void tetsuame::walls::detail::nonpressure_acceleration(pairs::workspace<D>&, wall_set<D>&,   \
                                                                        const volume::weight_sum<D, false>&); \
  where template void tetsuame::walls::detail::nonpressure_acceleration(pairs::workspace<D>&, wall_set<D>&,   \
                                                                        const volume::weight_sum<D, true>&);  \
  TETSUAME_SLIP(where, D, continuity);                                                                        \
  TETSUAME_SLIP(where, D, own_continuity)

// Volumes, and the forces with a gradient, in the same way.
#define TETSUAME_LIQUID_PASSES(where, D)                                                                               \
  where template void tetsuame::volume::equation_of_state(pairs::workspace<D>&, std::size_t, std::size_t);             \
  where template void tetsuame::volume::require_positive(pairs::workspace<D>&, const particles::array&, const char*,   \
                                                         const char*);                                                 \
  where template void tetsuame::volume::volumes_by_number(const pairs::workspace<D>&, const pairs::row_range&, double, \
                                                          double*);                                                    \
  where template void tetsuame::volume::smooth(pairs::workspace<D>&, const particles::array&, bool,                    \
                                               const pairs::row_range&);                                               \
  where template void tetsuame::volume::smooth(pairs::workspace<D>&, const particles::array&, bool,                    \
                                               const pairs::remainder&);                                               \
  where template void tetsuame::volume::smooth(pairs::workspace<D>&, const particles::array&, const particles::array&, \
                                               bool, const pairs::row_range&, particles::array&);                      \
  where template void tetsuame::volume::smooth_over_walls<D, false>(pairs::workspace<D>&, walls::wall_set<D>&);        \
  where template void tetsuame::volume::smooth_over_walls<D, true>(pairs::workspace<D>&, walls::wall_set<D>&);         \
  where template void tetsuame::volume::smooth_by_lattice(pairs::workspace<D>&, bool, const pairs::row_range&);        \
  where template void tetsuame::liquid::begin_forces(run::state<D>&, const rates<D>&);                                 \
  TETSUAME_LIQUID_FORCES(where, D, pattern_1);                                                                         \
  TETSUAME_LIQUID_FORCES(where, D, pattern_2);                                                                         \
  where template void                                                                                                  \
  tetsuame::liquid::sum_forces<tetsuame::gradient::pattern_1, D, tetsuame::gradient::own_continuity<D>>(               \
      run::state<D>&, const rates<D>&, const pairs::row_range&, bool)

TETSUAME_MARKER_PASSES(extern, 2);
TETSUAME_MARKER_PASSES(extern, 3);
TETSUAME_WALL_PASSES(extern, 2);
TETSUAME_WALL_PASSES(extern, 3);
TETSUAME_LIQUID_PASSES(extern, 2);
TETSUAME_LIQUID_PASSES(extern, 3);
