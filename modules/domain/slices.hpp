// Decomposition of a box into slices along x, one a rank; halos and migration.
//
// A ghost is a copy of a particle that lies within the halo width of a slice, or of a
// periodic border. Every rank count uses ghosts alike (one rank copies from itself), with
// the same shift added to the same coordinate, so that x_i - x_j has the same bits.
// Halos are made dimension by dimension: what x brought is offered to y, then to z,
// which fills the corners without messages across them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <domain/communicator.hpp>
#include <particles/storage.hpp>
#include <span>
#include <vector>

namespace tetsuame::domain {

template <int D>
struct box {
  std::array<double, D> length{};  // m; the box is [0, length)
  std::array<bool, D> periodic{};
};

// One dimension's copies from a block to the ghosts behind it.
struct copy {
  int to = 0, from = 0;  // ranks; MPI_PROC_NULL: none
  double shift = 0.0;    // m, added to the coordinate of what is sent
  std::size_t axis = 0;
  std::vector<std::size_t> sources;        // local indices sent
  std::size_t destination = 0, count = 0;  // local indices received
};

// Ghosts of one block (fluid or walls), in the order they are made.
using halo = std::vector<copy>;

template <int D>
struct slices {
  communicator ranks;
  box<D> region;
  double width = 0.0;        // m, of the halo
  std::vector<double> cuts;  // m, ranks + 1 of them
  halo fluid_halo, wall_halo;

  double lower() const { return cuts[static_cast<std::size_t>(ranks.rank)]; }
  double upper() const { return cuts[static_cast<std::size_t>(ranks.rank) + 1]; }
  // Particles beyond the first or last cut (wall particles) belong to the end slices.
  int owner(double x) const {
    const auto above = std::upper_bound(cuts.begin() + 1, cuts.end() - 1, x);
    return static_cast<int>(above - cuts.begin()) - 1;
  }
};

// Slices of equal width; fails with exit 2 when they would be narrower than the halo.
template <int D>
slices<D> make_slices(const communicator& ranks, const box<D>& region, double halo_width) {
  slices<D> d;
  d.ranks = ranks;
  d.region = region;
  d.width = halo_width;
  const auto most = static_cast<int>(region.length[0] / halo_width);
  if (ranks.size > 1 && ranks.size > most)
    foundation::fail_input(
        "too many MPI ranks for this domain: a slice along x must be at least as wide as the halo, " +
        std::to_string(halo_width) + " m (kernel support, marker radius and list skin), so at most " +
        std::to_string(std::max(most, 1)) + " ranks; use fewer ranks, and OpenMP threads beside them");
  for (int r = 0; r <= ranks.size; ++r) d.cuts.push_back(region.length[0] * r / ranks.size);
  return d;
}

// Brings particles that left the box through a periodic border back in; start and list
// positions move along, so displacements stay true.
template <int D>
void wrap(const box<D>& region, particles::particles<D>& s) {
  for (std::size_t a = 0; a < D; ++a) {
    if (!region.periodic[a]) continue;
    const double length = region.length[a];
    for (std::size_t i = 0; i < s.fluid; ++i) {
      const double shift = s.x[a][i] < 0.0 ? length : s.x[a][i] >= length ? -length : 0.0;
      if (shift == 0.0) continue;
      s.x[a][i] += shift;
      s.x_start[a][i] += shift;
      s.x_list[a][i] += shift;
    }
  }
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

// Sends rows[r] to rank r for every r; returns what the others sent here, in rank order.
template <class T>
std::vector<T> all_to_all(const communicator& ranks, const std::vector<std::vector<T>>& rows, MPI_Datatype type) {
  const auto n = static_cast<std::size_t>(ranks.size);
  std::vector<int> send(n), receive(n), send_at(n), receive_at(n);
  std::vector<T> out;
  for (std::size_t r = 0; r < n; ++r) {
    send[r] = static_cast<int>(rows[r].size());
    send_at[r] = static_cast<int>(out.size());
    out.insert(out.end(), rows[r].begin(), rows[r].end());
  }
  MPI_Alltoall(send.data(), 1, MPI_INT, receive.data(), 1, MPI_INT, ranks.comm);
  int total = 0;
  for (std::size_t r = 0; r < n; ++r) {
    receive_at[r] = total;
    total += receive[r];
  }
  std::vector<T> in(static_cast<std::size_t>(total));
  MPI_Alltoallv(out.data(), send.data(), send_at.data(), type, in.data(), receive.data(), receive_at.data(), type,
                ranks.comm);
  return in;
}

}  // namespace detail

// Hands every fluid particle to the rank whose slice holds `at` (its x or list position).
// Ghosts are gone afterwards; the order is arbitrary until it is sorted.
template <int D>
void migrate(const slices<D>& d, particles::particles<D>& s, const particles::array& at) {
  const auto size = static_cast<std::size_t>(d.ranks.size);
  const auto fields = detail::travelling_fields<D>(s);
  std::vector<std::size_t> stay;
  std::vector<std::vector<double>> values(size);
  std::vector<std::vector<std::int64_t>> keys(size);
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const int r = d.owner(at[i]);
    if (r == d.ranks.rank) {
      stay.push_back(i);
      continue;
    }
    const auto to = static_cast<std::size_t>(r);
    keys[to].push_back(s.id[i]);
    keys[to].push_back(s.material[i]);
    for (const auto* a : fields) values[to].push_back((*a)[i]);
  }
  const auto new_keys = detail::all_to_all(d.ranks, keys, MPI_INT64_T);
  const auto new_values = detail::all_to_all(d.ranks, values, MPI_DOUBLE);
  if (stay.size() < s.fluid) particles::reorder(s, 0, std::span<const std::size_t>(stay));
  const std::size_t arrived = new_keys.size() / 2, kept = stay.size();
  // Room for the new fluid; the walls move along behind it.
  particles::allocate(s, kept + arrived, 0, s.walls, 0);
  for (std::size_t n = 0; n < arrived; ++n) {
    s.id[kept + n] = new_keys[2 * n];
    s.material[kept + n] = static_cast<std::int32_t>(new_keys[2 * n + 1]);
    for (std::size_t f = 0; f < fields.size(); ++f) (*fields[f])[kept + n] = new_values[n * fields.size() + f];
  }
}

