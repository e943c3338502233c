// Neighbour lists of particles with supports of their own, a few of them far larger than the others.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <random>
#include <run/supports.hpp>

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

rows listed(const cloud& c, double skin, std::size_t interleave) {
  pairs::workspace<3> w;
  w.s = c.s;
  w.list.interleave = interleave;
  run::make_list<3>(w, c.S, skin, cells::make_grid<3>(c.s.x, c.s.id, c.s.fluid, 2.0));
  rows all(c.s.fluid);
  for (std::size_t r = 0; r < w.list.rows(); ++r)
    w.list.for_each(r, [&](std::uint32_t j, std::uint32_t of_lanes, auto...) {
      for (std::size_t lane = 0; lane < cells::neighbour_list::width; ++lane)
        if ((of_lanes >> lane & 1U) != 0) all[r * cells::neighbour_list::width + lane].push_back(j);
    });
  return all;
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
