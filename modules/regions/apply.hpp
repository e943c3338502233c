// Regions over the particles of a start.
#pragma once

#include <domain/communicator.hpp>
#include <foundation/agree.hpp>
#include <regions/region.hpp>

namespace tetsuame::regions {

// Collective. give(i, values) for each of this rank's n places: place_of(i), and T_of(i), K, before. What fails on one
// rank fails on all.
template <class PlaceOf, class TOf, class Give>
void apply(const domain::communicator& ranks, const all& regions, std::size_t n, const PlaceOf& place_of,
           const TOf& T_of, const Give& give) {
  std::vector<std::int64_t> counts(regions.size(), 0);
  std::string fault;
  try {
    for (std::size_t i = 0; i < n; ++i) give(i, regions.at(place_of(i), T_of(i), counts));
  } catch (const foundation::error& e) {
    fault = e.what();
  }
  foundation::agree(ranks.comm, fault, foundation::exit_status::bad_input);
  for (auto& count : counts) count = ranks.sum(count);
  regions.expect_used(counts);
}

}  // namespace tetsuame::regions
