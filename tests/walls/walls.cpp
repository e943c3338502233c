// Wall particles and their markers, and what each treatment gives them.
#include <hydrostatic/measures.hpp>
#include <set>

#include "../support/scene.hpp"

using namespace tetsuame;
using namespace tetsuame::test;

namespace {

// Disordered fluid in a box with walls on all sides; in space with the short kernel C2, which keeps it small.
template <int D>
hydrostatic::options closed_box(const std::string& treatment, const std::string& interpolation = "mls") {
  hydrostatic::options o;
  if constexpr (D == 2)
    o = box<2>({24, 9}, false, treatment);
  else
    o = box<3>({16, 6, 7}, false, treatment, "wendland_c2");
  o.walls.interpolation = interpolation;
  return o;
}

template <int D>
hydrostatic::scene<D> disorder(const hydrostatic::options& o,
                               const domain::communicator& ranks = domain::communicator::world()) {
  auto scene = make_scene<D>(o, ranks, 0.25);
  auto& w = scene.w;
  auto& s = w.s;
  for (std::size_t a = 0; a < D; ++a) fill<D>(w, s.v[a], [](std::size_t) { return 0.0; });
  fill<D>(w, s.rho, [](std::size_t) { return 7000.0; });
  fill<D>(w, s.T, [](std::size_t) { return 2500.0; });
  fill<D>(w, s.dV, [&](std::size_t i) { return s.m[i] / 7000.0; });
  fill<D>(w, s.p, [](std::size_t) { return 1e10; });
  fill<D>(w, s.Y, [&](std::size_t i) { return s.p[i] * s.dV[i]; });
  return scene;
}

// f(i, x, marker) for every owned wall particle, with the marker found from its position alone.
template <int D, class F>
void for_each_wall(const hydrostatic::scene<D>& scene, F&& f) {
  const auto& s = scene.w.s;
  for (std::size_t i = s.first_wall(); i < s.first_wall() + s.walls; ++i) {
    const auto x = cells::position<D>(s.x, i);
    auto marker = x;
    for (std::size_t a = 0; a < D; ++a) {
      const double length = scene.w.d.region.length[a];
      if (x[a] < 0.0) marker[a] = -x[a];
      if (x[a] > length) marker[a] = 2.0 * length - x[a];
    }
    f(i, x, marker);
  }
}

// Which side a coordinate is beyond: 0 the low, 1 the high end, -1 none.
int beyond(double x, double length) { return x < 0.0 ? 0 : x > length ? 1 : -1; }

template <int D>
double linear(const std::array<double, D>& x) {
  double value = 5.0;
  for (std::size_t a = 0; a < D; ++a) value += (0.3 - 0.7 * static_cast<double>(a)) * x[a];
  return value;
}
template <int D>
double quadratic(const std::array<double, D>& x) {
  return linear<D>(x) + 0.2 * x[0] * x[0] - 0.3 * x[0] * x[1] + 0.1 * x[D - 1] * x[D - 1];
}

// Values of up to 100 at the particles, moments of a condition up to 1e5 (see interpolation.cpp): 1e-8.
constexpr double exact = 1e-8;

}  // namespace

