// How bodies move: rigidly, as prescribed, or freely under forces.
//
//   x(t) = c + s(t) + R(t) (X − c),   v = ds/dt + ω × (x − c − s)
//
// with X where the point is in the body at rest, c the pivot, s its displacement, R a rotation about a fixed axis
// through it. In two dimensions the axis stands on the plane.
#pragma once

#include <memory>
#include <solids/bounds.hpp>
#include <tables/table.hpp>

namespace tetsuame::solids {

// Angular velocity, torque, …: one number in two dimensions.
template <int D>
using about = point<D == 2 ? 1 : 3>;

template <int D>
point<D> cross(const about<D>& w, const point<D>& r) {
  if constexpr (D == 2)
    return {{-w[0] * r[1], w[0] * r[0]}};
  else
    return {{w[1] * r[2] - w[2] * r[1], w[2] * r[0] - w[0] * r[2], w[0] * r[1] - w[1] * r[0]}};
}

// r × F
template <int D>
about<D> moment(const point<D>& r, const point<D>& F) {
  if constexpr (D == 2)
    return {{r[0] * F[1] - r[1] * F[0]}};
  else
    return cross<3>(r, F);
}

// exp of the rotation vector a: |a| radians about its direction [O. Rodrigues (1840)].
template <int D>
rotation<D> rotation_by(const about<D>& a);
// The reverse, with an angle of at most π.
template <int D>
about<D> rotation_vector(const rotation<D>& R);
// Of a quaternion (w, x, y, z) of any length but zero.
rotation<3> rotation_of(const std::array<double, 4>& q);

template <int D>
struct pose {
  rotation<D> turned = no_rotation<D>();
  point<D> pivot = foundation::zero<double, D>();  // m, of the body at rest
  point<D> shift = foundation::zero<double, D>();  // m

  point<D> to_space(const point<D>& X) const { return pivot + shift + turn<D>(turned, X - pivot); }
  point<D> to_body(const point<D>& x) const { return pivot + turn_back<D>(turned, x - pivot - shift); }
};

template <int D>
struct rate {
  point<D> centre;                                                                 // m, the pivot as it is now
  point<D> velocity = foundation::zero<double, D>();                               // m/s, of it
  about<D> angular = foundation::zero < double, D == 2 ? 1 : 3 > ();               // 1/s
  point<D> acceleration = foundation::zero<double, D>();                           // m/s2, of the pivot
  about<D> angular_acceleration = foundation::zero < double, D == 2 ? 1 : 3 > ();  // 1/s2

  point<D> at(const point<D>& x) const { return velocity + cross<D>(angular, x - centre); }
  // m/s2, of what of the body is at x: a + dω/dt × r + ω × (ω × r).
  point<D> acceleration_at(const point<D>& x) const {
    const auto r = x - centre;
    return acceleration + cross<D>(angular_acceleration, r) + cross<D>(angular, cross<D>(angular, r));
  }
};

// The whole body where it is now, as one that was given there.
template <int D>
body<D> placed(const body<D>& of, const pose<D>& now);

// The body where it is now.
template <int D>
foot<D> at(const body<D>& of, const pose<D>& now, const point<D>& x,
           double reach = std::numeric_limits<double>::infinity()) {
  auto f = of.at(now.to_body(x), reach);
  f.normal = turn<D>(now.turned, f.normal);
  f.nearest = now.to_space(f.nearest);
  return f;
}

// Rows of a table: time (s), displacement (m), angle (degrees).
struct motion_table {
  std::vector<double> time;
  std::array<std::vector<double>, 3> shift;
  std::vector<double> angle;
};
// Of a table with columns t (or time), x, y, z and angle by name, or else of five columns in this order; z is not read
// in two dimensions. Four rows at least, of times that increase.
motion_table read_motion(const tables::table& of, int dimension);

// Prescribed: A sin(2π t/T + β) in displacement and angle, or by a table, between whose rows cubics without overshoot
// run [F. N. Fritsch and J. Butland, SIAM J. Sci. Stat. Comput. 5, 300 (1984), by Boost]; before its first and from its
// last row on the body stands still.
template <int D>
class prescribed {
 public:
  struct harmonic {
    double period = 1.0, phase = 0.0;                // s, radians
    point<D> shift = foundation::zero<double, D>();  // m, amplitude
    double angle = 0.0;                              // radians, amplitude
  };
  prescribed() = default;  // at rest
  prescribed(const point<D>& pivot, const about<D>& axis, const harmonic& how);
  prescribed(const point<D>& pivot, const about<D>& axis, const motion_table& table);

