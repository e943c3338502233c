// The force of one contact: of a grain with another grain, or with a wall.
//
// Normal, of the overlap δ (compression positive), with R* = R1 R2/(R1 + R2) and m* = m1 m2/(m1 + m2):
//
//   Hertz   k = 4/3 E* √R*,   F_n = max(0, k δ^(3/2) + α √(m* k) δ^(1/4) dδ/dt)
//   Hooke   F_n = max(0, k δ + α √(m* k) dδ/dt)
//
// Hertz's contact may adhere (materials.hpp); the dashpots then take the contact's radius a in the place of √(R* δ).
//
// Tangential: a spring that sticks until Coulomb's limit and slides there. Its force Q is kept from step to step and
// turns with the contact. The increment is k_t times the tangential way of the surfaces, k_t = 8 G* a with the radius
// of the contact a = √(R* δ) [R. D. Mindlin, J. Appl. Mech. 16, 259 (1949)]. Where a shrinks the force shrinks with it,
// so that unloading makes no energy [C. Thornton, S. J. Cummins, P. W. Cleary, Powder Technol. 210, 189 (2011)]. While
// it sticks a dashpot acts beside the spring, with the same α.
//
// The grain meets the partner's surface at R1 d/(R1 + R2) from its centre, d being the distance of the centres: both
// levers together are d, and angular momentum is kept.
#pragma once

#include <cmath>
#include <dem/materials.hpp>
#include <numbers>
#include <solids/motion.hpp>

namespace tetsuame::dem {

template <int D>
inline constexpr std::size_t turns = D == 2 ? 1 : 3;

// n × F
template <int D>
solids::about<D> torque_of(const solids::point<D>& n, const solids::point<D>& F) {
  return solids::moment<D>(n, F);
}

// What a contact keeps from step to step.
template <int D>
struct contact_memory {
  solids::point<D> Q = foundation::zero<double, D>();  // N, of the tangential spring, on the first grain
  double a = 0.0;                                      // m, Hertz: radius of the contact; 0: there was none
  solids::about<D> M = foundation::zero < double, D == 2 ? 1 : 3 > ();  // N m, of the rolling spring, on the first