BOOST_AUTO_TEST_CASE(places_and_markers) {
  const auto check = []<int D>(const hydrostatic::scene<D>& scene, std::int64_t expected) {
    const auto& w = scene.w;
    std::set<std::int64_t> ids;
    for_each_wall<D>(scene, [&](std::size_t i, const auto& x, const auto& marker) {
      bool outside = false;
      for (std::size_t a = 0; a < D; ++a) {
        // On the lattice, as deep as the kernel reaches, not beyond a periodic border.
        const double length = w.d.region.length[a];
        BOOST_TEST(x[a] - std::floor(x[a]) == 0.5);
        BOOST_TEST((beyond(x[a], length) < 0 || !w.d.region.periodic[a]));
        BOOST_TEST(std::max(-x[a], x[a] - length) < std::ceil(w.support()));
        outside = outside || beyond(x[a], length) >= 0;
        BOOST_TEST(scene.walls.marker[a][i - w.s.first_wall()] == marker[a]);
        BOOST_TEST((marker[a] > 0.0 && marker[a] < length));
      }
      BOOST_TEST(outside);
      BOOST_TEST(w.s.id[i] >= scene.fluid_total);
      ids.insert(w.s.id[i]);
    });
    BOOST_TEST(ids.size() == w.s.walls);
    BOOST_TEST(w.d.ranks.sum(static_cast<std::int64_t>(w.s.walls)) == expected);
  };
  const auto world = domain::communicator::world();
  // Layers: 4 of the quintic's 3.6 spacings, 3 of C2's 2.6.
  check(make_scene<2>(closed_box<2>("virtual_marker"), world), 32 * 17 - 24 * 9);
  check(make_scene<3>(closed_box<3>("virtual_marker"), world), 22 * 12 * 13 - 16 * 6 * 7);
  auto o = closed_box<2>("virtual_marker");
  o.domain.periodic[0] = true;
  check(make_scene<2>(o, world), 24 * 8);
  o = closed_box<2>("virtual_marker");
  o.domain.periodic[1] = true;
  check(make_scene<2>(o, world), 8 * 9);
}

BOOST_AUTO_TEST_CASE(walls_deeper_than_the_box_are_bad_input) {
  auto o = box<2>({16, 3}, false, "virtual_marker");
  o.domain.periodic[0] = true;
  BOOST_CHECK_EXCEPTION(make_scene<2>(o, domain::communicator::world()), foundation::error,
                        [](const foundation::error& e) {
                          return e.status() == foundation::exit_status::bad_input &&
                                 std::string(e.what()).find("axis 2") != std::string::npos;
                        });
}

BOOST_AUTO_TEST_CASE(interpolation_at_every_marker_corners_too) {
  const auto check = []<int D>(const std::string& interpolation, double (*field)(const std::array<double, D>&),
                               const std::string& precision = "double") {
    auto o = closed_box<D>("virtual_marker", interpolation);
    o.kernel.precision = precision;
    auto scene = disorder<D>(o);
    auto& s = scene.w.s;
    fill<D>(scene.w, s.T, [&](std::size_t i) { return field(cells::position<D>(s.x, i)); });
    walls::virtual_marker::kinematics(scene.w, scene.walls);
    double worst = 0.0;
    for_each_wall<D>(scene, [&](std::size_t i, const auto&, const auto& marker) {
      worst = std::max(worst, std::abs(s.T[i] - field(marker)));
    });
    return scene.w.d.ranks.maximum(worst);
  };
  BOOST_TEST(check.operator()<2>("mls", linear<2>) < exact);
  BOOST_TEST(check.operator()<3>("mls", linear<3>) < exact);
  // Of single numbers a ten-millionth, times the share of large shape functions that cancel.
  BOOST_TEST(check.operator()<2>("mls", linear<2>, "single") < 1e-3);
  BOOST_TEST(check.operator()<3>("mls", linear<3>, "single") < 1e-3);
  BOOST_TEST(check.operator()<2>("mls2", quadratic<2>) < exact);
  BOOST_TEST(check.operator()<3>("mls2", quadratic<3>) < exact);
  BOOST_TEST(check.operator()<2>(
                 "shepard", +[](const std::array<double, 2>&) { return 42.0; }) < exact);
  // Orders below what the field needs are seen to miss it.
  BOOST_TEST(check.operator()<2>("shepard", linear<2>) > 1e-2);
  BOOST_TEST(check.operator()<2>("mls", quadratic<2>) > 1e-2);
}

