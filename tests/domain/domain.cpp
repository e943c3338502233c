// Halos, migration and periodic borders.
#include <omp.h>
#include <liquid/passes.hpp>

#include "../support/scene.hpp"

using namespace tetsuame;
using namespace tetsuame::test;

namespace {

template <int D>
using located = std::array<double, D + 1>;  // position, then ID

template <int D>
located<D> locate(const particles::particles<D>& s, std::size_t i) {
  located<D> p;
  for (std::size_t a = 0; a < D; ++a) p[a] = s.x[a][i];
  p[D] = static_cast<double>(s.id[i]);
  return p;
}

// The block's particles of all ranks with all images over the periodic borders, shifted as the halo shifts.
template <int D>
std::vector<located<D>> images(const hydrostatic::scene<D>& scene, std::size_t begin, std::size_t n) {
  const auto& ranks = scene.w.d.ranks;
  std::vector<double> mine;
  for (std::size_t i = begin; i < begin + n; ++i) {
    const auto p = locate<D>(scene.w.s, i);
    mine.insert(mine.end(), p.begin(), p.end());
  }
  const auto rows = of_all_ranks(ranks, mine);
  std::vector<located<D>> all(rows.size() / (D + 1));
  for (std::size_t k = 0; k < all.size(); ++k)
    std::copy_n(rows.begin() + static_cast<std::ptrdiff_t>(k * (D + 1)), D + 1, all[k].begin());
  const auto& region = scene.w.d.region;
  for (std::size_t a = 0; a < D; ++a) {
    if (!region.periodic[a]) continue;
    const std::size_t without = all.size();
    for (std::size_t k = 0; k < without; ++k)
      for (const double shift : {-region.length[a], region.length[a]}) {
        all.push_back(all[k]);
        all.back()[a] += shift;
      }
  }
  std::sort(all.begin(), all.end());
  return all;
}

// The ghosts are those images of all ranks' particles in this rank's cell widened by the halo that are not
// owned here, each once, bit by bit. Cells are read off the cuts here anew.
template <int D>
std::size_t check_halo(const hydrostatic::scene<D>& scene) {
  const auto& s = scene.w.s;
  const auto& d = scene.w.d;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::array<double, D> lower, upper;
  bool empty = false;
  auto group = static_cast<std::size_t>(d.ranks.rank);
  for (std::size_t a = D; a-- > 0;) {
    const auto n = static_cast<std::size_t>(d.cuts.counts[a]), i = group % n;
    group /= n;
    const double low = d.cuts.at[a][group * (n + 1) + i], high = d.cuts.at[a][group * (n + 1) + i + 1];
    lower[a] = i == 0 && !d.region.periodic[a] ? -infinity : low;
    upper[a] = i + 1 == n && !d.region.periodic[a] ? infinity : high;
    empty = empty || !(lower[a] < upper[a]);
  }
  std::size_t found = 0;
  const auto check = [&](std::size_t begin, std::size_t owned, std::size_t ghosts_begin, std::size_t ghosts) {
    std::vector<located<D>> mine, expected, is;
    for (std::size_t i = begin; i < begin + owned; ++i) mine.push_back(locate<D>(s, i));
    std::sort(mine.begin(), mine.end());
    for (const auto& p : images<D>(scene, begin, owned)) {
      bool seen = !empty && !std::binary_search(mine.begin(), mine.end(), p);
      for (std::size_t a = 0; a < D; ++a) seen = seen && p[a] >= lower[a] - d.width && p[a] <= upper[a] + d.width;
      if (seen) expected.push_back(p);
    }
    for (std::size_t i = ghosts_begin; i < ghosts_begin + ghosts; ++i) is.push_back(locate<D>(s, i));
    std::sort(is.begin(), is.end());
    BOOST_TEST((is == expected));
    found += is.size();
  };
  check(0, s.fluid, s.fluid, s.fluid_ghosts);
  check(s.first_wall(), s.walls, s.first_wall() + s.walls, s.wall_ghosts);
  return found;
}

// Cuts anywhere, some of them together: cells are narrower than the halo, and empty.
template <int D>
balance::cuts<D> irregular(const domain::decomposition<D>& d, std::uint64_t salt) {
  auto cuts = d.cuts;
  for (std::size_t a = 0; a < D; ++a)
    for (std::size_t g = 0; g < cuts.groups(a); ++g) {
      double* c = cuts.group(a, g);
      const int n = cuts.counts[a];
      for (int i = 1; i < n; ++i)
        c[i] = std::floor(8.0 * d.region.length[a] * 0.5 *
                          (1.0 + noise(static_cast<std::int64_t>(100 * g) + i, salt + a))) /
               8.0;
      std::sort(c + 1, c + n);
      if (n > 2 && g % 2 == salt % 2) c[2] = c[1];
    }
  return cuts;
}

// Ghosts before and after cuts moved. Ranks along x: as chosen, one, and all of them.
template <int D>
void check_halos(hydrostatic::options o) {
  const auto world = domain::communicator::world();
  for (const int ranks_x : {0, 1, world.size}) {
    o.domain.ranks_x.number = ranks_x;
    auto scene = make_scene<D>(o, world, 0.4);
    for (const std::uint64_t salt : {1, 2, 3}) {
      const auto ghosts = check_halo<D>(scene);
      BOOST_TEST((world.sum(static_cast<std::int64_t>(ghosts)) > 0) == (world.size > 1 || o.domain.periodic[0]));
      scene.w.d.cuts = irregular<D>(scene.w.d, salt);
      hydrostatic::place_walls(o, scene);
      hydrostatic::rebuild<D>(scene);
      for (std::size_t i = 0; i < scene.w.s.fluid; ++i)
        BOOST_REQUIRE(scene.w.d.owner(cells::position<D>(scene.w.s.x, i)) == world.rank);
      particles::array one(scene.w.s.total(), 1.0);
      for (const double count : fluid_by_id(scene, one)) BOOST_REQUIRE(count == 1.0);
    }
    check_halo<D>(scene);
  }
}

}  // namespace

