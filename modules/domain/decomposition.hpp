// Decomposition of a box into the cells of a slice grid (balance/cuts.hpp), one a rank; migration and halos.
//
// A ghost is a copy of a particle, or of its image over a periodic border, that lies in a rank's cell
// widened by the halo's width. Every number of ranks uses ghosts alike (a rank copies from itself), with the
// same shifts added to the same coordinates, so that x_i - x_j has the same bits. A cell may be narrower
// than the halo, and empty.
#pragma once

#include <algorithm>
#include <array>
#include <balance/cuts.hpp>
#include <bit>
#include <cmath>
#include <cstddef>
#include <domain/communicator.hpp>
#include <domain/halo.hpp>
#include <domain/options.hpp>
#include <foundation/threads.hpp>
#include <foundation/waiting.hpp>
#include <limits>
#include <particles/partners.hpp>
#include <particles/storage.hpp>
#include <span>
#include <vector>

namespace tetsuame::domain {

template <int D>
struct box {
  std::array<double, D> length{};  // m; the box is [0, length)
  std::array<bool, D> periodic{};
  // Of the lower and the upper side across each axis: nothing stands there, and the box is only where particles start;
  // they may go on to any distance.
  std::array<std::array<bool, 2>, D> open{};

  bool is_free(std::size_t a) const {
    return !periodic[a] && open[a][0] && open[a][1];
  }  // across axis a, on both sides
};

template <int D>
box<D> box_of(const options& o) {
  box<D> b;
  for (std::size_t a = 0; a < D; ++a) {
    b.length[a] = o.length[a];
    b.periodic[a] = o.periodic[a];
    b.open[a] = {o.open[a], o.open[a]};
  }
  return b;
}

template <int D>
struct decomposition {
  using bounds = typename balance::cuts<D>::bounds;

  communicator ranks;
  box<D> region;
  double width = 0.0;  // m, of the halo
  balance::cuts<D> cuts;
  halo<D> fluid_halo, wall_halo;
  int calls = 0;  // of sparse_exchange so far

