// Values of pairs: commits, rows that follow their particles, faults that are told.
#include <omp.h>

#include <array>
#include <bit>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <particles/partners.hpp>
#include <string>
#include <vector>

using tetsuame::particles::pair_table;
using tetsuame::particles::partners;
using tetsuame::particles::table_of;

namespace {

using ids = std::vector<std::int64_t>;

// What particle i keeps of each partner, in the order of the row.
std::vector<std::pair<std::int64_t, std::vector<double>>> all_of(const partners& p, std::size_t i) {
  std::vector<std::pair<std::int64_t, std::vector<double>>> all;
  const auto row = p.row(i);
  for (std::size_t k = 0; k < row.size(); ++k)
    all.emplace_back(row[k], std::vector<double>(p.values(i, k).begin(), p.values(i, k).end()));
  return all;
}

void set(partners& p, std::size_t i, std::int64_t partner, double first, double second) {
  const auto v = p.insert(i, partner);
  v[0] = first;
  v[1] = second;
}

// Particles 30, 10, 20 with partners 10 and 40, 30, and none.
partners three() {
  partners p(2);
  p.reset(ids{30, 10, 20});
  p.begin();
  set(p, 0, 40, 3.0, -4.0);
  set(p, 1, 30, 5.0, -6.0);
  set(p, 0, 10, 1.0, -2.0);
  p.commit();
  return p;
}

template <class Work>
void check_fault(const std::string& text, Work work) {
  BOOST_CHECK_EXCEPTION(work(), std::logic_error, [&](const std::logic_error& e) {
    BOOST_TEST(e.what() == text);
    return true;
  });
}

}  // namespace

BOOST_AUTO_TEST_CASE(rows_ascend_in_the_partners_id) {
  const auto p = three();
  BOOST_TEST(p.rows() == 3U);
  BOOST_TEST(p.pairs() == 3U);
  BOOST_TEST((all_of(p, 0) == decltype(all_of(p, 0)){{10, {1.0, -2.0}}, {40, {3.0, -4.0}}}));
  BOOST_TEST((all_of(p, 1) == decltype(all_of(p, 0)){{30, {5.0, -6.0}}}));
  BOOST_TEST(p.row(2).empty());
  BOOST_TEST(p.find(0, 40)[1] == -4.0);
  for (const std::int64_t nobody : {-1, 9, 11, 39, 41}) BOOST_TEST(p.find(0, nobody).empty());
  BOOST_TEST(p.find(2, 10).empty());
}

BOOST_AUTO_TEST_CASE(pairs_that_an_evaluation_leaves_out_are_gone) {
  auto p = three();
  p.begin();
  BOOST_TEST(p.is_open());
  const auto kept = p.insert(0, 40);
  BOOST_TEST(kept[0] == 3.0);  // begins with what was committed
  kept[0] = 7.0;
  BOOST_TEST(p.find(0, 40)[0] == 3.0);  // which stays until the next commit
  BOOST_TEST(!p.find(0, 10).empty());
  p.commit();
  BOOST_TEST(!p.is_open());
  BOOST_TEST(p.pairs() == 1U);
  BOOST_TEST((all_of(p, 0) == decltype(all_of(p, 0)){{40, {7.0, -4.0}}}));
  BOOST_TEST(p.find(0, 10).empty());
  // One that returns starts anew.
  p.begin();
  const auto again = p.insert(0, 10);
  BOOST_TEST(again[0] == 0.0);
  BOOST_TEST(again[1] == 0.0);
  p.commit();
  BOOST_TEST((all_of(p, 0) == decltype(all_of(p, 0)){{10, {0.0, 0.0}}}));
}

