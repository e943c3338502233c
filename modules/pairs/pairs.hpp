// The pair loop: every sum over neighbours in the physics runs through here.
//
// A term is a small struct that writes one sum of the notes. It names what it reads of the
// neighbours (records.hpp), what it keeps of particle i (`begin`), what a neighbour adds (`add`), and where the
// finished sum goes (`end`). It does so for several particles i at once, the members of a cluster (cluster.hpp): `real`
// holds one value a lane, those of i are each member's own, those of the neighbour the same for all.
//
//   struct divergence {                            // Σ_j ΔV_j v_ij·∇_i W_ij
//     auto reads() const;                          // {read(of_velocity, v), read(of_volume, dV, D)}: ΔV goes with m^D
//     template <class R>
//     me<R> begin(const cluster<R>& i) const;      // what the sum needs of i beside that, i(array), and its zero
//     void add(auto& a, const auto& ij) const;     // a.sum += ij(of_volume) * ij.F * ij.along(of_velocity)
//     void end(const auto& i, const auto& a) const;  // i.set(out, a.sum, -1): Σ ΔV F v·x goes with 1/m
//   };
//
// R is `real`, or `single` (cluster.hpp). A term whose begin takes a cluster<real> alone is for double precision.
//
// ij(tag) is the neighbour's value, ij.own(tag) that of i, ij.difference(tag) = own - neighbour's. A member
// that does not have the neighbour has exact zeros for W and F, and the term must add one.
//
// Several terms in one call share the neighbour's record, distance and kernel: one pass for the
// whole right-hand side. A particle's neighbours are added in the list's order, so the result depends on neither ranks
// nor threads, nor on who else is in the cluster.
#pragma once

#include <array>
#include <bit>
#include <cells/neighbour_list.hpp>
#include <cstddef>
#include <cstdint>
#include <foundation/lanes.hpp>
#include <foundation/threads.hpp>
#include <foundation/vec.hpp>
#include <pairs/cluster.hpp>
#include <pairs/records.hpp>
#include <particles/particles.hpp>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace tetsuame::pairs {

// Of the square of a distance: no kernel reaches there, and its fourth power is a number still.
template <class R>
inline constexpr double farthest = std::is_same_v<R, single> ? 1e16 : 1e120;

template <int D>
std::array<const double*, D> pointers(const std::array<particles::array, D>& a) {
  std::array<const double*, D> p;
  for (std::size_t k = 0; k < D; ++k) p[k] = a[k].data();
  return p;
}

// Lengths in R's unit (cluster.hpp).
template <class R, int D>
struct pair {
  pair() = default;
  // One by one: of a copy as a whole the compiler would keep in memory what no term uses.
  pair(const pair& b) : x_ij(b.x_ij), r2(b.r2), r(b.r), per_r(b.per_r), W(b.W), F(b.F) {}
  pair& operator=(const pair& b) {
    x_ij = b.x_ij;
    r2 = b.r2;
    r = b.r;
    per_r = b.per_r;
    W = b.W;
    F = b.F;
    return *this;
  }

  vec<R, D> x_ij;                                  // m, x_i - x_j
  R r2;                                            // m2, of at least the kernel's smallest_r(), as those that follow
  R r, per_r;                                      // m, 1/m
  R W;                                             // 1/m^D
  R F;                                             // 1/m^(D+2), W'(r)/r: ∇_i W_ij = F x_ij
  vec<R, D> gradient() const { return F * x_ij; }  // ∇_i W_ij
};

// A pair with both records: numbers are an R, vectors a vec.
template <class R, class Layout>
struct packed_pair : pair<R, Layout::dimension> {
  const std::array<R, Layout::used>* mine;  // but for the position
  neighbours<R> others;

  template <class Tag>
  auto operator()(Tag) const {
    return pick<Tag>([&](std::size_t k) { return others[k]; });
  }
  template <class Tag>
  auto own(Tag) const {
    return pick<Tag>([&](std::size_t k) { return (*mine)[k]; });
  }
  // Terms that ask for the same difference share it: the compiler sees one expression.
  template <class Tag>
  auto difference(Tag) const {
    return pick<Tag>([&](std::size_t k) { return (*mine)[k] - others[k]; });
  }
  // v_ij·x_ij of the vector field of that tag; times F it is v_ij·∇_i W_ij.
  template <class Tag>
  R along(Tag tag) const {
    return foundation::dot(difference(tag), this->x_ij);
  }

 private:
  // A number, or a vector, of the values at the tag's places in the record.
  template <class Tag, class F>
  [[gnu::always_inline]] static auto pick(const F& value) {
    constexpr std::size_t at = Layout::template place<Tag>(), n = Layout::template components<Tag>();
    static_assert(n > 0, "a term uses a field that its reads() does not name");
    if constexpr (Layout::template is_vector<Tag>())
      return vec<R, static_cast<int>(n)>::of([&](std::size_t k) { return value(at + k); });
    else
      return R(value(at));
  }
};

template <class Mine, class Pair, std::size_t... T, class... Terms>
void add_all(Mine& mine, const Pair& ij, std::index_sequence<T...>, const Terms&... terms) {
  (terms.add(std::get<T>(mine), ij), ...);
}

// Of `single`, whose halves have the sums over two sequences of neighbours: both halves, what began at zero as one sum,
// and what is the same in both, as it is. A term that keeps other things than these says by join(a, other half's a).
template <class R, class Term, class Me>
void join_halves(const Term& term, const Me& start, Me& mine) {
  using numbers = std::array<R, sizeof(Me) / sizeof(R)>;
  static_assert(sizeof(numbers) == sizeof(Me), "what a term keeps of i are numbers in lanes");
  const auto begun = std::bit_cast<numbers>(start);
  auto sums = std::bit_cast<numbers>(mine), others = sums;
  for (R& other : others) other = foundation::halves_exchanged(other);
  if constexpr (requires { term.join(mine, mine); }) {
    term.join(mine, std::bit_cast<Me>(others));
  } else {
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += others[k] - begun[k];
    mine = std::bit_cast<Me>(sums);
  }
}

