// Of each owned grain the grains that are nearer than both radii and the skin, from a neighbour list.
#pragma once

#include <bit>
#include <cells/neighbour_list.hpp>
#include <dem/contacts.hpp>

namespace tetsuame::dem {

template <int D>
typename contacts<D>::rows near_rows(const particles::particles<D>& s, const double* radius,
                                     const cells::neighbour_list& list, double skin) {
  constexpr std::size_t width = cells::neighbour_list::width;
  typename contacts<D>::rows near;
  std::array<std::vector<std::uint32_t>, width> of_cluster;
  for (std::size_t r = 0; r * width < s.fluid; ++r) {
    for (auto& one : of_cluster) one.clear();
    const auto add = [&](std::uint32_t j, std::uint32_t of_lanes, std::size_t) {
      for (; of_lanes != 0; of_lanes &= of_lanes - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(of_lanes));
        const std::size_t i = r * width + lane;
        const double reach = radius[i] + radius[j] + skin;
        double d2 = 0.0;
        for (std::size_t a = 0; a < D; ++a) d2 += (s.x[a][i] - s.x[a][j]) * (s.x[a][i] - s.x[a][j]);
        if (d2 < reach * reach) of_cluster[lane].push_back(j);
      }
    };
    if (r < list.rows()) list.for_each(r, add);
    for (std::size_t lane = 0; lane < width && r * width + lane < s.fluid; ++lane) {
      near.all.insert(near.all.end(), of_cluster[lane].begin(), of_cluster[lane].end());
      near.start.push_back(near.all.size());
    }
  }
  return near;
}

}  // namespace tetsuame::dem
