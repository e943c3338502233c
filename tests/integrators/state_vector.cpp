// The N_Vector: its arithmetic, its lazy copies, and reductions that know neither ranks, nor
// threads, nor order.
#include "ranks.hpp"

#include <omp.h>

#include <cmath>
#include <foundation/agree.hpp>
#include <integrators/state_vector.hpp>
#include <limits>

using namespace tetsuame::integrators;

namespace {

constexpr int total = 20011;  // more than one block a thread

struct sample {
  sundials::Context context;
  std::vector<int> id;
  std::vector<double> a, b;
  vector_handle home;

  explicit sample(MPI_Comm communicator, int way, int particles = total) : id(spread(communicator, particles, way)) {
    for (int k : id) {
      a.push_back(std::sin(1.0 + k) * std::exp(10.0 * std::cos(3.0 * k)));
      b.push_back(std::cos(2.0 + k));
    }
    home = make_state_vector(context, communicator, {{a.data(), id.size()}, {b.data(), id.size()}});
  }
  vector_handle clone() const { return vector_handle(N_VClone(home.get())); }
};

std::vector<std::uint64_t> all_reductions(MPI_Comm communicator, int way) {
  sample s(communicator, way);
  const vector_handle w = s.clone(), squared = s.clone();
  N_VAbs(s.home.get(), w.get());
  N_VAddConst(w.get(), 0.01, w.get());
  N_VInv(w.get(), w.get());
  N_VProd(s.home.get(), s.home.get(), squared.get());
  N_Vector others[] = {w.get(), squared.get(), s.home.get()};
  double dots[3];
  N_VDotProdMulti(3, s.home.get(), others, dots);
  std::vector<std::uint64_t> result;
  for (double v : {N_VWrmsNorm(s.home.get(), w.get()), N_VWL2Norm(s.home.get(), w.get()),
                   N_VDotProd(s.home.get(), squared.get()), N_VMaxNorm(s.home.get()), N_VMin(s.home.get()), dots[0],
                   dots[1], dots[2], static_cast<double>(N_VGetLength(w.get()))})
    result.push_back(bits(v));
  return result;
}

}  // namespace

BOOST_AUTO_TEST_CASE(reductions_have_the_same_bits_however_particles_are_spread) {
  omp_set_num_threads(1);
  const auto alone = all_reductions(MPI_COMM_SELF, 0);
  for (int threads : {1, 2, 3})
    for (int way : {0, 1, 2}) {
      omp_set_num_threads(threads);
      BOOST_TEST(all_reductions(MPI_COMM_WORLD, way) == alone, boost::test_tools::per_element());
    }
  omp_set_num_threads(1);
}

// Fields need not be of one length: here three values more, all on the first rank.
BOOST_AUTO_TEST_CASE(fields_of_different_lengths) {
  const std::vector<int> id = spread(MPI_COMM_WORLD, 1000, 1);
  std::vector<double> a(id.begin(), id.end()), few;
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  if (rank == 0) few = {-2000.0, 3000.0, 4000.0};
  const sundials::Context context;
  const auto home = make_state_vector(context, MPI_COMM_WORLD, {{few.data(), few.size()}, {a.data(), a.size()}});
  BOOST_TEST(N_VGetLength(home.get()) == 1003);
  BOOST_TEST(N_VMaxNorm(home.get()) == 4000.0);
  BOOST_TEST(N_VMin(home.get()) == -2000.0);
  BOOST_TEST(N_VDotProd(home.get(), home.get()) == 29e6 + 999.0 * 1000.0 * 1999.0 / 6.0);
  const vector_handle twice(N_VClone(home.get()));
  N_VScale(2.0, home.get(), twice.get());
  N_VScale(1.0, twice.get(), home.get());
  if (rank == 0) BOOST_TEST((few == std::vector<double>{-4000.0, 6000.0, 8000.0}));
  for (std::size_t i = 0; i < id.size(); ++i) BOOST_TEST(a[i] == 2.0 * id[i]);
}

BOOST_AUTO_TEST_CASE(reductions_agree_with_their_definitions) {
  sample s(MPI_COMM_WORLD, 1, 100);
  const vector_handle w = s.clone();
  N_VConst(0.5, w.get());
  long double squares = 0, lowest = 1e300L, highest = 0;
  for (int k = 0; k < 100; ++k)
    for (long double v : {std::sin(1.0 + k) * std::exp(10.0 * std::cos(3.0 * k)), std::cos(2.0 + k)}) {
      squares += 0.25L * v * v;
      lowest = std::min(lowest, v);
      highest = std::max(highest, std::fabs(v));
    }
  const double tolerance = 1e-13;  // relative: rounding of one product and of the reference's sum, in percent
  BOOST_CHECK_EQUAL(N_VGetLength(s.home.get()), 200);
  BOOST_CHECK_CLOSE(N_VWrmsNorm(s.home.get(), w.get()), static_cast<double>(std::sqrt(squares / 200)), 100 * tolerance);
  BOOST_CHECK_CLOSE(N_VWL2Norm(s.home.get(), w.get()), static_cast<double>(std::sqrt(squares)), 100 * tolerance);
  BOOST_CHECK_CLOSE(N_VDotProd(s.home.get(), s.home.get()), static_cast<double>(4 * squares), 100 * tolerance);
  BOOST_CHECK_EQUAL(N_VMin(s.home.get()), static_cast<double>(lowest));
  BOOST_CHECK_EQUAL(N_VMaxNorm(s.home.get()), static_cast<double>(highest));
}

