// Neighbour lists with a skin: valid until some particle has moved half of it.
//
// Particles that follow each other in memory, as many as a SIMD register has lanes, are a cluster: they stand together,
// since particles are sorted by cells, and share one row of the list. It holds every particle within reach of any of
// them, and says which of them. Neighbours stand in the order of the grid, and for members that do not have one it is
// so far away that it adds an exact zero. So every sum over a row has the same bits on any number of ranks and threads,
// wherever clusters begin and end.
#pragma once

#include <algorithm>
#include <bit>
#include <cells/grid.hpp>
#include <cstddef>
#include <cstdint>
#include <foundation/lanes.hpp>
#include <foundation/threads.hpp>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace tetsuame::cells {

// A vector with it leaves new values as they are: large arrays that are written at once are not filled before.
template <class T>
struct uninitialised : std::allocator<T> {
  template <class U>
  void construct(U* at) {
    ::new (static_cast<void*>(at)) U;
  }
};

using entries = std::vector<std::uint32_t, uninitialised<std::uint32_t>>;

struct list_of_rows {
  std::vector<std::size_t> start;  // per row, into `all`; one more at the end
  entries all;
  std::size_t pairs = 0;  // of a particle, or point, and a neighbour

  std::size_t rows() const { return start.empty() ? 0 : start.size() - 1; }
  std::span<const std::uint32_t> row(std::size_t r) const { return {all.data() + start[r], all.data() + start[r + 1]}; }
  double bytes() const {
    return static_cast<double>(start.capacity() * sizeof(start[0]) + all.capacity() * sizeof(all[0]));
  }
};

// Local indices of the neighbours of each of some points.
struct point_list : list_of_rows {};

// Of each cluster. An entry is what a neighbour's local index is above that of the one before, from 0 on, in its upper
// bits, and in the lower ones the lanes that have this neighbour. A larger distance stands by itself behind a 0.
struct neighbour_list : list_of_rows {
  // Members of a cluster: numbers in one SIMD register, doubles or single.
  std::size_t width = foundation::lanes;
  static_assert(foundation::single::size() == 2 * foundation::lanes && foundation::single::size() <= 16);
  // Lower bits of an entry.
  static constexpr int bits_of(std::size_t width) { return width <= 8 ? 8 : 16; }

  // Scratch of the pair loop: what it reads of the neighbours, packed.
  struct scratch {
    particles::array doubles;
    std::vector<float, particles::aligned_allocator<float>> singles;

    template <class Number>
    auto& of() {
      if constexpr (std::is_same_v<Number, float>)
        return singles;
      else
        return doubles;
    }
  };
  mutable scratch records;

  // The row of the cluster that particle i is in.
  std::span<const std::uint32_t> row_of(std::size_t i) const { return row(i / width); }
  // f(neighbour, lanes that have it) for each in the row of cluster r.
  template <class F>
  void for_each(std::size_t r, F&& f) const {
    for (neighbour n(row(r), width); n.next();) f(n.j, n.of_lanes);
  }

  // Goes through a row.
  struct neighbour {
    const std::uint32_t *at, *end;
    int bits;
    std::uint32_t j = 0, of_lanes = 0;

    neighbour(std::span<const std::uint32_t> row, std::size_t width)
        : at(row.data()), end(row.data() + row.size()), bits(bits_of(width)) {}
    [[gnu::always_inline]] bool next() {
      if (at == end) return false;
      std::uint32_t entry = *at++;
      if (entry == 0) [[unlikely]] {
        j += *at++;
        entry = *at++;
      }
      j += static_cast<std::uint32_t>(static_cast<std::int32_t>(entry) >> bits);
      of_lanes = entry & ((1U << bits) - 1U);
      return true;
    }
  };
};

// Writes entries of a row.
class entry_writer {
 public:
  // Words that an entry takes at most.
  static constexpr std::size_t most = 3;
  std::uint32_t* out = nullptr;

