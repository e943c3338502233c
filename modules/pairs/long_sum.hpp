// The sum of a row's forces. Forces of a pair in single numbers are opposite to the bit, but one after the other they
// would be added to sums some ten times as large, of one side's neighbours, whose roundings remain where these cancel:
// on a lattice at rest the same in every step. So what a sum rounds off is kept, and added up too:
//   t = s + f,  rest += f - (t - s),  s = t,   exact where |s| >= |f| [T. J. Dekker, Numer. Math. 18, 224 (1971)],
// for which s does not begin at zero. Doubles are added as they are.
#pragma once

#include <foundation/lanes.hpp>
#include <foundation/vec.hpp>

namespace tetsuame::pairs {

using foundation::real, foundation::single, foundation::vec;

template <class R, int D>
struct long_sum : vec<R, D> {
  explicit long_sum(const R&) : vec<R, D>(foundation::zero<R, D>()) {}
  void join() {}
};

template <int D>
struct long_sum<single, D> {
  // larger: than any force here, of either sign; should it not be, sums are those of single numbers. The larger, the
  // fewer digits has `rest`: n u times this is what n roundings u of it come to.
  explicit long_sum(const single& larger) : start(larger) {
    high = vec<single, D>::of([&](std::size_t) { return larger; });
    rest = foundation::zero<single, D>();
  }
  long_sum& operator-=(const vec<single, D>& f) {
    foundation::for_each_of<D>([&](std::size_t k) {
      const single subtracted = foundation::rounded(f[k]), next = high[k] - subtracted;
      rest[k] -= subtracted - (high[k] - next);
      high[k] = next;
    });
    return *this;
  }

  // Of a row's end: both halves as doubles.
  void join() {
    const auto of_half = [&](const single& h, const single& r) {
      return real(foundation::lower_half(h) - foundation::lower_half(start) + foundation::lower_half(r));
    };
    foundation::for_each_of<D>([&](std::size_t k) {
      total[k] = of_half(high[k], rest[k]) +
                 of_half(foundation::halves_exchanged(high[k]), foundation::halves_exchanged(rest[k]));
    });
  }
  const real& operator[](std::size_t k) const { return total[k]; }

 private:
  vec<single, D> high, rest;
  single start;
  vec<real, D> total;
};

}  // namespace tetsuame::pairs
