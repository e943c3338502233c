#include <fmt/format.h>
#include <math.h>  // isnan, which Boost 1.74 takes from there

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/interpolators/pchip.hpp>
#include <cmath>
#include <foundation/error.hpp>
#include <namelist/text.hpp>
#include <numbers>
#include <solids/motion.hpp>
#include <sstream>

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

motion_table read_motion(const std::string& text, const std::string& name) {
  motion_table table;
  std::istringstream in(text);
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    const auto first = line.find_first_not_of(" \t");
    if (first == std::string::npos || line[first] == '#') continue;
    if (table.time.empty() && namelist::is_letter(line[first])) continue;  // names of the columns
    std::array<double, 5> row{};
    std::istringstream words(line);
    std::string word;
    std::size_t count = 0;
    while (std::getline(words, word, ',')) {
      const auto begin = word.find_first_not_of(" \t"), end = word.find_last_not_of(" \t");
      const auto value =
          begin == std::string::npos ? std::nullopt : namelist::to_real(word.substr(begin, end - begin + 1));
      if (count == row.size() || !value || !std::isfinite(*value))
        fail_input(fmt::format("{}:{}: expected five numbers (s, m, m, m, degrees) with commas between, found {}", name,
                               number, namelist::quote(namelist::excerpt(line))));
      row[count++] = *value;
    }
    if (count != row.size())
      fail_input(fmt::format("{}:{}: expected five numbers (s, m, m, m, degrees), found {}", name, number, count));
    if (!table.time.empty() && row[0] <= table.time.back())
      fail_input(fmt::format("{}:{}: time {} s does not lie behind that of the row before", name, number, row[0]));
    table.time.push_back(row[0]);
    for (std::size_t k = 0; k < 3; ++k) table.shift[k].push_back(row[1 + k]);
    table.angle.push_back(row[4]);
  }
  if (table.time.size() < 4)
    fail_input(fmt::format("{}: holds {} rows; a motion takes at least four", name, table.time.size()));
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
  bool outside(double t) const { return t <= begin || t >= end; }
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
pose<D> prescribed<D>::at(double t) const {
  pose<D> p;
  p.pivot = pivot_;
  if (!move_) return p;
  double angle = 0.0;
  if (move_->shift.empty()) {
    const double s = move_->wave(t)[0];
    p.shift = s * move_->swing.shift;
    angle = s * move_->swing.angle;
  } else {
    p.shift = point<D>::of([&](std::size_t k) { return move_->value(move_->shift[k], t); });
    angle = move_->value(move_->angle.front(), t);
  }
  p.turned = rotation_by<D>(angle * axis_);
  return p;
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
                                    const rigid_matrix<D>& added) const {
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
  const Eigen::Matrix<double, N, 1> solved = of_both.partialPivLu().solve(force);
  rigid<D> a;
  for (std::size_t k = 0; k < N; ++k) a[k] = solved[static_cast<int>(k)];
  return a;
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

template <int D>
free_body<D> filled(const body<D>& of, double density, const point<D>& lower, const point<D>& upper, double spacing) {
  std::array<std::int64_t, D> cells;
  std::int64_t places = 1;
  double volume = 1.0;  // of a cell
  for (std::size_t k = 0; k < D; ++k) {
    cells[k] = std::max<std::int64_t>(1, std::llround((upper[k] - lower[k]) / spacing));
    places *= cells[k];
    volume *= (upper[k] - lower[k]) / static_cast<double>(cells[k]);
  }
  const auto place = [&](std::int64_t n) {
    return point<D>::of([&](std::size_t k) {
      const auto along = n % cells[k];
      n /= cells[k];
      return lower[k] + (upper[k] - lower[k]) * (static_cast<double>(along) + 0.5) / static_cast<double>(cells[k]);
    });
  };
  std::vector<point<D>> inside;
  auto centre = foundation::zero<double, D>();
  for (std::int64_t n = 0; n < places; ++n)
    if (const auto x = place(n); of.solid(x)) {
      inside.push_back(x);
      centre += x;
    }
  if (inside.empty())
    fail_input("body '" + of.name() + "' lies outside the box, or is smaller than the spacing of the particles");
  centre = (1.0 / static_cast<double>(inside.size())) * centre;
  free_body<D> b;
  const double mass = density * volume;
  b.mass = mass * static_cast<double>(inside.size());
  b.now.pivot = centre;
  b.inertia = {};
  for (const auto& x : inside) {
    const auto r = x - centre;
    if constexpr (D == 2) {
      b.inertia[0][0] += mass * foundation::dot(r, r);
    } else {
      for (std::size_t a = 0; a < D; ++a)
        for (std::size_t c = 0; c < D; ++c)
          b.inertia[a][c] += mass * ((a == c ? foundation::dot(r, r) : 0.0) - r[a] * r[c]);
    }
  }
  return b;
}

template rotation<2> rotation_by<2>(const about<2>&);
template about<2> rotation_vector<2>(const rotation<2>&);
template body<2> placed<2>(const body<2>&, const pose<2>&);
template class prescribed<2>;
template struct free_body<2>;
template void advance<2>(free_body<2>&, const point<2>&, const about<2>&, double);
template free_body<2> filled<2>(const body<2>&, double, const point<2>&, const point<2>&, double);
template rotation<3> rotation_by<3>(const about<3>&);
template about<3> rotation_vector<3>(const rotation<3>&);
template body<3> placed<3>(const body<3>&, const pose<3>&);
template class prescribed<3>;
template struct free_body<3>;
template void advance<3>(free_body<3>&, const point<3>&, const about<3>&, double);
template free_body<3> filled<3>(const body<3>&, double, const point<3>&, const point<3>&, double);

}  // namespace tetsuame::solids
