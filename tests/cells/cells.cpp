// Grids and neighbour lists against a search through all particles and their images.
#include <liquid/passes.hpp>

#include "../support/scene.hpp"

using namespace tetsuame;
using namespace tetsuame::test;

namespace {

template <int D>
struct point {
  std::array<double, D> x;
  std::int64_t id;
};

// All fluid and wall particles of all ranks, and their images over periodic borders: positions are
// the sums the halo makes, so everything below holds bit by bit.
template <int D>
std::vector<point<D>> all_with_images(const hydrostatic::scene<D>& scene) {
  const auto& s = scene.w.s;
  std::vector<point<D>> all;
  const auto gather = [&](std::size_t begin, std::size_t n) {
    std::vector<double> mine;
    for (std::size_t i = begin; i < begin + n; ++i) {
      for (std::size_t a = 0; a < D; ++a) mine.push_back(s.x[a][i]);
      mine.push_back(static_cast<double>(s.id[i]));
    }
    const auto rows = of_all_ranks(scene.w.d.ranks, mine);
    for (std::size_t k = 0; k < rows.size(); k += D + 1) {
      point<D> p;
      for (std::size_t a = 0; a < D; ++a) p.x[a] = rows[k + a];
      p.id = static_cast<std::int64_t>(rows[k + D]);
      all.push_back(p);
    }
  };
  gather(0, s.fluid);
  gather(s.first_wall(), s.walls);
  const auto& region = scene.w.d.region;
  for (std::size_t a = 0; a < D; ++a) {
    if (!region.periodic[a]) continue;
    const std::size_t n = all.size();
    for (std::size_t k = 0; k < n; ++k)
      for (const double shift : {-region.length[a], region.length[a]}) {
        all.push_back(all[k]);
        all.back().x[a] += shift;
      }
  }
  return all;
}

// In single precision: the first of two sequences on black squares (cubes) of half a cell's edge, the second on white.
template <int D>
std::size_t sequence_of(const std::array<double, D>& x, double edge) {
  double square = 0.0;
  for (const double c : x) square += std::floor(2.0 * c / edge);
  return std::fmod(square, 2.0) != 0.0 ? 1 : 0;
}

using sequences = std::array<std::vector<std::int64_t>, 2>;

// IDs of the neighbours of a point in the order of the lists: by cell along the axes, then along the
// last axis, then ID; in one sequence or two.
template <int D>
sequences expected(const std::vector<point<D>>& all, const point<D>& centre, double reach, double edge,
                   std::size_t interleave) {
  std::vector<std::tuple<std::array<double, D>, double, std::int64_t, std::size_t>> found;
  for (const auto& p : all) {
    double r2 = 0.0;
    std::array<double, D> cell;
    for (std::size_t a = 0; a < D; ++a) {
      r2 += (centre.x[a] - p.x[a]) * (centre.x[a] - p.x[a]);
      cell[a] = std::floor(p.x[a] / edge);
    }
    if (r2 < reach * reach && !(p.id == centre.id && r2 == 0.0))
      found.emplace_back(cell, p.x[D - 1], p.id, interleave > 1 ? sequence_of<D>(p.x, edge) : 0);
  }
  std::sort(found.begin(), found.end());
  sequences ids;
  for (const auto& f : found) ids[std::get<3>(f)].push_back(std::get<2>(f));
  return ids;
}

template <int D>
void check_lists(const hydrostatic::scene<D>& scene) {
  const auto& w = scene.w;
  const auto& s = w.s;
  const auto all = all_with_images<D>(scene);
  const double reach = w.support() + scene.skin;
  BOOST_REQUIRE(w.d.ranks.sum(static_cast<std::int64_t>(s.fluid)) == scene.fluid_total);
  constexpr std::size_t width = cells::neighbour_list::width;
  const double edge = cells::cell_edge(1.0);
  BOOST_REQUIRE(w.list.rows() == (s.fluid + width - 1) / width);
  std::size_t pairs = 0, wrong = 0;
  for (std::size_t r = 0; r < w.list.rows(); ++r) {
    // Of each lane, one sequence after the other.
    std::vector<sequences> is(width);
    w.list.for_each(r, [&](std::uint32_t j, std::uint32_t of_lanes, auto...) {
      wrong += of_lanes == 0;
      const std::size_t sequence = w.list.interleave > 1 ? sequence_of<D>(cells::position<D>(s.x, j), edge) : 0;
      for (std::size_t lane = 0; lane < width; ++lane)
        if ((of_lanes >> lane & 1U) != 0) is[lane][sequence].push_back(s.id[j]);
    });
    for (std::size_t lane = 0; lane < width; ++lane) {
      const std::size_t i = r * width + lane;
      const auto should = i < s.fluid
                              ? expected<D>(all, {cells::position<D>(s.x, i), s.id[i]}, reach, edge, w.list.interleave)
                              : sequences{};
      wrong += is[lane] != should;
      pairs += should[0].size() + should[1].size();
    }
  }
  BOOST_TEST(wrong == 0U);
  BOOST_TEST(w.list.pairs == pairs);
}

}  // namespace

