// What the kernels share: the positive part, which stands in for every branch, and the functions of r that
// follow from the one a kernel writes, both(r, 1/r, w, f).
#pragma once

#include <algorithm>
#include <cmath>
#include <foundation/lanes.hpp>
#include <numbers>

namespace tetsuame::kernels {

// max(x, 0) for a double or lanes.
template <class R>
[[gnu::always_inline]] inline R positive_part(const R& x) {
  return foundation::greater(R(0.0), x);
}

// The constant of dimension D out of one for each of D = 1, 2, 3.
template <int D>
constexpr double of_dimension(double one, double two, double three) {
  static_assert(D >= 1 && D <= 3, "kernels exist in one, two and three dimensions");
  return D == 1 ? one : D == 2 ? two : three;
}

// c^(1/n) (k - r/h)+, whose n-th power is c (k - q)+^n: the factors of a spline's pieces cost nothing a pair.
class piece {
 public:
  piece() = default;
  piece(double c, int n, double k, double h) {
    const double root = std::pow(c, 1.0 / n);
    at_zero_ = root * k;
    slope_ = root / h;
    while (at_zero_ - slope_ * (k * h) > 0.0) slope_ = std::nextafter(slope_, 2.0 * slope_);  // nothing beyond k h
  }
  template <class R>
  R operator()(const R& r) const {
    return positive_part(R(at_zero_ - slope_ * r));
  }

 private:
  double at_zero_ = 0.0, slope_ = 0.0;
};

// Base of Kernel, which has both(r, inverse_r, w, f).
template <class Kernel>
class functions_of_distance {
 public:
  explicit functions_of_distance(double support) : support_(support) {}

  // W(r), 1/m^D; r >= 0 in m.
  template <class R>
  R value(const R& r) const {
    R w, f;
    both(r, w, f);
    return w;
  }

  // W'(r)/r, 1/m^(D+2).
  template <class R>
  R gradient_over_r(const R& r) const {
    R w, f;
    both(r, w, f);
    return f;
  }

  // The two at once.
  template <class R>
  void both(const R& r, R& w, R& f) const {
    static_cast<const Kernel&>(*this).both(r, R(1.0 / foundation::greater(r, R(smallest_r()))), w, f);
  }

  // The two where both are wanted: of kernels whose `both` shares all it can, that.
  template <class R>
  void both_in_common(const R& r, const R& inverse_r, R& w, R& f) const {
    static_cast<const Kernel&>(*this).both(r, inverse_r, w, f);
  }

  double support() const { return support_; }  // m
  double self() const { return value(0.0); }   // W(0), 1/m^D

  // m; for 1/r in `both`, r is taken to be at least this. Nearer than this, differences of a spline's
  // pieces are lost in the rounding of its terms.
  double smallest_r() const { return 3e-10 * support_; }

 private:
  double support_;
};

// A kernel whose W and F are made of the same powers, for sums that need both: fewer multiplications than each by
// itself, and another rounding.
template <class Kernel>
struct in_common : Kernel {
  explicit in_common(double support) : Kernel(support) {}
  explicit in_common(const Kernel& k) : Kernel(k) {}

  template <class R>
  void both(const R& r, const R& inverse_r, R& w, R& f) const {
    this->both_in_common(r, inverse_r, w, f);
  }
};

}  // namespace tetsuame::kernels
