// Quintic spline, support S = 3 h, with q = r/h and (x)+ = max(x, 0):
//   W(r)    = a_D [(3-q)+^5 - 6 (2-q)+^5 + 15 (1-q)+^5]
//   W'(r)/r = -(5 a_D/h^2) [(3-q)+^4 - 6 (2-q)+^4 + 15 (1-q)+^4] / q
// [I. J. Schoenberg, Quart. Appl. Math. 4, 45 (1946); J. P. Morris, P. J. Fox, Y. Zhu,
// J. Comput. Phys. 136, 214 (1997)]. The a_D make the integral of W one:
// a_1 = 1/(120 h), a_2 = 7/(478 pi h^2), a_3 = 1/(120 pi h^3).
// The note of the Kyushu group prints a_3 = 3/(358 pi h^3), which is larger by
// 2/358 = 0.56 %: the integral of that kernel is 1.0056, so the exact value stands here.
#pragma once

#include <kernels/common.hpp>

namespace tetsuame::kernels {

template <int D>
class quintic_spline : public functions_of_distance<quintic_spline<D>> {
 public:
  static constexpr int dimension = D;
  static constexpr const char* name = "quintic";
  static constexpr double support_over_h = 3.0;
  static constexpr double default_h_over_dx = 1.2;

  explicit quintic_spline(double support) : support_(support) {  // m
    const double h = support / support_over_h;
    const double volume = D == 1 ? h : D == 2 ? h * h : h * h * h;
    inverse_h_ = 1.0 / h;
    w_scale_ =
        of_dimension<D>(1.0 / 120.0, 7.0 / (478.0 * std::numbers::pi), 1.0 / (120.0 * std::numbers::pi)) / volume;
    f_scale_ = -5.0 * w_scale_ * inverse_h_;
  }

  using functions_of_distance<quintic_spline<D>>::both;

  // inverse_r: 1/r, 1/m, of an r that is not below smallest_r().
  template <class R>
  void both(const R& r, const R& inverse_r, R& w, R& f) const {
    const R q = r * inverse_h_;
    const R t3 = positive_part(R(3.0 - q)), t2 = positive_part(R(2.0 - q)), t1 = positive_part(R(1.0 - q));
    const R s3 = t3 * t3, s2 = t2 * t2, s1 = t1 * t1;
    const R q3 = s3 * s3, q2 = 6.0 * (s2 * s2), q1 = 15.0 * (s1 * s1);
    w = w_scale_ * (q3 * t3 - q2 * t2 + q1 * t1);
    // The bracket is exactly 81 - 96 + 15 = 0 at r = 0, so f(0) = 0 and the pair of a
    // particle with itself gives no force; the limit r -> 0 is -120 a_D/h^2.
    f = f_scale_ * (q3 - q2 + q1) * inverse_r;
  }

  double support() const { return support_; }      // m
  double self() const { return w_scale_ * 66.0; }  // W(0), 1/m^D
  double smoothing_length() const { return support_ / support_over_h; }

 private:
  double support_, inverse_h_, w_scale_, f_scale_;
};

}  // namespace tetsuame::kernels