// Shepard's mean is over volumes, [S2]'s Y/p: by sums of its own over all fluid. What a particle holds has the share of
// its volume, so that one of four times the volume stands for four in its place; the mean of ΔV itself is Σ ΔV² W/Σ ΔV
// W.
BOOST_AUTO_TEST_CASE(shepard_over_unequal_volumes) {
  const auto world = domain::communicator::world();
  if (world.size > 1) return;  // loops over what one rank has
  for (const std::string precision : {"double", "single"}) {
    auto o = closed_box<2>("virtual_marker", "shepard");
    o.kernel.precision = precision;
    auto scene = disorder<2>(o);
    auto& w = scene.w;
    auto& s = w.s;
    randomise<2>(w, s.dV, 3, 0.5, 4.0);
    fill<2>(w, s.T, [&](std::size_t i) { return s.dV[i]; });
    fill<2>(w, s.rho, [&](std::size_t) { return 7.0; });
    walls::virtual_marker::kinematics(w, scene.walls);
    const auto& kernel = std::get<kernels::quintic_spline<2>>(w.kernel);
    double worst = 0.0, counted = 0.0, constant = 0.0;
    for_each_wall<2>(scene, [&](std::size_t i, const auto&, const auto& marker) {
      double volumes = 0.0, squares = 0.0, number = 0.0, sum = 0.0;
      for (std::size_t j = 0; j < s.fluid; ++j) {
        const double W = kernel.value(std::hypot(s.x[0][j] - marker[0], s.x[1][j] - marker[1]));
        volumes += s.dV[j] * W;
        squares += s.dV[j] * s.dV[j] * W;
        number += W;
        sum += s.dV[j] * W;
      }
      worst = std::max(worst, std::abs(s.T[i] / (squares / volumes) - 1.0));
      counted = std::max(counted, std::abs(s.T[i] / (sum / number) - 1.0));
      constant = std::max(constant, std::abs(s.rho[i] / 7.0 - 1.0));
    });
    // Sums of some forty positive terms; single numbers round each by 6e-8, and kernels by 90 of these (tests/schemes).
    const double rounding = precision == "double" ? 1e-13 : 6e-6;
    BOOST_TEST(worst <= rounding);
    BOOST_TEST(constant <= rounding);
    BOOST_TEST(counted > 0.05);  // the mean over numbers is another one
  }
}

// Every side with its own slip, heat, temperature and velocity; where two or three meet, all their mirrors act.
BOOST_AUTO_TEST_CASE(slip_and_heat_of_every_side) {
  const auto check = []<int D>(unsigned pattern) {
    auto o = closed_box<D>("virtual_marker");
    o.walls.slip = "free_slip";
    o.walls.thermal = "fixed";
    for (std::size_t n = 0; n < 2 * D; ++n) {
      auto& side = o.walls.sides[n];
      side.slip = (pattern >> n & 1U) != 0 ? "no_slip" : "inherit";
      side.thermal = (pattern >> (n + 1) & 1U) != 0 ? "inherit" : "adiabatic";
      side.temperature = 300.0 + 10.0 * static_cast<double>(n);
      side.velocity = 1.0 + static_cast<double>(n);
    }
    auto scene = disorder<D>(o);
    auto& s = scene.w.s;
    for (std::size_t a = 0; a < D; ++a)
      fill<D>(scene.w, s.v[a],
              [&](std::size_t i) { return (1.0 + static_cast<double>(a)) * linear<D>(cells::position<D>(s.x, i)); });
    fill<D>(scene.w, s.T, [&](std::size_t i) { return 400.0 + linear<D>(cells::position<D>(s.x, i)); });
    walls::virtual_marker::kinematics(scene.w, scene.walls);
    double worst = 0.0;
    for_each_wall<D>(scene, [&](std::size_t i, const auto& x, const auto& marker) {
      std::array<double, D> v;
      for (std::size_t a = 0; a < D; ++a) v[a] = (1.0 + static_cast<double>(a)) * linear<D>(marker);
      double T = 400.0 + linear<D>(marker);
      for (std::size_t axis = 0; axis < D; ++axis) {
        const int end = beyond(x[axis], scene.w.d.region.length[axis]);
        if (end < 0) continue;
        const std::size_t n = 2 * axis + static_cast<std::size_t>(end);
        std::array<double, D> wall_v{};
        wall_v[axis == 0 ? 1 : 0] = 1.0 + static_cast<double>(n);
        if ((pattern >> n & 1U) != 0)
          for (std::size_t a = 0; a < D; ++a) v[a] = 2.0 * wall_v[a] - v[a];
        else
          v[axis] = -v[axis];
        if ((pattern >> (n + 1) & 1U) != 0) T = 2.0 * (300.0 + 10.0 * static_cast<double>(n)) - T;
      }
      for (std::size_t a = 0; a < D; ++a) worst = std::max(worst, std::abs(s.v[a][i] - v[a]));
      worst = std::max(worst, std::abs(s.T[i] - T));
    });
    BOOST_TEST(scene.w.d.ranks.maximum(worst) < 10.0 * exact);  // values up to 500
  };
  for (const unsigned pattern : {0b00000U, 0b11111U, 0b00110U, 0b01001U}) check.operator()<2>(pattern);
  for (const unsigned pattern : {0b0000000U, 0b1111111U, 0b0101101U}) check.operator()<3>(pattern);
}

