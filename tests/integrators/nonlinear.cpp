// KINSOL's two solvers on problems whose solution is known, over ranks with and without unknowns.
#include "ranks.hpp"

#include <algorithm>
#include <cmath>
#include <foundation/error.hpp>
#include <integrators/nonlinear.hpp>

using namespace tetsuame::integrators;

namespace {

constexpr int total = 400;

// A chain with neighbours k - 1 and k + 1, as one particle sees another:
//   F_k(x) = x_k + 0.4 (e^{x_k} - e^{s_k}) - 0.3 (n_k(x) - n_k(s)) - s_k,  n_k = x_{k-1} + x_{k+1},
// which vanishes at x = s. All ranks hold the chain; each owns some of it.
struct chain {
  MPI_Comm communicator;
  std::vector<int> id;
  int calls = 0;

  chain(MPI_Comm c, int way) : communicator(c), id(spread(c, total, way)) {}

  static double solution(int k) { return std::sin(0.1 * k); }
  static double neighbours(const std::vector<double>& v, int k) {
    return (k > 0 ? v[static_cast<std::size_t>(k - 1)] : 0.0) +
           (k + 1 < total ? v[static_cast<std::size_t>(k + 1)] : 0.0);
  }
  std::vector<double> whole(std::span<const double> x) const {
    return gathered(communicator, id, {x.begin(), x.end()}, total);
  }
  int residual(std::span<const double> x, std::span<double> f) {
    ++calls;
    std::vector<double> s(total);
    for (int k = 0; k < total; ++k) s[static_cast<std::size_t>(k)] = solution(k);
    const auto all = whole(x);
    for (std::size_t i = 0; i < id.size(); ++i) {
      const int k = id[i];
      f[i] = x[i] - solution(k) + 0.4 * (std::exp(x[i]) - std::exp(solution(k))) -
             0.3 * (neighbours(all, k) - neighbours(s, k));
    }
    return 0;
  }
  // x - w F: contracts by about 1 - 0.05 * 0.4 only
  int map(std::span<const double> x, std::span<double> g) {
    const int status = residual(x, g);
    for (std::size_t i = 0; i < g.size(); ++i) g[i] = x[i] - 0.15 * g[i];
    return status;
  }
  int product(std::span<const double> x, std::span<const double> v, std::span<double> jv) const {
    const auto all = whole(v);
    for (std::size_t i = 0; i < id.size(); ++i)
      jv[i] = (1.0 + 0.4 * std::exp(x[i])) * v[i] - 0.3 * neighbours(all, id[i]);
    return 0;
  }
  static int diagonal(std::span<const double> x, std::span<double> d) {
    for (std::size_t i = 0; i < x.size(); ++i) d[i] = 1.0 + 0.4 * std::exp(x[i]);
    return 0;
  }
  double error(std::span<const double> x) const {
    double worst = 0.0;
    for (std::size_t i = 0; i < id.size(); ++i) worst = std::max(worst, std::fabs(x[i] - solution(id[i])));
    MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE, MPI_MAX, communicator);
    return worst;
  }
};

struct solved {
  nonlinear_result result;
  std::vector<double> x;
  double error;
};

solved by_anderson(MPI_Comm communicator, int way, const anderson_options& options) {
  chain c(communicator, way);
  std::vector<double> x(c.id.size(), 0.0);
  auto result = anderson(
      communicator, x, [&](auto from, auto to) { return c.map(from, to); }, options);
  BOOST_CHECK_EQUAL(result.evaluations, c.calls);
  return {result, gathered(communicator, c.id, x, total), c.error(x)};
}

solved by_newton(MPI_Comm communicator, int way) {
  chain c(communicator, way);
  std::vector<double> x(c.id.size(), 0.0);
  const jacobian_times product = [&](auto at, auto v, auto jv) { return c.product(at, v, jv); };
  auto result = newton_krylov(communicator, x, [&](auto from, auto to) { return c.residual(from, to); }, product,
                              chain::diagonal, {.tolerance = 1e-11});
  BOOST_CHECK_EQUAL(result.evaluations, c.calls);
  return {result, gathered(communicator, c.id, x, total), c.error(x)};
}

void check_same(const solved& a, const solved& b) {
  BOOST_TEST(a.result.residuals == b.result.residuals, boost::test_tools::per_element());
  BOOST_TEST(a.x == b.x, boost::test_tools::per_element());
}

}  // namespace

BOOST_AUTO_TEST_CASE(anderson_finds_the_solution_in_far_fewer_passes) {
  const auto plain = by_anderson(MPI_COMM_WORLD, 0, {.tolerance = 1e-10, .max_iterations = 2000, .depth = 0});
  const auto fast = by_anderson(MPI_COMM_WORLD, 0, {.tolerance = 1e-10, .max_iterations = 2000, .depth = 5});
  for (const auto& s : {plain, fast}) {
    BOOST_CHECK(s.result.converged);
    // |x - s| <= |g - x| / (1 - 0.95): the map contracts by 0.95 at worst
    BOOST_CHECK_LT(s.error, 1e-10 / 0.05);
    BOOST_CHECK_LE(s.result.residuals.back(), 1e-10);
  }
  BOOST_TEST_MESSAGE("passes: plain " << plain.result.evaluations << ", Anderson " << fast.result.evaluations);
  BOOST_CHECK_LT(4 * fast.result.evaluations, plain.result.evaluations);
}

