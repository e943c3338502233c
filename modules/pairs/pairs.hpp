// The pair loop: every sum over neighbours in the physics runs through here.
//
// A term is a small struct that writes one sum of the notes. It names what it reads of the
// neighbours (records.hpp), what it keeps of particle i (`begin`), what neighbours add (`add`, for
// several at once: `real` holds one value a lane), and where the finished sum goes (`end`):
//
//   struct divergence {                            // Σ_j ΔV_j v_ij·∇_i W_ij
//     auto reads() const;                          // {read(of_velocity, v), read(of_volume, dV)}
//     me begin(std::size_t i) const;               // what the sum needs of i beside that, and its zero
//     void add(me& a, const auto& ij) const;       // a.sum += ij(of_volume) * ij.F * ij.along(of_velocity)
//     void end(std::size_t i, const me& a) const;  // out[i] = sum(a.sum)
//   };
//
// ij(tag) is the neighbour's value, ij.own(tag) that of i, ij.difference(tag) = own - neighbour's.
//
// Several terms in one call share the neighbour's record, distance and kernel: one pass for the
// whole right-hand side. Neighbours are added in the list's order, lane by lane, and the
// lanes in a fixed tree, so the result depends on neither ranks nor threads.
#pragma once

#include <algorithm>
#include <array>
#include <cells/neighbour_list.hpp>
#include <cstddef>
#include <cstdint>
#include <foundation/lanes.hpp>
#include <foundation/threads.hpp>
#include <foundation/vec.hpp>
#include <pairs/records.hpp>
#include <particles/particles.hpp>
#include <tuple>
#include <utility>
#include <vector>

namespace tetsuame::pairs {

static_assert(cells::neighbour_list::lanes % lanes == 0);

template <int D>
std::array<const double*, D> pointers(const std::array<particles::array, D>& a) {
  std::array<const double*, D> p;
  for (std::size_t k = 0; k < D; ++k) p[k] = a[k].data();
  return p;
}

template <int D>
struct pair {
  vec<real, D> x_ij;                                  // m, x_i - x_j
  real r2;                                            // m2
  real r, per_r;                                      // m, 1/m: of at least the kernel's smallest_r()
  real W;                                             // 1/m^D
  real F;                                             // 1/m^(D+2), W'(r)/r: ∇_i W_ij = F x_ij
  vec<real, D> gradient() const { return F * x_ij; }  // ∇_i W_ij
};

// A pair with both records: numbers are a real, vectors a vec.
template <int D, class Layout>
struct packed_pair : pair<D> {
  std::array<real, Layout::size> mine, values;

  template <class Tag>
  auto operator()(Tag) const {
    return pick<Tag>(values);
  }
  template <class Tag>
  auto own(Tag) const {
    return pick<Tag>(mine);
  }
  // Terms that ask for the same difference share it: the compiler sees one expression.
  template <class Tag>
  auto difference(Tag tag) const {
    return own(tag) - (*this)(tag);
  }
  // v_ij·x_ij of the vector field of that tag; times F it is v_ij·∇_i W_ij.
  template <class Tag>
  real along(Tag tag) const {
    return foundation::dot(difference(tag), this->x_ij);
  }

 private:
  template <class Tag>
  static auto pick(const std::array<real, Layout::size>& record) {
    constexpr std::size_t at = Layout::template place<Tag>(), n = Layout::template components<Tag>();
    static_assert(n > 0, "a term uses a field that its reads() does not name");
    if constexpr (!Layout::template is_vector<Tag>()) {
      return record[at];
    } else {
      vec<real, static_cast<int>(n)> v;
      for (std::size_t k = 0; k < n; ++k) v[k] = record[at + k];
      return v;
    }
  }
};

template <class Mine, class Pair, std::size_t... T, class... Terms>
void add_all(Mine& mine, const Pair& ij, std::index_sequence<T...>, const Terms&... terms) {
  (terms.add(std::get<T>(mine), ij), ...);
}

template <class Mine, std::size_t... T, class... Terms>
void end_all(const Mine& mine, std::size_t i, std::index_sequence<T...>, const Terms&... terms) {
  (terms.end(i, std::get<T>(mine)), ...);
}

// Rows of sum_over: the particles [first, last), whose neighbours are all in [seen_first, seen_last).
struct stretch {
  std::size_t first, last, seen_first, seen_last;
  std::size_t size() const { return last - first; }
  std::size_t operator[](std::size_t r) const { return first + r; }

