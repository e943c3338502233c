// The exact Riemann problem of two stiffened gases [E. F. Toro, Riemann Solvers and Numerical
// Methods for Fluid Dynamics, 3rd ed. (2009), chapter 4; with p_inf: M. J. Ivings, D. M. Causon,
// E. F. Toro, Int. J. Numer. Meth. Fluids 28, 395 (1998)]. With P = p + p_inf of each side,
//   f(p) = (p - p_K) sqrt(A/(P + B))                   p > p_K, shock
//        = 2c/(gamma-1) [(P/P_K)^((gamma-1)/(2 gamma)) - 1]      rarefaction
//   A = 2/((gamma+1) rho),  B = (gamma-1)/(gamma+1) P_K,
// p* is the root of F(p) = f_l + f_r + u_r - u_l; then u* = u_l - f_l = u_r + f_r.
//
// The iteration needs no guard: why it converges stands in docs/theory/riemann.md.
// p_least = -min(p_inf) is where the first of the sides has no sound; F(p_least) >= 0: vacuum.
#pragma once

#include <cmath>
#include <experimental/simd>
#include <foundation/lanes.hpp>
#include <foundation/lanes_math.hpp>

namespace tetsuame::riemann {

// A choice by mask.
template <class R>
using mask_of = decltype(R() < R());

using foundation::select;
inline double select(bool yes, double a, double b) { return yes ? a : b; }

// A side: a stiffened gas of its own,
//   p = (gamma - 1) rho e - p_inf,   K_S = rho c^2 = gamma (p + p_inf),
// which holds the ideal gas (p_inf = 0) and, with gamma = dK_S/dp and p_inf = K_S/gamma - p at a state, any equation of
// state near it (docs/theory/riemann.md). R: double, or lanes of it.
template <class R>
struct side {
  R rho, u, p;          // kg/m^3; m/s towards +x; Pa. rho > 0, p > -p_infinity
  R gamma, p_infinity;  // dimensionless > 1; Pa
};

template <class R>
R sound_speed(const side<R>& s) {
  using std::sqrt;
  return sqrt(s.gamma * (s.p + s.p_infinity) / s.rho);
}

// Between the outer waves. The contact parts left from right.
template <class R>
struct star {
  R p, u;             // Pa, m/s; u is (u_l + u_r)/2
  R u_l, u_r;         // m/s: both u, but where a vacuum opens between them
  R rho_l, rho_r;     // kg/m^3
  mask_of<R> vacuum;  // the sides part: p is the least pressure either can have
};

namespace detail {

template <class R>
struct wave {
  R f, slope;  // m/s; m/(s Pa)
};

// Unqualified: lanes find their own by their namespace. Of greater(a, b) and lesser(a, b), b where one is not a number.
using foundation::greater, foundation::lesser, std::exp, std::sqrt, std::experimental::any_of;

// f/(p - p_K) of a shock.
template <class R>
R shock_slope(const side<R>& s, const R& p) {
  const R plus = s.gamma + 1.0, minus = s.gamma - 1.0;
  return sqrt(R(2.0 / (plus * s.rho * (p + s.p_infinity + minus / plus * (s.p + s.p_infinity)))));
}

// f and df/dp of one side; c its sound speed.
template <class R>
wave<R> curve(const side<R>& s, const R& c, const R& p) {
  const R P = p + s.p_infinity, P_K = s.p + s.p_infinity, plus = s.gamma + 1.0, minus = s.gamma - 1.0;
  const R B = minus / plus * P_K, root = shock_slope(s, p);
  wave<R> w{(p - s.p) * root, root * (1.0 - 0.5 * (p - s.p) / (P + B))};
  const auto rarefies = p < s.p;
  if (any_of(rarefies)) {
    const R ratio = P / P_K, speed = foundation::pow(ratio, R(0.5 * minus / s.gamma));  // c*/c
    w.f = select(rarefies, R(2.0 * c / minus * (speed - 1.0)), w.f);
    w.slope = select(rarefies, R(speed / (ratio * s.rho * c)), w.slope);
  }
  return w;
}

template <class R>
R star_density(const side<R>& s, const R& p) {
  const R ratio = (p + s.p_infinity) / (s.p + s.p_infinity), mu = (s.gamma - 1.0) / (s.gamma + 1.0);
  R rho = s.rho * (ratio + mu) / (mu * ratio + 1.0);
  const auto rarefies = p < s.p;
  if (any_of(rarefies)) rho = select(rarefies, R(s.rho * foundation::pow(ratio, R(1.0 / s.gamma))), rho);
  return rho;
}

// The problem with what all iterations share.
template <class R>
struct problem {
  side<R> l, r;
  R c_l, c_r;
  R p_low, p_least;           // min(p_l, p_r); where a vacuum begins
  mask_of<R> vacuum, rarefy;  // rarefy: both waves are rarefactions