// p = p0 - ρ g·(…) linear, ρ uniform: the step from marker to wall particle continues both p and Y = p ΔV as they are.
BOOST_AUTO_TEST_CASE(hydrostatic_pressure_goes_on_beyond_the_walls) {
  const auto check = []<int D>() {
    auto o = closed_box<D>("virtual_marker");
    auto scene = disorder<D>(o);
    auto& w = scene.w;
    auto& s = w.s;
    for (std::size_t a = 0; a < D; ++a) w.g[a] = 3.0 - 5.0 * static_cast<double>(a);  // aslant: every wall takes part
    const auto p = [&](const std::array<double, D>& x) {
      double value = 1e6;
      for (std::size_t a = 0; a < D; ++a) value += 7000.0 * w.g[a] * x[a];
      return value;
    };
    fill<D>(w, s.p, [&](std::size_t i) { return p(cells::position<D>(s.x, i)); });
    fill<D>(w, s.Y, [&](std::size_t i) { return s.p[i] * s.dV[i]; });
    walls::virtual_marker::kinematics(w, scene.walls);
    walls::virtual_marker::weights(w, scene.walls);
    walls::virtual_marker::pressures(w, scene.walls);
    double worst = 0.0;
    for_each_wall<D>(scene, [&](std::size_t i, const auto& x, const auto&) {
      worst = std::max({worst, std::abs(s.p[i] - p(x)), std::abs(s.Y[i] - p(x) * 1.0), std::abs(s.dV[i] - 1.0) * 1e6});
    });
    BOOST_TEST(w.d.ranks.maximum(worst) < 1e6 * exact);
  };
  check.operator()<2>();
  check.operator()<3>();
}