// The stages of a step, or a step that is made again with half its length, all start from the last commit.
BOOST_AUTO_TEST_CASE(evaluations_start_from_the_last_commit) {
  auto p = three();
  for (int stage = 0; stage < 3; ++stage) {
    p.begin();
    p.insert(0, 10)[0] += 1.0;
    p.insert(2, 50)[0] += 1.0;
  }
  p.commit();
  BOOST_TEST(p.find(0, 10)[0] == 2.0);
  BOOST_TEST(p.find(2, 50)[0] == 1.0);
  p.begin();
  p.insert(0, 10)[0] += 1.0;
  p.discard();
  BOOST_TEST(p.find(0, 10)[0] == 2.0);
  BOOST_TEST(p.pairs() == 2U);
}

BOOST_AUTO_TEST_CASE(rows_follow_the_particles) {
  const auto before = three();
  const auto check = [&](const partners& p, const ids& owners) {
    BOOST_TEST_REQUIRE(p.rows() == owners.size());
    BOOST_CHECK_NO_THROW(p.require_rows_of(owners));
    for (std::size_t i = 0; i < owners.size(); ++i) {
      const std::size_t was = owners[i] == 30 ? 0 : owners[i] == 10 ? 1 : 2;
      BOOST_TEST((all_of(p, i) == all_of(before, was)));
    }
  };
  auto p = before;
  p.reorder(std::array<std::uint32_t, 3>{2, 0, 1});
  check(p, {20, 30, 10});
  p.arrange(ids{10, 20, 30});
  check(p, {10, 20, 30});
  // A row that is left out is gone.
  p.reorder(std::array<std::uint32_t, 2>{2, 1});
  check(p, {30, 20});
  BOOST_TEST(p.pairs() == 2U);
  p.append(10);
  BOOST_TEST(p.row(2).empty());
  BOOST_TEST(p.owners()[2] == 10);
}

// Rows of all lengths, one behind the other, with bits that arithmetic would change.
BOOST_AUTO_TEST_CASE(packed_rows_keep_all_bits) {
  partners from(1), to(1);
  const std::array<double, 5> odd{-0.0, 5e-324, std::numeric_limits<double>::quiet_NaN(), 1.0 / 3.0,
                                  -std::numeric_limits<double>::infinity()};
  const auto highest = std::numeric_limits<std::int64_t>::max();
  from.reset(ids{0, 1, highest});
  from.begin();
  for (std::size_t k = 0; k < odd.size(); ++k) from.insert(1, highest - static_cast<std::int64_t>(k))[0] = odd[k];
  from.insert(2, 0)[0] = 1.0;
  from.commit();
  std::vector<double> packed{17.0};
  for (std::size_t i = 0; i < 3; ++i) from.pack(i, packed);
  const double* at = packed.data() + 1;
  for (std::size_t i = 0; i < 3; ++i) at = to.append(from.owners()[i], at);
  BOOST_TEST((at == packed.data() + packed.size()));
  BOOST_CHECK_NO_THROW(to.require_rows_of(from.owners()));
  for (std::size_t i = 0; i < 3; ++i) {
    BOOST_TEST_REQUIRE(from.row(i).size() == to.row(i).size());
    for (std::size_t k = 0; k < to.row(i).size(); ++k) {
      BOOST_TEST(from.row(i)[k] == to.row(i)[k]);
      BOOST_TEST(std::bit_cast<std::uint64_t>(from.values(i, k)[0]) ==
                 std::bit_cast<std::uint64_t>(to.values(i, k)[0]));
    }
  }
}

