// The pair loop: every sum over neighbours in the physics runs through here.
//
// A term is a small struct that writes one sum of the notes. It names what it reads of the
// neighbours (records.hpp), what it keeps of particle i (`begin`), what a neighbour adds (`add`), and where the
// finished sum goes (`end`). It does so for several particles i at once, the members of a cluster (cluster.hpp): `real`
// holds one value a lane, those of i are each member's own, those of the neighbour the same for all.
//
//   struct divergence {                            // Σ_j ΔV_j v_ij·∇_i W_ij
//     auto reads() const;                          // {read(of_velocity, v), read(of_volume, dV)}
//     me begin(const cluster& i) const;            // what the sum needs of i beside that, i(array), and its zero
//     void add(me& a, const auto& ij) const;       // a.sum += ij(of_volume) * ij.F * ij.along(of_velocity)
//     void end(const cluster& i, const me& a) const;  // i.set(out, a.sum)
//   };
//
// ij(tag) is the neighbour's value, ij.own(tag) that of i, ij.difference(tag) = own - neighbour's. A member
// that does not have the neighbour has exact zeros for W and F, and the term must add one.
//
// Several terms in one call share the neighbour's record, distance and kernel: one pass for the
// whole right-hand side. A particle's neighbours are added in the list's order, so the result depends on neither ranks
// nor threads, nor on who else is in the cluster.
#pragma once

#include <algorithm>
#include <array>
#include <cells/neighbour_list.hpp>
#include <cstddef>
#include <cstdint>
#include <foundation/lanes.hpp>
#include <foundation/threads.hpp>
#include <foundation/vec.hpp>
#include <pairs/cluster.hpp>
#include <pairs/records.hpp>
#include <particles/particles.hpp>
#include <tuple>
#include <utility>

namespace tetsuame::pairs {

static_assert(cells::neighbour_list::lanes == lanes);

template <int D>
std::array<const double*, D> pointers(const std::array<particles::array, D>& a) {
  std::array<const double*, D> p;
  for (std::size_t k = 0; k < D; ++k) p[k] = a[k].data();
  return p;
}

template <int D>
struct pair {
  vec<real, D> x_ij;                                  // m, x_i - x_j
  real r2;                                            // m2, of at least the kernel's smallest_r(), as those that follow
  real r, per_r;                                      // m, 1/m
  real W;                                             // 1/m^D
  real F;                                             // 1/m^(D+2), W'(r)/r: ∇_i W_ij = F x_ij
  vec<real, D> gradient() const { return F * x_ij; }  // ∇_i W_ij
};

// A pair with both records: numbers are a real, vectors a vec.
template <int D, class Layout>
struct packed_pair : pair<D> {
  const std::array<real, Layout::size>* mine;
  const double* record;  // the neighbour's

  template <class Tag>
  auto operator()(Tag) const {
    return pick<Tag>([&](std::size_t k) { return real(record[k]); });
  }
  template <class Tag>
  auto own(Tag) const {
    return pick<Tag>([&](std::size_t k) { return (*mine)[k]; });
  }
  // Terms that ask for the same difference share it: the compiler sees one expression.
  template <class Tag>
  auto difference(Tag) const {
    return pick<Tag>([&](std::size_t k) { return (*mine)[k] - record[k]; });
  }
  // v_ij·x_ij of the vector field of that tag; times F it is v_ij·∇_i W_ij.
  template <class Tag>
  real along(Tag tag) const {
    return foundation::dot(difference(tag), this->x_ij);
  }

 private:
  // A number, or a vector, of the values at the tag's places in the record.
  template <class Tag, class F>
  [[gnu::always_inline]] static auto pick(const F& value) {
    constexpr std::size_t at = Layout::template place<Tag>(), n = Layout::template components<Tag>();
    static_assert(n > 0, "a term uses a field that its reads() does not name");
    if constexpr (Layout::template is_vector<Tag>())
      return vec<real, static_cast<int>(n)>::of([&](std::size_t k) { return value(at + k); });
    else
      return real(value(at));
  }
};

template <class Mine, class Pair, std::size_t... T, class... Terms>
void add_all(Mine& mine, const Pair& ij, std::index_sequence<T...>, const Terms&... terms) {
  (terms.add(std::get<T>(mine), ij), ...);
}

template <class Mine, std::size_t... T, class... Terms>
void end_all(const Mine& mine, const cluster& i, std::index_sequence<T...>, const Terms&... terms) {
  (terms.end(i, std::get<T>(mine)), ...);
}

// The members' sums over their row of the list. `flatten`: everything called in here is inlined, so that the compiler
// keeps sums and kernel in registers whatever it thinks of the program's size.
template <int D, class Layout, class Kernel, class... Terms>
[[gnu::flatten]] void sum_row(const cluster& i, std::span<const std::uint32_t> row, const double* records,
                              const Kernel& kernel, const Terms&... terms) {
  // m2; who does not have the neighbour is that far from it.
  const real nearest(kernel.smallest_r() * kernel.smallest_r()), far(1e120);
  std::array<real, Layout::size> own;
  detail::load_own(records + i.first * Layout::size, own);
  const auto record_of = [&](std::uint32_t j) { return records + std::size_t{j} * Layout::size; };
  cells::neighbour_list::neighbour n(row);
  const auto next_pair = [&] {
    const double* const x_j = record_of(n.j);
    pair<D> p;
    p.x_ij = vec<real, D>::of([&](std::size_t a) { return own[a] - x_j[a]; });
    p.r2 = foundation::greater_where(n.of_lanes, foundation::dot(p.x_ij, p.x_ij), nearest, far);
    const auto root = foundation::both_roots(p.r2);
    p.r = root.r;
    p.per_r = root.inverse;
    kernel.both(root.r, root.inverse, p.W, p.F);
    return p;
  };
  std::tuple mine{terms.begin(i)...};
  const auto add = [&](const pair<D>& p, std::uint32_t j) {
    add_all(mine, packed_pair<D, Layout>{p, &own, record_of(j)}, std::index_sequence_for<Terms...>{}, terms...);
  };
  // A pair ahead of the sums: the processor computes them side by side.
  if (n.next()) {
    pair<D> last = next_pair();
    for (std::uint32_t j = n.j; n.next(); j = n.j) {
      const pair<D> next = next_pair();
      add(last, j);
      last = next;
    }
    add(last, n.j);
  }
  end_all(mine, i, std::index_sequence_for<Terms...>{}, terms...);
}

// For each cluster i of the rows: begin, its neighbours from its row of the list, end.
template <int D, class Kernel, class Rows, class... Terms>
void sum_over(const Rows& rows, const cells::neighbour_list& list, const std::array<const double*, D>& x,
              const Kernel& kernel, const Terms&... terms) {
  const auto reads = std::apply([](auto... r) { return detail::unique_reads(std::tuple<>{}, r...); },
                                std::tuple_cat(reads_of(terms)...));
  const std::size_t n = rows.clusters();
  if (n == 0) return;
  pack<D>(x, reads, rows.packed(), list);
  const double* const records = list.records.data();
#pragma omp parallel for schedule(static) if (n > foundation::rows_worth_threads / lanes)
  for (std::size_t r = 0; r < n; ++r) {
    const cluster i = rows[r];
    sum_row<D, decltype(layout_of<D>(reads))>(i, list.row_of(i.first), records, kernel, terms...);
  }
}

}  // namespace tetsuame::pairs