// f = ν∇²v + g on all fluid that a marker sees, along axes that have walls: the sum over all fluid, owned or ghost.
void check_acceleration(bool along_one_axis) {
  auto o = closed_box<2>("virtual_marker");
  o.domain.periodic[0] = along_one_axis;
  auto scene = disorder<2>(o);
  auto& w = scene.w;
  auto& s = w.s;
  w.g = {0.5, -9.0};
  for (std::size_t a = 0; a < 2; ++a) randomise<2>(w, s.v[a], 3 + a, -1.0, 1.0);
  randomise<2>(w, s.eta, 5, 1e3, 5e3);
  w.uniform_transport.reset();
  walls::virtual_marker::kinematics(w, scene.walls);
  std::array<particles::array, 2> f;
  for (auto& component : f) component.assign(s.total() + 1, 0.0);
  test::sum<2>(w, diffusion::viscosity<2>{
                      pairs::pointers<2>(s.v), s.eta.data(), s.dV.data(), {f[0].data(), f[1].data()}, nullptr});
  for (std::size_t a = 0; a < 2; ++a)
    for (std::size_t i = 0; i < s.fluid; ++i) f[a][i] = f[a][i] / s.m[i] + w.g[a];
  for (std::size_t a = 0; a < 2; ++a) w.exchange_fluid({f[a].data()});
  std::size_t seen = 0, wrong = 0;
  for (const auto* markers : {&scene.walls.read, &*scene.walls.unread})
    for (std::size_t k = 0; k < markers->of.size(); ++k)
      for (const std::uint32_t place : markers->near.row(k)) {
        const std::size_t j = markers->listed[place];
        double r2 = 0.0;
        for (std::size_t a = 0; a < 2; ++a) r2 += std::pow(s.x[a][j] - scene.walls.marker[a][markers->of[k]], 2);
        if (r2 >= std::pow(scene.walls.reach, 2)) continue;
        ++seen;
        for (std::size_t a = along_one_axis ? 1 : 0; a < 2; ++a) wrong += (*scene.walls.f[a])[j] != f[a][j];
      }
  BOOST_TEST((seen > 0 || s.walls == 0));
  BOOST_TEST(wrong == 0U);
}

BOOST_AUTO_TEST_CASE(acceleration_without_pressure) {
  check_acceleration(false);
  check_acceleration(true);
}

// Wall particles that no fluid reaches are left out unless they are asked for, and change nothing of the others.
BOOST_AUTO_TEST_CASE(what_no_particle_reads_is_left_out) {
  constexpr double untouched = -7.0;
  const auto check = []<int D>(const hydrostatic::options& o) {
    const auto values = [&](bool complete) {
      auto scene = make_scene<D>(o, domain::communicator::world(), 0.05);
      auto& w = scene.w;
      auto& s = w.s;
      scene.walls.complete = complete;
      for (std::size_t a = 0; a < D; ++a) randomise<D>(w, s.v[a], 3 + a, -1.0, 1.0);
      randomise<D>(w, s.p, 8, 1e9, 2e9);
      fill<D>(w, s.dV, [&](std::size_t i) { return s.m[i] / s.rho[i]; });
      for (std::size_t i = s.first_wall(); i < s.total(); ++i) s.p[i] = untouched;
      walls::virtual_marker::kinematics(w, scene.walls);
      walls::virtual_marker::weights(w, scene.walls);
      walls::virtual_marker::pressures(w, scene.walls);
      // A wall particle in some fluid particle's reach has its value.
      std::size_t missing = 0;
      for (std::size_t i = 0; i < s.fluid; ++i)
        w.list.for_each(i / w.list.width, [&](std::uint32_t j, auto...) {
          double r2 = 0.0;
          for (std::size_t a = 0; a < D; ++a) r2 += std::pow(s.x[a][i] - s.x[a][j], 2);
          missing += j >= s.first_wall() && r2 < std::pow(w.support(), 2) && s.p[j] == untouched ? 1 : 0;
        });
      BOOST_TEST(missing == 0U);
      return std::pair{walls_by_id(scene, s.p), walls_by_id(scene, s.v[0])};
    };
    const auto all = values(true), some = values(false);
    std::size_t left_out = 0, wrong = 0, number = 0;
    for (std::size_t k = 0; k < all.first.size(); ++k) {
      if (all.first[k] == 0.0) continue;  // no wall particle's
      ++number;
      wrong += all.first[k] == untouched ? 1 : 0;
      if (some.first[k] == untouched)
        ++left_out;
      else
        wrong += some.first[k] != all.first[k] || some.second[k] != all.second[k] ? 1 : 0;
    }
    BOOST_TEST(wrong == 0U);
    return static_cast<double>(left_out) / static_cast<double>(number);
  };
  // The outermost of the quintic's four layers, which is behind 0.1 spacings alone.
  auto o = box<2>({24, 16}, false, "virtual_marker");
  o.domain.periodic[0] = true;
  BOOST_TEST(check.operator()<2>(o) == 0.25);
  // Of C2's three too; in edges and corners, which are farther from the fluid, more.
  BOOST_TEST(check.operator()<3>(closed_box<3>("virtual_marker")) > 1.0 / 3.0);
}