namespace detail {

inline void transfer(const communicator& ranks, const copy& c, const std::vector<double>& out,
                     std::vector<double>& in) {
  if (c.to == ranks.rank && c.from == ranks.rank) {
    in = out;
    return;
  }
  MPI_Sendrecv(out.data(), static_cast<int>(out.size()), MPI_DOUBLE, c.to, 0, in.data(), static_cast<int>(in.size()),
               MPI_DOUBLE, c.from, 0, ranks.comm, MPI_STATUS_IGNORE);
}

template <int D>
copy plan_copy(const slices<D>& d, const particles::particles<D>& s, std::size_t axis, int side, std::size_t begin,
               std::size_t end, std::size_t ghosts_begin, std::size_t ghosts_end) {
  const int size = d.ranks.size, rank = d.ranks.rank;
  const double length = d.region.length[axis];
  copy c;
  c.axis = axis;
  double edge = side < 0 ? 0.0 : length;
  if (axis == 0) {
    edge = side < 0 ? d.lower() : d.upper();
    const int to = rank + side, from = rank - side;
    const bool around = d.region.periodic[0];
    c.to = to >= 0 && to < size ? to : around ? (to + size) % size : MPI_PROC_NULL;
    c.from = from >= 0 && from < size ? from : around ? (from + size) % size : MPI_PROC_NULL;
    // What leaves over the right border turns up left of it, and the reverse.
    if (to < 0 || to >= size) c.shift = side < 0 ? length : -length;
  } else {
    c.to = c.from = d.region.periodic[axis] ? rank : MPI_PROC_NULL;
    c.shift = side < 0 ? length : -length;
  }
  if (c.to == MPI_PROC_NULL) return c;
  const auto take = [&](std::size_t i) {
    const double x = s.x[axis][i];
    if (side < 0 ? x < edge + d.width : x >= edge - d.width) c.sources.push_back(i);
  };
  for (std::size_t i = begin; i < end; ++i) take(i);
  for (std::size_t i = ghosts_begin; i < ghosts_end; ++i) take(i);
  return c;
}

}  // namespace detail