template <class R, class Mine, std::size_t... T, class... Terms>
void join_all(Mine& mine, const Mine& start, std::index_sequence<T...>, const Terms&... terms) {
  (join_halves<R>(terms, std::get<T>(start), std::get<T>(mine)), ...);
}

template <class Mine, class R, std::size_t... T, class... Terms>
void end_all(const Mine& mine, const cluster<R>& i, std::index_sequence<T...>, const Terms&... terms) {
  (terms.end(i, std::get<T>(mine)), ...);
}

// The members' sums over their row of the list. `flatten`: everything called in here is inlined, so that the compiler
// keeps sums and kernel in registers whatever it thinks of the program's size.
template <class R, class Layout, class Kernel, class... Terms>
[[gnu::flatten]] void sum_row(const cluster<R>& i, std::span<const std::uint16_t> row, const sources<Layout>& fields,
                              const positions<R>& place, const typename positions<R>::number* records,
                              const Kernel& kernel, const Terms&... terms) {
  constexpr int D = Layout::dimension;
  // m2; who does not have the neighbour is that far from it. In single numbers differences of a spline's pieces are
  // lost in rounding that much sooner.
  const double smallest_r = kernel.smallest_r() * (std::is_same_v<R, single> ? 1e5 : 1.0);
  const R nearest(smallest_r * smallest_r), far(farthest<R>);
  std::array<typename positions<R>::own_type, D> x_i;
  std::array<R, Layout::used> own;
  for (std::size_t c = 0; c < D; ++c) x_i[c] = place.own(i, fields.from[c]);
  for (std::size_t c = D; c < Layout::used; ++c)
    own[c] = i(fields.from[c], fields.lengths[c], fields.factor[c], fields.less[c]);
  const auto record_of = [&](std::uint32_t j) { return records + std::size_t{j} * Layout::size; };
  constexpr std::size_t interleave = neighbours<R>::interleave;
  cells::neighbour_list::neighbours<interleave> n(row);
  const auto next_pair = [&] {
    packed_pair<R, Layout> p;
    p.mine = &own;
    for (std::size_t k = 0; k < interleave; ++k) p.others.records[k] = record_of(n.j[k]);
    p.x_ij = vec<R, D>::of([&](std::size_t a) { return place.difference(x_i[a], p.others, a); });
    p.r2 = foundation::greater_where(n.of_lanes, foundation::dot(p.x_ij, p.x_ij), nearest, far);
    const auto root = foundation::both_roots(p.r2);
    p.r = root.r;
    p.per_r = root.inverse;
    kernel.both(root.r, root.inverse, p.W, p.F);
    return p;
  };
  std::tuple mine{terms.begin(i)...};
  constexpr std::index_sequence_for<Terms...> all_terms;
  // A pair ahead of the sums: the processor computes them side by side.
  if (n.next()) {
    auto last = next_pair();
    while (n.next()) {
      const auto next = next_pair();
      add_all(mine, last, all_terms, terms...);
      last = next;
    }
    add_all(mine, last, all_terms, terms...);
  }
  if constexpr (interleave == 1) {
    end_all(mine, i, all_terms, terms...);
  } else {
    auto joined = mine;
    join_all<R>(joined, std::tuple{terms.begin(i)...}, all_terms, terms...);
    end_all(joined, i, all_terms, terms...);
  }
}

// Whether a term's sum can be computed in R.
template <class Term, class R>
concept takes = requires(const Term& t, const cluster<R>& i) {
  t.begin(i);
};

// For each cluster i of the rows: begin, its neighbours from its row of the list, end. In this unit, the kernel too.
template <int D, class R, class Kernel, class Rows, class... Terms>
void sum_in(const unit<R>& lengths, const Rows& rows, const cells::neighbour_list& list, const places<D>& x,
            const Kernel& kernel, const Terms&... terms) {
  if (list.interleave != neighbours<R>::interleave) throw std::logic_error("the list is for sums in another precision");
  const auto reads = std::apply([](auto... r) { return detail::unique_reads(std::tuple<>{}, r...); },
                                std::tuple_cat(reads_of(terms)...));
  const std::size_t n = rows.clusters();
  if (n == 0) return;
  const sources<decltype(layout_of<D>(reads))> fields(x, reads);
  const positions<R> place(lengths);
  auto& records = list.records.template of<typename positions<R>::number>();
  pack<R>(fields, rows.packed(), lengths, place, records);
  constexpr std::size_t chunk = 32;  // clusters: some 50 microseconds
  foundation::for_chunks(n, chunk, n > foundation::rows_worth_threads / lanes,
                         [&](std::size_t first, std::size_t last) {
                           for (std::size_t r = first; r < last; ++r) {
                             const members m = rows.cluster(r);
                             sum_row(cluster<R>{m.first, m.mask, lengths}, list.row_of(m.first), fields, place,
                                     records.data(), kernel, terms...);
                           }
                         });
}
template <int D, class Kernel, class Rows, class... Terms>
void sum_over(const Rows& rows, const cells::neighbour_list& list, const places<D>& x, const Kernel& kernel,
              const Terms&... terms) {
  sum_in<D>(unit<real>{}, rows, list, x, kernel, terms...);
}

}  // namespace tetsuame::pairs