// One viscosity for all: the same, told once or carried by each particle.
BOOST_AUTO_TEST_CASE(acceleration_of_one_viscosity) {
  constexpr double eta = 2e3;
  std::array<std::vector<double>, 2> near;
  for (const bool told : {true, false}) {
    auto scene = disorder<2>(closed_box<2>("virtual_marker"));
    auto& w = scene.w;
    for (std::size_t a = 0; a < 2; ++a) randomise<2>(w, w.s.v[a], 3 + a, -1.0, 1.0);
    std::fill(w.s.eta.begin(), w.s.eta.end(), eta);
    w.uniform_transport.reset();
    if (told) w.uniform_transport = eta;
    walls::virtual_marker::kinematics(w, scene.walls);
    for (const std::size_t i : scene.walls.read.near_wall.rows)
      for (const auto* f : scene.walls.f) near[told ? 1 : 0].push_back((*f)[i]);
  }
  BOOST_REQUIRE(near[0].size() == near[1].size());
  double most = 0.0, apart = 0.0;
  for (std::size_t k = 0; k < near[0].size(); ++k) {
    most = std::max(most, std::abs(near[0][k]));
    apart = std::max(apart, std::abs(near[0][k] - near[1][k]));
  }
  BOOST_TEST((most > 0.0 || near[0].empty()));
  BOOST_TEST(apart <= 1e-12 * most);
}

BOOST_AUTO_TEST_CASE(treatments_by_name) {
  for (const std::string name : {"virtual_marker", "none", "frozen", "repulsion"})
    std::visit([&](auto t) { BOOST_TEST(decltype(t)::name == name); }, walls::make(name));
  const auto scene = make_scene<2>(closed_box<2>("none"), domain::communicator::world());
  BOOST_TEST(scene.w.s.walls + scene.w.s.wall_ghosts == 0U);
}

// ρ = ρ0 exp(ρ0 g (L - y)/K) solves the linear EOS's column, beyond the walls as within.
BOOST_AUTO_TEST_CASE(frozen_walls_keep_the_start) {
  auto o = closed_box<2>("frozen");
  o.g = 1e4;
  o.initial.profile = "hydrostatic";
  o.walls.sides[2].velocity = 2.5;
  auto scene = make_scene<2>(o, domain::communicator::world(), 0.2);
  auto& s = scene.w.s;
  for (std::size_t i = s.first_wall(); i < s.total(); ++i) s.v[0][i] = s.rho[i] = s.p[i] = s.dV[i] = s.Y[i] = -1.0;
  walls::frozen::kinematics(scene.w, scene.walls);
  walls::frozen::weights(scene.w, scene.walls);
  for (std::size_t i = s.first_wall(); i < s.total(); ++i) {
    const double y = s.x[1][i], rho = 7000.0 * std::exp(7000.0 * 1e4 * (9.0 - y) / 1e11),
                 p = 1e10 + 1e11 * (rho / 7000.0 - 1.0);
    // Runge-Kutta of fourth order with an exponent of 4e-5 a step: rounding alone.
    BOOST_TEST(std::abs(s.rho[i] / rho - 1.0) < 1e-12);
    BOOST_TEST(std::abs(s.p[i] / p - 1.0) < 1e-12);
    BOOST_TEST(std::abs(s.dV[i] - 1.0) < 1e-12);
    BOOST_TEST(std::abs(s.Y[i] / p - 1.0) < 1e-12);
    BOOST_TEST(s.v[0][i] == (y < 0.0 ? 2.5 : 0.0));
  }
}