BOOST_AUTO_TEST_CASE(lists_on_the_lattice_and_jittered) {
  for (const std::string precision : {"double", "single"})
    for (const bool periodic : {true, false})
      for (const double jitter : {0.0, 0.4}) {
        auto plane = box<2>({16, 9}, periodic);
        auto space = box<3>({12, 6, 6}, periodic, "none", "wendland_c2");
        plane.kernel.precision = space.kernel.precision = precision;
        check_lists<2>(make_scene<2>(plane, domain::communicator::world(), jitter));
        check_lists<3>(make_scene<3>(space, domain::communicator::world(), jitter));
      }
}

BOOST_AUTO_TEST_CASE(lists_with_walls) {
  auto o = box<2>({16, 8}, false, "frozen");
  check_lists<2>(make_scene<2>(o, domain::communicator::world(), 0.3));
  o.domain.periodic[0] = true;
  check_lists<2>(make_scene<2>(o, domain::communicator::world(), 0.3));
}

// Most particles in a corner, far from equal numbers a cell or a rank.
BOOST_AUTO_TEST_CASE(lists_of_a_cluster) {
  for (const bool periodic : {true, false})
    check_lists<2>(make_scene<2>(box<2>({16, 16}, periodic), domain::communicator::world(),
                                 [](std::int64_t, std::array<double, 2> x) {
                                   for (double& c : x) c = 16.0 * std::pow(c / 16.0, 4);
                                   return x;
                                 }));
}

// Cells hold each particle once, in their bounds, in order; negative coordinates and far-off ones too.
BOOST_AUTO_TEST_CASE(grid_sorts_by_cell_and_place) {
  constexpr std::size_t n = 500;
  std::array<particles::array, 2> x;
  std::vector<std::int64_t> id;
  for (std::size_t i = 0; i < n; ++i) {
    x[0].push_back(7.0 * noise(static_cast<std::int64_t>(i), 1));
    x[1].push_back(3.0 * noise(static_cast<std::int64_t>(i), 2) - 40.0);
    id.push_back(static_cast<std::int64_t>((i * 77) % n));
  }
  const double size = 0.9;
  const auto g = cells::make_grid<2>(x, id, n, size);
  BOOST_REQUIRE(g.members.size() == n);
  std::vector<std::array<double, 4>> order;
  std::vector<int> seen(n, 0);
  for (const auto i : g.members) {
    ++seen[i];
    order.push_back({std::floor(x[0][i] / size), std::floor(x[1][i] / size), x[1][i], static_cast<double>(id[i])});
  }
  BOOST_TEST(std::count(seen.begin(), seen.end(), 1) == static_cast<std::ptrdiff_t>(n));
  BOOST_TEST(std::is_sorted(order.begin(), order.end()));
}