  explicit entry_writer(std::size_t width) : bits_(neighbour_list::bits_of(width)) {}

  // Nothing where no lane has it.
  void add(std::uint32_t j, std::uint32_t of_lanes) {
    if (of_lanes == 0) return;
    const std::int64_t step = std::int64_t{j} - std::int64_t{last_};
    const std::int64_t reach = std::int64_t{1} << (31 - bits_);
    std::uint32_t upper = static_cast<std::uint32_t>(step) << bits_;
    if (step < -reach || step >= reach) {
      *out++ = 0;
      *out++ = static_cast<std::uint32_t>(step);
      upper = 0;
    }
    *out++ = upper | of_lanes;
    last_ = j;
  }

 private:
  int bits_;
  std::uint32_t last_ = 0;
};

// Where a thread's rows grow.
class row_store {
 public:
  // Room for n more; returns where they go. Those written are kept by keep(their end).
  std::uint32_t* room(std::size_t n) {
    if (used_ + n > made_.size()) made_.resize(2 * (used_ + n));
    return made_.data() + used_;
  }
  void keep(const std::uint32_t* end) { used_ = static_cast<std::size_t>(end - made_.data()); }
  std::size_t size() const { return used_; }
  const std::uint32_t* begin() const { return made_.data(); }
  void clear() { used_ = 0; }

 private:
  entries made_;
  std::size_t used_ = 0;
};

// Rows of a list, row r made by make(r, row_store), which returns its number of pairs. The list's memory serves again.
//
// Threads make blocks of rows in stores that stay in their caches, and copy each to its place as soon as the lengths of
// those before it are known. Where the memory does not suffice, the first sweep finds out how much is needed.
template <class Make>
void make_rows(list_of_rows& list, std::size_t rows, const Make& make) {
  constexpr std::size_t block = 32;
  list.start.resize(rows + 1);
  list.start[0] = 0;
  list.all.resize(list.all.capacity());
  std::size_t pairs = 0, end = 0;
  const auto sweep = [&] {
    pairs = end = 0;
#pragma omp parallel reduction(+ : pairs) if (rows > block)
    {
      row_store made;
#pragma omp for ordered schedule(dynamic, 1)
      for (std::size_t first = 0; first < rows; first += block) {
        const std::size_t last = std::min(rows, first + block);
        made.clear();
        for (std::size_t r = first; r < last; ++r) {
          pairs += make(r, made);
          list.start[r + 1] = made.size();  // from the block's begin
        }
        std::size_t begin;
#pragma omp ordered
        {
          begin = end;
          end += made.size();
        }
        for (std::size_t r = first; r < last; ++r) list.start[r + 1] += begin;
        if (begin + made.size() <= list.all.size())
          std::copy_n(made.begin(), made.size(), list.all.begin() + static_cast<std::ptrdiff_t>(begin));
      }
    }
  };
  sweep();
  if (end > list.all.size()) {
    list.all.clear();
    list.all.shrink_to_fit();         // before the new memory is taken
    list.all.resize(end + end / 64);  // a little to spare
    sweep();
  }
  list.all.resize(end);
  list.pairs = pairs;
}

// Register h of the values of n members, the last one's in the lanes behind.
inline foundation::real of_members(const double* from, std::size_t n, std::size_t h) {
  return foundation::real([&](auto lane) { return from[std::min<std::size_t>(h * foundation::lanes + lane, n - 1)]; });
}

// One reach for all pairs: those of one support.
struct one_reach {
  double most;  // m
  const one_reach& of(std::size_t, std::size_t) const { return *this; }
  foundation::real squared(std::uint32_t, std::size_t) const { return most * most; }
};

// The members of a cluster, so many registers of them: particles [first, first + n).
template <int D, std::size_t registers>
struct cluster_positions {
  std::array<std::array<foundation::real, D>, registers> x;  // m
  std::array<double, D> low, high;