// Λ n = (f·n) λ n with λ = -1 at the wall: it takes away f there, and nothing from its range on; the pressure gets no
// step.
BOOST_AUTO_TEST_CASE(repulsion_by_distance) {
  auto o = closed_box<2>("repulsion");
  o.walls.repulsion_range = 2.0;
  auto scene = disorder<2>(o);
  auto& w = scene.w;
  auto& s = w.s;
  w.g = {0.5, -9.0};
  walls::repulsion::kinematics(w, scene.walls);
  std::array<particles::array, 2> force;
  for (auto& component : force) component.assign(s.fluid, 0.0);
  walls::repulsion::push<2>(w, scene.walls, {force[0].data(), force[1].data()});
  const auto share = [](double x, double length) {
    return std::max(0.0, 1.0 - x / 2.0) + std::max(0.0, 1.0 - (length - x) / 2.0);
  };
  for (std::size_t i = 0; i < s.fluid; ++i) {
    BOOST_TEST(std::abs(force[0][i] / s.m[i] + 0.5 * share(s.x[0][i], 24.0)) < 10.0 * epsilon);
    BOOST_TEST(std::abs(force[1][i] / s.m[i] - 9.0 * share(s.x[1][i], 9.0)) < 100.0 * epsilon);
  }
  fill<2>(w, s.p, [&](std::size_t i) { return linear<2>(cells::position<2>(s.x, i)); });
  walls::repulsion::pressures(w, scene.walls);
  double worst = 0.0;
  for_each_wall<2>(scene, [&](std::size_t i, const auto&, const auto& marker) {
    worst = std::max(worst, std::abs(s.p[i] - linear<2>(marker)));
  });
  BOOST_TEST(w.d.ranks.maximum(worst) < exact);
}

// In a corner, behind a wall, at the end of the range: -∂/∂x of the potential that is counted, and ω = c/(4 Δx).
BOOST_AUTO_TEST_CASE(boundary_force_is_the_slope_of_its_potential) {
  auto scene = disorder<2>(closed_box<2>("virtual_marker"), alone());
  auto& w = scene.w;
  auto& s = w.s;
  const double c = eos::evaluate(w.materials[0], 7000.0, 2500.0).sound_speed, stiffness = c * c / 16.0;
  const auto push = [&] {
    std::array<particles::array, 2> force;
    for (auto& component : force) component.assign(s.fluid, 0.0);
    walls::virtual_marker::push<2>(w, scene.walls, {force[0].data(), force[1].data()});
    return force;
  };
  // x, y, and how far within the range along both axes, inward positive.
  const double places[5][4] = {{0.1, 0.25, 0.2, 0.05},
                               {5.0, -0.05, 0.0, 0.35},
                               {23.9, 8.8, -0.2, -0.1},
                               {5.0, 9.0, 0.0, -0.3},
                               {0.3, 0.5, 0.0, 0.0}};
  for (const auto& [x, y, depth_x, depth_y] : places) {
    s.x[0][0] = x;
    s.x[1][0] = y;
    const auto force = push();
    BOOST_TEST(std::abs(force[0][0] - s.m[0] * stiffness * depth_x) < 1e-10 * s.m[0] * stiffness);
    BOOST_TEST(std::abs(force[1][0] - s.m[0] * stiffness * depth_y) < 1e-10 * s.m[0] * stiffness);
    for (std::size_t a = 0; a < 2; ++a) {
      const double at = s.x[a][0], small = 1e-4;
      s.x[a][0] = at + small;
      const double above = hydrostatic::measure_totals(scene).potential;
      s.x[a][0] = at - small;
      const double below = hydrostatic::measure_totals(scene).potential;
      s.x[a][0] = at;
      // At the end of the range the slope has a kink, and the difference is off by its half.
      BOOST_TEST(std::abs(force[a][0] + (above - below) / (2.0 * small)) < small * s.m[0] * stiffness);
    }
  }
}

