// Neighbour lists with a skin: valid until some particle has moved half of it.
//
// Particles that follow each other in memory, as many as a SIMD register has lanes, are a cluster: they stand together,
// since particles are sorted by cells, and share one row of the list. It holds every particle within reach of any of
// them, and says which of them. Neighbours stand in the order of the grid, and for members that do not have one it is
// so far away that it adds an exact zero. So every sum over a row has the same bits on any number of ranks and threads,
// wherever clusters begin and end.
//
// In single precision a register has room for the members beside two neighbours at once. A row then goes through two
// sequences, each in the order of the grid, side by side; which of them a particle is in follows from its place alone,
// so that ranks and clusters change no bit of the two sums, nor of their sum.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cells/grid.hpp>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <foundation/lanes.hpp>
#include <foundation/threads.hpp>
#include <foundation/unfilled.hpp>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace tetsuame::cells {

template <class Word>
struct list_of_rows {
  using word = Word;
  using words = foundation::unfilled<Word>;
  std::vector<std::size_t> start;  // per row, into `all`; one more at the end
  words all;
  std::size_t pairs = 0;  // of a particle, or point, and a neighbour

  std::size_t rows() const { return start.empty() ? 0 : start.size() - 1; }
  std::span<const Word> row(std::size_t r) const { return {all.data() + start[r], all.data() + start[r + 1]}; }
  double bytes() const {
    return static_cast<double>(start.capacity() * sizeof(start[0]) + all.capacity() * sizeof(all[0]));
  }
};

// Local indices of the neighbours of each of some points.
struct point_list : list_of_rows<std::uint32_t> {};

// Of each cluster. The lower byte of an entry has the lanes that have this neighbour, the upper one what its local
// index is above that of the one before in its sequence. Steps that are too far for that, and the first one, stand
// behind the row's entries, two words each, the last one first.
struct neighbour_list : list_of_rows<std::uint16_t> {
  static constexpr std::size_t width = foundation::lanes;  // members of a cluster
  static_assert(width <= 8 && foundation::single::size() == 2 * width);
  static constexpr std::int32_t far_step = -128;

  std::size_t interleave = 1;  // sequences, 1 or 2

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
  std::span<const std::uint16_t> row_of(std::size_t i) const { return row(i / width); }
  // f(neighbour, lanes that have it, its sequence) for each in the row of cluster r, the sequences side by side.
  template <class F>
  void for_each(std::size_t r, F&& f) const {
    constexpr std::uint32_t lanes_of_one = (1U << width) - 1U;
    const auto through = [&](auto n) {
      while (n.next())
        for (std::size_t k = 0; k < n.j.size(); ++k)
          if (const std::uint32_t of_lanes = n.of_lanes >> k * width & lanes_of_one; of_lanes != 0)
            f(n.j[k], of_lanes, k);
    };
    interleave == 1 ? through(neighbours<1>(row(r))) : through(neighbours<2>(row(r)));
  }

  // Goes through a row, its n sequences at once.
  template <std::size_t n>
  struct neighbours {
    const std::uint16_t *at, *far;
    std::array<std::uint32_t, n> j{};
    std::uint32_t of_lanes = 0;  // of the first neighbour, then of the second

    explicit neighbours(std::span<const std::uint16_t> row) : at(row.data()), far(row.data() + row.size()) {}
    // No jumps: few steps are far, but nobody can foresee which.
    [[gnu::always_inline]] bool next() {
      if (at == far) return false;
      of_lanes = 0;
      for (std::size_t k = 0; k < n; ++k) {
        const std::uint32_t entry = *at++;
        const std::int32_t step = static_cast<std::int16_t>(entry) >> 8;
        std::uint32_t far_away;
        std::memcpy(&far_away, far - 2, sizeof(far_away));
        const auto near_by = static_cast<std::uint32_t>(step), is_far = static_cast<std::uint32_t>(step == far_step);
        j[k] += near_by ^ ((near_by ^ far_away) & (0U - is_far));
        far -= 2 * is_far;
        of_lanes |= (entry & 0xffU) << k * width;
      }
      return true;
    }
  };
};

// Where a thread's rows grow.
template <class Word>
class row_store {
 public:
  // Room for n more; returns where they go. Those written are kept by keep(their end).
  Word* room(std::size_t n) {
    if (used_ + n > made_.size()) made_.resize(2 * (used_ + n));
    return made_.data() + used_;
  }
  void keep(const Word* end) { used_ = static_cast<std::size_t>(end - made_.data()); }
  std::size_t size() const { return used_; }
  const Word* begin() const { return made_.data(); }
  void clear() { used_ = 0; }