// A cloud about the origin, the last particles of it far away on each side: nearer to each other than they are to it.
template <int D>
std::pair<std::array<particles::array, D>, std::vector<std::int64_t>> cloud_with_ejecta(std::size_t n, double far) {
  std::array<particles::array, D> x;
  std::vector<std::int64_t> id;
  for (std::size_t i = 0; i < n; ++i) {
    id.push_back(static_cast<std::int64_t>(i));
    for (std::size_t a = 0; a < D; ++a) {
      const double here = 5.0 * noise(id.back(), 20 + a);
      x[a].push_back(i + 6 < n || far == 0.0 ? here : (i % 2 == 0 ? far : -far) + 0.1 * here);
    }
  }
  return {x, id};
}

// IDs in the order of the neighbours, a row for each particle.
template <int D>
std::vector<std::vector<std::int64_t>> neighbours_of(const std::array<particles::array, D>& x,
                                                     const std::vector<std::int64_t>& id, double reach) {
  const auto g = cells::make_grid<D>(x, id, id.size(), 1.0);
  std::array<particles::array, D> ordered;
  std::vector<std::int64_t> ids;
  for (const std::uint32_t i : g.members) {
    ids.push_back(id[i]);
    for (std::size_t a = 0; a < D; ++a) ordered[a].push_back(x[a][i]);
  }
  const auto again = cells::make_grid<D>(ordered, ids, ids.size(), 1.0);
  cells::neighbour_list list;
  cells::make_list<D>(list, again, ordered, ids.size(), cells::one_reach{reach});
  std::vector<std::vector<std::int64_t>> rows(id.size());
  for (std::size_t r = 0; r < list.rows(); ++r)
    list.for_each(r, [&](std::uint32_t j, std::uint32_t of_lanes, auto...) {
      for (std::size_t lane = 0; lane < cells::neighbour_list::width; ++lane)
        if ((of_lanes >> lane & 1U) != 0)
          rows[static_cast<std::size_t>(ids[r * cells::neighbour_list::width + lane])].push_back(ids[j]);
    });
  return rows;
}

// Particles a million spacings away cost as many cells as they are, and leave the rows of all others as they were.
BOOST_AUTO_TEST_CASE(cells_of_a_cloud_with_ejecta) {
  constexpr std::size_t n = 3000;
  const auto check = [&]<int D>(std::integral_constant<int, D>) {
    const auto [near, id] = cloud_with_ejecta<D>(n, 0.0);
    const auto [x, same_id] = cloud_with_ejecta<D>(n, 1e6);
    const auto g = cells::make_grid<D>(x, id, n, 1.0);
    BOOST_TEST(g.sparse);
    BOOST_TEST(g.cells() <= n);
    BOOST_TEST(!(cells::make_grid<D>(near, id, n, 1.0).sparse));
    for (const double reach : {0.7, 2.5}) {
      const auto rows = neighbours_of<D>(x, id, reach), whole = neighbours_of<D>(near, id, reach);
      std::size_t wrong = 0, far_pairs = 0;
      for (std::size_t i = 0; i < n; ++i) {
        std::vector<std::int64_t> should;
        if (i + 6 < n) {
          for (const auto j : whole[i])
            if (j + 6 < static_cast<std::int64_t>(n)) should.push_back(j);
        } else {
          far_pairs += rows[i].size();
          should = rows[i];
          for (const auto j : should)
            wrong += j + 6 < static_cast<std::int64_t>(n) || (j - static_cast<std::int64_t>(i)) % 2 != 0;
        }
        wrong += rows[i] != should;
      }
      BOOST_TEST(wrong == 0U);
      BOOST_TEST(far_pairs > 0U);
    }
  };
  check(std::integral_constant<int, 2>{});
  check(std::integral_constant<int, 3>{});
}