  problem(const side<R>& l_, const side<R>& r_) : l(l_), r(r_), c_l(sound_speed(l_)), c_r(sound_speed(r_)) {
    p_low = lesser(r.p, l.p);
    p_least = 0.0 - lesser(r.p_infinity, l.p_infinity);
    rarefy = at(p_low).f > 0.0;
    vacuum = rarefy;
    if (any_of(rarefy)) vacuum = rarefy && (curve(l, c_l, p_least).f + curve(r, c_r, p_least).f + r.u - l.u >= 0.0);
  }

  wave<R> at(const R& p) const {
    const wave<R> a = curve(l, c_l, p), b = curve(r, c_r, p);
    return {a.f + b.f + r.u - l.u, a.slope + b.slope};
  }

  // The greatest of what acoustics give [Toro (4.47)], of the least pressure of two shocks
  // into cold gas, from f < sqrt(A (p + p_inf)), and of p_low; then twice the two-shock
  // estimate with the last pressure in the slopes [Toro (9.42)], which costs no power.
  R start() const {
    const R z_l = l.rho * c_l, z_r = r.rho * c_r, closing = l.u - r.u;
    const R acoustic = (z_r * l.p + z_l * r.p + z_l * z_r * closing) / (z_l + z_r);
    const R root = greater(R(0.0), R(closing)) /
                   (sqrt(R(2.0 / ((l.gamma + 1.0) * l.rho))) + sqrt(R(2.0 / ((r.gamma + 1.0) * r.rho))));
    const R cold = root * root - greater(r.p_infinity, l.p_infinity);
    R p = greater(greater(cold, acoustic), p_low);
    for (int k = 0; k < 2; ++k) {
      const R g_l = shock_slope(l, p), g_r = shock_slope(r, p);
      p = greater(R((g_l * l.p + g_r * r.p + closing) / (g_l + g_r)), p_low);
    }
    return select(rarefy, p_low, p);
  }

  // One step; finish() puts lanes with a vacuum right.
  R next(const R& p) const {
    const wave<R> w = at(p);
    const R step = w.f / w.slope;
    R q = greater(R(p - step), p_low);
    if (any_of(rarefy)) {
      const R above = p - p_least;
      q = select(rarefy, R(p_least + above * exp(R(-step / above))), q);
    }
    return q;
  }

  star<R> finish(const R& reached) const {
    const R p = select(vacuum, p_least, reached);
    const R u_l = l.u - curve(l, c_l, p).f, u_r = r.u + curve(r, c_r, p).f, u = 0.5 * (u_l + u_r);
    return {p, u, select(vacuum, u_l, u), select(vacuum, u_r, u), star_density(l, p), star_density(r, p), vacuum};
  }
};

}  // namespace detail

// A fixed number of steps, for lanes: no state is refused, and one that is not a number in a lane
// stays in that lane. Of the shock tubes in tests/riemann two steps give p* to 3e-5 where
// there is a shock, three to 1e-9; two strong rarefactions near a vacuum need four for 1e-6.
template <class R>
star<R> solve(const side<R>& left, const side<R>& right, int iterations) {
  const detail::problem<R> both(left, right);
  R p = both.start();
  for (int k = 0; k < iterations; ++k) p = both.next(p);
  return both.finish(p);
}

// Until steps are at rounding level; fail_input for a side with rho, P or gamma - 1 not
// above 0 or not finite, fail_calculation if 100 steps do not do.
star<double> solve(const side<double>& left, const side<double>& right);

struct primitive {
  double rho, u, p;  // kg/m^3, m/s, Pa
};

// The solution at x/t = xi (m/s), of the star state that solve() gave. In a vacuum rho = 0,
// u = xi and p = p_least.
primitive sample(const side<double>& left, const side<double>& right, const star<double>& between, double xi);

}  // namespace tetsuame::riemann