 private:
  typename list_of_rows<Word>::words made_;
  std::size_t used_ = 0;
};

// A row of a neighbour_list, until it is written.
class row_of_clusters {
 public:
  // Nothing where no lane has it.
  void add(std::size_t sequence, std::uint32_t j, std::uint32_t of_lanes) {
    if (of_lanes != 0) sequences_[sequence].push_back({j, of_lanes});
  }
  // The first so many sequences; those that are shorter end with neighbours that no lane has. Empty after that.
  void write(std::size_t interleave, row_store<std::uint16_t>& made) {
    const std::size_t length = std::max(sequences_[0].size(), sequences_[1].size());
    for (std::size_t k = 0; k < interleave && length > 0; ++k) {
      const auto& other = sequences_[1 - k];
      const std::uint32_t some = sequences_[k].empty() ? other.back().j : sequences_[k].back().j;
      sequences_[k].resize(length, {some, 0});
    }
    std::uint16_t* out = made.room(length * interleave * 3);
    far_.clear();
    for (std::size_t at = 0; at < length; ++at)
      for (std::size_t k = 0; k < interleave; ++k) {
        const entry e = sequences_[k][at];
        const std::uint32_t before = at > 0 ? sequences_[k][at - 1].j : 0;
        const std::int64_t step = std::int64_t{e.j} - std::int64_t{before};
        const bool is_far = at == 0 || step <= neighbour_list::far_step || step > 127;
        if (is_far) far_.push_back(e.j - before);
        const auto upper = static_cast<std::uint32_t>(is_far ? neighbour_list::far_step : step);
        *out++ = static_cast<std::uint16_t>(upper << 8 | e.of_lanes);
      }
    for (std::size_t n = far_.size(); n-- > 0; out += 2) std::memcpy(out, &far_[n], sizeof(far_[n]));
    made.keep(out);
    for (auto& s : sequences_) s.clear();
  }

 private:
  struct entry {
    std::uint32_t j, of_lanes;
  };
  std::array<std::vector<entry>, 2> sequences_;
  std::vector<std::uint32_t> far_;
};

// Where blocks of rows stand in a list: behind those before them, as soon as the lengths of these are known.
class places_of_blocks {
 public:
  explicit places_of_blocks(std::size_t blocks) : lengths_(blocks, unknown), begins_(1, 0) {
    begins_.reserve(blocks + 1);
  }

  void made(std::size_t block, std::size_t length) {
    const std::lock_guard lock(one_at_a_time_);
    lengths_[block] = length;
    for (std::size_t k = begins_.size() - 1; k < lengths_.size() && lengths_[k] != unknown; ++k)
      begins_.push_back(begins_.back() + lengths_[k]);
  }
  // Of a block that is made; none where one before it is not.
  std::optional<std::size_t> begin(std::size_t block) {
    const std::lock_guard lock(one_at_a_time_);
    return block < begins_.size() ? std::optional(begins_[block]) : std::nullopt;
  }
  // Of all, when they are made.
  std::size_t end() const { return begins_.back(); }

 private:
  static constexpr std::size_t unknown = SIZE_MAX;
  std::vector<std::size_t> lengths_, begins_;
  std::mutex one_at_a_time_;
};

// A thread's blocks, until they are copied to their places in the list.
template <class Word>
class blocks_to_place {
 public:
  static constexpr std::size_t rows_of_one = 32;

  blocks_to_place(list_of_rows<Word>& list, places_of_blocks& places) : list_(list), places_(places) {}

  // The rows of this block by make_row(r, row_store), which returns the number of pairs: all pairs.
  template <class Make>
  std::size_t make(std::size_t block, Make& make_row) {
    row_store<Word> made = unused_.empty() ? row_store<Word>() : std::move(unused_.back());
    if (!unused_.empty()) unused_.pop_back();
    std::size_t pairs = 0;
    for (std::size_t r = block * rows_of_one; r < end_of(block); ++r) {
      pairs += make_row(r, made);
      list_.start[r + 1] = made.size();  // from the block's begin
    }
    places_.made(block, made.size());
    waiting_.emplace_back(block, std::move(made));
    return pairs;
  }
  // Those whose places are known. What has no room in the list's memory is lost.
  void place() {
    std::size_t placed = 0;
    for (; placed < waiting_.size(); ++placed) {
      auto& [block, made] = waiting_[placed];
      const auto begin = places_.begin(block);
      if (!begin) break;
      for (std::size_t r = block * rows_of_one; r < end_of(block); ++r) list_.start[r + 1] += *begin;
      if (*begin + made.size() <= list_.all.size())
        std::copy_n(made.begin(), made.size(), list_.all.begin() + static_cast<std::ptrdiff_t>(*begin));
      made.clear();
      unused_.push_back(std::move(made));
    }
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(placed));
  }

 private:
  std::size_t end_of(std::size_t block) const { return std::min(list_.rows(), (block + 1) * rows_of_one); }

  list_of_rows<Word>& list_;
  places_of_blocks& places_;
  std::vector<std::pair<std::size_t, row_store<Word>>> waiting_;  // by block
  std::vector<row_store<Word>> unused_;
};