// So many rows that threads share them, inserted in two orders.
BOOST_AUTO_TEST_CASE(neither_threads_nor_the_order_of_insertion_matter) {
  const std::size_t n = 3 * tetsuame::foundation::values_worth_threads;
  ids owners(n);
  for (std::size_t i = 0; i < n; ++i) owners[i] = static_cast<std::int64_t>(7 * i);
  const auto make = [&](int threads, bool backwards) {
    const int before = omp_get_max_threads();
    omp_set_num_threads(threads);
    partners p(2);
    p.reset(owners);
    for (int step = 0; step < 3; ++step) {
      p.begin();
#pragma omp parallel for schedule(static)
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t k = 0; k < i % 5; ++k) {
          const auto j = static_cast<std::int64_t>(backwards ? i % 5 - 1 - k : k);
          p.insert(i, 1000 - 3 * j)[0] += 0.1 * static_cast<double>(j + step);
        }
      p.commit();
    }
    omp_set_num_threads(before);
    return p;
  };
  const auto one = make(1, false), other = make(3, true);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < n; ++i) wrong += all_of(one, i) != all_of(other, i) || one.row(i).size() != i % 5;
  BOOST_TEST(wrong == 0U);
}

BOOST_AUTO_TEST_CASE(tables_number_the_pairs) {
  const auto t = table_of(three(), 4);
  BOOST_TEST((t.owner == ids{30, 30, 10}));
  BOOST_TEST((t.partner == ids{10, 40, 30}));
  BOOST_TEST((t.ids == ids{120, 121, 40}));
  BOOST_TEST((t.values == std::vector<std::vector<double>>{{1.0, 3.0, 5.0}, {-2.0, -4.0, -6.0}}));
  BOOST_CHECK_THROW(table_of(three(), std::numeric_limits<std::int64_t>::max() / 20), std::overflow_error);
}

BOOST_AUTO_TEST_CASE(misuse_is_told_and_changes_nothing) {
  auto p = three();
  check_fault("a pair needs at least one value", [] { partners none(0); });
  check_fault("particle 5 is there twice", [] { partners(1).reset(ids{5, 6, 5}); });
  check_fault("values of pairs are inserted between begin() and commit()", [&] { p.insert(0, 1); });
  check_fault("commit() of values of pairs without begin()", [&] { p.commit(); });
  check_fault("an order of rows of partners names row 3 of 3", [&] { p.reorder(std::array<std::uint32_t, 2>{0, 3}); });
  check_fault("an order of rows of partners names that of particle 10 twice", [&] {
    p.reorder(std::array<std::uint32_t, 3>{0, 1, 1});
  });
  check_fault("particle 11 has no row of partners here", [&] { p.arrange(ids{10, 11, 20, 30}); });
  check_fault("particle 40 has no row of partners here", [&] { p.arrange(ids{10, 20, 30, 40}); });
  check_fault("particle 20 has a row of partners here, but is not among the particles", [&] {
    p.arrange(ids{10, 30});
  });
  check_fault("particle 30 has a row of partners here, but is not among the particles", [&] {
    p.arrange(ids{10, 20});
  });
  check_fault("particle 10 is there twice", [&] { p.arrange(ids{10, 30, 10}); });
  check_fault("there are 3 rows of partners for 2 particles", [&] { p.require_rows_of(ids{30, 10}); });
  check_fault(
      "row 1 of the partners is of particle 10, and the particle there is 20: rows were not reordered with the "
      "particles",
      [&] {
        p.require_rows_of(ids{30, 20, 10});
      });
  p.begin();
  check_fault("particle 3 has no row of partners: there are 3", [&] { p.insert(3, 1); });
  for (const std::int64_t partner : {40, 10, 40}) p.insert(0, partner);
  check_fault("particle 30 has partner 40 twice", [&] { p.commit(); });
  const std::string amid = " amid an evaluation: commit or discard what was inserted first";
  check_fault("partners are reordered" + amid, [&] { p.reorder(std::array<std::uint32_t, 3>{2, 0, 1}); });
  check_fault("partners are given new rows" + amid, [&] { p.append(50); });
  check_fault("partners are handed on" + amid, [&] { p.require_rows_of(ids{30, 10, 20}); });
  p.discard();
  for (std::size_t i = 0; i < 3; ++i) BOOST_TEST((all_of(p, i) == all_of(three(), i)));
  BOOST_CHECK_NO_THROW(p.require_rows_of(ids{30, 10, 20}));
}