BOOST_AUTO_TEST_CASE(halo_is_what_a_search_finds) {
  check_halos<2>(box<2>({16, 10}, true));
  check_halos<2>(box<2>({16, 10}, false, "virtual_marker"));
  auto o = box<2>({16, 8}, false, "frozen");
  o.domain.periodic[0] = true;
  check_halos<2>(o);
}

BOOST_AUTO_TEST_CASE(halo_in_three_dimensions) {
  check_halos<3>(box<3>({12, 6, 6}, true, "none", "wendland_c2"));
  auto tall = box<3>({8, 6, 6}, true, "virtual_marker", "wendland_c2");
  tall.domain.periodic[1] = false;
  check_halos<3>(tall);
}

// As narrow as a periodic box may be: the halo's ghosts are the box's images on both sides.
BOOST_AUTO_TEST_CASE(halo_as_wide_as_the_box) {
  auto o = box<2>({16, 8}, true);
  o.kernel.skin = 4.3;
  check_halo<2>(make_scene<2>(o, domain::communicator::world(), 0.4));
}

BOOST_AUTO_TEST_CASE(exchange_refreshes_ghosts) {
  auto o = box<3>({12, 6, 6}, true, "frozen", "wendland_c2");
  o.domain.periodic[1] = false;
  auto scene = make_scene<3>(o, domain::communicator::world(), 0.4);
  auto& s = scene.w.s;
  for (std::size_t i = 0; i < s.total(); ++i) s.T[i] = s.Y[i] = -1.0;
  const auto set = [&](std::size_t begin, std::size_t n) {
    for (std::size_t i = begin; i < begin + n; ++i) {
      s.T[i] = noise(s.id[i], 1);
      s.Y[i] = noise(s.id[i], 2);
    }
  };
  set(0, s.fluid);
  set(s.first_wall(), s.walls);
  scene.w.exchange_fluid({s.T.data(), s.Y.data()});
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < s.first_wall() + s.walls; ++i)
    wrong += s.T[i] != noise(s.id[i], 1) || s.Y[i] != noise(s.id[i], 2);
  BOOST_TEST(wrong == 0U);
  // Ghosts of the walls are not of the fluid's halo, and come with their own.
  for (std::size_t i = s.first_wall() + s.walls; i < s.total(); ++i) wrong += s.T[i] != -1.0;
  scene.w.exchange_walls({s.T.data(), s.Y.data()});
  for (std::size_t i = 0; i < s.total(); ++i) wrong += s.T[i] != noise(s.id[i], 1) || s.Y[i] != noise(s.id[i], 2);
  BOOST_TEST(wrong == 0U);
}