// Rows of a list, row r made by make(r, row_store), which returns its number of pairs; each thread has a copy of
// `make`. The list's memory serves again.
//
// Threads take blocks of rows one by one, make them in stores that stay in their caches, and go on: who is slower is
// not waited for. Where the memory does not suffice, the first sweep finds out how much is needed.
template <class Word, class Make>
void make_rows(list_of_rows<Word>& list, std::size_t rows, const Make& make) {
  constexpr std::size_t block = blocks_to_place<Word>::rows_of_one;
  const std::size_t blocks = (rows + block - 1) / block;
  list.start.resize(rows + 1);
  list.start[0] = 0;
  list.all.resize(list.all.capacity());
  std::size_t pairs = 0;
  const auto sweep = [&] {
    pairs = 0;
    places_of_blocks places(blocks);
    std::atomic<std::size_t> next{0};
#pragma omp parallel reduction(+ : pairs) if (rows > block)
    {
      blocks_to_place<Word> mine(list, places);
      Make make_row = make;
      for (std::size_t b; (b = next.fetch_add(1, std::memory_order_relaxed)) < blocks; mine.place())
        pairs += mine.make(b, make_row);
#pragma omp barrier
      mine.place();
    }
    return places.end();
  };
  std::size_t end = sweep();
  if (end > list.all.size()) {
    list.all.clear();
    list.all.shrink_to_fit();         // before the new memory is taken
    list.all.resize(end + end / 64);  // a little to spare
    end = sweep();
  }
  list.all.resize(end);
  list.pairs = pairs;
}

// The values of n members, the last one's in the lanes behind.
inline foundation::real of_members(const double* from, std::size_t n) {
  return foundation::real([&](auto lane) { return from[std::min<std::size_t>(lane, n - 1)]; });
}

// One reach for all pairs: those of one support.
struct one_reach {
  double most;  // m
  const one_reach& of(std::size_t, std::size_t) const { return *this; }
  foundation::real squared(std::uint32_t) const { return most * most; }
};

// The members of a cluster: particles [first, first + n).
template <int D>
struct cluster_positions {
  std::array<foundation::real, D> x;  // m
  std::array<double, D> low, high;

  cluster_positions(const std::array<particles::array, D>& all, std::size_t first, std::size_t n) {
    for (std::size_t a = 0; a < D; ++a) {
      const double* from = all[a].data() + first;
      x[a] = of_members(from, n);
      const auto [least, most] = std::minmax_element(from, from + n);
      low[a] = *least;
      high[a] = *most;
    }
  }
  double longest_edge() const {
    double longest = 0.0;
    for (std::size_t a = 0; a < D; ++a) longest = std::max(longest, high[a] - low[a]);
    return longest;
  }
};

// The search about a cluster whose members lie far apart, at the ends of two rows of cells or with a particle that has
// left the others behind: about each member, not about the box that holds all of them.
class spread_cluster {
 public:
  // search(i, f) as cells::for_each_near() about particle i, of [first, first + n); f(k, 1) once for each member of the
  // grid that is found, in its order.
  template <class Search, class F>
  void for_each_near(std::size_t first, std::size_t n, const Search& search, F&& f) {
    found_.clear();
    for (std::size_t i = first; i < first + n; ++i)
      search(i, [&](std::uint32_t k, std::uint64_t near) {
        for (; near != 0; near &= near - 1) found_.push_back(k + static_cast<std::uint32_t>(std::countr_zero(near)));
      });
    std::sort(found_.begin(), found_.end());
    found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
    for (const std::uint32_t k : found_) f(k, 1);
  }

 private:
  std::vector<std::uint32_t> found_;
};

// Which of two sequences each member of the grid is in: squares (cubes) of half a cell's edge, black and white, so that
// about as many neighbours of any cluster are in either.
template <int D>
std::vector<unsigned char> sequences_of(const grid<D>& g) {
  std::vector<unsigned char> sequence(g.members.size());
  foundation::for_all(sequence.size(), [&](std::size_t k) {
    std::int64_t square = 0;
    for (std::size_t a = 0; a < D; ++a) square += static_cast<std::int64_t>(std::floor(2.0 * g.sorted[a][k] / g.size));
    sequence[k] = static_cast<unsigned char>(square & 1);
  });
  return sequence;
}

