// The pair loop: every sum over neighbours in the physics runs through here.
//
// A term is a small struct that writes one sum of the notes. It names what it reads of the
// neighbours (records.hpp), what it keeps of particle i (`begin`), what neighbours add (`add`, for
// several at once: `real` holds one value a lane), and where the finished sum goes (`end`):
//
//   struct divergence {                            // Σ_j ΔV_j v_ij·∇_i W_ij
//     auto reads() const;                          // {read(of_velocity, v), read(of_volume, dV)}
//     me begin(std::size_t i) const;               // what the sum needs of i beside that, and its zero
//     void add(me& a, const auto& ij) const;       // a.sum += ij(of_volume) * ij.along_gradient(of_velocity)
//     void end(std::size_t i, const me& a) const;  // out[i] = sum(a.sum)
//   };
//
// ij(tag) is the neighbour's value, ij.own(tag) that of i, ij.difference(tag) = own - neighbour's.
//
// Several terms in one call share the neighbour's record, distance and kernel: one pass for the
// whole right-hand side. Neighbours are added in the list's order, lane by lane, and the
// lanes in a fixed tree, so the result depends on neither ranks nor threads.
#pragma once

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

namespace tetsuame::pairs {

static_assert(cells::neighbour_list::lanes % lanes == 0);

// For terms that read a field now and then: from the array itself.
inline real gather(const double* a, const std::int32_t* j) {
  return real([&](auto lane) { return a[j[lane]]; });
}

template <int D>
vec<real, D> gather(const std::array<const double*, D>& a, const std::int32_t* j) {
  vec<real, D> values;
  for (std::size_t k = 0; k < D; ++k) values[k] = gather(a[k], j);
  return values;
}

template <int D>
std::array<const double*, D> pointers(const std::array<particles::array, D>& a) {
  std::array<const double*, D> p;
  for (std::size_t k = 0; k < D; ++k) p[k] = a[k].data();
  return p;
}

template <int D>
struct pair {
  const std::int32_t* j;                              // local indices of the neighbours, one a lane
  vec<real, D> x_ij;                                  // m, x_i - x_j
  real r2;                                            // m2
  real W;                                             // 1/m^D
  real F;                                             // 1/m^(D+2), W'(r)/r
  vec<real, D> gradient() const { return F * x_ij; }  // ∇_i W_ij
};

// What differences of fields are good for, whatever the pair's values come from. Terms that ask for the
// same share it: the compiler sees one expression.
template <int D, class Pair>
struct pair_fields : pair<D> {
  template <class Tag>
  auto difference(Tag tag) const {
    return self().own(tag) - self()(tag);
  }
  // v_ij·∇_i W_ij of the vector field of that tag.
  template <class Tag>
  real along_gradient(Tag tag) const {
    return this->F * foundation::dot(difference(tag), this->x_ij);
  }

 private:
  const Pair& self() const { return static_cast<const Pair&>(*this); }
};

// A pair with both records: scalars are a real, vectors a vec.
template <int D, class Layout>
struct packed_pair : pair_fields<D, packed_pair<D, Layout>> {
  std::array<real, Layout::size> mine, values;

  template <class Tag>
  auto operator()(Tag) const {
    return pick<Tag>(values);
  }
  template <class Tag>
  auto own(Tag) const {
    return pick<Tag>(mine);
  }

 private:
  template <class Tag>
  static auto pick(const std::array<real, Layout::size>& record) {
    constexpr std::size_t at = Layout::template place<Tag>(), n = Layout::template components<Tag>();
    static_assert(n > 0, "a term uses a field that its reads() does not name");
    if constexpr (n == 1) {
      return record[at];
    } else {
      vec<real, static_cast<int>(n)> v;
      for (std::size_t k = 0; k < n; ++k) v[k] = record[at + k];
      return v;
    }
  }
};

// A pair whose fields come from the arrays themselves: for a few rows, where packing all particles
// would cost more than it saves. The same values, so the same bits.
template <int D, class Reads>
struct gathered_pair : pair_fields<D, gathered_pair<D, Reads>> {
  const Reads* reads;
  std::size_t i;

  template <class Tag>
  auto operator()(Tag) const {
    return std::apply(
        [this](const auto&... r) { return pick<Tag>([this](const double* a) { return gather(a, this->j); }, r...); },
        *reads);
  }
  template <class Tag>
  auto own(Tag) const {
    return std::apply(
        [this](const auto&... r) { return pick<Tag>([this](const double* a) { return real(a[i]); }, r...); }, *reads);
  }