BOOST_AUTO_TEST_CASE(positions_of_ghosts_follow_their_owners) {
  auto scene = make_scene<2>(box<2>({16, 10}, true), domain::communicator::world(), 0.4);
  auto& s = scene.w.s;
  for (std::size_t i = 0; i < s.fluid; ++i)
    for (std::size_t a = 0; a < 2; ++a) s.x[a][i] += 0.09 * noise(s.id[i], 5 + a);
  // What needs no ghost may be done while they travel; with them goes a field.
  for (std::size_t i = 0; i < s.fluid; ++i) s.T[i] = noise(s.id[i], 9);
  const std::array<double*, 1> fields{s.T.data()};
  domain::begin_exchange<2>(scene.w.d.ranks, scene.w.d.fluid_halo, fields, &s.x);
  const auto all = images<2>(scene, 0, s.fluid);
  domain::end_exchange<2>(scene.w.d.ranks, scene.w.d.fluid_halo);
  std::size_t strangers = 0;
  for (std::size_t i = 0; i < s.first_wall(); ++i)
    strangers += !std::binary_search(all.begin(), all.end(), locate<2>(s, i)) || s.T[i] != noise(s.id[i], 9);
  BOOST_TEST(strangers == 0U);
}

// What is counted as sent on all ranks is what came from others on all ranks; a rank's copies to itself are not.
BOOST_AUTO_TEST_CASE(traffic_is_counted) {
  auto scene = make_scene<2>(box<2>({16, 10}, true), domain::communicator::world(), 0.4);
  auto& s = scene.w.s;
  const auto& ranks = scene.w.d.ranks;
  std::int64_t ghosts = 0, senders = 0;
  for (const auto& from : scene.w.d.fluid_halo.from) {
    if (from.rank == ranks.rank) continue;
    ghosts += static_cast<std::int64_t>(from.count);
    ++senders;
  }
  const auto before = foundation::sent;
  scene.w.exchange_fluid({s.T.data(), s.Y.data(), s.rho.data()});
  const auto after = foundation::sent;
  const auto messages = ranks.sum(after.halo_messages - before.halo_messages);
  const auto bytes = ranks.sum(after.halo_bytes - before.halo_bytes);
  BOOST_TEST(messages == ranks.sum(senders));
  BOOST_TEST(bytes == ranks.sum(ghosts) * 3 * 8);
  BOOST_TEST((messages > 0) == (ranks.size > 1));
  BOOST_TEST(after.collectives == before.collectives);
  BOOST_TEST(foundation::sent.collectives == before.collectives + 4);  // the four sums
}

// So much that packing is worth threads, at least on one rank.
BOOST_AUTO_TEST_CASE(exchange_of_much_on_threads) {
  auto scene = make_scene<2>(box<2>({160, 40}, true), domain::communicator::world(), 0.4);
  auto& s = scene.w.s;
  const std::array<double*, 8> fields{s.v[0].data(), s.v[1].data(), s.T.data(), s.rho.data(),
                                      s.Y.data(),    s.u.data(),    s.p.data(), s.dV.data()};
  const auto& plan = scene.w.d.fluid_halo;
  if (scene.w.d.ranks.size == 1) BOOST_TEST(plan.sources.size() * fields.size() > foundation::values_worth_threads);
  for (std::size_t i = 0; i < s.total(); ++i)
    for (std::size_t f = 0; f < fields.size(); ++f) fields[f][i] = i < s.fluid ? noise(s.id[i], f) : -2.0;
  const auto before = s.x;
  for (std::size_t i = s.fluid; i < s.total(); ++i) s.x[0][i] = s.x[1][i] = -2.0;
  const int threads = omp_get_max_threads();
  omp_set_num_threads(3);
  domain::exchange<2>(scene.w.d.ranks, plan, fields, &s.x);
  omp_set_num_threads(threads);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < s.total(); ++i) {
    for (std::size_t f = 0; f < fields.size(); ++f) wrong += fields[f][i] != noise(s.id[i], f);
    for (std::size_t a = 0; a < 2; ++a) wrong += bits(s.x[a][i]) != bits(before[a][i]);
  }
  BOOST_TEST(wrong == 0U);
  // Room for the traffic is made once.
  const auto* out = plan.out.data();
  const auto* in = plan.in.data();
  domain::exchange<2>(scene.w.d.ranks, plan, fields, &s.x);
  scene.w.exchange_fluid({s.T.data()});
  BOOST_TEST((plan.out.data() == out && plan.in.data() == in));
}

