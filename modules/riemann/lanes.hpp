// What a solver written once for double and for std::experimental::simd needs beside arithmetic:
// a choice by mask, and whether a mask holds anywhere. Functions of <cmath> are called
// unqualified after `using std::...`: lanes find their own by their namespace.
#pragma once

#include <cmath>
#include <experimental/simd>

namespace tetsuame::riemann {

template <class R>
using mask_of = decltype(R() < R());

inline double select(bool yes, double a, double b) { return yes ? a : b; }
inline bool any(bool yes) { return yes; }

template <class T, class Abi>
std::experimental::simd<T, Abi> select(const std::experimental::simd_mask<T, Abi>& yes,
                                       const std::experimental::simd<T, Abi>& a, std::experimental::simd<T, Abi> b) {
  where(yes, b) = a;
  return b;
}
template <class T, class Abi>
bool any(const std::experimental::simd_mask<T, Abi>& yes) {
  return any_of(yes);
}

}  // namespace tetsuame::riemann
