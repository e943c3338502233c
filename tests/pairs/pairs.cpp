// The pair loop against a plain double loop over all particles, for every kernel.
#include <omp.h>
#include <liquid/passes.hpp>

#include "../support/scene.hpp"

using namespace tetsuame;
using namespace tetsuame::test;

namespace {

// Σ_j f_j W_ij and Σ_j (f_i - f_j) ∇_i W_ij: everything a pair offers.
template <int D>
struct probe {
  const double* f;
  double* scalar;
  std::array<double*, D> vector;

  template <class R>
  struct me {
    R f, scalar;
    pairs::vec<R, D> vector;
  };
  template <class R>
  me<R> begin(const pairs::cluster<R>& i) const {
    return {i(f), R(0.0), foundation::zero<R, D>()};
  }
  auto reads() const { return std::tuple{pairs::read(pairs::of_weight, f)}; }
  void add(auto& a, const auto& ij) const {
    const auto f_j = ij(pairs::of_weight);
    a.scalar += f_j * ij.W;
    a.vector += (a.f - f_j) * ij.gradient();
  }
  void end(const auto& i, const auto& a) const {
    i.set(scalar, a.scalar, -D);
    for (std::size_t k = 0; k < D; ++k) i.set(vector[k], a.vector[k], -D - 1);
  }
};

template <int D>
struct result {
  particles::array scalar;
  std::array<particles::array, D> vector;
  explicit result(std::size_t n) : scalar(n) { vector.fill(particles::array(n)); }
  probe<D> of(const particles::array& f) {
    probe<D> p{f.data(), scalar.data(), {}};
    for (std::size_t k = 0; k < D; ++k) p.vector[k] = vector[k].data();
    return p;
  }
};

// Against all particles, one after the other.
template <int D>
void check_values(const pairs::workspace<D>& w, const result<D>& is) {
  const auto& s = w.s;
  // Some 150 terms in two orders, each rounded a few times, the kernel's polynomial included: 100 ε of the absolute sum
  // leaves a wide margin, and a missing or doubled neighbour is far beyond it.
  const double error =
      100.0 * (w.single_pairs() ? static_cast<double>(std::numeric_limits<float>::epsilon()) : epsilon);
  std::visit(
      [&](const auto& k) {
        for (std::size_t i = 0; i < s.fluid; ++i) {
          double scalar = 0.0, scalar_size = 0.0;
          std::array<double, D> vector{}, vector_size{};
          neighbours_of<D>(w, i, [&](std::size_t j, const std::array<double, D>& x_ij, double r) {
            scalar += s.T[j] * k.value(r);
            scalar_size += std::abs(s.T[j] * k.value(r));
            for (std::size_t a = 0; a < D; ++a) {
              vector[a] += (s.T[i] - s.T[j]) * k.gradient_over_r(r) * x_ij[a];
              vector_size[a] += std::abs((s.T[i] - s.T[j]) * k.gradient_over_r(r) * x_ij[a]);
            }
          });
          BOOST_TEST(std::abs(is.scalar[i] - scalar) <= error * scalar_size);
          for (std::size_t a = 0; a < D; ++a)
            BOOST_TEST(std::abs(is.vector[a][i] - vector[a]) <= error * vector_size[a]);
        }
      },
      w.kernel);
}

template <int D>
void check_kernel(const std::string& kernel, std::array<std::int64_t, D> n, const std::string& precision = "double") {
  auto of = box<D>(n, true, "none", kernel);
  of.kernel.precision = precision;
  auto scene = make_scene<D>(of, domain::communicator::world(), 0.4);
  auto& w = scene.w;
  auto& s = w.s;
  randomise<D>(w, s.T, 1, -1.0, 1.0);
  result<D> is(s.fluid);
  w.sum(w.fluid(), is.of(s.T));
  check_values(w, is);

  // Threads share out particles, never a sum.
  omp_set_num_threads(2);
  result<D> again(s.fluid);
  w.sum(w.fluid(), again.of(s.T));
  omp_set_num_threads(1);
  const auto same = [](const particles::array& a, const particles::array& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) { return bits(x) == bits(y); });
  };
  BOOST_TEST(same(again.scalar, is.scalar));

  // In layers, whatever the records held before: here particles on top of the last one.
  const auto spoil = [&] {
    std::fill(w.list.records.doubles.begin(), w.list.records.doubles.end(), s.x[0][s.fluid - 1]);
    std::fill(w.list.records.singles.begin(), w.list.records.singles.end(), 1.0F);
  };
  result<D> layers(s.fluid);
  spoil();
  w.sum(w.interior(), layers.of(s.T));
  spoil();
  w.sum(w.at_border(), layers.of(s.T));
  BOOST_TEST(same(layers.scalar, is.scalar));
  for (std::size_t a = 0; a < D; ++a) BOOST_TEST(same(layers.vector[a], is.vector[a]));
  for (std::size_t a = 0; a < D; ++a) BOOST_TEST(same(again.vector[a], is.vector[a]));

  // The same bits as one rank alone gives.
  auto single = make_scene<D>(of, alone(), 0.4);
  randomise<D>(single.w, single.w.s.T, 1, -1.0, 1.0);
  result<D> lone(single.w.s.fluid);
  single.w.sum(single.w.fluid(), lone.of(single.w.s.T));
  BOOST_TEST(same_bits(fluid_by_id(scene, is.scalar), fluid_by_id(single, lone.scalar)));
  for (std::size_t a = 0; a < D; ++a)
    BOOST_TEST(same_bits(fluid_by_id(scene, is.vector[a]), fluid_by_id(single, lone.vector[a])));
}

}  // namespace