// Particles of every density at once: rows of cells with gaps of all lengths, and cells by themselves, beside those of
// a box that is full, in the same order.
BOOST_AUTO_TEST_CASE(sparse_cells_with_gaps_of_all_lengths) {
  constexpr std::size_t n = 4000;
  const auto check = [&]<int D>(std::integral_constant<int, D>) {
    constexpr double extent = D == 1 ? 4000.0 : D == 2 ? 80.0 : 16.0;
    std::array<particles::array, D> x;
    std::vector<std::int64_t> id;
    for (std::size_t i = 0; i < n; ++i) {
      id.push_back(static_cast<std::int64_t>((i * 77) % n));
      for (std::size_t a = 0; a < D; ++a) x[a].push_back(extent * std::pow(noise(id.back(), 40 + a), 5.0));
    }
    const auto same = [&](const auto& all, const auto& some) {
      BOOST_TEST(some.members == all.members, boost::test_tools::per_element());
      std::size_t wrong = 0;
      for (std::size_t k = 0; k < n; ++k) {
        const auto c = all.cell(cells::position<D>(x, k));
        const std::size_t in_all = all.stored(c), in_some = some.stored(c);
        wrong += in_some == cells::no_cell || all.start[in_all] != some.start[in_some] ||
                 all.start[in_all + 1] != some.start[in_some + 1] || some.cell_of_members(in_some) != c;
      }
      BOOST_TEST(wrong == 0U);
    };
    const auto all = cells::make_grid<D>(x, id, n, 1.0);
    BOOST_REQUIRE(!all.sparse);
    cells::grid<D> some = all;
    some.start.clear();
    some.sparse = true;
    cells::detail::store_sparsely<D>(some, x, n);
    BOOST_TEST(some.cells() < all.cells());
    // As they are sorted within the cells of `all`.
    for (std::size_t c = 0; c + 1 < some.start.size(); ++c)
      std::sort(some.members.begin() + some.start[c], some.members.begin() + some.start[c + 1],
                [&](std::uint32_t i, std::uint32_t j) {
                  return std::pair(x[D - 1][i], id[i]) < std::pair(x[D - 1][j], id[j]);
                });
    same(all, some);
    // Places between the cells, outside all of them, and stretches about boxes of all sizes.
    std::size_t wrong = 0;
    for (std::int64_t k = 0; k < 2000; ++k) {
      std::array<double, D> low, high;
      for (std::size_t a = 0; a < D; ++a) {
        low[a] = 1.2 * extent * noise(k, 50 + a);
        high[a] = low[a] + 3.0 * std::abs(noise(k, 60 + a));
      }
      const double reach = 20.0 * std::pow(std::abs(noise(k, 70)), 3);
      const auto found = [&](const auto& g) {
        std::vector<std::uint32_t> within;
        cells::for_each_near<D>(g, low, high, reach, [&](std::uint32_t at, std::uint64_t near) {
          for (std::uint32_t bit = 0; bit < 64; ++bit)
            if ((near >> bit & 1U) != 0) within.push_back(at + bit);
        });
        return within;
      };
      wrong += found(all) != found(some);
      const auto c = all.cell(low);
      const auto in_all = all.stored(c), in_some = some.stored(c);
      const bool there = in_all != cells::no_cell && all.start[in_all] != all.start[in_all + 1];
      wrong += there != (in_some != cells::no_cell && some.start[in_some] != some.start[in_some + 1]);
    }
    BOOST_TEST(wrong == 0U);
  };
  check(std::integral_constant<int, 1>{});
  check(std::integral_constant<int, 2>{});
  check(std::integral_constant<int, 3>{});
}