  int owner(const std::array<double, D>& x) const { return cuts.owner(x); }
  bounds cell() const { return cuts.cell(ranks.rank); }  // this rank's; open towards the outside of the box
  // Whether x belongs to a cell: owner() for one cell, without the search.
  static bool within(const bounds& cell, const std::array<double, D>& x) {
    for (std::size_t a = 0; a < D; ++a)
      if (!(x[a] >= cell.lower[a] && x[a] < cell.upper[a])) return false;
    return true;
  }
};

// Cells of equal size.
// Fails with exit 2 where the columns do not divide the number of ranks. The halo may not be wider than a periodic box
// (check_widths): a particle would meet images that lie more than one box away.
template <int D>
decomposition<D> decompose(const communicator& ranks, const box<D>& region, double halo_width,
                           const rank_columns& columns = {}) {
  if (columns.number > 0 && ranks.size % columns.number != 0)
    foundation::fail_input(columns.place + std::to_string(columns.number) +
                           " does not divide the number of MPI ranks, " + std::to_string(ranks.size) +
                           ": choose one of its divisors, or 0 to have it chosen");
  decomposition<D> d;
  d.ranks = ranks;
  d.region = region;
  // A little more than lists ask for, so that rounding at the halo's edge leaves nothing out.
  d.width = halo_width * (1.0 + 1e-6);
  d.cuts = balance::equal_cuts<D>(balance::choose_counts<D>(ranks.size, region.length, static_cast<int>(columns.number),
                                                            {d.width, region.periodic}),
                                  region.length);
  d.fluid_halo.tag = 0;
  d.wall_halo.tag = 1;
  return d;
}

// Brings particles that left the box through a periodic border back in; start and list
// positions move along, so displacements stay true.
template <int D>
void wrap(const box<D>& region, particles::particles<D>& s) {
  for (std::size_t a = 0; a < D; ++a) {
    if (!region.periodic[a]) continue;
    const double length = region.length[a];
    foundation::for_all(s.fluid, [&](std::size_t i) {
      const double x = s.x[a][i];
      if (x >= 0.0 && x < length) return;
      const double shift = -std::floor(x / length) * length;
      s.x[a][i] += shift;
      if (s.keeps_start) s.x_start[a][i] += shift;
      s.x_list[a][i] += shift;
    });
  }
}

// Messages to a few ranks whose receivers do not know of them beforehand, without a step whose cost grows with the
// number of ranks: the non-blocking consensus of Hoefler, Siebert & Lumsdaine, "Scalable communication protocols for
// dynamic sparse data exchange", PPoPP (2010).
struct message {
  int rank = 0;  // where to, or where from
  std::vector<double> values;
};

// Sends every message to its rank (each rank at most once, this rank among them if need be); returns what came
// here, by rank. All ranks call this together, and two calls that follow each other differ in `tag`: a rank may
// be a call ahead of another.
inline std::vector<message> sparse_exchange(const communicator& ranks, const std::vector<message>& out, int tag) {
  std::vector<message> in;
  std::vector<MPI_Request> sent;
  for (const message& l : out) {
    if (l.rank == ranks.rank) {
      in.push_back(l);
      continue;
    }
    sent.emplace_back();
    // Synchronous: complete when the receiver has it.
    MPI_Issend(l.values.data(), static_cast<int>(l.values.size()), MPI_DOUBLE, l.rank, tag, ranks.comm, &sent.back());
    ++foundation::sent.migration_messages;
    foundation::sent.migration_bytes += static_cast<std::int64_t>(l.values.size() * sizeof(double));
  }
  if (ranks.size == 1) return in;
  const foundation::collective timed;
  MPI_Request barrier = MPI_REQUEST_NULL;
  bool all_mine_arrived = false;
  for (int everyone_done = 0; everyone_done == 0;) {
    int here = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, tag, ranks.comm, &here, &status);
    if (here != 0) {
      int n = 0;
      MPI_Get_count(&status, MPI_DOUBLE, &n);
      message l{status.MPI_SOURCE, std::vector<double>(static_cast<std::size_t>(n))};
      MPI_Recv(l.values.data(), n, MPI_DOUBLE, l.rank, tag, ranks.comm, MPI_STATUS_IGNORE);
      in.push_back(std::move(l));
    }
    if (all_mine_arrived) {
      MPI_Test(&barrier, &everyone_done, MPI_STATUS_IGNORE);
      continue;
    }
    int done = 0;
    MPI_Testall(static_cast<int>(sent.size()), sent.data(), &done, MPI_STATUSES_IGNORE);
    if (done == 0) continue;
    all_mine_arrived = true;
    MPI_Ibarrier(ranks.comm, &barrier);
  }
  std::sort(in.begin(), in.end(), [](const message& a, const message& b) { return a.rank < b.rank; });
  return in;
}

namespace detail {

template <int D>
std::vector<particles::array*> travelling_fields(particles::particles<D>& s) {
  std::vector<particles::array*> all;
  particles::for_each_field<D>(s, [&](const particles::field_info& field, const auto& components) {
    if (particles::travels(field.kind)) all.insert(all.end(), components.begin(), components.end());
  });
  return all;
}

// Two tags in turn, neither of them a halo's.
template <int D>
int next_tag(decomposition<D>& d) {
  return 2 + d.calls++ % 2;
}

}  // namespace detail

