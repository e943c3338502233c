// What all problems of particles in a box have in common, compiled once a dimension and width of SIMD registers, in the
// library run_passes, for the files that include this.
#pragma once

#include <run/particle_simulation.hpp>

// where: extern, they are elsewhere; nothing: here.
#define TETSUAME_RUN_PASSES(where, D)                                                                             \
  where template void tetsuame::particles::allocate(particles<D>&, std::size_t, std::size_t, std::size_t,         \
                                                    std::size_t);                                                 \
  where template void tetsuame::particles::reorder(particles<D>&, std::size_t, std::span<const std::uint32_t>);   \
  where template tetsuame::cells::grid<D> tetsuame::cells::make_grid<D>(                                          \
      const std::array<particles::array, D>&, const std::vector<std::int64_t>&, std::size_t, double);             \
  where template void tetsuame::domain::migrate(decomposition<D>&, particles::particles<D>&,                      \
                                                std::span<particles::partners* const>);                           \
  where template void tetsuame::walls::place(pairs::workspace<D>&, wall_set<D>&, std::int64_t, double);           \
  where template void tetsuame::walls::make_images(wall_set<D>&, particles::particles<D>&, std::int64_t, double); \
  where template void tetsuame::walls::detail::prepare_markers(pairs::workspace<D>&, wall_set<D>&,                \
                                                               const cells::grid<D>&, double);                    \
  where template void tetsuame::run::surround(state<D>&, double);                                                 \
  where template void tetsuame::run::rebuild(state<D>&, bool);                                                    \
  where template tetsuame::output::table_view tetsuame::run::checkpoint_table(const particles::particles<D>&,     \
                                                                              std::vector<std::int64_t>&);        \
  where template void tetsuame::run::fluid_from_checkpoint(const output::table&, particles::particles<D>&,        \
                                                           bool (*)(std::string_view));                           \
  where template struct tetsuame::run::load_balance<D>;                                                           \
  where template class tetsuame::run::particle_simulation<D>

TETSUAME_RUN_PASSES(extern, 2);
TETSUAME_RUN_PASSES(extern, 3);
