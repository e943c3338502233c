// Several species of particles in one box: each a set with fields, IDs, ghosts and partners of its own. One
// decomposition owns ranks and cells for all of them, and there are neighbour lists from any species to any other, or
// to itself.
//
//   species::mixture<3> m(ranks, box, {{"fluid", cells::cell_edge(dx)}, {"grains", cells::cell_edge(diameter)}});
//   auto& grains = m[1];                                    // m.index("grains")
//   auto& spin = particles::declare(grains.s, "Spin", "1/s", particles::role::integrated);
//   m.set_reach(1, 0, h + radius);                          // grains look for fluid
//   ... particles::allocate(grains.s, n, 0, 0, 0) and start values, on any ranks ...
//   m.rebuild();                                            // owners, ghosts, lists: collective
//   m.for_each_pair(1, 0, [&](std::size_t i, std::uint32_t j) { ... });
//
// The owned particles of a species are those called fluid in its arrays, whatever they are made of; those called walls
// stay empty: wall particles are a species. IDs are unique within a species.
//
// Neighbours stand in the order of their species' grid, whose cells are anchored at the origin: sums over a row have
// the same bits on any number of ranks and threads (cells/neighbour_list.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cells/grid.hpp>
#include <cells/neighbour_list.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <domain/decomposition.hpp>
#include <foundation/error.hpp>
#include <foundation/threads.hpp>
#include <particles/partners.hpp>
#include <particles/storage.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tetsuame::species {

struct description {
  std::string name;
  double edge = 0.0;  // m, of the cells in which others look for it (cells::cell_edge of its spacing)
};

template <int D>
struct species : description {
  particles::particles<D> s;
  domain::halo<D> halo;
  cells::grid<D> grid;                         // of those owned and the ghosts, as they were when lists were made
  std::vector<particles::partners*> partners;  // whose rows follow the owned particles; not owned

  explicit species(description d) : description(std::move(d)) {
    if (!(edge > 0.0)) throw std::logic_error("species " + name + " needs cells with an edge");
    particles::allocate(s, 0, 0, 0, 0);
  }
};

template <int D>
class mixture {
 public:
  domain::decomposition<D> d;  // its own halos are not used; d.width is that of the widest species

  // widest: m, the longest reach there will be, by which the shape of the ranks' cells is chosen.
  mixture(const domain::communicator& ranks, const domain::box<D>& region, const std::vector<description>& all,
          double widest = 0.0, const domain::rank_columns& columns = {})
      : d(domain::decompose<D>(ranks, region, widest, columns)),
        reach_(all.size() * all.size(), 0.0),
        lists_(all.size() * all.size()) {
    all_.reserve(all.size());
    for (const auto& one : all) {
      if (std::ranges::find(all_, one.name, &description::name) != all_.end())
        throw std::logic_error("species " + one.name + " is there twice");
      all_.emplace_back(one);
      all_.back().halo.tag = first_tag + static_cast<int>(all_.size());
    }
    d.width = 0.0;
  }
  // Fields and lists are referred to.
  mixture(const mixture&) = delete;
  mixture& operator=(const mixture&) = delete;

  std::size_t size() const { return all_.size(); }
  species<D>& operator[](std::size_t a) { return all_[a]; }
  const species<D>& operator[](std::size_t a) const { return all_[a]; }
  std::size_t index(std::string_view name) const {
    const auto found = std::ranges::find(all_, name, &description::name);
    if (found == all_.end()) throw std::logic_error("no species " + std::string(name));
    return static_cast<std::size_t>(found - all_.begin());
  }

  // m, within which particles of species a find those of species b from the next lists on; 0: there is no such list.
  // Fails with exit 2 where a periodic box is narrower: a particle would meet images that lie more than one box away.
  void set_reach(std::size_t a, std::size_t b, double reach) {
    if (!(reach >= 0.0)) throw std::logic_error("a reach of " + std::to_string(reach) + " m");
    for (std::size_t axis = 0; axis < D; ++axis)
      if (d.region.periodic[axis] && reach > d.region.length[axis] * (1.0 - 2e-6))
        foundation::fail_input("the periodic box, " + std::to_string(d.region.length[axis]) +
                               " m wide, is narrower than the reach of " + all_[a].name + " for " + all_[b].name +
                               ", " + std::to_string(reach) + " m");
    reach_[a * size() + b] = reach;
  }
  double reach(std::size_t a, std::size_t b) const { return reach_[a * size() + b]; }  // m

  // Rows of the owned particles of a: local indices of b.
  cells::neighbour_list& list(std::size_t a, std::size_t b) { return lists_[a * size() + b]; }
  const cells::neighbour_list& list(std::size_t a, std::size_t b) const { return lists_[a * size() + b]; }

  // The rows of these partners follow the owned particles of a from now on. They must outlive the mixture.
  void attach(std::size_t a, particles::partners& rows) {
    rows.require_rows_of(owned_ids(all_[a]));
    all_[a].partners.push_back(&rows);
  }