// Lattices at rest, whose first row is at 0.5 Δx, keep their bits; treatments of other kinds have forces of their own.
BOOST_AUTO_TEST_CASE(boundary_force_ends_before_the_lattice) {
  const auto pushed = [](const hydrostatic::scene<2>& scene) {
    std::size_t number = 0;
    for (std::size_t i = 0; i < scene.w.s.fluid; ++i)
      walls::push_off(scene.walls.force, scene.walls.sides, scene.w.s, i, [&](std::size_t, double) { ++number; });
    return number;
  };
  const auto world = domain::communicator::world();
  const auto rest = make_scene<2>(closed_box<2>("virtual_marker"), world);
  BOOST_TEST(rest.walls.force.stiffness > 0.0);
  BOOST_TEST(pushed(rest) == 0U);
  BOOST_TEST(world.sum(static_cast<std::int64_t>(pushed(disorder<2>(closed_box<2>("virtual_marker"))))) > 0);
  for (const char* other : {"none", "frozen", "repulsion"})
    BOOST_TEST(make_scene<2>(closed_box<2>(other), world).walls.force.stiffness == 0.0);
}

BOOST_AUTO_TEST_CASE(reflection_counts_and_mirrors) {
  auto o = closed_box<2>("virtual_marker");
  o.domain.periodic[0] = true;
  auto scene = disorder<2>(o, alone());
  auto& s = scene.w.s;
  const auto put = [&](std::size_t i, double x, double y, double v) {
    s.x[0][i] = x;
    s.x[1][i] = y;
    s.v[0][i] = 7.0;
    s.v[1][i] = v;
  };
  put(0, 3.0, -0.25, -2.0);  // through the bottom
  put(1, 3.0, 9.5, 4.0);     // through the top
  put(2, 3.0, -0.5, 1.0);    // outside, on its way back
  put(3, -0.5, 0.25, -2.0);  // over a periodic border: no wall there
  put(4, 3.0, 0.0, -2.0);    // on the wall is inside
  BOOST_TEST(walls::reflect(scene.walls, s) == 3);
  const double expected[5][2] = {{0.25, 2.0}, {8.5, -4.0}, {0.5, 1.0}, {0.25, -2.0}, {0.0, -2.0}};
  for (std::size_t i = 0; i < 5; ++i) {
    BOOST_TEST(s.x[1][i] == expected[i][0]);
    BOOST_TEST(s.v[1][i] == expected[i][1]);
    BOOST_TEST(s.v[0][i] == 7.0);
  }
  BOOST_TEST(s.x[0][3] == -0.5);
  BOOST_TEST(walls::reflect(scene.walls, s) == 0);
}

BOOST_AUTO_TEST_CASE(walls_do_not_depend_on_ranks) {
  const auto values = [](const domain::communicator& ranks, const std::string& interpolation) {
    auto scene = disorder<2>(closed_box<2>("virtual_marker", interpolation), ranks);
    auto& w = scene.w;
    auto& s = w.s;
    w.g = {0.5, -9.0};
    for (std::size_t a = 0; a < 2; ++a) randomise<2>(w, s.v[a], 3 + a, -1.0, 1.0);
    randomise<2>(w, s.T, 6, 2000.0, 3000.0);
    randomise<2>(w, s.eta, 7, 1.0, 2.0);
    randomise<2>(w, s.p, 8, 1e9, 2e9);
    walls::virtual_marker::kinematics(w, scene.walls);
    walls::virtual_marker::weights(w, scene.walls);
    walls::virtual_marker::pressures(w, scene.walls);
    std::vector<double> all;
    for (const auto* a : {&s.x[0], &s.x[1], &s.v[0], &s.v[1], &s.T, &s.eta, &s.dV, &s.Y, &s.p}) {
      const auto one = walls_by_id(scene, *a);
      all.insert(all.end(), one.begin(), one.end());
    }
    return all;
  };
  for (const std::string interpolation : {"mls", "mls2"})
    BOOST_TEST(same_bits(values(domain::communicator::world(), interpolation), values(alone(), interpolation)));
}
