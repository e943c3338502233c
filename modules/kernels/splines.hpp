// The cubic and the quintic spline, with q = r/h and (x)+ = max(x, 0).
#pragma once

#include <array>
#include <kernels/common.hpp>

namespace tetsuame::kernels {

// Cubic spline, support S = 2 h, with q = r/h and (x)+ = max(x, 0):
//   W(r)    = a_D [(2-q)+^3 - 4 (1-q)+^3]
//   W'(r)/r = -(3 a_D/h^2) [(2-q)+^2 - 4 (1-q)+^2] / q
// a_1 = 1/(6 h), a_2 = 5/(14 pi h^2), a_3 = 1/(4 pi h^3)
// [J. J. Monaghan, J. C. Lattanzio, Astron. Astrophys. 149, 135 (1985), eq. (21)].
template <int D>
class cubic_spline : public functions_of_distance<cubic_spline<D>> {
 public:
  static constexpr int dimension = D;
  static constexpr const char* name = "cubic";
  static constexpr double support_over_h = 2.0;
  static constexpr double default_h_over_dx = 1.2;

  explicit cubic_spline(double support) : functions_of_distance<cubic_spline>(support) {  // m
    const double h = support / support_over_h;
    const double volume = D == 1 ? h : D == 2 ? h * h : h * h * h;
    const double scale =
        of_dimension<D>(1.0 / 6.0, 5.0 / (14.0 * std::numbers::pi), 1.0 / (4.0 * std::numbers::pi)) / volume;
    const double slope = 3.0 * scale / h;
    w_ = {piece(scale, 3, 2.0, h), piece(4.0 * scale, 3, 1.0, h)};
    f_ = {piece(slope, 2, 2.0, h), piece(4.0 * slope, 2, 1.0, h)};
  }

  using functions_of_distance<cubic_spline<D>>::both;

  // inverse_r: 1/r, 1/m, of an r that is not below smallest_r().
  template <class R>
  void both(const R& r, const R& inverse_r, R& w, R& f) const {
    const R w2 = w_[0](r), w1 = w_[1](r), f2 = f_[0](r), f1 = f_[1](r);
    w = w2 * w2 * w2 - w1 * w1 * w1;
    // At r = 0 the two cancel, 4 - 4, to rounding, so that f stays far below its limit -12 a_D/h^2 there: the
    // pair of a particle with itself gives no force either way.
    f = (f1 * f1 - f2 * f2) * inverse_r;
  }

 private:
  std::array<piece, 2> w_, f_;
};

// Quintic spline, support S = 3 h, with q = r/h and (x)+ = max(x, 0):
//   W(r)    = a_D [(3-q)+^5 - 6 (2-q)+^5 + 15 (1-q)+^5]
//   W'(r)/r = -(5 a_D/h^2) [(3-q)+^4 - 6 (2-q)+^4 + 15 (1-q)+^4] / q
// [I. J. Schoenberg, Quart. Appl. Math. 4, 45 (1946); J. P. Morris, P. J. Fox, Y. Zhu,
// J. Comput. Phys. 136, 214 (1997)]. The a_D make the integral of W one:
// a_1 = 1/(120 h), a_2 = 7/(478 pi h^2), a_3 = 1/(120 pi h^3).
// The note of the Kyushu group prints another a_3 (docs/theory/kernels.md).
template <int D>
class quintic_spline : public functions_of_distance<quintic_spline<D>> {
 public:
  static constexpr int dimension = D;
  static constexpr const char* name = "quintic";
  static constexpr double support_over_h = 3.0;
  static constexpr double default_h_over_dx = 1.2;

  explicit quintic_spline(double support) : functions_of_distance<quintic_spline>(support) {  // m
    const double h = support / support_over_h;
    const double volume = D == 1 ? h : D == 2 ? h * h : h * h * h;
    const double scale =
        of_dimension<D>(1.0 / 120.0, 7.0 / (478.0 * std::numbers::pi), 1.0 / (120.0 * std::numbers::pi)) / volume;
    const double slope = 5.0 * scale / h;
    w_ = {piece(scale, 5, 3.0, h), piece(6.0 * scale, 5, 2.0, h), piece(15.0 * scale, 5, 1.0, h)};
    f_ = {piece(slope, 4, 3.0, h), piece(6.0 * slope, 4, 2.0, h), piece(15.0 * slope, 4, 1.0, h)};
  }

  using functions_of_distance<quintic_spline<D>>::both;

  // inverse_r: 1/r, 1/m, of an r that is not below smallest_r().
  template <class R>
  void both(const R& r, const R& inverse_r, R& w, R& f) const {
    const auto fourth = [](const R& t) { return R((t * t) * (t * t)); };
    const R w3 = w_[0](r), w2 = w_[1](r), w1 = w_[2](r);
    w = fourth(w3) * w3 - fourth(w2) * w2 + fourth(w1) * w1;
    // At r = 0 the three cancel, 81 - 96 + 15, to rounding, so that f stays far below its limit -120 a_D/h^2
    // there: the pair of a particle with itself gives no force either way.
    f = (fourth(f_[1](r)) - fourth(f_[0](r)) - fourth(f_[2](r))) * inverse_r;
  }

 private:
  std::array<piece, 3> w_, f_;
};

}  // namespace tetsuame::kernels
