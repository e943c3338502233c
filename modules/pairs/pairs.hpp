// The pair loop: every sum over neighbours in the physics runs through here.
//
// A term is a small struct that writes one sum of the notes. It names what it reads of the
// neighbours (records.hpp), what it keeps of particle i (`begin`), what neighbours add (`add`, for
// several at once: `real` holds one value a lane), and where the finished sum goes (`end`):
//
//   struct divergence {                                  // Σ_j ΔV_j v_ij·∇_i W_ij
//     auto reads() const;                                // -> {read(of_velocity, v), read(of_volume, dV)}
//     auto begin(std::size_t i) const;                   // -> what the sum needs of i, and its zero
//     void add(me& a, const auto& ij) const;             // a.sum += ij(of_volume) * ij.F * dot(a.v - ij(of_velocity),
//     ij.x_ij) void end(std::size_t i, const me& a) const;        // out[i] = sum(a.sum)
//   };
//
// Several terms in one call share the neighbour's record, distance and kernel: one pass for the
// whole right-hand side. Neighbours are added in the list's order, lane by lane, and the
// lanes in a fixed tree, so the result depends on neither ranks nor threads.
#pragma once

#include <array>
#include <cells/neighbour_list.hpp>
#include <cstddef>
#include <cstdint>
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

// The lanes' sum in the fixed order of a binary tree: (0 + 2) + (1 + 3) for four lanes.
template <class R>
double sum(const R& a) {
#if defined(__AVX__)
  if constexpr (R::size() == 4) {
    const auto all = static_cast<__m256d>(a);
    const __m128d pair = _mm_add_pd(_mm256_castpd256_pd128(all), _mm256_extractf128_pd(all, 1));
    return _mm_cvtsd_f64(_mm_add_sd(pair, _mm_unpackhi_pd(pair, pair)));
  }
#endif
  std::array<double, lanes> part;
  a.copy_to(part.data(), stdx::element_aligned);
  for (std::size_t half = lanes / 2; half > 0; half /= 2)
    for (std::size_t k = 0; k < half; ++k) part[k] += part[k + half];
  return part[0];
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
  // v·∇_i W_ij, written so that terms which need it for the same v share it.
  real along_gradient(const vec<real, D>& v) const { return F * foundation::dot(v, x_ij); }
};

// A pair with the neighbours' records: ij(of_volume) is a real, ij(of_velocity) a vector.
template <int D, class Layout>
struct packed_pair : pair<D> {
  std::array<real, Layout::size> values;

  template <class Tag>
  auto operator()(Tag) const {
    constexpr std::size_t at = Layout::template place<Tag>(), n = Layout::template components<Tag>();
    static_assert(n > 0, "a term uses a field that its reads() does not name");
    if constexpr (n == 1) {
      return values[at];
    } else {
      vec<real, static_cast<int>(n)> v;
      for (std::size_t k = 0; k < n; ++k) v[k] = values[at + k];
      return v;
    }
  }
};

// A pair whose fields come from the arrays themselves: for a few rows, where packing all particles
// would cost more than it saves. The same values, so the same bits.
template <int D, class Reads>
struct gathered_pair : pair<D> {
  const Reads* reads;

  template <class Tag>
  auto operator()(Tag) const {
    return std::apply([this](const auto&... r) { return pick<Tag>(r...); }, *reads);
  }

 private:
  template <class Tag, class Read, class... Rest>
  auto pick(const Read& read, const Rest&... rest) const {
    if constexpr (std::is_same_v<Tag, typename Read::tag> && Read::components == 1)
      return gather(read.from[0], this->j);
    else if constexpr (std::is_same_v<Tag, typename Read::tag>)
      return gather<static_cast<int>(Read::components)>(read.from, this->j);
    else
      return pick<Tag>(rest...);
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

// Rows of sum_over: all particles in [0, n).
struct every {
  std::size_t n;
  std::size_t size() const { return n; }
  std::size_t operator[](std::size_t r) const { return r; }
};

// One particle's sums. `flatten`: everything called in here is inlined, so that the compiler keeps
// sums and kernel in registers whatever it thinks of the program's size.
template <int D, class Pair, class Fetch, class Kernel, class... Terms>
[[gnu::flatten]] void sum_row(std::size_t i, const cells::neighbour_list& list, const std::array<const double*, D>& x,
                              const Fetch& fetch, const Kernel& kernel, const Terms&... terms) {
  vec<real, D> x_i;
  for (std::size_t k = 0; k < D; ++k) x_i[k] = real(x[k][i]);
  std::tuple mine{terms.begin(i)...};
  const std::int32_t* end = list.neighbours.data() + list.start[i + 1];
  for (const std::int32_t* j = list.neighbours.data() + list.start[i]; j < end; j += lanes) {
    Pair ij;
    ij.j = j;
    ij.x_ij = x_i - fetch(ij);
    ij.r2 = foundation::dot(ij.x_ij, ij.x_ij);
    kernel.both(stdx::sqrt(ij.r2), ij.W, ij.F);
    add_all(mine, ij, std::index_sequence_for<Terms...>{}, terms...);
  }
  end_all(mine, i, std::index_sequence_for<Terms...>{}, terms...);
}

// For each particle i = rows[r]: begin, its neighbours from row i of the list, end.
template <int D, class Kernel, class Rows, class... Terms>
void sum_over(const Rows& rows, const cells::neighbour_list& list, const std::array<const double*, D>& x,
              const Kernel& kernel, const Terms&... terms) {
  const auto reads = std::apply([](auto... r) { return detail::unique_reads(std::tuple<>{}, r...); },
                                std::tuple_cat(reads_of(terms)...));
  const std::size_t n = rows.size();
  if constexpr (std::is_same_v<Rows, every>) {
    using packed = packed_pair<D, decltype(layout_of<D>(reads))>;
    pack<D>(x, reads, list.null + 1, list.records);
    const double* records = list.records.data();
    const auto fetch = [records](packed& ij) {
      detail::load(records, ij.j, ij.values);
      vec<real, D> x_j;
      for (std::size_t k = 0; k < D; ++k) x_j[k] = ij.values[k];
      return x_j;
    };
#pragma omp parallel for schedule(static) if (n > foundation::rows_worth_threads)
    for (std::size_t r = 0; r < n; ++r) sum_row<D, packed>(rows[r], list, x, fetch, kernel, terms...);
  } else {
    using gathered = gathered_pair<D, decltype(reads)>;
    const auto fetch = [&](gathered& ij) {
      ij.reads = &reads;
      return gather<D>(x, ij.j);
    };
#pragma omp parallel for schedule(static) if (n > foundation::rows_worth_threads)
    for (std::size_t r = 0; r < n; ++r) sum_row<D, gathered>(rows[r], list, x, fetch, kernel, terms...);
  }
}

}  // namespace tetsuame::pairs