BOOST_AUTO_TEST_CASE(newton_finds_the_solution) {
  const auto s = by_newton(MPI_COMM_WORLD, 0);
  BOOST_CHECK(s.result.converged);
  BOOST_CHECK_LT(s.error, 1e-11 / 0.5);  // diagonal dominance: 1 + 0.4 e^-1 - 0.6 > 0.5
  BOOST_CHECK_LT(s.result.iterations, 12);
}

BOOST_AUTO_TEST_CASE(the_preconditioner_is_used) {
  // Unequal diagonal values are what GMRES alone finds hard.
  std::vector<double> x(100, 1.0);
  const auto scale = [](std::size_t i) { return std::pow(10.0, 0.06 * static_cast<double>(i)); };
  const residual_function f = [&](auto at, auto to) {
    for (std::size_t i = 0; i < at.size(); ++i) to[i] = scale(i) * (at[i] + 0.1 * at[i] * at[i] * at[i] - 1.1);
    return 0;
  };
  const jacobian_times jv = [&](auto at, auto v, auto to) {
    for (std::size_t i = 0; i < at.size(); ++i) to[i] = scale(i) * (1.0 + 0.3 * at[i] * at[i]) * v[i];
    return 0;
  };
  const jacobian_diagonal d = [&](auto at, auto to) {
    for (std::size_t i = 0; i < at.size(); ++i) to[i] = scale(i) * (1.0 + 0.3 * at[i] * at[i]);
    return 0;
  };
  x.assign(100, 3.0);
  const auto with = newton_krylov(MPI_COMM_SELF, x, f, jv, d, {.tolerance = 1e-8});
  BOOST_CHECK(with.converged);
  for (double v : x) BOOST_CHECK_SMALL(v - 1.0, 1e-8);
  x.assign(100, 3.0);
  const jacobian_diagonal ones = [](auto, auto to) {
    std::fill(to.begin(), to.end(), 1.0);
    return 0;
  };
  const auto without = newton_krylov(MPI_COMM_SELF, x, f, jv, ones, {.tolerance = 1e-8});
  BOOST_CHECK(!without.converged || without.products > 4 * with.products);
}

BOOST_AUTO_TEST_CASE(same_bits_however_the_unknowns_are_spread) {
  const auto anderson_alone = by_anderson(MPI_COMM_SELF, 0, {});
  const auto newton_alone = by_newton(MPI_COMM_SELF, 0);
  for (int way : {0, 1, 2}) {
    check_same(by_anderson(MPI_COMM_WORLD, way, {}), anderson_alone);
    check_same(by_newton(MPI_COMM_WORLD, way), newton_alone);
  }
}

BOOST_AUTO_TEST_CASE(failing_to_converge_is_told_not_thrown) {
  const auto s = by_anderson(MPI_COMM_WORLD, 0, {.tolerance = 1e-10, .max_iterations = 3, .depth = 0});
  BOOST_CHECK(!s.result.converged);
  BOOST_CHECK_EQUAL(s.result.residuals.size(), 3U);
  BOOST_CHECK_NE(s.result.reason.find("3 iterations"), std::string::npos);

  std::vector<double> x(3, 1.0);
  const auto apart = anderson(MPI_COMM_WORLD, x,
                              [](auto from, auto to) {
                                for (std::size_t i = 0; i < from.size(); ++i) to[i] = 1e200 * from[i] * from[i];
                                return 0;
                              },
                              {.depth = 0});
  BOOST_CHECK(!apart.converged);
  BOOST_CHECK_NE(apart.reason.find("not finite"), std::string::npos);

  x.assign(3, 1.0);
  const auto refused = anderson(MPI_COMM_WORLD, x, [](auto, auto) { return 1; });
  BOOST_CHECK(!refused.converged);
  BOOST_CHECK_NE(refused.reason.find("could not be evaluated"), std::string::npos);

  x.assign(3, 1.0);
  const jacobian_times slope = [](auto at, auto v, auto jv) {
    for (std::size_t i = 0; i < v.size(); ++i) jv[i] = 2.0 * at[i] * v[i];
    return 0;
  };
  const residual_function positive = [](auto from, auto to) {
    for (std::size_t i = 0; i < from.size(); ++i) to[i] = 1.0 + from[i] * from[i];
    return 0;
  };
  const auto rootless = newton_krylov(MPI_COMM_WORLD, x, positive, slope, [](auto at, auto to) {
    for (std::size_t i = 0; i < at.size(); ++i) to[i] = 2.0 * at[i];
    return 0;
  });
  BOOST_CHECK(!rootless.converged);
  BOOST_CHECK(!rootless.reason.empty());
}

BOOST_AUTO_TEST_CASE(exceptions_and_failures_pass_through) {
  using tetsuame::foundation::error;
  std::vector<double> x(3, 1.0);
  const bool mine = rank_of(MPI_COMM_WORLD) == 0;
  const auto thrower = [&](auto, auto) {
    if (mine) tetsuame::foundation::fail_calculation("p <= 0 at particle 17");
    return 0;
  };
  const jacobian_times unused = [](auto, auto, auto) { return 0; };
  const auto expected = [&](const error& e) {
    const bool own = std::string(e.what()) == "p <= 0 at particle 17";
    return own == mine && e.status() == tetsuame::foundation::exit_status::calculation_failed;
  };
  BOOST_CHECK_EXCEPTION(anderson(MPI_COMM_WORLD, x, thrower), error, expected);
  const jacobian_diagonal no_diagonal = [](auto, auto) { return 0; };
  BOOST_CHECK_EXCEPTION(newton_krylov(MPI_COMM_WORLD, x, thrower, unused, no_diagonal), error, expected);
  BOOST_CHECK_THROW(anderson(MPI_COMM_WORLD, x, [](auto, auto) { return -1; }), error);
}