// Makes the halo of the block [begin, begin + owned), whose ghosts will stand from
// `ghosts_begin` on; returns their number. Each axis offers what the axes before it brought.
// Positions of the ghosts are kept in the arrays, which must have room: hence two passes,
// with `grow(ghosts so far)` called before ghosts are written.
template <int D, class Grow>
std::size_t make_halo(const slices<D>& d, particles::particles<D>& s, std::size_t begin, std::size_t owned,
                      std::size_t ghosts_begin, halo& plan, Grow&& grow) {
  plan.clear();
  std::size_t ghosts = 0;
  for (std::size_t axis = 0; axis < D; ++axis) {
    const std::size_t known = ghosts;
    for (const int side : {-1, +1}) {
      copy c = detail::plan_copy(d, s, axis, side, begin, begin + owned, ghosts_begin, ghosts_begin + known);
      auto sent = static_cast<std::int64_t>(c.sources.size());
      std::int64_t received = 0;
      if (c.to == d.ranks.rank && c.from == d.ranks.rank)
        received = sent;
      else
        MPI_Sendrecv(&sent, 1, MPI_INT64_T, c.to, 1, &received, 1, MPI_INT64_T, c.from, 1, d.ranks.comm,
                     MPI_STATUS_IGNORE);
      c.count = static_cast<std::size_t>(received);
      c.destination = ghosts_begin + ghosts;
      ghosts += c.count;
      grow(ghosts);
      std::vector<double> out, in(c.count * (D + 2));
      for (const std::size_t i : c.sources) {
        for (std::size_t a = 0; a < D; ++a) out.push_back(s.x[a][i] + (a == axis ? c.shift : 0.0));
        out.push_back(static_cast<double>(s.id[i]));
        out.push_back(s.material[i]);
      }
      detail::transfer(d.ranks, c, out, in);
      for (std::size_t n = 0; n < c.count; ++n) {
        const std::size_t g = c.destination + n;
        for (std::size_t a = 0; a < D; ++a) s.x[a][g] = in[n * (D + 2) + a];
        s.id[g] = static_cast<std::int64_t>(in[n * (D + 2) + D]);
        s.material[g] = static_cast<std::int32_t>(in[n * (D + 2) + D + 1]);
      }
      plan.push_back(std::move(c));
    }
  }
  return ghosts;
}

// Refreshes the ghosts' values of the given arrays.
inline void exchange(const communicator& ranks, const halo& plan, std::span<double* const> fields) {
  std::vector<double> out, in;
  for (const copy& c : plan) {
    out.clear();
    out.reserve(c.sources.size() * fields.size());
    for (const double* f : fields)
      for (const std::size_t i : c.sources) out.push_back(f[i]);
    in.resize(c.count * fields.size());
    detail::transfer(ranks, c, out, in);
    for (std::size_t f = 0; f < fields.size(); ++f)
      std::copy_n(in.begin() + static_cast<std::ptrdiff_t>(f * c.count), c.count, fields[f] + c.destination);
  }
}

// Refreshes the ghosts' positions, shifted over periodic borders.
template <int D>
void exchange_positions(const communicator& ranks, const halo& plan, std::array<particles::array, D>& x) {
  std::vector<double> out, in;
  for (const copy& c : plan) {
    out.clear();
    for (std::size_t a = 0; a < D; ++a)
      for (const std::size_t i : c.sources) out.push_back(x[a][i] + (a == c.axis ? c.shift : 0.0));
    in.resize(c.count * D);
    detail::transfer(ranks, c, out, in);
    for (std::size_t a = 0; a < D; ++a)
      std::copy_n(in.begin() + static_cast<std::ptrdiff_t>(a * c.count), c.count,
                  x[a].begin() + static_cast<std::ptrdiff_t>(c.destination));
  }
}

}  // namespace tetsuame::domain