// Particles thrown anywhere in the box: all arrive, once, at their owner, with all they carry.
BOOST_AUTO_TEST_CASE(migration_loses_nothing) {
  auto scene = make_scene<2>(box<2>({16, 10}, true, "none"), domain::communicator::world(), 0.4);
  auto& s = scene.w.s;
  auto& d = scene.w.d;
  d.cuts = irregular<2>(d, 4);
  const auto stamp = [](std::size_t field, std::int64_t id) { return noise(id, 1000 + field); };
  const auto new_x = [](std::int64_t id) { return 8.0 * (1.0 + noise(id, 7)); };
  const auto for_each_travelling = [&](auto&& f) {
    std::size_t n = 0;
    for (auto* a : domain::detail::travelling_fields<2>(s)) f(n++, *a);
  };
  for (std::size_t i = 0; i < s.fluid; ++i) {
    s.material[i] = static_cast<std::int32_t>(s.id[i] % 5);
    for_each_travelling([&](std::size_t n, auto& a) { a[i] = stamp(n, s.id[i]); });
    s.x[0][i] = new_x(s.id[i]);
    s.x[1][i] = 10.0 / 16.0 * new_x(s.id[i] + 1000);
  }
  domain::migrate(d, s);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    wrong += s.x[0][i] != new_x(s.id[i]) || d.owner(cells::position<2>(s.x, i)) != d.ranks.rank ||
             s.material[i] != s.id[i] % 5;
    for_each_travelling(
        [&](std::size_t n, auto& a) { wrong += &a != &s.x[0] && &a != &s.x[1] && a[i] != stamp(n, s.id[i]); });
  }
  BOOST_TEST(wrong == 0U);
  particles::array one(s.fluid, 1.0);
  for (const double count : fluid_by_id(scene, one)) BOOST_TEST(count == 1.0);
}

// All to the last rank and back; ranks may be empty. Walls and what they hold stay in place.
BOOST_AUTO_TEST_CASE(empty_ranks_and_walls_survive_migration) {
  auto scene = make_scene<2>(box<2>({16, 8}, false, "frozen"), domain::communicator::world(), 0.0);
  auto& s = scene.w.s;
  const auto wall_rho = walls_by_id(scene, s.rho), wall_x = walls_by_id(scene, s.x[0]),
             fluid_m = fluid_by_id(scene, s.m);
  const auto start = fluid_by_id(scene, s.x[0]), height = fluid_by_id(scene, s.x[1]);
  for (std::size_t i = 0; i < s.fluid; ++i) s.x[0][i] = 15.9, s.x[1][i] = 7.9;
  hydrostatic::rebuild<2>(scene);
  const bool last = scene.w.d.ranks.rank + 1 == scene.w.d.ranks.size;
  BOOST_TEST(s.fluid == (last ? static_cast<std::size_t>(scene.fluid_total) : 0U));
  for (std::size_t i = 0; i < s.fluid; ++i) {
    s.x[0][i] = start[static_cast<std::size_t>(s.id[i])];
    s.x[1][i] = height[static_cast<std::size_t>(s.id[i])];
  }
  hydrostatic::rebuild<2>(scene);
  BOOST_TEST(same_bits(fluid_by_id(scene, s.x[0]), start));
  BOOST_TEST(same_bits(fluid_by_id(scene, s.m), fluid_m));
  BOOST_TEST(same_bits(walls_by_id(scene, s.rho), wall_rho));
  BOOST_TEST(same_bits(walls_by_id(scene, s.x[0]), wall_x));
}

