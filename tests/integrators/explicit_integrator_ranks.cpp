// Explicit steps over several ranks and threads: the same bits as on one, with particles
// that migrate and ranks that are empty, and failures that one rank meets.
#include <omp.h>

#include <cmath>
#include <foundation/error.hpp>
#include <integrators/explicit_integrator.hpp>

#include "ranks.hpp"

using namespace tetsuame::integrators;
using tetsuame::foundation::error;

namespace {

constexpr int total = 6001;

// Particle k swings with its own frequency; the tolerances act over all of them.
struct swarm {
  MPI_Comm communicator;
  std::vector<int> id;
  std::vector<double> x, v, earlier_x, earlier_v;  // the last two: rates that 'ab2' and 'kdk' keep

  swarm(MPI_Comm c, int way) : communicator(c), id(spread(c, total, way)) {
    for (int k : id) {
      x.push_back(std::cos(0.01 * k));
      v.push_back(0.0);
    }
    earlier_x.resize(id.size());
    earlier_v.resize(id.size());
  }
  std::vector<field> fields() {
    return {{"x", x.data(), 1e-8, 1.0, 0.0, 0.0, earlier_x.data()},
            {"v", v.data(), 1e-8, 1.0, 0.0, 0.0, earlier_v.data()}};
  }
  int rates(std::span<double* const> rate) const {
    for (std::size_t i = 0; i < id.size(); ++i) {
      rate[0][i] = v[i];
      rate[1][i] = -(1.0 + 2e-3 * id[i]) * std::sin(3.0 * x[i]);
    }
    return 0;
  }
  void migrate(int way) {
    const std::vector<int> before = id;
    id = spread(communicator, total, way);
    for (auto* array : {&x, &v, &earlier_x, &earlier_v}) {
      const auto all = gathered(communicator, before, *array, total);
      array->clear();
      for (int k : id) array->push_back(all[static_cast<std::size_t>(k)]);
    }
  }
};

// x and v of all particles, then times, steps and the controller's state.
std::vector<double> outcome(MPI_Comm communicator, const explicit_options& options, std::vector<int> ways) {
  swarm s(communicator, ways[0]);
  explicit_integrator integrator(
      communicator, s.fields(), s.id.size(), 0.0, options,
      [&](double, std::span<double* const> rate) { return s.rates(rate); }, {}, [](double) { return 7.0; });
  for (std::size_t k = 0; k < ways.size(); ++k) {
    if (k > 0) {
      s.migrate(ways[k]);
      integrator.resize(s.fields(), s.id.size());
    }
    for (int n = 0; n < 12; ++n) integrator.step(0.9);
  }
  auto all = gathered(communicator, s.id, s.x, total);
  const auto all_v = gathered(communicator, s.id, s.v, total);
  all.insert(all.end(), all_v.begin(), all_v.end());
  const auto& statistics = integrator.statistics();
  for (double value : {integrator.time(), statistics.next_dt, statistics.last_error,
                       static_cast<double>(statistics.steps), static_cast<double>(statistics.rejections)})
    all.push_back(value);
  return all;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() &&
         std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) { return bits(x) == bits(y); });
}

}  // namespace

BOOST_AUTO_TEST_CASE(same_bits_on_any_ranks_and_threads_and_through_migration) {
  const explicit_options euler{.method = "euler", .dt = 0.01};
  const explicit_options adaptive{.method = "adaptive", .order = 3, .dt = 0.5, .rtol = 1e-5};
  const explicit_options high{.method = "adaptive", .order = 5, .rtol = 1e-9};
  const explicit_options ab2{.method = "ab2", .dt = 0.01};
  const explicit_options kdk{.method = "kdk", .dt = 0.01, .error_control = false};
  const explicit_options rkl2{.method = "rkl2", .dt = 0.5, .rtol = 1e-5};
  const explicit_options rkc2{.method = "rkc2", .rtol = 1e-6};
  for (const auto& options : {euler, adaptive, high, ab2, kdk, rkl2, rkc2}) {
    omp_set_num_threads(1);
    const auto alone = outcome(MPI_COMM_SELF, options, {0, 0, 0});
    if (options.dt == 0.5) BOOST_CHECK_GT(alone.back(), 0.0);  // rejections are among what agrees
    // Every way for one of each kind; for the others the one that moves the most.
    const bool all = options.method == "adaptive" || options.method == "rkl2";
    std::vector<std::vector<int>> ways{{2, 0, 1}};
    if (all) ways.insert(ways.end(), {{0, 0, 0}, {1, 1, 1}, {0, 2, 2}});
    for (int threads : {1, 2}) {
      omp_set_num_threads(threads);
      for (const auto& way : ways) BOOST_CHECK(same_bits(outcome(MPI_COMM_WORLD, options, way), alone));
    }
  }
  omp_set_num_threads(1);
}

BOOST_AUTO_TEST_CASE(no_particles_at_all) {
  explicit_integrator integrator(MPI_COMM_WORLD, {{"x", nullptr, 1.0}}, 0, 0.0, {.method = "adaptive"},
                                 [](double, std::span<double* const>) { return 0; });
  BOOST_CHECK_EQUAL(integrator.step(2.0), 2.0);
}

BOOST_AUTO_TEST_CASE(what_one_rank_cannot_evaluate_all_try_again) {
  swarm s(MPI_COMM_WORLD, 0);
  const bool last = rank_of(MPI_COMM_WORLD) == ranks_of(MPI_COMM_WORLD) - 1;
  int calls = 0;
  explicit_integrator integrator(MPI_COMM_WORLD, s.fields(), s.id.size(), 0.0,
                                 {.method = "adaptive", .order = 3, .dt = 0.01, .rtol = 1e-4},
                                 [&](double, std::span<double* const> rate) {
                                   s.rates(rate);
                                   return ++calls == 3 && last ? 1 : 0;
                                 });
  integrator.step(1.0);
  BOOST_CHECK_EQUAL(integrator.statistics().unevaluable, 1);
  BOOST_CHECK_CLOSE(integrator.statistics().last_dt, 0.0025, 1e-10);
}

BOOST_AUTO_TEST_CASE(an_exception_on_one_rank_ends_the_step_on_all) {
  swarm s(MPI_COMM_WORLD, 0);
  const auto x = s.x;
  const bool mine = rank_of(MPI_COMM_WORLD) == 0;
  int calls = 0;
  explicit_integrator integrator(MPI_COMM_WORLD, s.fields(), s.id.size(), 0.0, {.method = "order_4", .dt = 0.01},
                                 [&](double, std::span<double* const> rate) {
                                   if (++calls == 3 && mine) tetsuame::foundation::fail_calculation("p <= 0");
                                   return s.rates(rate);
                                 });
  BOOST_CHECK_EXCEPTION(integrator.step(1.0), error,
                        [&](const error& e) { return (std::string(e.what()) == "p <= 0") == mine; });
  BOOST_CHECK(same_bits(s.x, x));
}
