// Cubic spline, support S = 2 h, with q = r/h and (x)+ = max(x, 0):
//   W(r)    = a_D [(2-q)+^3 - 4 (1-q)+^3]
//   W'(r)/r = -(3 a_D/h^2) [(2-q)+^2 - 4 (1-q)+^2] / q
// a_1 = 1/(6 h), a_2 = 5/(14 pi h^2), a_3 = 1/(4 pi h^3)
// [J. J. Monaghan, J. C. Lattanzio, Astron. Astrophys. 149, 135 (1985), eq. (21)].
#pragma once

#include <kernels/common.hpp>

namespace tetsuame::kernels {

template <int D>
class cubic_spline : public functions_of_distance<cubic_spline<D>> {
 public:
  static constexpr int dimension = D;
  static constexpr const char* name = "cubic";
  static constexpr double support_over_h = 2.0;
  static constexpr double default_h_over_dx = 1.2;

  explicit cubic_spline(double support) : support_(support) {  // m
    const double h = support / support_over_h;
    const double volume = D == 1 ? h : D == 2 ? h * h : h * h * h;
    inverse_h_ = 1.0 / h;
    w_scale_ = of_dimension<D>(1.0 / 6.0, 5.0 / (14.0 * std::numbers::pi), 1.0 / (4.0 * std::numbers::pi)) / volume;
    f_scale_ = -3.0 * w_scale_ * inverse_h_;
  }

  using functions_of_distance<cubic_spline<D>>::both;

  // inverse_r: 1/r, 1/m, of an r that is not below smallest_r().
  template <class R>
  void both(const R& r, const R& inverse_r, R& w, R& f) const {
    const R q = r * inverse_h_;
    const R t2 = positive_part(R(2.0 - q)), t1 = positive_part(R(1.0 - q));
    const R s2 = t2 * t2, s1 = 4.0 * (t1 * t1);
    w = w_scale_ * (s2 * t2 - s1 * t1);
    // The bracket is exactly 4 - 4 = 0 at r = 0, so f(0) = 0 and the pair of a particle
    // with itself gives no force; the limit r -> 0 is -12 a_D/h^2.
    f = f_scale_ * (s2 - s1) * inverse_r;
  }

  double support() const { return support_; }     // m
  double self() const { return w_scale_ * 4.0; }  // W(0), 1/m^D
  double smoothing_length() const { return support_ / support_over_h; }

 private:
  double support_, inverse_h_, w_scale_, f_scale_;
};

}  // namespace tetsuame::kernels