// Hands every fluid particle to the rank whose cell holds its position, and with it its rows of the attached partners.
// Ghosts are gone afterwards; the order is arbitrary until it is sorted, that of the rows the same.
template <int D>
void migrate(decomposition<D>& d, particles::particles<D>& s, std::span<particles::partners* const> attached = {}) {
  for (const auto* p : attached) p->require_rows_of({s.id.data(), s.fluid});
  const auto fields = detail::travelling_fields<D>(s);
  const std::size_t row = fields.size() + 2;
  const auto cell = d.cell();
  const auto stays = [&](std::size_t i) { return d.within(cell, particles::position<D>(s.x, i)); };
  std::vector<std::pair<int, std::size_t>> leave;  // to which rank, who
  const auto leaves = [&](std::size_t i) { return !stays(i); };
  for (const std::size_t i : foundation::indices_where<std::size_t>(s.fluid, leaves))
    leave.emplace_back(d.owner(particles::position<D>(s.x, i)), i);
  std::sort(leave.begin(), leave.end());
  std::vector<message> out;
  for (const auto& [rank, i] : leave) {
    if (out.empty() || out.back().rank != rank) out.push_back({rank, {}});
    auto& values = out.back().values;
    values.push_back(std::bit_cast<double>(s.id[i]));
    values.push_back(static_cast<double>(s.material[i]));
    for (const auto* a : fields) values.push_back((*a)[i]);
    for (const auto* p : attached) p->pack(i, values);
  }
  const auto in = sparse_exchange(d.ranks, out, detail::next_tag(d));
  const std::size_t staying = s.fluid - leave.size();
  if (!leave.empty()) {
    const auto stay = foundation::indices_where<std::uint32_t>(s.fluid, stays);
    particles::reorder(s, 0, std::span<const std::uint32_t>(stay));
    for (auto* p : attached) p->reorder(stay);
  }
  std::vector<const double*> rows;  // where that of each particle that came begins
  for (const auto& l : in)
    for (const double* v = l.values.data(); v < l.values.data() + l.values.size();) {
      rows.push_back(v);
      const auto id = std::bit_cast<std::int64_t>(v[0]);
      v += row;
      for (auto* p : attached) v = p->append(id, v);
    }
  // Room for the new fluid; the walls move along behind it.
  particles::allocate(s, staying + rows.size(), 0, s.walls, 0);
  std::size_t i = staying;
  for (const double* v : rows) {
    s.id[i] = std::bit_cast<std::int64_t>(v[0]);
    s.material[i] = static_cast<std::int32_t>(v[1]);
    for (std::size_t f = 0; f < fields.size(); ++f) (*fields[f])[i] = v[2 + f];
    ++i;
  }
}

namespace detail {

// f(rank, cell widened by the halo) for the cells that so come near the box from `low` to `high`. Over a periodic
// border images stand for what is beyond, so cells end there. Cells between two cuts that coincide hold nothing.
template <int D, class F>
void for_each_cell_near(const decomposition<D>& d, const std::array<double, D>& low, const std::array<double, D>& high,
                        F&& f) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  typename decomposition<D>::bounds b;
  const auto descend = [&](auto&& self, std::size_t axis, std::size_t group) -> void {
    if (axis == D) {
      f(static_cast<int>(group), b);
      return;
    }
    const int n = d.cuts.counts[axis];
    const double* c = d.cuts.group(axis, group);
    for (int i = 0; i < n; ++i) {
      const double lower = i == 0 && !d.region.periodic[axis] ? -infinity : c[i];
      const double upper = i + 1 == n && !d.region.periodic[axis] ? infinity : c[i + 1];
      b.lower[axis] = lower - d.width;
      b.upper[axis] = upper + d.width;
      if (!(lower < upper && high[axis] >= b.lower[axis] && low[axis] <= b.upper[axis])) continue;
      self(self, axis + 1, group * static_cast<std::size_t>(n) + static_cast<std::size_t>(i));
    }
  };
  descend(descend, 0, 0);
}

// Particles of the block that another cell, or an image of this rank's own, may see.
template <int D>
std::vector<std::uint32_t> rim(const decomposition<D>& d, const particles::particles<D>& s, std::size_t begin,
                               std::size_t end) {
  auto deep = d.cell();
  for (std::size_t a = 0; a < D; ++a) {
    // Over a periodic border the neighbour is an image.
    if (d.region.periodic[a]) {
      deep.lower[a] = std::max(deep.lower[a], 0.0);
      deep.upper[a] = std::min(deep.upper[a], d.region.length[a]);
    }
    // Twice the width, against rounding at its edge.
    deep.lower[a] += 2.0 * d.width;
    deep.upper[a] -= 2.0 * d.width;
  }
  auto all = foundation::indices_where<std::uint32_t>(
      end - begin, [&](std::size_t k) { return !d.within(deep, particles::position<D>(s.x, begin + k)); });
  for (std::uint32_t& i : all) i += static_cast<std::uint32_t>(begin);
  return all;
}