BOOST_AUTO_TEST_CASE(not_a_number_on_one_rank_is_seen_on_all) {
  sample s(MPI_COMM_WORLD, 0, 50);
  const vector_handle w = s.clone();
  N_VConst(1.0, w.get());
  if (rank_of(MPI_COMM_WORLD) == ranks_of(MPI_COMM_WORLD) - 1) s.a.back() = std::numeric_limits<double>::quiet_NaN();
  home_was_changed(s.home.get());
  BOOST_CHECK(std::isinf(N_VMaxNorm(s.home.get())));
  BOOST_CHECK(std::isnan(N_VWrmsNorm(s.home.get(), w.get())));
}

BOOST_AUTO_TEST_CASE(arithmetic_is_that_of_a_plain_loop) {
  sample s(MPI_COMM_WORLD, 0, 5000);
  const auto a = s.a;
  const vector_handle x = s.clone(), y = s.clone(), z = s.clone();
  N_VScale(2.5, s.home.get(), x.get());
  N_VAddConst(x.get(), -1.0, y.get());
  N_VLinearSum(0.3, x.get(), -0.7, y.get(), z.get());
  N_VDiv(z.get(), y.get(), z.get());
  double c[] = {0.1, 0.0, 1.0, -3.0};
  N_Vector v[] = {x.get(), y.get(), s.home.get(), z.get()};
  N_VLinearCombination(4, c, v, x.get());
  double factors[] = {2.0, 3.0};
  N_Vector from[] = {y.get(), z.get()}, to[] = {y.get(), z.get()};
  N_VScaleAddMulti(2, factors, x.get(), from, to);
  bool same = true;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double x0 = 2.5 * a[i], y0 = x0 - 1.0, z0 = (0.3 * x0 + -0.7 * y0) / y0;
    const double x1 = (0.1 * x0 + a[i]) + -3.0 * z0;
    same = same && bits(values(x.get())[0][i]) == bits(x1) && bits(values(y.get())[0][i]) == bits(2.0 * x1 + y0) &&
           bits(values(z.get())[0][i]) == bits(3.0 * x1 + z0) && bits(s.a[i]) == bits(a[i]);
  }
  BOOST_CHECK(same);
}

BOOST_AUTO_TEST_CASE(copies_are_lazy_but_independent) {
  sample s(MPI_COMM_SELF, 0, 1000);
  const auto a = s.a;
  const vector_handle x = s.clone(), y = s.clone();
  N_VScale(1.0, s.home.get(), x.get());
  BOOST_CHECK_EQUAL(copies_made(x.get()), 1);
  N_VScale(1.0, x.get(), y.get());
  N_VScale(1.0, y.get(), s.home.get());
  BOOST_CHECK_EQUAL(copies_made(x.get()), 1);
  BOOST_CHECK(holds_values_of(s.home.get(), y.get()));

  N_VScale(3.0, y.get(), y.get());  // must not be seen in x
  BOOST_CHECK_EQUAL(values(x.get())[0][7], a[7]);
  BOOST_CHECK_EQUAL(values(y.get())[0][7], 3.0 * a[7]);
  BOOST_CHECK(!holds_values_of(s.home.get(), y.get()));
  N_VScale(1.0, y.get(), s.home.get());
  BOOST_CHECK_EQUAL(s.a[7], 3.0 * a[7]);
  BOOST_CHECK_EQUAL(copies_made(x.get()), 2);

  s.a[7] = -1.0;  // behind the vector's back
  home_was_changed(s.home.get());
  N_VScale(1.0, s.home.get(), x.get());
  BOOST_CHECK_EQUAL(values(x.get())[0][7], -1.0);
  values_to_overwrite(x.get())[0][7] = 5.0;
  BOOST_CHECK_EQUAL(s.a[7], -1.0);
}

BOOST_AUTO_TEST_CASE(the_worst_status_of_any_rank_counts) {
  const int last = rank_of(MPI_COMM_WORLD) == ranks_of(MPI_COMM_WORLD) - 1;
  exception_carrier thrown;
  const auto worst = [&](int status) { return thrown.guard(MPI_COMM_WORLD, [&] { return status; }); };
  BOOST_CHECK_EQUAL(worst(0), 0);
  BOOST_CHECK_EQUAL(worst(last ? 2 : 0), 2);
  BOOST_CHECK_EQUAL(worst(last ? -3 : 4), -3);
  tetsuame::foundation::exact_sum sum;
  sum.add(last ? 1.0 : 1e300);
  sum.add(last ? 0.0 : -1e300);
  double result = 0.0;
  tetsuame::foundation::sum_over_ranks(MPI_COMM_WORLD, {&sum, 1}, {&result, 1});
  BOOST_CHECK_EQUAL(result, 1.0);
}
