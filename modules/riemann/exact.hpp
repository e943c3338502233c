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

#include <riemann/states.hpp>
#include <type_traits>

// glibc's pow for four lanes (libmvec, error below 4 ulp): std::experimental::simd calls the
// scalar one lane by lane, which makes the whole solution four times as slow.
#if defined(__AVX2__) && defined(__x86_64__) && defined(__GLIBC__)
#define TETSUAME_VECTOR_POW 1
#include <immintrin.h>
extern "C" __m256d _ZGVdN4vv_pow(__m256d, __m256d);
#else
#define TETSUAME_VECTOR_POW 0
#endif

namespace tetsuame::riemann {

namespace detail {

template <class R>
struct wave {
  R f, slope;  // m/s; m/(s Pa)
};

// Unqualified: lanes find their own by their namespace.
using std::exp, std::sqrt;

template <class R>
R power(const R& x, const R& y) {
  using std::pow;
#if TETSUAME_VECTOR_POW
  if constexpr (std::is_same_v<R, std::experimental::simd<double, std::experimental::simd_abi::_VecBuiltin<32>>>)
    return R(_ZGVdN4vv_pow(static_cast<__m256d>(x), static_cast<__m256d>(y)));
  else
#endif
    return pow(x, y);
}
template <class R>
R greater(const R& a, const R& b) {
  return select(a < b, b, a);
}
template <class R>
R smaller(const R& a, const R& b) {
  return select(b < a, b, a);
}

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
  if (any(rarefies)) {
    const R ratio = P / P_K, speed = power(ratio, R(0.5 * minus / s.gamma));  // c*/c
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
  if (any(rarefies)) rho = select(rarefies, R(s.rho * power(ratio, R(1.0 / s.gamma))), rho);
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
    p_low = smaller(l.p, r.p);
    p_least = 0.0 - smaller(l.p_infinity, r.p_infinity);
    rarefy = at(p_low).f > 0.0;
    vacuum = rarefy;
    if (any(rarefy)) vacuum = rarefy && (curve(l, c_l, p_least).f + curve(r, c_r, p_least).f + r.u - l.u >= 0.0);
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
    const R root = greater(R(closing), R(0.0)) /
                   (sqrt(R(2.0 / ((l.gamma + 1.0) * l.rho))) + sqrt(R(2.0 / ((r.gamma + 1.0) * r.rho))));
    const R cold = root * root - greater(l.p_infinity, r.p_infinity);
    R p = greater(p_low, greater(acoustic, cold));
    for (int k = 0; k < 2; ++k) {
      const R g_l = shock_slope(l, p), g_r = shock_slope(r, p);
      p = greater(p_low, R((g_l * l.p + g_r * r.p + closing) / (g_l + g_r)));
    }
    return select(rarefy, p_low, p);
  }

  // One step; finish() puts lanes with a vacuum right.
  R next(const R& p) const {
    const wave<R> w = at(p);
    const R step = w.f / w.slope;
    R q = greater(p_low, R(p - step));
    if (any(rarefy)) {
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
