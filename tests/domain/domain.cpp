// Halos, migration, periodic borders and what ranks agree on.
#define BOOST_TEST_MODULE domain
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
std::vector<located<D>> images(const simulation::scene<D>& scene, std::size_t begin, std::size_t n) {
  const auto& ranks = scene.w.d.ranks;
  std::vector<double> mine;
  for (std::size_t i = begin; i < begin + n; ++i) {
    const auto p = locate<D>(scene.w.s, i);
    mine.insert(mine.end(), p.begin(), p.end());
  }
  const auto rows = domain::detail::all_to_all(
      ranks, std::vector<std::vector<double>>(static_cast<std::size_t>(ranks.size), mine), MPI_DOUBLE);
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

// Every ghost is an image, none stands twice, and all images in reach of an owned fluid particle are here.
template <int D>
void check_halo(const simulation::scene<D>& scene) {
  const auto& s = scene.w.s;
  const auto check = [&](std::size_t begin, std::size_t owned, std::size_t ghosts_begin, std::size_t ghosts) {
    const auto all = images<D>(scene, begin, owned);
    std::vector<located<D>> here;
    for (std::size_t i = begin; i < begin + owned; ++i) here.push_back(locate<D>(s, i));
    for (std::size_t i = ghosts_begin; i < ghosts_begin + ghosts; ++i) here.push_back(locate<D>(s, i));
    std::sort(here.begin(), here.end());
    BOOST_TEST((std::adjacent_find(here.begin(), here.end()) == here.end()));
    BOOST_TEST(std::includes(all.begin(), all.end(), here.begin(), here.end()));
    // The halo's border is drawn before the shift is added: leave out what lies on it to rounding.
    const double reach = scene.w.d.width * (1.0 - 1e-12);
    std::size_t missing = 0;
    for (const auto& p : all) {
      if (std::binary_search(here.begin(), here.end(), p)) continue;
      for (std::size_t i = 0; i < s.fluid; ++i) {
        double r2 = 0.0;
        for (std::size_t a = 0; a < D; ++a) r2 += (s.x[a][i] - p[a]) * (s.x[a][i] - p[a]);
        missing += r2 < reach * reach;
      }
    }
    BOOST_TEST(missing == 0U);
  };
  check(0, s.fluid, s.fluid, s.fluid_ghosts);
  check(s.first_wall(), s.walls, s.first_wall() + s.walls, s.wall_ghosts);
}

}  // namespace

BOOST_AUTO_TEST_CASE(halo_is_complete) {
  const auto world = domain::communicator::world();
  for (const bool periodic : {true, false}) {
    check_halo<2>(make_scene<2>(box<2>({16, 10}, periodic), world, 0.4));
    check_halo<3>(make_scene<3>(box<3>({12, 6, 6}, periodic, "none", "wendland_c2"), world, 0.4));
  }
  auto o = box<2>({16, 8}, false, "frozen");
  check_halo<2>(make_scene<2>(o, world, 0.4));
  o.domain.periodic[0] = true;
  check_halo<2>(make_scene<2>(o, world, 0.4));
  auto tall = box<3>({12, 6, 6}, true, "frozen", "wendland_c2");
  tall.domain.periodic[1] = false;
  check_halo<3>(make_scene<3>(tall, world, 0.4));
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
  domain::exchange_positions<2>(scene.w.d.ranks, scene.w.d.fluid_halo, s.x);
  const auto all = images<2>(scene, 0, s.fluid);
  std::size_t strangers = 0;
  for (std::size_t i = 0; i < s.first_wall(); ++i)
    strangers += !std::binary_search(all.begin(), all.end(), locate<2>(s, i));
  BOOST_TEST(strangers == 0U);
}