  cluster_positions(const std::array<particles::array, D>& all, std::size_t first, std::size_t n) {
    for (std::size_t a = 0; a < D; ++a) {
      const double* from = all[a].data() + first;
      for (std::size_t h = 0; h < registers; ++h) x[h][a] = of_members(from, n, h);
      const auto [least, most] = std::minmax_element(from, from + n);
      low[a] = *least;
      high[a] = *most;
    }
  }
};

template <int D, std::size_t registers, class Reach>
void make_list_of(neighbour_list& list, const grid<D>& g, const std::array<particles::array, D>& x, std::size_t n,
                  const Reach& reach) {
  using foundation::lanes, foundation::real;
  const std::size_t width = list.width;
  make_rows(list, (n + width - 1) / width, [&](std::size_t r, row_store& made) {
    const std::size_t first = r * width, members = std::min(width, n - first);
    const cluster_positions<D, registers> cluster(x, first, members);
    const std::uint32_t all_members = (1U << members) - 1U;
    std::size_t pairs = 0;
    entry_writer row(width);
    const auto& of_cluster = reach.of(first, members);
    for_each_near<D>(g, cluster.low, cluster.high, of_cluster.most, [&](std::uint32_t k, std::uint64_t near) {
      row.out = made.room(64 * entry_writer::most);
      for (; near != 0; near &= near - 1) {
        const std::uint32_t at = k + static_cast<std::uint32_t>(std::countr_zero(near));
        const std::uint32_t j = g.members[at];
        std::uint32_t within = 0;
        for (std::size_t h = 0; h < registers; ++h) {
          real r2(0.0);
          for (std::size_t a = 0; a < D; ++a) {
            const real x_ij = cluster.x[h][a] - g.sorted[a][at];
            r2 += x_ij * x_ij;
          }
          within |= foundation::bits_of_less(r2, of_cluster.squared(j, h)) << h * lanes;
        }
        within &= all_members;
        // None is its own neighbour.
        if (const std::size_t own = j - first; own < width) within &= ~(1U << own);
        row.add(j, within);
        pairs += static_cast<std::size_t>(std::popcount(within));
      }
      made.keep(row.out);
    });
    return pairs;
  });
}

// Rows of the clusters of particles [0, n): the particles nearer than the pair's reach to a member. reach.of(first, n),
// of the cluster [first, first + n), has `most`, m, no smaller than any pair's reach, and squared(j, h), m2, that of j
// with each member of the cluster's register number h.
template <int D, class Reach>
void make_list(neighbour_list& list, const grid<D>& g, const std::array<particles::array, D>& x, std::size_t n,
               const Reach& reach) {
  if (list.width == foundation::lanes)
    make_list_of<D, 1>(list, g, x, n, reach);
  else
    make_list_of<D, 2>(list, g, x, n, reach);
}

// Rows of points: row r has the particles nearer to centre(r) than `reach` that `accept` takes, filled up with `null`
// to a multiple of the lanes.
template <int D, class Centre, class Accept>
void make_list_of_points(point_list& list, const grid<D>& g, std::size_t points, double reach, std::uint32_t null,
                         const Centre& centre, const Accept& accept) {
  using foundation::lanes;
  make_rows(list, points, [&](std::size_t r, row_store& made) {
    const std::array<double, D> at = centre(r);
    const std::size_t before = made.size();
    for_each_near<D>(g, at, at, reach, [&](std::uint32_t k, std::uint64_t near) {
      std::uint32_t* out = made.room(64);
      for (; near != 0; near &= near - 1) {
        const std::uint32_t j = g.members[k + static_cast<std::uint32_t>(std::countr_zero(near))];
        *out = j;
        out += accept(j) ? 1 : 0;
      }
      made.keep(out);
    });
    const std::size_t pairs = made.size() - before, padding = (lanes - pairs % lanes) % lanes;
    made.keep(std::fill_n(made.room(padding), padding, null));
    return pairs;
  });
}

}  // namespace tetsuame::cells
