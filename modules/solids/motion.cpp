#include <fmt/format.h>
#include <fmt/ranges.h>
#include <math.h>  // isnan, which Boost 1.74 takes from there

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/interpolators/pchip.hpp>
#include <cmath>
#include <foundation/error.hpp>
#include <numbers>
#include <solids/motion.hpp>

namespace tetsuame::solids {

namespace {

using foundation::fail_input;

template <std::size_t N>
using matrix = Eigen::Matrix<double, static_cast<int>(N), static_cast<int>(N)>;

template <int D>
matrix<D> matrix_of(const std::array<foundation::vec<double, D>, D>& rows) {
  matrix<D> m;
  for (int a = 0; a < D; ++a)
    for (int b = 0; b < D; ++b) m(a, b) = rows[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
  return m;
}

template <int D>
std::array<foundation::vec<double, D>, D> rows_of(const matrix<D>& m) {
  std::array<foundation::vec<double, D>, D> rows;
  for (int a = 0; a < D; ++a)
    for (int b = 0; b < D; ++b) rows[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)] = m(a, b);
  return rows;
}

}  // namespace

template <int D>
rotation<D> rotation_by(const about<D>& a) {
  if constexpr (D == 2) {
    return {point<2>{{std::cos(a[0]), -std::sin(a[0])}}, point<2>{{std::sin(a[0]), std::cos(a[0])}}};
  } else {
    const Eigen::Vector3d v(a[0], a[1], a[2]);
    const double angle = v.norm();
    if (angle == 0.0) return no_rotation<3>();
    return rows_of<3>(Eigen::AngleAxisd(angle, v / angle).toRotationMatrix());
  }
}

template <int D>
about<D> rotation_vector(const rotation<D>& R) {
  if constexpr (D == 2) {
    return {{std::atan2(R[1][0], R[0][0])}};
  } else {
    const Eigen::AngleAxisd a(Eigen::Matrix3d(matrix_of<3>(R)));
    const Eigen::Vector3d v = a.angle() * a.axis();
    return {{v[0], v[1], v[2]}};
  }
}

rotation<3> rotation_of(const std::array<double, 4>& q) {
  return rows_of<3>(Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix());
}

template <int D>
body<D> placed(const body<D>& of, const pose<D>& now) {
  const auto shift = now.pivot + now.shift - turn<D>(now.turned, now.pivot);
  auto pieces = of.pieces();
  for (auto& p : pieces) p.bounds = placed<D>(std::move(p.bounds), now.turned, shift);
  return {of.name(), std::move(pieces)};
}

namespace {

// Of t, x, y, z, angle; none of z in two dimensions.
std::array<std::optional<std::size_t>, 5> columns_of_motion(const tables::table& of, int dimension) {
  std::array named{of.column_of({"t", "time"}), of.column_of({"x"}), of.column_of({"y"}), of.column_of({"z"}),
                   of.column_of({"angle"})};
  if (dimension == 2) named[3].reset();
  const auto has = [](const auto& column) { return column.has_value(); };
  const auto found = std::ranges::count_if(named, has);
  if (found == (dimension == 2 ? 4 : 5)) return named;
  if (found > 0 || of.columns() != 5)
    of.fail(
        fmt::format("expected the columns t, x, y, z, angle (s, m, m, m, degrees), in this order or with these names; "
                    "there are {}{}",
                    of.columns(), of.headings().empty() ? "" : fmt::format(": {}", fmt::join(of.headings(), ", "))));
  for (std::size_t k = 0; k < named.size(); ++k) named[k] = k;
  if (dimension == 2) named[3].reset();
  return named;
}

}  // namespace

motion_table read_motion(const tables::table& of, int dimension) {
  constexpr std::array<const char*, 5> units{"s", "m", "m", "m", "degrees"};
  const auto columns = columns_of_motion(of, dimension);
  for (std::size_t k = 0; k < columns.size(); ++k)
    if (columns[k]) of.expect_unit(*columns[k], units[k], 1.0);
  if (of.rows() < 4) of.fail(fmt::format("holds {} rows; a motion takes at least four", of.rows()));
  motion_table table;
  table.time = of.ascending(*columns[0], "time");
  for (std::size_t k = 0; k < 3; ++k)
    table.shift[k] = columns[1 + k] ? of.numbers(*columns[1 + k]) : std::vector<double>(of.rows(), 0.0);
  table.angle = of.numbers(*columns[4]);
  return table;
}

// Displacement and angle as functions of time, with their derivatives.
template <int D>
struct prescribed<D>::course {
  using cubic = boost::math::interpolators::pchip<std::vector<double>>;
  harmonic swing;
  double begin = 0.0, end = 0.0;  // s, of the table
  std::vector<double> times;      // s, of the table
  std::vector<cubic> shift;       // of the table: along each axis
  std::vector<cubic> angle;       // radians