// 1e5 particles and one at 1e4 radii of their cloud: cells take no more memory than without it, and neighbours are the
// same ones. (Lists take 1.00 to 1.05 of the time.)
BOOST_AUTO_TEST_CASE(one_particle_far_from_a_large_cloud) {
  constexpr double radius = 29.0, far = 1e4 * radius;
  std::array<particles::array, 3> x;
  std::vector<std::int64_t> id;
  for (std::int64_t place = 0; place < 58 * 58 * 58; ++place) {
    const std::array<std::int64_t, 3> row{place / (58 * 58), place / 58 % 58, place % 58};
    std::array<double, 3> at;
    double r2 = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      at[a] = static_cast<double>(row[a]) + 0.5 - radius + 0.2 * noise(place, a);
      r2 += at[a] * at[a];
    }
    if (r2 > radius * radius) continue;
    for (std::size_t a = 0; a < 3; ++a) x[a].push_back(at[a]);
    id.push_back(static_cast<std::int64_t>(id.size()));
  }
  const std::size_t n = id.size();
  BOOST_REQUIRE(n > 100000U);
  const double reach = 2.6;
  const auto cloud = cells::make_grid<3>(x, id, n, 2.0);
  const auto rows = [&](const cells::grid<3>& g) {
    cells::neighbour_list list;
    cells::make_list<3>(list, g, x, n, cells::one_reach{reach});
    std::vector<std::vector<std::uint32_t>> all(n);
    for (std::size_t r = 0; r < list.rows(); ++r)
      list.for_each(r, [&](std::uint32_t j, std::uint32_t of_lanes, auto...) {
        for (std::size_t lane = 0; lane < cells::neighbour_list::width; ++lane)
          if ((of_lanes >> lane & 1U) != 0) all[r * cells::neighbour_list::width + lane].push_back(j);
      });
    return all;
  };
  auto should = rows(cloud);
  const auto left = static_cast<std::uint32_t>(n / 2);
  const double signs[]{1.0, -0.3, 0.7};
  for (std::size_t a = 0; a < 3; ++a) x[a][left] = signs[a] * far;
  should[left].clear();
  for (auto& row : should) std::erase(row, left);
  const auto with_one_far = cells::make_grid<3>(x, id, n, 2.0);
  BOOST_TEST(!cloud.sparse);
  BOOST_TEST(with_one_far.sparse);
  BOOST_TEST(with_one_far.bytes() <= 1.1 * cloud.bytes());
  BOOST_TEST((rows(with_one_far) == should));
}

// A box of more cells than 64 bits number is no matter; coordinates that they cannot number are an error, not a wrong
// cell.
BOOST_AUTO_TEST_CASE(cells_beyond_64_bits) {
  std::array<particles::array, 3> x;
  for (auto& component : x) component = {0.0, 1e18, -1e18, 1e18 + 512.0};
  const auto g = cells::make_grid<3>(x, {0, 1, 2, 3}, 4, 1.0);
  BOOST_TEST(g.cells() == 4U);
  BOOST_TEST(g.members == (std::vector<std::uint32_t>{2, 0, 1, 3}), boost::test_tools::per_element());
  for (std::size_t i = 0; i < 4; ++i) {
    const auto at = g.stored(g.cell(cells::position<3>(x, i)));
    BOOST_REQUIRE(at != cells::no_cell);
    BOOST_TEST(g.members[g.start[at]] == i);
  }
  for (auto& component : x) component[1] = 1e19;
  BOOST_CHECK_EXCEPTION((cells::make_grid<3>(x, {0, 1}, 2, 1.0)), foundation::error, [](const foundation::error& e) {
    return std::string(e.what()).find("64 bits") != std::string::npos;
  });
}

