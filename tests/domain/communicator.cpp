// What ranks agree on: faults, sums and the largest of all.
#include <domain/communicator.hpp>

#include "../support/scene.hpp"

using namespace tetsuame;
using namespace tetsuame::test;

BOOST_AUTO_TEST_CASE(all_ranks_throw_the_fault_of_the_lowest_particle) {
  const auto world = domain::communicator::world();
  using enum foundation::exit_status;
  BOOST_CHECK_NO_THROW(world.agree_on_fault(world.rank, "", calculation_failed));
  const auto told = [](const std::string& text, foundation::exit_status status) {
    return [=](const foundation::error& e) { return e.what() == text && e.status() == status; };
  };
  // Falling IDs: the last rank knows the lowest; the text's length differs from rank to rank.
  const auto mine =
      "fault of " + std::to_string(1000 - world.rank) + std::string(static_cast<std::size_t>(world.rank), '!');
  const auto its =
      "fault of " + std::to_string(1001 - world.size) + std::string(static_cast<std::size_t>(world.size - 1), '!');
  BOOST_CHECK_EXCEPTION(world.agree_on_fault(1000 - world.rank, mine, calculation_failed), foundation::error,
                        told(its, calculation_failed));
  // Only one rank saw anything.
  const bool last = world.rank + 1 == world.size;
  BOOST_CHECK_EXCEPTION(world.agree_on_fault(3, last ? "alone" : "", last ? file_failed : completed), foundation::error,
                        told("alone", file_failed));
  // Two ranks saw the same particle: the first speaks.
  BOOST_CHECK_EXCEPTION(world.agree_on_fault(3, "rank " + std::to_string(world.rank), bad_input), foundation::error,
                        told("rank 0", bad_input));
}

template <class T>
concept adds = requires(const domain::communicator& c, T value) {
  c.sum(value);
};

BOOST_AUTO_TEST_CASE(reductions) {
  static_assert(adds<int> && adds<std::int64_t> && adds<std::span<double>> && !adds<double> && !adds<float>);
  const auto world = domain::communicator::world();
  BOOST_TEST(world.maximum(world.rank) == world.size - 1);
  BOOST_TEST(world.minimum(-world.rank) == 1 - world.size);
  BOOST_TEST(world.sum(world.rank) == world.size * (world.size - 1) / 2);
  // Signs, infinities and what is smallest come out bit by bit.
  constexpr double infinity = std::numeric_limits<double>::infinity(), tiny = 5e-324;
  const bool first = world.rank == 0;
  for (const double x : {-infinity, -1e300, -1.0, -tiny, tiny, 1.0, 1e300, infinity}) {
    BOOST_TEST(bits(world.maximum(first ? x : -infinity)) == bits(x));
    BOOST_TEST(bits(world.minimum(first ? x : infinity)) == bits(x));
  }
  // NaN on one rank, whichever, comes out on all.
  for (int lost = 0; lost < world.size; ++lost) {
    const double mine = world.rank == lost ? -std::nan("") : 1.0 + world.rank;
    BOOST_TEST(std::isnan(world.maximum(mine)));
    BOOST_TEST(std::isnan(world.minimum(mine)));
    std::array<double, 2> both{mine, 1.0 + world.rank};
    world.maximum(both);
    BOOST_TEST(std::isnan(both[0]));
    BOOST_TEST(both[1] == world.size);
  }
  const auto every = world.every(10.0 + world.rank);
  for (int r = 0; r < world.size; ++r) BOOST_TEST(every[static_cast<std::size_t>(r)] == 10.0 + r);
  BOOST_TEST(world.broadcast(world.rank == 0 ? "text" : "") == "text");
  foundation::exact_sum here, all;
  for (std::int64_t k = 0; k < 1000; ++k) {
    const double term = std::ldexp(noise(k, 1), static_cast<int>(k % 120));
    if (k % world.size == world.rank) here.add(term);
    all.add(term);
  }
  BOOST_TEST(bits(world.exact(here)) == bits(all.value()));
}
