// Values of pairs in checkpoints: from the ranks into a table, and back on any number of ranks.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <domain/decomposition.hpp>
#include <map>
#include <particles/partners.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace tetsuame::domain {

// Collective. The committed pairs of this rank, in rows that are the same on any number of ranks once they are in the
// order of their IDs. Throws file_failed on all ranks where 64 bits cannot number the rows.
inline particles::pair_table table_of(const communicator& ranks, const particles::partners& all) {
  std::size_t most = 0;
  for (std::size_t i = 0; i < all.rows(); ++i) most = std::max(most, all.row(i).size());
  most = static_cast<std::size_t>(ranks.maximum(static_cast<double>(most)));
  particles::pair_table t;
  std::string problem;
  try {
    t = particles::table_of(all, static_cast<std::int64_t>(most));
  } catch (const std::overflow_error& e) {
    problem = e.what();
  }
  ranks.agree_on_fault(0, problem, foundation::exit_status::file_failed);
  return t;
}

namespace detail {

// Who has a particle of which ID, and the pairs on their way to it: one rank of all knows that of an ID.
struct directory {
  std::size_t values = 0;                     // of a pair
  std::unordered_map<std::int64_t, int> has;  // the rank that has a particle
  struct pair {
    std::int64_t owner, partner;
    const double* values;
  };
  std::vector<pair> pairs;
  std::vector<std::int64_t> twice;  // IDs of particles that are there twice

  // The number of IDs, these, and behind them pairs: IDs of owner and partner, values. `from`: the sender.
  void read(int from, std::span<const double> all) {
    const double *v = all.data(), *const end = v + all.size();
    const auto ids = static_cast<std::size_t>(*v++);
    for (std::size_t k = 0; k < ids; ++k) {
      const auto id = std::bit_cast<std::int64_t>(*v++);
      if (!has.emplace(id, from).second) twice.push_back(id);
    }
    for (; v < end; v += 2 + values)
      pairs.push_back({std::bit_cast<std::int64_t>(v[0]), std::bit_cast<std::int64_t>(v[1]), v + 2});
  }
  // Sorts the pairs. The lowest particle with a fault, and the fault, whose text is empty where there is none.
  std::pair<std::int64_t, std::string> check() {
    if (!twice.empty()) {
      const std::int64_t id = *std::min_element(twice.begin(), twice.end());
      return {id, "particle " + std::to_string(id) + " is there twice"};
    }
    std::sort(pairs.begin(), pairs.end(), [](const pair& a, const pair& b) {
      return a.owner != b.owner ? a.owner < b.owner : a.partner < b.partner;
    });
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const auto& p = pairs[k];
      const auto name = [&] {
        return "there are values of the pair of particles " + std::to_string(p.owner) + " and " +
               std::to_string(p.partner);
      };
      if (!has.contains(p.owner)) return {p.owner, name() + ", but no particle " + std::to_string(p.owner)};
      if (k > 0 && pairs[k - 1].owner == p.owner && pairs[k - 1].partner == p.partner)
        return {p.owner, name() + " twice"};
    }
    return {};
  }
};

// Collective. Sends each rank its values, and returns what came here.
template <int D>
auto exchange_by_rank(decomposition<D>& d, std::map<int, std::vector<double>>& values) {
  std::vector<message> out;
  for (auto& [rank, v] : values) out.push_back({rank, std::move(v)});
  return sparse_exchange(d.ranks, out, next_tag(d));
}

// Collective. What directory::read() takes, by the rank that reads it. An ID's rank is that of a block of IDs: what is
// spread over the ranks in its order stays near.
inline std::map<int, std::vector<double>> by_directory(const communicator& ranks, std::span<const std::int64_t> ids,
                                                       const particles::pair_table& t) {
  const std::int64_t largest = ids.empty() ? 0 : *std::max_element(ids.begin(), ids.end());
  const double block = (std::max(ranks.maximum(static_cast<double>(largest)), 0.0) + 1.0) / ranks.size;
  const auto knows = [&](std::int64_t id) {
    return static_cast<int>(std::clamp(static_cast<double>(id) / block, 0.0, ranks.size - 1.0));
  };
  std::map<int, std::vector<double>> ids_of, pairs_of;
  for (const std::int64_t id : ids) ids_of[knows(id)].push_back(std::bit_cast<double>(id));
  for (std::size_t r = 0; r < t.owner.size(); ++r) {
    auto& v = pairs_of[knows(t.owner[r])];
    v.insert(v.end(), {std::bit_cast<double>(t.owner[r]), std::bit_cast<double>(t.partner[r])});
    for (const auto& component : t.values) v.push_back(component[r]);
  }
  std::map<int, std::vector<double>> all;
  for (const auto* part : {&ids_of, &pairs_of})
    for (const auto& [rank, v] : *part) all[rank];
  for (auto& [rank, v] : all) {
    v.push_back(static_cast<double>(ids_of[rank].size()));
    for (const auto* part : {&ids_of[rank], &pairs_of[rank]}) v.insert(v.end(), part->begin(), part->end());
  }
  return all;
}

}  // namespace detail

// Collective. Gives each particle of this rank, whose IDs these are, its pairs of the table, whose rows lie on any
// ranks. Throws file_failed on all ranks where an owner is not there, or a particle or a pair is there twice.
template <int D>
void read_table(decomposition<D>& d, std::span<const std::int64_t> ids, const particles::pair_table& t,
                particles::partners& all) {
  const std::size_t width = all.values_per_pair();
  std::pair<std::int64_t, std::string> fault;
  if (t.values.size() != width)
    fault.second = "pairs have " + std::to_string(t.values.size()) + " values in the table, and " +
                   std::to_string(width) + " in this run";
  d.ranks.agree_on_fault(fault.first, fault.second, foundation::exit_status::file_failed);

  auto asked = detail::by_directory(d.ranks, ids, t);
  const auto in = detail::exchange_by_rank(d, asked);
  detail::directory here;
  here.values = width;
  for (const auto& m : in) here.read(m.rank, m.values);
  fault = here.check();
  d.ranks.agree_on_fault(fault.first, fault.second, foundation::exit_status::file_failed);

  std::map<int, std::vector<double>> forwarded;
  for (const auto& p : here.pairs) {
    auto& v = forwarded[here.has.at(p.owner)];
    v.insert(v.end(), {std::bit_cast<double>(p.owner), std::bit_cast<double>(p.partner)});
    v.insert(v.end(), p.values, p.values + width);
  }
  const auto mine = detail::exchange_by_rank(d, forwarded);
  std::unordered_map<std::int64_t, std::size_t> place;
  for (std::size_t i = 0; i < ids.size(); ++i) place.emplace(ids[i], i);
  all.reset(ids);
  all.begin();
  for (const auto& m : mine)
    for (const double* v = m.values.data(); v < m.values.data() + m.values.size(); v += 2 + width)
      std::copy_n(v + 2, width,
                  all.insert(place.at(std::bit_cast<std::int64_t>(v[0])), std::bit_cast<std::int64_t>(v[1])).begin());
  all.commit();
}

}  // namespace tetsuame::domain
