// Regions over the particles of a start.
#pragma once

#include <domain/communicator.hpp>
#include <foundation/agree.hpp>
#include <regions/region.hpp>

namespace tetsuame::regions {

// Collective. give(i, values) for each of this rank's fluid particles, whose temperatures are those before. What fails
// on one rank fails on all.
template <class Particles, class Give>
void apply(const domain::communicator& ranks, const all& regions, const Particles& s, const Give& give) {
  std::vector<std::int64_t> counts(regions.size(), 0);
  std::string fault;
  try {
    for (std::size_t i = 0; i < s.fluid; ++i) {
      place x{};
      for (std::size_t a = 0; a < s.x.size(); ++a) x[a] = s.x[a][i];
      give(i, regions.at(x, s.T[i], counts));
    }
  } catch (const foundation::error& e) {
    fault = e.what();
  }
  foundation::agree(ranks.comm, fault, foundation::exit_status::bad_input);
  for (auto& count : counts) count = ranks.sum(count);
  regions.expect_used(counts);
}

}  // namespace tetsuame::regions
