// What water in a box computes, compiled once a dimension and width of SIMD registers, in the library water_flows, for
// the files that include this.
#pragma once

#include <free_surface/flow.hpp>
#include <run/passes.hpp>

// where: extern, they are elsewhere; nothing: here.
#define TETSUAME_WATER_PASSES(where, D)                                                                      \
  where template void tetsuame::free_surface::sum_over_neighbours(water<D>&, const pairs::row_range&);       \
  where template void tetsuame::free_surface::sum_over_neighbours(water<D>&, const pairs::row_subset&);      \
  where template void tetsuame::free_surface::declare(water<D>&);                                            \
  where template void tetsuame::free_surface::set_up(water<D>&);                                             \
  where template void tetsuame::free_surface::arrange(water<D>&, double);                                    \
  where template void tetsuame::free_surface::guide_outflows(water<D>&);                                     \
  where template std::vector<bool> tetsuame::free_surface::find_surface(water<D>&);                          \
  where template void tetsuame::free_surface::find_tension(water<D>&);                                       \
  where template double tetsuame::free_surface::surface_energy(water<D>&);                                   \
  where template void tetsuame::rigid::place_bodies_for_lists(bodies<D>&, bool);                             \
  where template void tetsuame::rigid::find_beside_bodies(bodies<D>&);                                       \
  where template void tetsuame::free_surface::find_rows_beside(water<D>&);                                   \
  where template void tetsuame::free_surface::group_walls(water<D>&);                                        \
  where template std::int64_t tetsuame::rigid::put_out_of_bodies(bodies<D>&);                                \
  where template std::vector<tetsuame::free_surface::load<D>> tetsuame::free_surface::read_loads(water<D>&); \
  where template tetsuame::free_surface::energies tetsuame::free_surface::energies_of(water<D>&);            \
  where template void tetsuame::free_surface::count_put_back(water<D>&);                                     \
  where template double tetsuame::free_surface::pressure_at(const water<D>&, const point&);                  \
  where template double tetsuame::free_surface::depth_at(const water<D>&, const point&)

TETSUAME_WATER_PASSES(extern, 2);
TETSUAME_WATER_PASSES(extern, 3);
