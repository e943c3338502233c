// The sums over neighbours of two fluids, with every kernel, precision and kind of supports, compiled once a dimension
// in units of their own (problems/two_fluids_sums_2d.cpp): half of what there is to compile.
#pragma once

#include <two_fluids/sums.hpp>

#define TETSUAME_TWO_FLUIDS_SUM(where, D, ...) \
  where template void tetsuame::two_fluids::sum(const fluids<D>&, const pairs::row_range&, const __VA_ARGS__&)

// where: extern, they are elsewhere; nothing: here.
#define TETSUAME_TWO_FLUIDS_SUMS(where, D)                                                         \
  TETSUAME_TWO_FLUIDS_SUM(where, D, forces<D, false>);                                             \
  TETSUAME_TWO_FLUIDS_SUM(where, D, forces<D, true>);                                              \
  TETSUAME_TWO_FLUIDS_SUM(where, D, density_rate<D>);                                              \
  TETSUAME_TWO_FLUIDS_SUM(where, D, elements::exchange<D>);                                        \
  TETSUAME_TWO_FLUIDS_SUM(where, D, diffusion::conduction<D>);                                     \
  where template void tetsuame::two_fluids::sum_volumes(fluids<D>&, const pairs::row_range&);      \
  where template void tetsuame::two_fluids::count_neighbours(fluids<D>&, const pairs::row_range&); \
  where template void tetsuame::tension::between_liquids<D>::sum_colour(const pairs::row_range&);  \
  where template void tetsuame::tension::between_liquids<D>::sum_stress(const pairs::row_range&)

TETSUAME_TWO_FLUIDS_SUMS(extern, 2);
TETSUAME_TWO_FLUIDS_SUMS(extern, 3);