// Particles thrown anywhere in the box: all arrive, once, at their owner, with all they carry.
BOOST_AUTO_TEST_CASE(migration_loses_nothing) {
  auto scene = make_scene<2>(box<2>({16, 10}, true, "none"), domain::communicator::world(), 0.4);
  auto& s = scene.w.s;
  const auto& d = scene.w.d;
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
  }
  domain::migrate(d, s, s.x[0]);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    wrong += s.x[0][i] != new_x(s.id[i]) || d.owner(s.x[0][i]) != d.ranks.rank || s.material[i] != s.id[i] % 5;
    for_each_travelling([&](std::size_t n, auto& a) { wrong += &a != &s.x[0] && a[i] != stamp(n, s.id[i]); });
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
  const auto start = fluid_by_id(scene, s.x[0]);
  for (std::size_t i = 0; i < s.fluid; ++i) s.x[0][i] = 15.9;
  simulation::rebuild<2>(scene);
  const bool last = scene.w.d.ranks.rank + 1 == scene.w.d.ranks.size;
  BOOST_TEST(s.fluid == (last ? static_cast<std::size_t>(scene.fluid_total) : 0U));
  for (std::size_t i = 0; i < s.fluid; ++i) s.x[0][i] = start[static_cast<std::size_t>(s.id[i])];
  simulation::rebuild<2>(scene);
  BOOST_TEST(same_bits(fluid_by_id(scene, s.x[0]), start));
  BOOST_TEST(same_bits(fluid_by_id(scene, s.m), fluid_m));
  BOOST_TEST(same_bits(walls_by_id(scene, s.rho), wall_rho));
  BOOST_TEST(same_bits(walls_by_id(scene, s.x[0]), wall_x));
}

BOOST_AUTO_TEST_CASE(wrap_moves_start_and_list_positions_along) {
  auto o = box<2>({16, 8}, true);
  o.domain.periodic[1] = false;
  auto scene = make_scene<2>(o, alone());
  auto& s = scene.w.s;
  const auto before = s.x;
  const auto start = s.x_start;
  for (std::size_t i = 0; i < s.fluid; ++i)
    for (std::size_t a = 0; a < 2; ++a) s.x[a][i] += 3.0 * noise(s.id[i], a);
  const auto moved = s.x;
  domain::wrap<2>(scene.w.d.region, s);
  for (std::size_t i = 0; i < s.fluid; ++i) {
    BOOST_TEST((s.x[0][i] >= 0.0 && s.x[0][i] < 16.0));
    BOOST_TEST(s.x[1][i] == moved[1][i]);
    // Powers of two as length and a range below it: the shift costs one rounding, of a few ulp of 16.
    BOOST_TEST(std::abs((s.x[0][i] - s.x_list[0][i]) - (moved[0][i] - before[0][i])) <= 16.0 * epsilon);
    BOOST_TEST(std::abs((s.x[0][i] - s.x_start[0][i]) - (moved[0][i] - start[0][i])) <= 16.0 * epsilon);
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

BOOST_AUTO_TEST_CASE(too_many_ranks_is_bad_input) {
  const domain::box<2> region{{16.0, 8.0}, {true, true}};
  const auto refused = [](const foundation::error& e) {
    return e.status() == foundation::exit_status::bad_input &&
           std::string(e.what()).find("at most 4 ranks") != std::string::npos;
  };
  BOOST_CHECK_EXCEPTION(domain::make_slices<2>({MPI_COMM_SELF, 0, 5}, region, 3.8), foundation::error, refused);
  BOOST_CHECK_NO_THROW(domain::make_slices<2>({MPI_COMM_SELF, 0, 4}, region, 3.8));
  BOOST_CHECK_NO_THROW(domain::make_slices<2>({MPI_COMM_SELF, 0, 1}, region, 17.0));
}

BOOST_AUTO_TEST_CASE(owners_of_cuts_and_beyond) {
  const auto d = domain::make_slices<2>({MPI_COMM_SELF, 0, 4}, {{16.0, 8.0}, {false, false}}, 3.8);
  for (const auto& [x, owner] :
       {std::pair{-3.0, 0}, {0.0, 0}, {3.999, 0}, {4.0, 1}, {8.0, 2}, {12.0, 3}, {16.0, 3}, {99.0, 3}})
    BOOST_TEST(d.owner(x) == owner);
}

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

BOOST_AUTO_TEST_CASE(reductions) {
  const auto world = domain::communicator::world();
  BOOST_TEST(world.maximum(world.rank) == world.size - 1);
  BOOST_TEST(world.minimum(-world.rank) == 1 - world.size);
  BOOST_TEST(world.sum(world.rank) == world.size * (world.size - 1) / 2);
  BOOST_TEST(world.broadcast(world.rank == 0 ? "text" : "") == "text");
  foundation::exact_sum here, all;
  for (std::int64_t k = 0; k < 1000; ++k) {
    const double term = std::ldexp(noise(k, 1), static_cast<int>(k % 120));
    if (k % world.size == world.rank) here.add(term);
    all.add(term);
  }
  BOOST_TEST(bits(world.exact(here)) == bits(all.value()));
}