  static constexpr std::size_t size = D + 1 + turns<D>;
  static contact_memory read(const double* from) {
    contact_memory m;
    for (std::size_t k = 0; k < D; ++k) m.Q[k] = from[k];
    m.a = from[D];
    for (std::size_t k = 0; k < turns<D>; ++k) m.M[k] = from[D + 1 + k];
    return m;
  }
  // Zeros have one sign: of the two grains of a pair either may be the first.
  void write(double* to) const {
    for (std::size_t k = 0; k < D; ++k) to[k] = Q[k] + 0.0;
    to[D] = a;
    for (std::size_t k = 0; k < turns<D>; ++k) to[D + 1 + k] = M[k] + 0.0;
  }
  // As the other grain has it.
  contact_memory reversed() const { return {-1.0 * Q, a, -1.0 * M}; }
};

template <int D>
struct encounter {
  solids::point<D> n;     // from the partner to the grain, of length one
  double overlap;         // m, δ > 0
  double R, m;            // m, kg: R*, m*
  double approach;        // m/s, dδ/dt
  solids::point<D> slip;  // m/s, tangential velocity of the grain's surface against the partner's
  solids::point<D> way;   // m, by which that has gone on in the step
  // Where there is rolling resistance: radians, by which the grain has rolled on the partner in the step; 1/s, now; kg
  // m2, reduced, about the contact, of the rolling spring's dashpot.
  solids::about<D> rolling, roll;
  double inertia;
};

template <int D>
struct contact_force {
  solids::point<D> force;       // N, on the grain
  solids::point<D> tangential;  // N, of which
  solids::about<D> rolling;     // N m, on the grain
  double normal = 0.0;          // N
  double elastic = 0.0;         // J, in the springs
};

template <int D>
double square(const solids::point<D>& a) {
  return foundation::dot(a, a);
}

// Of a component of M along n nothing is left in three dimensions: the contact does not resist twisting.
template <int D>
solids::about<D> without_twist(const solids::about<D>& a, [[maybe_unused]] const solids::point<D>& n) {
  if constexpr (D == 2)
    return a;
  else
    return a - foundation::dot(a, n) * n;
}

// Changes the memory to what it is after the step.
template <int D>
contact_force<D> force_of(const contact_rules& rules, const pair_constants& c, const encounter<D>& e,
                          contact_memory<D>& memory) {
  contact_force<D> f;
  const bool hertz = rules.model == contact_model::hertz_mindlin;
  // m, a; N/m, F/δ and that of the tangential spring. √(m k_t) is √(m F/δ) times a number of the materials.
  const bool adheres = hertz && c.adhesion > 0.0;
  const double root = adheres ? adhesive_radius(c, e.R, e.overlap) : hertz ? std::sqrt(e.R * e.overlap) : 1.0;
  const double stiff = hertz ? 4.0 / 3.0 * c.normal * root : c.normal;
  const double k_t = hertz ? 8.0 * c.tangential * root : c.tangential;
  const double dashpot = c.damping * std::sqrt(e.m * stiff);  // kg/s
  double pulls = 0.0;                                         // N, at most
  if (adheres) {
    const double w = std::numbers::pi * c.adhesion, a2 = root * root, a3 = a2 * root;
    const double stuck = std::sqrt(2.0 * w * c.normal * a3);
    pulls = 1.5 * w * e.R;
    f.normal = std::fmax(-pulls, stiff * a2 / e.R - 2.0 * stuck + dashpot * e.approach);
    f.elastic = a2 * (8.0 / 15.0 * c.normal * a3 / (e.R * e.R) - 4.0 / 3.0 * stuck / e.R + w);
  } else {
    f.normal = std::fmax(0.0, stiff * e.overlap + dashpot * e.approach);
    f.elastic = (hertz ? 0.4 : 0.5) * stiff * e.overlap * e.overlap;
  }

  // The spring's force as the contact now lies, with the size that it had.
  auto Q = memory.Q;
  const double before2 = square<D>(Q);
  Q -= foundation::dot(Q, e.n) * e.n;
  const double now2 = square<D>(Q);
  if (now2 > 0.0) Q = std::sqrt(before2 / now2) * Q;
  if (hertz && root < memory.a) Q = (root / memory.a) * Q;
  Q -= k_t * e.way;
  memory.a = hertz ? root : 1.0;

  // With adhesion by what presses beyond the force that breaks the contact [C. Thornton, J. Phys. D 24, 1942 (1991)].
  const double pressed = f.normal + 2.0 * pulls;
  const double limit = c.friction * pressed, size2 = square<D>(Q);
  if (size2 > limit * limit) {
    Q = (limit / std::sqrt(size2)) * Q;
    f.tangential = Q;
  } else {
    f.tangential = Q - (dashpot * c.tangential_root) * e.slip;
    const double all2 = square<D>(f.tangential);
    if (all2 > limit * limit) f.tangential = (limit / std::sqrt(all2)) * f.tangential;
  }
  memory.Q = Q;
  f.elastic += k_t > 0.0 ? 0.5 * square<D>(Q) / k_t : 0.0;
  f.force = f.normal * e.n + f.tangential;

  f.rolling = foundation::zero<double, turns<D>>();
  if (rules.rolling == rolling_model::none || !(c.rolling > 0.0)) return f;
  const double most = c.rolling * e.R * pressed;  // N m
  if (rules.rolling == rolling_model::constant_torque) {
    const auto roll = without_twist<D>(e.roll, e.n);
    const double speed = std::sqrt(foundation::dot(roll, roll));
    if (speed > 0.0) f.rolling = (-most / speed) * roll;
    return f;
  }
  // k_r = 3 k_n (μ_r R*)² in two dimensions, 2.25 k_n (μ_r R*)² in three.
  const double k_r = (D == 2 ? 3.0 : 2.25) * stiff * (c.rolling * e.R) * (c.rolling * e.R);
  auto M = without_twist<D>(memory.M, e.n) - k_r * without_twist<D>(e.rolling, e.n);
  const double size = std::sqrt(foundation::dot(M, M));
  if (size > most) {
    M = (most / size) * M;
    f.rolling = M;
  } else {
    f.rolling = M - (2.0 * rules.rolling_damping * std::sqrt(e.inertia * k_r)) * without_twist<D>(e.roll, e.n);
  }
  memory.M = M;
  f.elastic += 0.5 * foundation::dot(M, M) / k_r;
  return f;
}

}  // namespace tetsuame::dem