BOOST_AUTO_TEST_CASE(wrap_moves_start_and_list_positions_along) {
  for (const double farthest : {3.0, 70.0}) {  // of many lengths, too
    auto o = box<2>({16, 8}, true);
    o.domain.periodic[1] = false;
    auto scene = make_scene<2>(o, alone());
    auto& s = scene.w.s;
    const auto before = s.x;
    s.keeps_start = true;
    s.x_start = s.x;
    const auto start = s.x_start;
    for (std::size_t i = 0; i < s.fluid; ++i)
      for (std::size_t a = 0; a < 2; ++a) s.x[a][i] += farthest * noise(s.id[i], a);
    const auto moved = s.x;
    domain::wrap<2>(scene.w.d.region, s);
    for (std::size_t i = 0; i < s.fluid; ++i) {
      BOOST_TEST((s.x[0][i] >= 0.0 && s.x[0][i] < 16.0));
      BOOST_TEST(s.x[1][i] == moved[1][i]);
      // A power of two as length: the shift costs one rounding, of a few ulp of 16, and the place had one before.
      BOOST_TEST(std::abs((s.x[0][i] - s.x_list[0][i]) - (moved[0][i] - before[0][i])) <= 6.0 * farthest * epsilon);
      BOOST_TEST(std::abs((s.x[0][i] - s.x_start[0][i]) - (moved[0][i] - start[0][i])) <= 6.0 * farthest * epsilon);
    }
  }
}

// A coordinate a rounding error below zero plus the length is the length itself: it must still be owned and seen.
BOOST_AUTO_TEST_CASE(a_rounding_error_outside) {
  const auto scene =
      make_scene<2>(box<2>({16, 8}, true), domain::communicator::world(), [](std::int64_t id, std::array<double, 2> x) {
        if (id % 16 == 0) x[0] = -1e-20;
        return x;
      });
  check_halo<2>(scene);
  BOOST_TEST(scene.w.d.ranks.sum(static_cast<std::int64_t>(scene.w.s.fluid)) == scene.fluid_total);
}

namespace {

auto refused(const std::string& because) {
  return [=](const foundation::error& e) {
    return e.status() == foundation::exit_status::bad_input && std::string(e.what()).find(because) != std::string::npos;
  };
}

}  // namespace

BOOST_AUTO_TEST_CASE(ranks_along_x) {
  const domain::box<2> region{{1600.0, 800.0}, {true, true}};
  const auto columns = [&](int size, int ranks_x) {
    return domain::decompose<2>({MPI_COMM_SELF, 0, size}, region, 3.8, {ranks_x}).cuts.counts[0];
  };
  BOOST_TEST(columns(32, 0) == 8);  // square cells
  for (const int ranks_x : {1, 2, 4, 8}) BOOST_TEST(columns(8, ranks_x) == ranks_x);
  BOOST_CHECK_EXCEPTION(columns(8, 3), foundation::error, refused("&domain ranks_x: 3 does not divide"));
  BOOST_CHECK_EXCEPTION(columns(8, 16), foundation::error, refused("number of MPI ranks, 8"));
  BOOST_TEST(columns(1 << 20, 0) > 0);  // cells far narrower than the halo
}

BOOST_AUTO_TEST_CASE(owners_of_cuts_and_beyond) {
  auto d = domain::decompose<2>({MPI_COMM_SELF, 0, 4}, {{16.0, 8.0}, {false, false}}, 3.8, {4});
  for (const auto& [x, owner] :
       {std::pair{-3.0, 0}, {0.0, 0}, {3.999, 0}, {4.0, 1}, {8.0, 2}, {12.0, 3}, {16.0, 3}, {99.0, 3}})
    for (const double y : {-1.0, 0.0, 8.0, 9.0}) BOOST_TEST(d.owner({x, y}) == owner);
  // owner() and the cell of a rank say the same, on coinciding cuts too.
  d = domain::decompose<2>({MPI_COMM_SELF, 0, 12}, {{16.0, 8.0}, {false, true}}, 3.8);
  for (const std::uint64_t salt : {1, 2, 3, 4}) {
    d.cuts = irregular<2>(d, salt);
    for (int x = -8; x <= 136; ++x)
      for (int y = -8; y <= 72; ++y) {
        const std::array<double, 2> at{x / 8.0, y / 8.0};
        int owners = 0;
        for (d.ranks.rank = 0; d.ranks.rank < 12; ++d.ranks.rank)
          if (d.within(d.cell(), at)) owners += 1 + 100 * (d.owner(at) != d.ranks.rank);
        BOOST_REQUIRE(owners == 1);
      }
  }
}