// Rows of the clusters of particles [0, n): the particles nearer than the pair's reach to a member. reach.of(first, n),
// of the cluster [first, first + n), has squared(j), m2, that of j with each member of the cluster, and `most`, m, no
// smaller than any pair's reach. Where reach has a search of its own, for_each_near(of_cluster, cluster, spread, f),
// that takes the place of one within `most`, and find_wide(low, high, found) gives the places in the grid, in their
// order, of those members that it may miss. `among_members`: the grid's members, those with the same local index, are
// these particles themselves, which are not their own neighbours; else they are another set of particles.
template <int D, bool among_members = true, class Reach>
void make_list(neighbour_list& list, const grid<D>& g, const std::array<particles::array, D>& x, std::size_t n,
               const Reach& reach) {
  using foundation::real;
  constexpr std::size_t width = neighbour_list::width;
  const auto sequences = list.interleave > 1 ? sequences_of(g) : std::vector<unsigned char>{};
  make_rows(list, (n + width - 1) / width,
            [&, row = row_of_clusters(), spread = spread_cluster(), wide = std::vector<std::uint32_t>()](
                std::size_t r, auto& made) mutable {
              const std::size_t first = r * width, members = std::min(width, n - first);
              const cluster_positions<D> cluster(x, first, members);
              const std::uint32_t all_members = (1U << members) - 1U;
              std::size_t pairs = 0;
              const auto& of_cluster = reach.of(first, members);
              const auto add = [&](std::uint32_t at) {
                const std::uint32_t j = g.members[at];
                real r2(0.0);
                for (std::size_t a = 0; a < D; ++a) {
                  const real x_ij = cluster.x[a] - g.sorted[a][at];
                  r2 += x_ij * x_ij;
                }
                std::uint32_t within = foundation::bits_of_less(r2, of_cluster.squared(j)) & all_members;
                if constexpr (among_members)
                  if (const std::size_t own = j - first; own < width) within &= ~(1U << own);
                row.add(sequences.empty() ? 0 : sequences[at], j, within);
                pairs += static_cast<std::size_t>(std::popcount(within));
              };
              constexpr bool has_wide = requires { reach.find_wide(cluster.low, cluster.high, wide); };
              if constexpr (has_wide) reach.find_wide(cluster.low, cluster.high, wide);
              std::size_t wide_added = 0;
              const auto add_wide_before = [&](std::uint32_t at) {
                for (; wide_added < wide.size() && wide[wide_added] < at; ++wide_added) add(wide[wide_added]);
              };
              const auto add_near = [&](std::uint32_t k, std::uint64_t near) {
                for (; near != 0; near &= near - 1) {
                  const std::uint32_t at = k + static_cast<std::uint32_t>(std::countr_zero(near));
                  if constexpr (has_wide) {
                    add_wide_before(at);
                    if (wide_added < wide.size() && wide[wide_added] == at) ++wide_added;
                  }
                  add(at);
                }
              };
              if constexpr (has_wide) {
                reach.for_each_near(of_cluster, cluster, spread, add_near);
                add_wide_before(UINT32_MAX);
              } else if (cluster.longest_edge() > 4.0 * of_cluster.most) {
                const auto search = [&](std::size_t i, auto&& f) {
                  for_each_near<D>(g, position<D>(x, i), position<D>(x, i), of_cluster.most, f);
                };
                spread.for_each_near(first, members, search, add_near);
              } else {
                for_each_near<D>(g, cluster.low, cluster.high, of_cluster.most, add_near);
              }
              row.write(list.interleave, made);
              return pairs;
            });
}

// Rows of points: row r has the particles nearer to centre(r) than `reach` that `accept` takes, filled up with `null`
// to a multiple of so many.
template <int D, class Centre, class Accept>
void make_list_of_points(point_list& list, const grid<D>& g, std::size_t points, double reach, std::uint32_t null,
                         std::size_t multiple, const Centre& centre, const Accept& accept) {
  make_rows(list, points, [&](std::size_t r, row_store<std::uint32_t>& made) {
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
    const std::size_t pairs = made.size() - before, padding = (multiple - pairs % multiple) % multiple;
    made.keep(std::fill_n(made.room(padding), padding, null));
    return pairs;
  });
}

}  // namespace tetsuame::cells