BOOST_AUTO_TEST_CASE(plane) {
  for (const auto& line : kernels::table)
    for (const std::string precision : {"double", "single"}) BOOST_TEST_CONTEXT(line.name << ", " << precision)
  check_kernel<2>(std::string(line.name), {16, 11}, precision);
}

BOOST_AUTO_TEST_CASE(space) {
  for (const auto& line : kernels::table)
    for (const std::string precision : {"double", "single"}) BOOST_TEST_CONTEXT(line.name << ", " << precision)
  check_kernel<3>(std::string(line.name), {11, 11, 11}, precision);
}

// Single precision: what i has of j and j of i cancel to the bit, and a scale that is a power of two, whatever its
// size, changes no bit of a sum.
BOOST_AUTO_TEST_CASE(single_pairs_cancel_at_any_scale) {
  const auto sums_of = [](double scale) {
    auto of = box<3>({11, 11, 11}, true);
    of.kernel.precision = "single";
    for (double& length : of.domain.length) length *= scale;
    auto scene = make_scene<3>(of, alone(), 0.4);
    randomise<3>(scene.w, scene.w.s.T, 1, -1.0, 1.0);
    result<3> is(scene.w.s.fluid);
    scene.w.sum(scene.w.fluid(), is.of(scene.w.s.T));
    return fluid_by_id(scene, is.vector[1]);
  };
  const auto plain = sums_of(1.0);
  for (const int exponent : {-40, 31}) {
    const double scale = std::ldexp(1.0, exponent);
    auto scaled = sums_of(scale);
    for (double& value : scaled) value *= scale * scale * scale * scale;  // of ∇W
    BOOST_TEST(same_bits(plain, scaled));
  }

  // Two particles alone: each other's only neighbour, at a distance that no float of the box's size has.
  auto of = box<3>({11, 11, 11}, false);
  of.kernel.precision = "single";
  auto scene = make_scene<3>(of, alone(), [](std::int64_t id, std::array<double, 3> x) {
    if (id == 0) x = {5.123456789012345, 5.0, 5.0};
    if (id == 1) x = {5.123456789012345 + 0.7071067811865, 5.1, 4.9};
    if (id > 1) x = {1.0 + 1e-3 * static_cast<double>(id), 1.0, 10.0};
    return x;
  });
  auto& s = scene.w.s;
  for (std::size_t i = 0; i < s.total(); ++i) s.T[i] = s.id[i] == 0 ? 1.0 : s.id[i] == 1 ? 2.0 : 0.0;
  result<3> is(s.fluid);
  scene.w.sum(scene.w.fluid(), is.of(s.T));
  for (std::size_t a = 0; a < 3; ++a) {
    const auto force = fluid_by_id(scene, is.vector[a]);
    BOOST_TEST(force[0] != 0.0);
    BOOST_TEST(bits(force[0]) == bits(force[1]));  // (f_i - f_j) ∇_i W_ij changes its sign twice
  }
}

// Any subset of rows, and a sum over no rows.
BOOST_AUTO_TEST_CASE(chosen_rows_alone_are_written) {
  for (const std::string precision : {"double", "single"}) {
    auto of = box<2>({16, 10}, true);
    of.kernel.precision = precision;
    auto scene = make_scene<2>(of, alone(), 0.4);
    auto& s = scene.w.s;
    randomise<2>(scene.w, s.T, 1, -1.0, 1.0);
    result<2> all(s.fluid), some(s.fluid);
    std::fill(some.scalar.begin(), some.scalar.end(), -7.0);
    const std::vector<std::size_t> rows{3, 17, 5}, none;
    scene.w.sum(scene.w.fluid(), all.of(s.T));
    scene.w.sum(pairs::choose(scene.w.list, rows, s.total()), some.of(s.T));
    scene.w.sum(pairs::choose(scene.w.list, none, s.total()), some.of(s.T));
    for (std::size_t i = 0; i < s.fluid; ++i)
      BOOST_TEST(some.scalar[i] == (std::find(rows.begin(), rows.end(), i) != rows.end() ? all.scalar[i] : -7.0));
  }
}

BOOST_AUTO_TEST_CASE(the_first_fault_is_that_of_the_lowest_id) {
  pairs::fault f;
  f.report(7, "seven");
  f.report(9, "nine");
  f.report(7, "seven again");
  BOOST_TEST(f.message == "seven");
  f.report(2, "two");
  BOOST_TEST(f.message == "two");
  BOOST_TEST(f.key == 2);
  ++f.stage;  // what a later stage sees may follow from it
  f.report(1, "one, later");
  BOOST_TEST(f.message == "two");
}

BOOST_AUTO_TEST_CASE(rows_that_need_no_ghosts) {
  const std::array<std::int64_t, 2> n{84, 42};
  const auto scene = make_scene<2>(box<2>(n, true), domain::communicator::world(), 0.4);
  const auto& w = scene.w;
  BOOST_TEST((w.border > 0) == (w.d.ranks.size > 1));
  BOOST_TEST((w.core > 0) == (w.d.ranks.size > 1));
  BOOST_TEST(w.border % pairs::lanes == 0U);
  for (std::size_t r = 0; r < w.list.rows(); ++r)
    w.list.for_each(r, [&](std::size_t j, auto...) {
      const std::size_t i = r * pairs::lanes;
      BOOST_TEST((i >= w.border || j < w.s.fluid));
      BOOST_TEST((i < w.border || j >= w.core));
    });
  check_kernel<2>("quintic", n);
}
