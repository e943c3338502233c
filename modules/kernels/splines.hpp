// The cubic and the quintic spline, with q = r/h and (x)+ = max(x, 0).
#pragma once

#include <array>
#include <kernels/common.hpp>

namespace tetsuame::kernels {

// Cubic spline, support S = 2 h:
//   W(r)    = a_D [(2-q)+^3 - 4 (1-q)+^3]
//   W'(r)/r = -(3 a_D/h^2) [(2-q)+^2 - 4 (1-q)+^2] / q
// a_1 = 1/(6 h), a_2 = 5/(14 pi h^2), a_3 = 1/(4 pi h^3)
// [J. J. Monaghan, J. C. Lattanzio, Astron. Astrophys. 149, 135 (1985), eq. (21)].
//
// Quintic spline, support S = 3 h:
//   W(r)    = a_D [(3-q)+^5 - 6 (2-q)+^5 + 15 (1-q)+^5]
//   W'(r)/r = -(5 a_D/h^2) [(3-q)+^4 - 6 (2-q)+^4 + 15 (1-q)+^4] / q
// [I. J. Schoenberg, Quart. Appl. Math. 4, 45 (1946); J. P. Morris, P. J. Fox, Y. Zhu,
// J. Comput. Phys. 136, 214 (1997)]. The a_D make the integral of W one:
// a_1 = 1/(120 h), a_2 = 7/(478 pi h^2), a_3 = 1/(120 pi h^3).
// The note of the Kyushu group prints another a_3 (docs/theory/kernels.md).
template <int D, int Degree>
class spline : public functions_of_distance<spline<D, Degree>> {
 public:
  static constexpr int dimension = D, pieces = (Degree + 1) / 2;
  static constexpr const char* name = Degree == 3 ? "cubic" : "quintic";
  static constexpr double support_over_h = pieces;
  static constexpr double default_h_over_dx = 1.2;

  explicit spline(double support) : functions_of_distance<spline>(support) {  // m
    constexpr double pi = std::numbers::pi;
    const double h = support / support_over_h;
    const double volume = D == 1 ? h : D == 2 ? h * h : h * h * h;
    const double a = Degree == 3 ? of_dimension<D>(1.0 / 6.0, 5.0 / (14.0 * pi), 1.0 / (4.0 * pi))
                                 : of_dimension<D>(1.0 / 120.0, 7.0 / (478.0 * pi), 1.0 / (120.0 * pi));
    const double scale = a / volume, slope = Degree * scale / h;
    constexpr std::array<double, 3> factors{1.0, Degree == 3 ? 4.0 : 6.0, 15.0};
    for (std::size_t k = 0; k < pieces; ++k) {
      const double end = support_over_h - static_cast<double>(k);
      w_[k] = piece(factors[k] * scale, Degree, end, h);
      f_[k] = piece(factors[k] * slope, Degree - 1, end, h);
    }
    share_ = h / Degree;
  }

  using functions_of_distance<spline>::both;

  // inverse_r: 1/r, 1/m, of an r that is not below smallest_r(). At r = 0 the pieces of f cancel, 4 - 4 or
  // 81 - 96 + 15, to rounding, so that f stays far below its limit there, -12 or -120 a_D/h^2: the pair of a particle
  // with itself gives no force either way.
  template <class R>
  void both(const R& r, const R& inverse_r, R& w, R& f) const {
    if constexpr (Degree == 3) {
      const R w2 = w_[0](r), w1 = w_[1](r), f2 = f_[0](r), f1 = f_[1](r);
      w = w2 * w2 * w2 - w1 * w1 * w1;
      f = (f1 * f1 - f2 * f2) * inverse_r;
    } else {
      const auto fourth = [](const R& t) { return R((t * t) * (t * t)); };
      const R w3 = w_[0](r), w2 = w_[1](r), w1 = w_[2](r);
      w = fourth(w3) * w3 - fourth(w2) * w2 + fourth(w1) * w1;
      f = (fourth(f_[1](r)) - fourth(f_[0](r)) - fourth(f_[2](r))) * inverse_r;
    }
  }

  // The same from one set of powers. With those of the slope, A of (S/h - q)+, B of (S/h - 1 - q)+ and C of
  // (1 - q)+, all with their factors, W = (h/n) [(S/h - q) A - (S/h - 1 - q) B + (1 - q) C], n the degree, so that
  //   W'(r)/r = -(A - B + C)/r,   W = ((S - r)/n) (A - B + C) + (h/n) (B - 2 C),
  // with no C for the cubic: 13 multiplications for the quintic where `both` has 22, 8 for the cubic where it has 11.
  template <class R>
  void both_in_common(const R& r, const R& inverse_r, R& w, R& f) const {
    const R from_end = pieces * share_ - r * (1.0 / Degree);
    R minus_sum, rest;
    if constexpr (Degree == 3) {
      const R f2 = f_[0](r), f1 = f_[1](r);
      rest = f1 * f1;
      minus_sum = rest - f2 * f2;
    } else {
      // In this order the compiler fuses the first two and not c, which it would then multiply out twice.
      const R f3 = f_[0](r), f2 = f_[1](r), f1 = f_[2](r), a2 = f3 * f3, b2 = f2 * f2, c2 = f1 * f1;
      const R b = b2 * b2, c = c2 * c2, b_less_c = b - c;
      rest = b_less_c - c;
      minus_sum = b_less_c - a2 * a2;
    }
    w = share_ * rest - from_end * minus_sum;
    f = minus_sum * inverse_r;
  }

 private:
  std::array<piece, pieces> w_, f_;
  double share_;  // m, h/n
};

template <int D>
using cubic_spline = spline<D, 3>;
template <int D>
using quintic_spline = spline<D, 5>;

}  // namespace tetsuame::kernels
