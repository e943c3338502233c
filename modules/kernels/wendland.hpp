// Wendland's kernels of least degree with two, four and six continuous derivatives,
// support S, q = r/S, t = max(1 - q, 0) [H. Wendland, Adv. Comput. Math. 4, 389 (1995);
// W. Dehnen, H. Aly, MNRAS 425, 1068 (2012), table 1]; in 1-D the members of the family that
// is of least degree there. Table of them: docs/theory/kernels.md. Here h = S/2.
#pragma once

#include <kernels/common.hpp>

namespace tetsuame::kernels {

// Order: the number of continuous derivatives.
template <int D, int Order>
class wendland : public functions_of_distance<wendland<D, Order>> {
 public:
  static constexpr int dimension = D;
  static constexpr const char* name = Order == 2 ? "wendland_c2" : Order == 4 ? "wendland_c4" : "wendland_c6";
  static constexpr double support_over_h = 2.0;
  static constexpr double default_h_over_dx = Order == 2 ? 1.3 : Order == 4 ? 2.25 : 2.5;

  explicit wendland(double support)  // m
      : functions_of_distance<wendland>(support), inverse_support_(1.0 / support) {
    constexpr double pi = std::numbers::pi;
    constexpr double normalisation = Order == 2 ? of_dimension<D>(5.0 / 4.0, 7.0 / pi, 21.0 / (2.0 * pi))
                                     : Order == 4
                                         ? of_dimension<D>(3.0 / 2.0, 9.0 / pi, 495.0 / (32.0 * pi))
                                         : of_dimension<D>(55.0 / 32.0, 78.0 / (7.0 * pi), 1365.0 / (64.0 * pi));
    constexpr double slope = Order == 2   ? of_dimension<D>(-12.0, -20.0, -20.0)
                             : Order == 4 ? of_dimension<D>(-14.0, -56.0 / 3.0, -56.0 / 3.0)
                                          : of_dimension<D>(-18.0, -22.0, -22.0);
    const double volume = D == 1 ? support : D == 2 ? support * support : support * support * support;
    w_scale_ = normalisation / volume;
    f_scale_ = slope * w_scale_ * inverse_support_ * inverse_support_;
  }

  using functions_of_distance<wendland>::both;

  template <class R>
  void both(const R& r, const R&, R& w, R& f) const {  // W'(r)/r is a polynomial: no 1/r
    const R q = r * inverse_support_;
    shape(q, positive_part(R(1.0 - q)), w, f);
    w = w_scale_ * w;
    f = f_scale_ * f;
  }

  // W/a and S^2 W'/(a r) of q, but for the slope's constant.
  template <class R>
  static void shape(const R& q, const R& t, R& w, R& f) {
    const R t2 = t * t;
    if constexpr (Order == 2 && D == 1) {
      w = t2 * t * (1.0 + 3.0 * q);
      f = t2;
    } else if constexpr (Order == 2) {
      f = t2 * t;
      w = f * t * (1.0 + 4.0 * q);
    } else if constexpr (Order == 4) {
      const R t4 = t2 * t2;
      if constexpr (D == 1) {
        w = t4 * t * (1.0 + q * (5.0 + 8.0 * q));
        f = t4 * (1.0 + 4.0 * q);
      } else {
        const R t5 = t4 * t;
        w = t5 * t * (1.0 + q * (6.0 + (35.0 / 3.0) * q));
        f = t5 * (1.0 + 5.0 * q);
      }
    } else {
      const R t6 = t2 * t2 * t2;
      if constexpr (D == 1) {
        w = t6 * t * (1.0 + q * (7.0 + q * (19.0 + 21.0 * q)));
        f = t6 * (1.0 + q * (6.0 + (35.0 / 3.0) * q));
      } else {
        const R t7 = t6 * t;
        w = t7 * t * (1.0 + q * (8.0 + q * (25.0 + 32.0 * q)));
        f = t7 * (1.0 + q * (7.0 + 16.0 * q));
      }
    }
  }

  double self() const { return w_scale_; }  // W(0), 1/m^D

 private:
  double inverse_support_, w_scale_, f_scale_;
};

template <int D>
using wendland_c2 = wendland<D, 2>;
template <int D>
using wendland_c4 = wendland<D, 4>;
template <int D>
using wendland_c6 = wendland<D, 6>;

}  // namespace tetsuame::kernels