  // Collective. Hands particles to their ranks, sorts them by cell and ID, and makes ghosts, with positions, IDs and
  // materials, grids and lists. as_they_were: from the positions that the last lists were made from, with which a
  // restart, or a change of cuts, has the same sums. reach_of(a, b): what cells::make_list takes as the reach of that
  // pair of species, none of whose pairs is farther apart than reach(a, b); asked when the ghosts are there.
  template <class ReachOf>
  void rebuild(bool as_they_were, const ReachOf& reach_of) {
    for (auto& one : all_) {
      if (as_they_were)
        particles::exchange_list_positions(one.s);
      else
        domain::wrap(d.region, one.s);
      settle(one);
      if (!as_they_were)
        for (std::size_t k = 0; k < D; ++k) std::copy_n(one.s.x[k].begin(), one.s.fluid, one.s.x_list[k].begin());
    }
    surround();
    for (std::size_t a = 0; a < size(); ++a)
      for (std::size_t b = 0; b < size(); ++b) make_list(a, b, reach_of);
    if (!as_they_were) return;
    for (auto& one : all_) {
      particles::exchange_list_positions(one.s);
      domain::exchange<D>(d.ranks, one.halo, {}, &one.s.x);
    }
  }
  void rebuild(bool as_they_were = false) {
    rebuild(as_they_were, [this](std::size_t a, std::size_t b) { return cells::one_reach{reach(a, b)}; });
  }

  // Collective. The ghosts' values of these arrays of species b, and their positions if asked for.
  void update_ghosts(std::size_t b, std::span<double* const> fields, bool positions = false) {
    domain::exchange<D>(d.ranks, all_[b].halo, fields, positions ? &all_[b].s.x : nullptr);
  }

  // m, the longest way of an owned particle of a since lists were made, on this rank. The list of a for b has all
  // pairs nearer than reach(a, b) less the longest ways of a and b on any rank.
  double moved(std::size_t a) const {
    const auto& s = all_[a].s;
    double longest2 = 0.0;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      double way2 = 0.0;
      for (std::size_t k = 0; k < D; ++k) way2 += (s.x[k][i] - s.x_list[k][i]) * (s.x[k][i] - s.x_list[k][i]);
      longest2 = std::max(longest2, way2);
    }
    return std::sqrt(longest2);
  }

  // f(i, j) for each owned particle i of a and each j of b in its list, which has one sequence; those of one i in the
  // order of the list and on one thread.
  template <class F>
  void for_each_pair(std::size_t a, std::size_t b, const F& f) const {
    constexpr std::size_t width = cells::neighbour_list::width;
    const auto& pairs = list(a, b);
    if (pairs.interleave != 1) throw std::logic_error("a list with two sequences has no order of all its pairs");
#pragma omp parallel for schedule(static) if (pairs.rows() > foundation::rows_worth_threads / width)
    for (std::size_t r = 0; r < pairs.rows(); ++r)
      pairs.for_each(r, [&](std::uint32_t j, std::uint32_t of_lanes, std::size_t) {
        for (; of_lanes != 0; of_lanes &= of_lanes - 1)
          f(r * width + static_cast<std::size_t>(std::countr_zero(of_lanes)), j);
      });
  }

 private:
  static constexpr int first_tag = 3;  // behind those of a decomposition's own halos and its migration

  static std::span<const std::int64_t> owned_ids(const species<D>& one) { return {one.s.id.data(), one.s.fluid}; }

  // Particles go to their ranks, where they stand by cell and ID, their partners with them.
  void settle(species<D>& one) {
    domain::migrate(d, one.s, one.partners);
    const auto order = cells::make_grid<D>(one.s.x, one.s.id, one.s.fluid, one.edge).members;
    particles::reorder(one.s, 0, std::span<const std::uint32_t>(order));
    for (auto* rows : one.partners) rows->reorder(order);
  }

  // Ghosts as far as any species looks for this one, a little more against rounding.
  void surround() {
    double widest = 0.0;
    for (std::size_t b = 0; b < size(); ++b) {
      auto& one = all_[b];
      d.width = 0.0;
      for (std::size_t a = 0; a < size(); ++a) d.width = std::max(d.width, reach(a, b) * (1.0 + 1e-6));
      widest = std::max(widest, d.width);
      domain::make_halo<D>(d, one.s, 0, one.s.fluid, one.s.fluid, one.halo,
                           [&](std::size_t ghosts) { particles::allocate(one.s, one.s.fluid, ghosts, 0, 0); });
      one.grid = cells::make_grid<D>(one.s.x, one.s.id, one.s.total(), one.edge);
    }
    d.width = widest;
  }

  template <class ReachOf>
  void make_list(std::size_t a, std::size_t b, const ReachOf& reach_of) {
    const auto& rows = all_[a].s;
    const auto& grid = all_[b].grid;
    if (!(reach(a, b) > 0.0))
      cells::make_list<D>(list(a, b), grid, rows.x, 0, cells::one_reach{0.0});
    else if (a == b)
      cells::make_list<D>(list(a, b), grid, rows.x, rows.fluid, reach_of(a, b));
    else
      cells::make_list<D, false>(list(a, b), grid, rows.x, rows.fluid, reach_of(a, b));
  }

  std::vector<species<D>> all_;
  std::vector<double> reach_;  // m, of a for b at a * size() + b
  std::vector<cells::neighbour_list> lists_;
};

}  // namespace tetsuame::species