// Fills what is sent: to each rank, for each shift over periodic borders, the sources in their order.
template <int D>
void choose_sources(const decomposition<D>& d, const particles::particles<D>& s, std::size_t begin, std::size_t end,
                    halo<D>& plan) {
  struct part {
    int rank;
    std::uint8_t shift;
    std::vector<std::uint32_t> sources;
  };
  std::vector<part> parts;
  const auto candidates = rim(d, s, begin, end);
  std::array<double, D> low, high;
  low.fill(std::numeric_limits<double>::infinity());
  high.fill(-std::numeric_limits<double>::infinity());
  for (const std::uint32_t i : candidates)
    for (std::size_t a = 0; a < D; ++a) {
      low[a] = std::min(low[a], s.x[a][i]);
      high[a] = std::max(high[a], s.x[a][i]);
    }
  for (std::size_t n = 0; n < plan.shifts; ++n) {
    auto& by = plan.shift_by[n];
    auto from = low, to = high;
    bool exists = !candidates.empty(), moves = false;
    std::size_t digits = n;
    for (std::size_t a = 0; a < D; ++a, digits /= 3) {
      // -0.0 added leaves every value as it is, a zero's sign too.
      by[a] = digits % 3 == 0 ? -0.0 : digits % 3 == 1 ? d.region.length[a] : -d.region.length[a];
      exists = exists && (digits % 3 == 0 || d.region.periodic[a]);
      moves = moves || digits % 3 != 0;
      from[a] += by[a];
      to[a] += by[a];
    }
    if (!exists) continue;
    for_each_cell_near<D>(d, from, to, [&](int rank, const typename decomposition<D>::bounds& cell) {
      if (rank == d.ranks.rank && !moves) return;
      part p{rank, static_cast<std::uint8_t>(n), {}};
      for (const std::uint32_t i : candidates) {
        bool seen = true;
        for (std::size_t a = 0; a < D; ++a) {
          const double x = s.x[a][i] + by[a];
          seen = seen && x >= cell.lower[a] && x <= cell.upper[a];
        }
        if (seen) p.sources.push_back(i);
      }
      if (!p.sources.empty()) parts.push_back(std::move(p));
    });
  }
  std::stable_sort(parts.begin(), parts.end(), [](const part& a, const part& b) { return a.rank < b.rank; });
  plan.sources.clear();
  plan.shift.clear();
  plan.to.clear();
  for (const part& p : parts) {
    if (plan.to.empty() || plan.to.back().rank != p.rank) plan.to.push_back({p.rank, plan.sources.size(), 0});
    plan.to.back().count += p.sources.size();
    plan.sources.insert(plan.sources.end(), p.sources.begin(), p.sources.end());
    plan.shift.insert(plan.shift.end(), p.sources.size(), p.shift);
  }
}

}  // namespace detail

// Makes the halo of the block [begin, begin + owned), whose ghosts will stand from `ghosts_begin` on, with the
// ghosts' positions, IDs and materials. `grow(number of ghosts)` must make room for them.
template <int D, class Grow>
void make_halo(decomposition<D>& d, particles::particles<D>& s, std::size_t begin, std::size_t owned,
               std::size_t ghosts_begin, halo<D>& plan, Grow&& grow) {
  detail::choose_sources<D>(d, s, begin, begin + owned, plan);
  constexpr std::size_t row = D + 2;
  std::vector<message> out;
  for (const auto& to : plan.to) {
    out.push_back({to.rank, {}});
    auto& values = out.back().values;
    values.reserve(to.count * row);
    for (std::size_t k = to.begin; k < to.begin + to.count; ++k) {
      const std::size_t i = plan.sources[k];
      for (std::size_t a = 0; a < D; ++a) values.push_back(s.x[a][i] + plan.shift_by[plan.shift[k]][a]);
      values.push_back(std::bit_cast<double>(s.id[i]));
      values.push_back(static_cast<double>(s.material[i]));
    }
  }
  const auto in = sparse_exchange(d.ranks, out, detail::next_tag(d));
  plan.from.clear();
  plan.ghosts_begin = ghosts_begin;
  plan.ghosts = 0;
  for (const message& l : in) {
    plan.from.push_back({l.rank, plan.ghosts, l.values.size() / row});
    plan.ghosts += plan.from.back().count;
  }
  grow(plan.ghosts);
  std::size_t g = ghosts_begin;
  for (const message& l : in)
    for (const double* v = l.values.data(); v < l.values.data() + l.values.size(); v += row, ++g) {
      for (std::size_t a = 0; a < D; ++a) s.x[a][g] = v[a];
      s.id[g] = std::bit_cast<std::int64_t>(v[D]);
      s.material[g] = static_cast<std::int32_t>(v[D + 1]);
    }
}

}  // namespace tetsuame::domain
