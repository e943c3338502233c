// Wendland's kernels of least degree with two, four and six continuous derivatives,
// support S, q = r/S, t = max(1 - q, 0) [H. Wendland, Adv. Comput. Math. 4, 389 (1995);
// W. Dehnen, H. Aly, MNRAS 425, 1068 (2012), table 1]; in 1-D the members of the family that
// is of least degree there. Table of them: docs/theory/kernels.md. Here h = S/2.
#pragma once

#include <kernels/common.hpp>

namespace tetsuame::kernels {

// The part all three share; Kernel gives shape(q, t, w, f): W/a and S^2 W'/(a r) of q.
template <int D, class Kernel>
class wendland : public functions_of_distance<Kernel> {
 public:
  static constexpr int dimension = D;
  static constexpr double support_over_h = 2.0;

  using functions_of_distance<Kernel>::both;

  template <class R>
  void both(const R& r, const R&, R& w, R& f) const {  // W'(r)/r is a polynomial: no 1/r
    const R q = r * inverse_support_;
    Kernel::shape(q, positive_part(R(1.0 - q)), w, f);
    w = w_scale_ * w;
    f = f_scale_ * f;
  }

  double self() const { return w_scale_; }  // W(0), 1/m^D

 protected:
  wendland(double support, double normalisation, double slope)
      : functions_of_distance<Kernel>(support), inverse_support_(1.0 / support) {
    const double volume = D == 1 ? support : D == 2 ? support * support : support * support * support;
    w_scale_ = normalisation / volume;
    f_scale_ = slope * w_scale_ * inverse_support_ * inverse_support_;
  }

 private:
  double inverse_support_, w_scale_, f_scale_;
};

template <int D>
class wendland_c2 : public wendland<D, wendland_c2<D>> {
 public:
  static constexpr const char* name = "wendland_c2";
  static constexpr double default_h_over_dx = 1.3;

  explicit wendland_c2(double support)  // m
      : wendland<D, wendland_c2>(support,
                                 of_dimension<D>(5.0 / 4.0, 7.0 / std::numbers::pi, 21.0 / (2.0 * std::numbers::pi)),
                                 of_dimension<D>(-12.0, -20.0, -20.0)) {}

  template <class R>
  static void shape(const R& q, const R& t, R& w, R& f) {
    const R t2 = t * t;
    if constexpr (D == 1) {
      w = t2 * t * (1.0 + 3.0 * q);
      f = t2;
    } else {
      f = t2 * t;
      w = f * t * (1.0 + 4.0 * q);
    }
  }
};

template <int D>
class wendland_c4 : public wendland<D, wendland_c4<D>> {
 public:
  static constexpr const char* name = "wendland_c4";
  static constexpr double default_h_over_dx = 2.25;

  explicit wendland_c4(double support)  // m
      : wendland<D, wendland_c4>(support,
                                 of_dimension<D>(3.0 / 2.0, 9.0 / std::numbers::pi, 495.0 / (32.0 * std::numbers::pi)),
                                 of_dimension<D>(-14.0, -56.0 / 3.0, -56.0 / 3.0)) {}

  template <class R>
  static void shape(const R& q, const R& t, R& w, R& f) {
    const R t2 = t * t, t4 = t2 * t2;
    if constexpr (D == 1) {
      w = t4 * t * (1.0 + q * (5.0 + 8.0 * q));
      f = t4 * (1.0 + 4.0 * q);
    } else {
      const R t5 = t4 * t;
      w = t5 * t * (1.0 + q * (6.0 + (35.0 / 3.0) * q));
      f = t5 * (1.0 + 5.0 * q);
    }
  }
};

template <int D>
class wendland_c6 : public wendland<D, wendland_c6<D>> {
 public:
  static constexpr const char* name = "wendland_c6";
  static constexpr double default_h_over_dx = 2.5;

  explicit wendland_c6(double support)  // m
      : wendland<D, wendland_c6>(
            support, of_dimension<D>(55.0 / 32.0, 78.0 / (7.0 * std::numbers::pi), 1365.0 / (64.0 * std::numbers::pi)),
            of_dimension<D>(-18.0, -22.0, -22.0)) {}

  template <class R>
  static void shape(const R& q, const R& t, R& w, R& f) {
    const R t2 = t * t, t6 = t2 * t2 * t2;
    if constexpr (D == 1) {
      w = t6 * t * (1.0 + q * (7.0 + q * (19.0 + 21.0 * q)));
      f = t6 * (1.0 + q * (6.0 + (35.0 / 3.0) * q));
    } else {
      const R t7 = t6 * t;
      w = t7 * t * (1.0 + q * (8.0 + q * (25.0 + 32.0 * q)));
      f = t7 * (1.0 + q * (7.0 + 16.0 * q));
    }
  }
};

}  // namespace tetsuame::kernels