// Rows with centres of their own, as the walls' markers: anywhere, inside or outside the grid, and a filter.
BOOST_AUTO_TEST_CASE(list_about_other_points) {
  constexpr std::size_t n = 400, rows = 60;
  std::array<particles::array, 3> x;
  std::vector<std::int64_t> id;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t a = 0; a < 3; ++a) x[a].push_back(5.0 * noise(static_cast<std::int64_t>(i), 3 + a));
    id.push_back(static_cast<std::int64_t>(i));
  }
  const auto centre = [](std::size_t r) {
    std::array<double, 3> c;
    for (std::size_t a = 0; a < 3; ++a) c[a] = 9.0 * noise(static_cast<std::int64_t>(r), 10 + a);
    return c;
  };
  const auto even = [](std::uint32_t j) { return j % 2 == 0; };
  cells::point_list list;  // one after the other in the same memory
  // Reaches above and below the grid's own cells.
  for (const double reach : {0.8, 2.0, 7.0}) {
    const auto g = cells::make_grid<3>(x, id, n, 2.0);
    cells::make_list_of_points<3>(list, g, rows, reach, n, foundation::lanes, centre, even);
    BOOST_REQUIRE(list.rows() == rows);
    for (std::size_t r = 0; r < rows; ++r) {
      std::vector<std::uint32_t> is, should;
      BOOST_TEST(list.row(r).size() % foundation::lanes == 0U);
      for (const std::uint32_t j : list.row(r))
        if (j != n) is.push_back(j);
      std::sort(is.begin(), is.end());
      for (std::size_t j = 0; j < n; j += 2) {
        double r2 = 0.0;
        for (std::size_t a = 0; a < 3; ++a) r2 += (centre(r)[a] - x[a][j]) * (centre(r)[a] - x[a][j]);
        if (r2 < reach * reach) should.push_back(static_cast<std::uint32_t>(j));
      }
      BOOST_TEST(is == should, boost::test_tools::per_element());
    }
  }
}

// Neighbours come back as they were written, with their lanes: near and far, backwards too.
// Steps that an entry just holds, and those that it does not; sequences of different lengths, and none at all.
BOOST_AUTO_TEST_CASE(entries_come_back) {
  constexpr std::uint32_t top = 1U << (cells::neighbour_list::width - 1);
  using entry = std::pair<std::uint32_t, std::uint32_t>;
  const std::vector<entry> first{{0, 1},   {1, 3},   {7, 2},   {5, 2},          {131, 1},        {130, 1}, {258, 3},
                                 {385, 1}, {258, 2}, {130, 3}, {0xfffffff0, 3}, {0xffffffff, 1}, {0, 2},   {12, top}};
  const std::vector<entry> second{{7, 1}, {9, top}, {40'000'000, 3}};
  const std::vector<entry> none;
  using row_of_two = std::array<std::vector<entry>, 2>;
  const std::vector<row_of_two> rows{row_of_two{first, second}, row_of_two{second, first}, row_of_two{second, none},
                                     row_of_two{none, first},   row_of_two{none, none},    row_of_two{first, none}};
  for (const std::size_t interleave : {1, 2}) {
    cells::neighbour_list list;
    list.interleave = interleave;
    cells::make_rows(list, rows.size(), [&, row = cells::row_of_clusters()](std::size_t r, auto& made) mutable {
      for (std::size_t k = 0; k < interleave; ++k)
        for (const auto& [j, of_lanes] : rows[r][k]) row.add(k, j, of_lanes);
      row.add(0, 12, 0);
      row.write(interleave, made);
      return 1;
    });
    BOOST_TEST(list.pairs == rows.size());
    for (std::size_t r = 0; r < rows.size(); ++r) {
      std::vector<entry> should, found;  // side by side
      for (std::size_t n = 0; n < first.size(); ++n)
        for (std::size_t k = 0; k < interleave; ++k)
          if (n < rows[r][k].size()) should.push_back(rows[r][k][n]);
      list.for_each(r, [&](std::uint32_t j, std::uint32_t of_lanes, auto...) { found.emplace_back(j, of_lanes); });
      BOOST_TEST((found == should));
    }
  }
}

BOOST_AUTO_TEST_CASE(no_particles_no_neighbours) {
  std::array<particles::array, 2> x;
  const auto g = cells::make_grid<2>(x, {}, 0, 1.0);
  cells::neighbour_list list;
  cells::make_list<2>(list, g, x, 0, cells::one_reach{1.0});
  BOOST_TEST(list.pairs == 0U);
  BOOST_TEST(list.rows() == 0U);
}