  // What is packed: those seen, and the null particle, with which every row is filled up.
  struct seen {
    std::size_t first, count, null;
    std::size_t size() const { return count + 1; }
    std::size_t operator[](std::size_t k) const { return k < count ? first + k : null; }
  };
  seen packed_with(std::size_t null) const { return {seen_first, std::min(seen_last, null) - seen_first, null}; }
};

// Some rows, and those particles that are one of them or in their lists: only these are packed.
struct chosen {
  std::vector<std::size_t> rows, packed;
  std::size_t size() const { return rows.size(); }
  std::size_t operator[](std::size_t r) const { return rows[r]; }
  const std::vector<std::size_t>& packed_with(std::size_t) const { return packed; }
};

inline chosen choose(const cells::neighbour_list& list, std::vector<std::size_t> rows) {
  std::vector<char> needed(list.null + 1, 0);
  std::vector<std::uint32_t> buffer;
  for (const std::size_t i : rows) {
    needed[i] = 1;
    for (const std::uint32_t j : list.row(i, buffer)) needed[j] = 1;
  }
  chosen c{std::move(rows), {}};
  for (std::size_t i = 0; i < list.null; ++i)
    if (needed[i] != 0) c.packed.push_back(i);
  c.packed.push_back(list.null);
  return c;
}

// One particle's sums over its row of the list, whose records are at the places [place, end); meanwhile the next row
// is written out, which the processor does beside; returns its end. `flatten`: everything
// called in here is inlined, so that the compiler keeps sums and kernel in registers whatever it thinks of the
// program's size. `source` gives the pair's values: its own(ij, i) once a row, neighbour(ij, place), which returns x_j,
// for every register of neighbours.
template <int D, class Source, class Kernel, class... Terms>
[[gnu::flatten]] std::uint32_t* sum_row(std::size_t i, const std::uint32_t* place, const std::uint32_t* end,
                                        cells::row_writer<Source::stride> next, const Source& source,
                                        const Kernel& kernel, const Terms&... terms) {
  const real nearest(kernel.smallest_r() * kernel.smallest_r());
  typename Source::pair ij;
  const vec<real, D> x_i = source.own(ij, i);
  std::tuple mine{terms.begin(i)...};
  for (; place < end; place += lanes) {
    next.step();
    ij.x_ij = x_i - source.neighbour(ij, place);
    ij.r2 = foundation::dot(ij.x_ij, ij.x_ij);
    const auto root = foundation::both_roots(foundation::greater(ij.r2, nearest));
    ij.r = root.r;
    ij.per_r = root.inverse;
    kernel.both(root.r, root.inverse, ij.W, ij.F);
    add_all(mine, ij, std::index_sequence_for<Terms...>{}, terms...);
  }
  end_all(mine, i, std::index_sequence_for<Terms...>{}, terms...);
  return next.finish();
}

// Pairs out of the records.
template <int D, class Layout>
struct from_records {
  using pair = packed_pair<D, Layout>;
  static constexpr std::uint32_t stride = Layout::size;
  const double* records;

  vec<real, D> own(pair& ij, std::size_t i) const {
    for (std::size_t k = 0; k < Layout::size; ++k) ij.mine[k] = real(records[i * Layout::size + k]);
    return position(ij.mine);
  }
  vec<real, D> neighbour(pair& ij, const std::uint32_t* place) const {
    detail::load(records, place, ij.values);
    return position(ij.values);
  }

 private:
  static vec<real, D> position(const std::array<real, Layout::size>& record) {
    vec<real, D> x;
    for (std::size_t k = 0; k < D; ++k) x[k] = record[k];
    return x;
  }
};

// For each particle i = rows[r]: begin, its neighbours from row i of the list, end.
template <int D, class Kernel, class Rows, class... Terms>
void sum_over(const Rows& rows, const cells::neighbour_list& list, const std::array<const double*, D>& x,
              const Kernel& kernel, const Terms&... terms) {
  const auto reads = std::apply([](auto... r) { return detail::unique_reads(std::tuple<>{}, r...); },
                                std::tuple_cat(reads_of(terms)...));
  if (rows.size() == 0) return;
  pack<D>(x, reads, rows.packed_with(list.null), list);
  const from_records<D, decltype(layout_of<D>(reads))> source{list.records.data()};
  const std::size_t n = rows.size();
  const std::size_t room = list.room();
#pragma omp parallel if (n > foundation::rows_worth_threads)
  {
    const auto share = foundation::share_of_thread(n);
    std::vector<std::uint32_t> places(2 * room);
    std::uint32_t *now = places.data(), *ahead = now + room;
    const std::uint32_t* end = share.first < share.last ? list.expand<source.stride>(rows[share.first], now) : nullptr;
    for (std::size_t r = share.first; r < share.last; ++r) {
      // Behind the last row: that row again.
      const cells::row_writer<source.stride> next(list, rows[std::min(r + 1, share.last - 1)], ahead);
      end = sum_row<D>(rows[r], now, end, next, source, kernel, terms...);
      std::swap(now, ahead);
    }
  }
}

}  // namespace tetsuame::pairs
