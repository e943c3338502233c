// Neighbour lists of particles with supports of their own, a few of them far larger than the others, and of particles
// that are expected to move.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <random>
#include <run/reach.hpp>

using namespace tetsuame;

namespace {

// A cloud of particles some 1 m apart with supports of about 2 m, and some further out with these supports, m.
struct cloud {
  particles::particles<3> s;
  particles::array S;

  cloud(std::size_t near, const std::vector<double>& supports) {
    std::mt19937_64 engine(7);
    const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
    const std::size_t n = near + supports.size();
    particles::allocate(s, n, 0, 0, 0);
    S.assign(n, 0.0);
    const double edge = std::cbrt(static_cast<double>(near));
    for (std::size_t i = 0; i < n; ++i) {
      const double width = i < near ? edge : 2.0 * edge;
      for (std::size_t a = 0; a < 3; ++a) s.x[a][i] = width * uniform() - 0.5 * (width - edge);
      s.id[i] = static_cast<std::int64_t>(i);
      S[i] = i < near ? 1.5 + uniform() : supports[i - near];
    }
    const auto order = cells::make_grid<3>(s.x, s.id, n, 2.0).members;
    particles::array sorted(n);
    for (std::size_t k = 0; k < n; ++k) sorted[k] = S[order[k]];
    S = sorted;
    particles::reorder(s, 0, std::span<const std::uint32_t>(order));
  }
};

using rows = std::vector<std::vector<std::uint32_t>>;

rows rows_of(const pairs::workspace<3>& w) {
  rows all(w.s.fluid);
  for (std::size_t r = 0; r < w.list.rows(); ++r)
    w.list.for_each(r, [&](std::uint32_t j, std::uint32_t of_lanes, auto...) {
      for (std::size_t lane = 0; lane < cells::neighbour_list::width; ++lane)
        if ((of_lanes >> lane & 1U) != 0) all[r * cells::neighbour_list::width + lane].push_back(j);
    });
  return all;
}

rows listed(const cloud& c, double skin, std::size_t interleave) {
  pairs::workspace<3> w;
  w.s = c.s;
  w.list.interleave = interleave;
  run::make_list<3>(w, {c.S, skin}, cells::make_grid<3>(c.s.x, c.s.id, c.s.fluid, 2.0));
  return rows_of(w);
}

// Of all pairs, in the order of the grid.
rows by_all_pairs(const cloud& c, double skin) {
  const auto grid = cells::make_grid<3>(c.s.x, c.s.id, c.s.fluid, 2.0);
  rows all(c.s.fluid);
  for (std::size_t i = 0; i < c.s.fluid; ++i)
    for (const std::uint32_t j : grid.members) {
      double r2 = 0.0;
      for (std::size_t a = 0; a < 3; ++a) r2 += std::pow(c.s.x[a][i] - c.s.x[a][j], 2);
      if (i != j && std::sqrt(r2) < std::max(c.S[i], c.S[j]) + skin) all[i].push_back(j);
    }
  return all;
}

}  // namespace

BOOST_AUTO_TEST_CASE(neighbours_within_the_larger_support) {
  const std::vector<std::vector<double>> outside{
      {}, {30.0}, {4.0, 5.0, 6.0, 9.0, 12.0, 12.0, 12.0, 40.0}, std::vector<double>(400, 7.0)};
  for (const auto& supports : outside) {
    const cloud c(2000, supports);
    BOOST_TEST((listed(c, 0.3, 1) == by_all_pairs(c, 0.3)));
    // Two sequences, side by side: the same neighbours.
    auto two = listed(c, 0.3, 2), all = by_all_pairs(c, 0.3);
    for (auto* some : {&two, &all})
      for (auto& row : *some) std::ranges::sort(row);
    BOOST_TEST((two == all));
  }
}

BOOST_AUTO_TEST_CASE(no_particles) {
  const cloud none(0, {});
  BOOST_TEST(listed(none, 0.3, 1).empty());
}

// Two halves that pass each other and turn, and a few that fly through them: wherever particles go within their ranges,
// those that come near are in the list, which is not that of all pairs.
BOOST_AUTO_TEST_CASE(neighbours_of_what_moves) {
  constexpr double lifetime = 2.0, rest = 0.1;
  cloud c(2000, std::vector<double>(20, 5.0));
  pairs::workspace<3> w;
  w.s = c.s;
  auto& s = w.s;
  const run::list_motion<3> motion{particles::declare_vector<3>(s, "Velocity", "m/s", particles::role::memory),
                                   particles::declare(s, "Range", "m", particles::role::memory)};
  std::mt19937_64 engine(11);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const bool flies = i % 97 == 0;
    motion.range[i] = flies ? 1.5 : 0.05 + 0.1 * uniform();
    motion.velocity[0][i] = (s.x[2][i] > 6.0 ? 0.4 : -0.4) - 0.03 * s.x[1][i] + (flies ? 3.0 : 0.0);
    motion.velocity[1][i] = 0.03 * s.x[0][i];
    motion.velocity[2][i] = flies ? -1.0 : 0.0;
  }
  run::make_list<3>(w, {c.S, rest, &motion, lifetime}, cells::make_grid<3>(s.x, s.id, s.fluid, 2.0));
  auto found = rows_of(w);
  for (auto& row : found) std::ranges::sort(row);
  std::size_t near = 0, in_list = 0;
  for (const auto& row : found) in_list += row.size();
  for (const double time : {0.0, 0.7, lifetime}) {
    auto x = s.x;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      std::array<double, 3> way;
      double length2 = 0.0;
      for (auto& component : way) length2 += std::pow(component = uniform() - 0.5, 2);
      for (std::size_t a = 0; a < 3; ++a)
        x[a][i] += motion.velocity[a][i] * time + motion.range[i] * way[a] / std::sqrt(length2);
    }
    for (std::size_t i = 0; i < s.fluid; ++i)
      for (std::uint32_t j = 0; j < s.fluid; ++j) {
        double r2 = 0.0;
        for (std::size_t a = 0; a < 3; ++a) r2 += std::pow(x[a][i] - x[a][j], 2);
        if (i == j || std::sqrt(r2) >= std::max(c.S[i], c.S[j]) + rest) continue;
        ++near;
        BOOST_TEST_REQUIRE(std::ranges::binary_search(found[i], j));
      }
  }
  BOOST_TEST(near > 3 * 2000 * 10);
  BOOST_TEST(in_list < 2020 * 2019 / 5);
}