  bool moves() const { return move_ != nullptr; }
  pose<D> at(double t) const;
  rate<D> rate_at(double t) const;
  // Of all that there ever are so many that it turns by a few degrees from one to the next, and those where its ways
  // end.
  std::vector<pose<D>> poses() const;

 private:
  struct course;
  pose<D> posed(const point<D>& shift, double angle) const;
  point<D> pivot_ = foundation::zero<double, D>();
  about<D> axis_ = foundation::zero < double, D == 2 ? 1 : 3 > ();
  std::shared_ptr<const course> move_;
};

// What moves a body as a whole, component by component: of an acceleration, of a force with its moment.
template <int D>
struct rigid {
  static constexpr std::size_t turns = D == 2 ? 1 : 3, components = D + turns;
  point<D> linear = foundation::zero<double, D>();
  about<D> turning = foundation::zero<double, turns>();

  double operator[](std::size_t k) const { return k < D ? linear[k] : turning[k - D]; }
  double& operator[](std::size_t k) { return k < D ? linear[k] : turning[k - D]; }
};
// Row k: what takes part in component k of the force, for each component of an acceleration.
template <int D>
using rigid_matrix = std::array<std::array<double, rigid<D>::components>, rigid<D>::components>;

// What restrains a free body beside the water: components that do not move, and linear springs and dampers.
template <int D>
struct restraint {
  static constexpr std::size_t components = rigid<D>::components;
  std::array<bool, components> held{};
  // N/m and N s/m, N m and N m s (per radian); the displacement, m and radians, at which a spring is relaxed.
  rigid<D> stiffness, damping, rest;

  // N and N m, of a body that has moved by s from where it began and moves with v.
  rigid<D> force(const rigid<D>& s, const rigid<D>& v) const {
    rigid<D> f;
    for (std::size_t k = 0; k < components; ++k) f[k] = -stiffness[k] * (s[k] - rest[k]) - damping[k] * v[k];
    return f;
  }
  double energy(const rigid<D>& s) const {  // J, of the springs
    double all = 0.0;
    for (std::size_t k = 0; k < components; ++k) all += 0.5 * stiffness[k] * (s[k] - rest[k]) * (s[k] - rest[k]);
    return all;
  }
};

// Moves under forces: momentum and angular momentum are what it holds, so that both change by exactly what acts.
template <int D>
struct free_body {
  static constexpr std::size_t turns = D == 2 ? 1 : 3;
  double mass = 1.0;                               // kg (kg/m in two dimensions)
  std::array<about<D>, turns> inertia;             // kg m2, about the pivot, of the body at rest
  pose<D> now;                                     // its pivot is the centre of mass, or the hinge that it turns about
  point<D> lever = foundation::zero<double, D>();  // m, of the centre of mass from the pivot, of the body at rest
  point<D> momentum = foundation::zero<double, D>();              // kg m/s
  about<D> angular_momentum = foundation::zero<double, turns>();  // kg m2/s, about the pivot
  restraint<D> restrained;

  // Turns about this point (m) from now on, whose linear components are held.
  void hinge(const point<D>& at);
  bool hinged() const { return foundation::dot(lever, lever) > 0.0; }

  about<D> angular_velocity(const rotation<D>& turned) const;
  // m/s2 and 1/s2, where the force (N) and the moment (N m, about the centre of mass) are `at_none`, less `added` times
  // the acceleration: m a = F - m_aa a - m_aω ω' + m g, I ω' = T - m_ωa a - m_ωω ω' - ω × L; zero of what is held.
  rigid<D> acceleration(const rotation<D>& turned, const point<D>& gravity, const rigid<D>& at_none,
                        const rigid_matrix<D>& added, const std::array<bool, rigid<D>::components>& held = {}) const;
  rate<D> rate_now() const;
  double kinetic_energy() const;  // J
};

// Force (N) and torque (N m) about the centre of mass, over a time step: these first, then half way through the step
// the angular velocity that turns it (implicit midpoint rule). Second order with forces of the step's middle.
template <int D>
void advance(free_body<D>& b, const point<D>& force, const about<D>& torque, double dt);

// Mass and inertia of a body of one density (kg/m3), of what of it lies within these bounds, which have ends: over
// cells that are halved until they lie on one side of its surface, or are as small as that (m), but no fewer than some
// hundred along the body.
template <int D>
free_body<D> filled(const body<D>& of, double density, const bounds<D>& where, double spacing);

}  // namespace tetsuame::solids