  explicit course(const harmonic& how) : swing(how) {}
  explicit course(const motion_table& table) : begin(table.time.front()), end(table.time.back()), times(table.time) {
    for (std::size_t k = 0; k < D; ++k) shift.emplace_back(std::vector(table.time), std::vector(table.shift[k]));
    auto radians = table.angle;
    for (double& a : radians) a *= std::numbers::pi / 180.0;
    angle.emplace_back(std::vector(table.time), std::move(radians));
  }

  // Value and the first two derivatives of the amplitudes' common course.
  std::array<double, 3> wave(double t) const {
    const double w = 2.0 * std::numbers::pi / swing.period, s = std::sin(w * t + swing.phase);
    return {s, w * std::cos(w * t + swing.phase), -w * w * s};
  }
  // At its first time it has the velocity with which it goes on: a step is chosen by that.
  bool outside(double t) const { return t < begin || t >= end; }
  double value(const cubic& of, double t) const { return of(std::clamp(t, begin, end)); }
  double derivative(const cubic& of, double t) const { return outside(t) ? 0.0 : of.prime(t); }
  // Of the cubic between two rows, from values and slopes there.
  double second_derivative(const cubic& of, double t) const {
    if (outside(t)) return 0.0;
    const auto after = std::upper_bound(times.begin(), times.end(), t);
    const double t0 = *(after - 1), t1 = *after, h = t1 - t0, s = (t - t0) / h;
    return ((12.0 * s - 6.0) * (of(t0) - of(t1)) / h + (6.0 * s - 4.0) * of.prime(t0) +
            (6.0 * s - 2.0) * of.prime(t1)) /
           h;
  }
};

template <int D>
prescribed<D>::prescribed(const point<D>& pivot, const about<D>& axis, const harmonic& how)
    : pivot_(pivot), axis_(axis), move_(std::make_shared<const course>(how)) {}

template <int D>
prescribed<D>::prescribed(const point<D>& pivot, const about<D>& axis, const motion_table& table)
    : pivot_(pivot), axis_(axis), move_(std::make_shared<const course>(table)) {}

template <int D>
pose<D> prescribed<D>::posed(const point<D>& shift, double angle) const {
  pose<D> p;
  p.pivot = pivot_;
  p.shift = shift;
  p.turned = rotation_by<D>(angle * axis_);
  return p;
}

template <int D>
pose<D> prescribed<D>::at(double t) const {
  if (!move_) return posed(foundation::zero<double, D>(), 0.0);
  if (move_->shift.empty()) {
    const double s = move_->wave(t)[0];
    return posed(s * move_->swing.shift, s * move_->swing.angle);
  }
  return posed(point<D>::of([&](std::size_t k) { return move_->value(move_->shift[k], t); }),
               move_->value(move_->angle.front(), t));
}

template <int D>
std::vector<pose<D>> prescribed<D>::poses() const {
  constexpr double widest = std::numbers::pi / 60.0;  // of a turn between two of them
  if (!move_) return {at(0.0)};
  std::vector<pose<D>> all;
  if (move_->shift.empty()) {
    const double n = 2.0 + std::ceil(2.0 * std::abs(move_->swing.angle) / widest);
    for (double k = 0.0; k <= n; k += 1.0) {
      const double s = 2.0 * k / n - 1.0;
      all.push_back(posed(s * move_->swing.shift, s * move_->swing.angle));
    }
    return all;
  }
  const auto& times = move_->times;
  for (std::size_t row = 0; row + 1 < times.size(); ++row) {
    const auto angle = [&](std::size_t k) { return move_->value(move_->angle.front(), times[k]); };
    const double n = 4.0 + std::ceil(2.0 * std::abs(angle(row + 1) - angle(row)) / widest);
    for (double k = 0.0; k <= n; k += 1.0) all.push_back(at(times[row] + k / n * (times[row + 1] - times[row])));
  }
  return all;
}

template <int D>
rate<D> prescribed<D>::rate_at(double t) const {
  rate<D> r{pivot_ + at(t).shift};
  if (!move_) return r;
  if (move_->shift.empty()) {
    const auto [s, ds, dds] = move_->wave(t);
    r.velocity = ds * move_->swing.shift;
    r.angular = (ds * move_->swing.angle) * axis_;
    r.acceleration = dds * move_->swing.shift;
    r.angular_acceleration = (dds * move_->swing.angle) * axis_;
  } else {
    r.velocity = point<D>::of([&](std::size_t k) { return move_->derivative(move_->shift[k], t); });
    r.angular = move_->derivative(move_->angle.front(), t) * axis_;
    r.acceleration = point<D>::of([&](std::size_t k) { return move_->second_derivative(move_->shift[k], t); });
    r.angular_acceleration = move_->second_derivative(move_->angle.front(), t) * axis_;
  }
  return r;
}

// R I⁻¹ Rᵀ a
template <int D>
about<D> over_inertia(const free_body<D>& b, const rotation<D>& turned, const about<D>& a) {
  if constexpr (D == 2) {
    return {{a[0] / b.inertia[0][0]}};
  } else {
    const auto R = matrix_of<3>(turned);
    const Eigen::Vector3d w =
        R * matrix_of<3>(b.inertia).ldlt().solve(R.transpose() * Eigen::Vector3d(a[0], a[1], a[2]));
    return {{w[0], w[1], w[2]}};
  }
}

template <int D>
about<D> free_body<D>::angular_velocity(const rotation<D>& turned) const {
  return over_inertia<D>(*this, turned, angular_momentum);
}

template <int D>
rigid<D> free_body<D>::acceleration(const rotation<D>& turned, const point<D>& gravity, const rigid<D>& at_none,
                                    const rigid_matrix<D>& added,
                                    const std::array<bool, rigid<D>::components>& held) const {
  constexpr int N = rigid<D>::components;
  Eigen::Matrix<double, N, N> of_both;
  Eigen::Matrix<double, N, 1> force;
  for (std::size_t k = 0; k < N; ++k) {
    force[static_cast<int>(k)] = at_none[k] + (k < D ? mass * gravity[k] : 0.0);
    for (std::size_t c = 0; c < N; ++c) of_both(static_cast<int>(k), static_cast<int>(c)) = added[k][c];
  }
  for (int a = 0; a < D; ++a) of_both(a, a) += mass;
  if constexpr (D == 2) {
    of_both(2, 2) += inertia[0][0];
  } else {
    const auto R = matrix_of<3>(turned);
    of_both.template bottomRightCorner<3, 3>() += R * matrix_of<3>(inertia) * R.transpose();
    const auto spin = cross<3>(angular_velocity(turned), angular_momentum);
    for (std::size_t k = 0; k < 3; ++k) force[static_cast<int>(D + k)] -= spin[k];
  }
  for (std::size_t k = 0; k < held.size(); ++k) {
    if (!held[k]) continue;
    const auto row = static_cast<int>(k);
    of_both.row(row).setZero();
    of_both.col(row).setZero();
    of_both(row, row) = 1.0;
    force[row] = 0.0;
  }
  const Eigen::Matrix<double, N, 1> solved = of_both.partialPivLu().solve(force);
  rigid<D> a;
  for (std::size_t k = 0; k < N; ++k) a[k] = solved[static_cast<int>(k)];
  return a;
}

// Huygens and Steiner
template <int D>
void free_body<D>::hinge(const point<D>& at) {
  lever = now.pivot - at;
  now.pivot = at;
  const double l2 = foundation::dot(lever, lever);
  for (std::size_t k = 0; k < turns; ++k)
    for (std::size_t c = 0; c < turns; ++c)
      inertia[k][c] += mass * ((k == c ? l2 : 0.0) - (D == 3 ? lever[k] * lever[c] : 0.0));
}

template <int D>
rate<D> free_body<D>::rate_now() const {
  return {now.pivot + now.shift, (1.0 / mass) * momentum, angular_velocity(now.turned)};
}

template <int D>
double free_body<D>::kinetic_energy() const {
  return 0.5 * (foundation::dot(momentum, momentum) / mass) +
         0.5 * foundation::dot(angular_momentum, angular_velocity(now.turned));
}

template <int D>
void advance(free_body<D>& b, const point<D>& force, const about<D>& torque, double dt) {
  const auto half_force = (0.5 * dt) * force;
  const auto half_torque = (0.5 * dt) * torque;
  b.momentum += half_force;
  b.angular_momentum += half_torque;
  b.now.shift += (dt / b.mass) * b.momentum;
  // R' = exp(ω dt) R with ω of the orientation half way, exp(ω dt/2) R.
  auto w = b.angular_velocity(b.now.turned);
  const auto turned = [&](double step) {
    const auto by = rotation_by<D>(step * w);
    rotation<D> result;
    for (std::size_t k = 0; k < D; ++k) result[k] = turn_back<D>(b.now.turned, by[k]);
    return result;
  };
  for (int iteration = 0; iteration < 8; ++iteration) w = b.angular_velocity(turned(0.5 * dt));
  b.now.turned = turned(dt);
  b.momentum += half_force;
  b.angular_momentum += half_torque;
}

template rotation<2> rotation_by<2>(const about<2>&);
template about<2> rotation_vector<2>(const rotation<2>&);
template body<2> placed<2>(const body<2>&, const pose<2>&);
template class prescribed<2>;
template struct free_body<2>;
template void advance<2>(free_body<2>&, const point<2>&, const about<2>&, double);
template rotation<3> rotation_by<3>(const about<3>&);
template about<3> rotation_vector<3>(const rotation<3>&);
template body<3> placed<3>(const body<3>&, const pose<3>&);
template class prescribed<3>;
template struct free_body<3>;
template void advance<3>(free_body<3>&, const point<3>&, const about<3>&, double);

}  // namespace tetsuame::solids