 private:
  template <class Tag, class Take, class Read, class... Rest>
  static auto pick(const Take& take, const Read& read, const Rest&... rest) {
    if constexpr (!std::is_same_v<Tag, typename Read::tag>) {
      return pick<Tag>(take, rest...);
    } else if constexpr (Read::components == 1) {
      return take(read.from[0]);
    } else {
      vec<real, static_cast<int>(Read::components)> v;
      for (std::size_t k = 0; k < Read::components; ++k) v[k] = take(read.from[k]);
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
};

// One particle's sums. `flatten`: everything called in here is inlined, so that the compiler keeps
// sums and kernel in registers whatever it thinks of the program's size. `source` gives the pair's values:
// its own(ij, i) once a row, neighbour(ij), which returns x_j, for every register of neighbours.
template <int D, class Source, class Kernel, class... Terms>
[[gnu::flatten]] void sum_row(std::size_t i, const cells::neighbour_list& list, const Source& source,
                              const Kernel& kernel, const Terms&... terms) {
  const real nearest(kernel.smallest_r() * kernel.smallest_r());
  typename Source::pair ij;
  const vec<real, D> x_i = source.own(ij, i);
  std::tuple mine{terms.begin(i)...};
  const std::int32_t* end = list.neighbours.data() + list.start[i + 1];
  for (const std::int32_t* j = list.neighbours.data() + list.start[i]; j < end; j += lanes) {
    ij.j = j;
    ij.x_ij = x_i - source.neighbour(ij);
    ij.r2 = foundation::dot(ij.x_ij, ij.x_ij);
    const auto root = foundation::both_roots(max(ij.r2, nearest));
    kernel.both(root.r, root.inverse, ij.W, ij.F);
    add_all(mine, ij, std::index_sequence_for<Terms...>{}, terms...);
  }
  end_all(mine, i, std::index_sequence_for<Terms...>{}, terms...);
}

// Pairs out of the records.
template <int D, class Layout>
struct from_records {
  using pair = packed_pair<D, Layout>;
  const double* records;

  vec<real, D> own(pair& ij, std::size_t i) const {
    for (std::size_t k = 0; k < Layout::size; ++k) ij.mine[k] = real(records[i * Layout::size + k]);
    return position(ij.mine);
  }
  vec<real, D> neighbour(pair& ij) const {
    detail::load(records, ij.j, ij.values);
    return position(ij.values);
  }

 private:
  static vec<real, D> position(const std::array<real, Layout::size>& record) {
    vec<real, D> x;
    for (std::size_t k = 0; k < D; ++k) x[k] = record[k];
    return x;
  }
};

// Pairs out of the arrays.
template <int D, class Reads>
struct from_arrays {
  using pair = gathered_pair<D, Reads>;
  std::array<const double*, D> x;
  const Reads* reads;

  vec<real, D> own(pair& ij, std::size_t i) const {
    ij.reads = reads;
    ij.i = i;
    vec<real, D> x_i;
    for (std::size_t k = 0; k < D; ++k) x_i[k] = real(x[k][i]);
    return x_i;
  }
  vec<real, D> neighbour(const pair& ij) const { return gather<D>(x, ij.j); }
};

// For each particle i = rows[r]: begin, its neighbours from row i of the list, end.
template <int D, class Kernel, class Rows, class... Terms>
void sum_over(const Rows& rows, const cells::neighbour_list& list, const std::array<const double*, D>& x,
              const Kernel& kernel, const Terms&... terms) {
  const auto reads = std::apply([](auto... r) { return detail::unique_reads(std::tuple<>{}, r...); },
                                std::tuple_cat(reads_of(terms)...));
  const std::size_t n = rows.size();
  if (n == 0) return;
  const auto sum_rows = [&](const auto& source) {
#pragma omp parallel for schedule(static) if (n > foundation::rows_worth_threads)
    for (std::size_t r = 0; r < n; ++r) sum_row<D>(rows[r], list, source, kernel, terms...);
  };
  if constexpr (std::is_same_v<Rows, stretch>) {
    pack<D>(x, reads, rows.seen_first, rows.seen_last, list.null + 1, list.records);
    // Every row is filled up with the null particle.
    if (rows.seen_last <= list.null) pack<D>(x, reads, list.null, list.null + 1, list.null + 1, list.records);
    sum_rows(from_records<D, decltype(layout_of<D>(reads))>{list.records.data()});
  } else {
    sum_rows(from_arrays<D, decltype(reads)>{x, &reads});
  }
}

}  // namespace tetsuame::pairs
