// Species that pass through each other: lists between them against a search through all particles and images, sums
// with the same bits as on one rank, fields and partners that travel along.
#include <omp.h>

#include <array>
#include <cmath>
#include <map>
#include <particles/named_fields.hpp>
#include <species/species.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "../support/numbers.hpp"

using namespace tetsuame;
using namespace tetsuame::test;

namespace {

// What a species starts from: each of these is a function of the ID.
template <int D>
struct stream {
  std::int64_t number;
  std::array<double, D> velocity;  // m/s, of all, beside what each has of its own
  double edge;                     // m, of cells
  std::uint64_t salt;

  std::array<double, D> start(std::int64_t id, const domain::box<D>& box) const {
    std::array<double, D> x;
    for (std::size_t a = 0; a < D; ++a) x[a] = 0.5 * box.length[a] * (1.0 + noise(id, salt + a));
    return x;
  }
  std::array<double, D> speed(std::int64_t id) const {
    auto v = velocity;
    for (std::size_t a = 0; a < D; ++a) v[a] += 0.3 * noise(id, salt + 10 + a);
    return v;
  }
};

template <int D>
struct scenario {
  domain::box<D> box;
  std::vector<stream<D>> streams;
  std::vector<double> reach;  // m, of a for b at a * streams + b

  double of(std::size_t a, std::size_t b) const { return reach[a * streams.size() + b]; }
};

// Two of other numbers, cells and reaches, which have IDs in common; the reaches are not symmetric.
template <int D>
scenario<D> crossing() {
  scenario<D> all;
  std::array<double, D> east{}, back{};
  east[0] = 1.0;
  back[0] = -0.8;
  back[1] = 0.6;
  all.box.periodic.fill(true);
  all.box.length.fill(D == 2 ? 6.0 : 4.0);
  all.box.length[0] = D == 2 ? 9.0 : 5.0;
  all.streams = {{170, east, 1.1, 1}, {90, back, 1.7, 1000}};
  all.reach = {0.9, 1.6, 0.8, 1.2};
  return all;
}

// All particles of all species without ranks.
template <int D>
struct search {
  const scenario<D>& all;
  std::vector<std::vector<std::array<double, D>>> x;  // m, by species and ID

  explicit search(const scenario<D>& of) : all(of), x(of.streams.size()) {
    for (std::size_t a = 0; a < x.size(); ++a)
      for (std::int64_t id = 0; id < all.streams[a].number; ++id) x[a].push_back(all.streams[a].start(id, all.box));
  }
  void move(double dt) {
    for (std::size_t a = 0; a < x.size(); ++a)
      for (std::size_t id = 0; id < x[a].size(); ++id) {
        const auto v = all.streams[a].speed(static_cast<std::int64_t>(id));
        for (std::size_t k = 0; k < D; ++k) {
          double& at = x[a][id][k];
          const double length = all.box.length[k];
          at += v[k] * dt;
          if (all.box.periodic[k] && (at < 0.0 || at >= length)) at += -std::floor(at / length) * length;
        }
      }
  }
  // IDs of those of b nearer to particle i of a than `within(j)`, with images, in the order of lists: by cell along the
  // axes, in it along the last axis, then those before, then ID.
  template <class Within>
  std::vector<std::int64_t> neighbours(std::size_t a, std::size_t i, std::size_t b, const Within& within) const {
    using place = std::tuple<std::array<double, D>, std::array<double, D>, std::int64_t>;
    std::vector<place> found;
    for (std::size_t j = 0; j < x[b].size(); ++j) {
      std::array<int, D> image;
      image.fill(-1);
      for (bool more = true; more;) {
        std::array<double, D> cell, backwards;
        double r2 = 0.0;
        for (std::size_t k = 0; k < D; ++k) {
          const double at = x[b][j][k] + image[k] * all.box.length[k], gap = x[a][i][k] - at;
          r2 += gap * gap;
          cell[k] = std::floor(at / all.streams[b].edge);
          backwards[D - 1 - k] = at;
        }
        const bool itself = a == b && i == j && r2 == 0.0;
        if (r2 < within(j) * within(j) && !itself) found.emplace_back(cell, backwards, static_cast<std::int64_t>(j));
        more = false;
        for (std::size_t k = 0; k < D && !more; ++k) {
          more = ++image[k] <= 1;
          if (!more) image[k] = -1;
        }
      }
    }
    std::sort(found.begin(), found.end());
    std::vector<std::int64_t> ids;
    for (const auto& f : found) ids.push_back(std::get<2>(f));
    return ids;
  }
};

template <int D>
std::vector<species::description> described(const scenario<D>& all) {
  std::vector<species::description> d;
  for (const auto& stream : all.streams) d.push_back({"species " + std::to_string(d.size()), stream.edge});
  return d;
}

template <int D>
struct simulated {
  const scenario<D>& all;
  species::mixture<D> m;

  simulated(const scenario<D>& of, const domain::communicator& ranks) : all(of), m(ranks, of.box, described(of), 2.0) {
    for (std::size_t a = 0; a < m.size(); ++a) {
      for (std::size_t b = 0; b < m.size(); ++b) m.set_reach(a, b, all.of(a, b));
      auto& s = m[a].s;
      std::vector<std::int64_t> ids;
      for (std::int64_t id = ranks.rank; id < all.streams[a].number; id += ranks.size) ids.push_back(id);
      particles::allocate(s, ids.size(), 0, 0, 0);
      for (std::size_t i = 0; i < ids.size(); ++i) {
        s.id[i] = ids[i];
        for (std::size_t k = 0; k < D; ++k) {
          s.x[k][i] = all.streams[a].start(ids[i], all.box)[k];
          s.v[k][i] = all.streams[a].speed(ids[i])[k];
        }
      }
    }
  }
  void move(double dt) {
    for (std::size_t a = 0; a < m.size(); ++a)
      for (std::size_t k = 0; k < D; ++k)
        for (std::size_t i = 0; i < m[a].s.fluid; ++i) m[a].s.x[k][i] += m[a].s.v[k][i] * dt;
  }
  double r2(std::size_t a, std::size_t b, std::size_t i, std::uint32_t j) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < D; ++k) sum += (m[a].s.x[k][i] - m[b].s.x[k][j]) * (m[a].s.x[k][i] - m[b].s.x[k][j]);
    return sum;
  }
  // IDs of the neighbours of each owned particle, those nearer than `within`.
  std::vector<std::vector<std::int64_t>> lists(std::size_t a, std::size_t b, double within = 1e9) const {
    std::vector<std::vector<std::int64_t>> ids(m[a].s.fluid);
    m.for_each_pair(a, b, [&](std::size_t i, std::uint32_t j) {
      if (r2(a, b, i, j) < within * within) ids[i].push_back(m[b].s.id[j]);
    });
    return ids;
  }
  // Σ_j 1/r² of each particle of a, by ID, on all ranks.
  std::vector<double> sums(std::size_t a, std::size_t b) const {
    const auto& s = m[a].s;
    std::vector<double> sum(s.fluid, 0.0), by_id(static_cast<std::size_t>(all.streams[a].number), 0.0);
    m.for_each_pair(a, b, [&](std::size_t i, std::uint32_t j) { sum[i] += 1.0 / r2(a, b, i, j); });
    for (std::size_t i = 0; i < s.fluid; ++i) by_id[static_cast<std::size_t>(s.id[i])] = sum[i];
    MPI_Allreduce(MPI_IN_PLACE, by_id.data(), static_cast<int>(by_id.size()), MPI_DOUBLE, MPI_SUM, m.d.ranks.comm);
    return by_id;
  }
  // How many rows, and particles, differ from what the search finds. within(a, i, b, j), IDs: m.
  template <class Within>
  std::size_t differences(const search<D>& expected, const Within& within) const {
    std::size_t wrong = 0;
    for (std::size_t a = 0; a < m.size(); ++a) {
      const auto& s = m[a].s;
      wrong += m.d.ranks.sum(static_cast<std::int64_t>(s.fluid)) != all.streams[a].number;
      for (std::size_t i = 0; i < s.fluid; ++i) wrong += m.d.owner(particles::position<D>(s.x, i)) != m.d.ranks.rank;
      for (std::size_t b = 0; b < m.size(); ++b) {
        const auto is = lists(a, b);
        std::size_t pairs = 0;
        for (std::size_t i = 0; i < s.fluid; ++i) {
          const auto id = static_cast<std::size_t>(s.id[i]);
          wrong += is[i] != expected.neighbours(a, id, b, [&](std::size_t j) { return within(a, id, b, j); });
          pairs += is[i].size();
        }
        wrong += m.list(a, b).pairs != pairs;
      }
    }
    return wrong;
  }
  std::size_t differences(const search<D>& expected) const {
    return differences(expected, [&](std::size_t a, std::size_t, std::size_t b, std::size_t) { return all.of(a, b); });
  }
};

template <int D>
void pass_through_each_other(int steps, double dt, int search_every) {
  const auto world = domain::communicator::world();
  const auto all = crossing<D>();
  simulated<D> on_all(all, world), on_one(all, alone());
  search<D> expected(all);
  std::size_t wrong = 0, other_bits = 0, migrated = 0;
  for (int n = 0; n < steps; ++n) {
    on_all.m.rebuild();
    on_one.m.rebuild();
    if (n % search_every == 0) wrong += on_all.differences(expected);
    for (std::size_t a = 0; a < 2 && n % 4 == 0; ++a)
      for (std::size_t b = 0; b < 2; ++b) {
        const auto sums = on_all.sums(a, b);
        other_bits += !same_bits(sums, on_one.sums(a, b));
        BOOST_REQUIRE(*std::max_element(sums.begin(), sums.end()) > 1.0);
      }
    on_all.move(dt);
    on_one.move(dt);
    expected.move(dt);
    for (std::size_t a = 0; a < 2; ++a)
      for (std::size_t i = 0; i < on_all.m[a].s.fluid; ++i)
        migrated += on_all.m.d.owner(particles::position<D>(on_all.m[a].s.x, i)) != world.rank;
  }
  BOOST_TEST(wrong == 0U);
  BOOST_TEST(other_bits == 0U);
  BOOST_TEST((world.sum(static_cast<std::int64_t>(migrated)) > steps) == (world.size > 1));
}

}  // namespace

BOOST_AUTO_TEST_CASE(two_species_pass_through_each_other) { pass_through_each_other<2>(120, 0.1, 1); }
BOOST_AUTO_TEST_CASE(in_three_dimensions) { pass_through_each_other<3>(40, 0.15, 4); }

// Lists with a skin serve several steps, with ghosts whose positions are refreshed; then all pairs nearer than
// the reach less what has moved are in them.
BOOST_AUTO_TEST_CASE(lists_hold_until_the_skin_is_used_up) {
  const auto world = domain::communicator::world();
  auto all = crossing<2>();
  const auto support = all.reach;
  constexpr double skin = 0.4, dt = 0.02;
  for (double& reach : all.reach) reach += skin;
  simulated<2> is(all, world);
  search<2> expected(all);
  std::size_t wrong = 0;
  int rebuilt = 0, steps = 0;
  for (; steps < 100; ++steps) {
    std::array<double, 2> longest{is.m.moved(0), is.m.moved(1)};
    world.maximum(longest);
    const double limit = 2.0 * std::max(longest[0], longest[1]) + 2.0 * 1.5 * dt;  // after the step that comes
    if (steps == 0 || limit > skin) {
      is.m.rebuild();
      ++rebuilt;
    } else {
      for (std::size_t a = 0; a < 2; ++a) is.m.update_ghosts(a, {}, true);
    }
    for (std::size_t a = 0; a < 2; ++a)
      for (std::size_t b = 0; b < 2; ++b) {
        auto lists = is.lists(a, b, support[2 * a + b]);
        for (std::size_t i = 0; i < lists.size(); ++i) {
          auto should = expected.neighbours(a, static_cast<std::size_t>(is.m[a].s.id[i]), b,
                                            [&](std::size_t) { return support[2 * a + b]; });
          std::sort(lists[i].begin(), lists[i].end());
          std::sort(should.begin(), should.end());
          wrong += lists[i] != should;
        }
      }
    is.move(dt);
    expected.move(dt);
  }
  BOOST_TEST(wrong == 0U);
  BOOST_TEST(rebuilt > 5);
  BOOST_TEST(rebuilt < steps / 3);
}

namespace {

// Grains touch where their radii say so: the reach is that of the pair of particles.
struct sum_of_radii {
  const std::vector<double>*mine, *others;
  double most;  // m, no pair's reach is longer

  struct of_cluster {
    foundation::real mine;
    const std::vector<double>* others;
    double most;
    foundation::real squared(std::uint32_t j) const {
      const foundation::real both = mine + (*others)[j];
      return both * both;
    }
  };
  of_cluster of(std::size_t first, std::size_t n) const {
    return {cells::of_members(mine->data() + first, n), others, most};
  }
};

}  // namespace

BOOST_AUTO_TEST_CASE(reach_of_each_pair_of_particles) {
  const auto world = domain::communicator::world();
  auto all = crossing<2>();
  const auto radius = [](std::size_t a, std::int64_t id) { return 0.3 + 0.2 * noise(id, 77 + a); };  // m
  all.reach.assign(4, 1.0);
  simulated<2> is(all, world);
  search<2> expected(all);
  std::size_t wrong = 0;
  for (int n = 0; n < 20; ++n) {
    std::array<std::vector<double>, 2> radii;
    is.m.rebuild(false, [&](std::size_t a, std::size_t b) {
      for (const std::size_t c : {a, b}) {
        radii[c].clear();
        for (std::size_t i = 0; i < is.m[c].s.total(); ++i) radii[c].push_back(radius(c, is.m[c].s.id[i]));
      }
      return sum_of_radii{&radii[a], &radii[b], 1.0};
    });
    wrong += is.differences(expected, [&](std::size_t a, std::size_t i, std::size_t b, std::size_t j) {
      return radius(a, static_cast<std::int64_t>(i)) + radius(b, static_cast<std::int64_t>(j));
    });
    is.move(0.3);
    expected.move(0.3);
  }
  BOOST_TEST(wrong == 0U);
}

// A few far from all others: cells are stored sparsely. A species may be alone on a rank, and one may be empty.
BOOST_AUTO_TEST_CASE(far_apart) {
  const auto world = domain::communicator::world();
  scenario<3> all;
  all.box.length.fill(4.0);
  all.streams = {{150, {}, 0.7, 1}, {60, {300.0, 200.0, -100.0}, 1.1, 500}, {0, {}, 1.0, 900}};
  all.reach = {0.6, 1.1, 1.0, 0.9, 1.3, 0.0, 1.0, 1.0, 1.0};
  simulated<3> is(all, world);
  search<3> expected(all);
  for (auto* at : {&is.m[1].s.x[0], &is.m[1].s.x[1]})
    for (std::size_t i = 0; i < is.m[1].s.fluid; ++i)
      if (is.m[1].s.id[i] < 4) (*at)[i] += 1e4;
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t id = 0; id < 4; ++id) expected.x[1][id][k] += 1e4;
  all.box.length.fill(1e9);  // images that nobody meets
  std::size_t wrong = 0;
  for (int n = 0; n < 3; ++n) {
    is.m.rebuild();
    wrong += is.differences(expected);
    if (n == 0) BOOST_TEST(world.sum(static_cast<std::int64_t>(is.m.list(0, 1).pairs)) > 0);
    if (n == 0 && world.size == 1) BOOST_TEST(is.m[1].grid.sparse);
    is.move(0.01);
    expected.move(0.01);
  }
  BOOST_TEST(wrong == 0U);
  BOOST_TEST(is.m.list(1, 2).rows() == 0U);
}

// So many rows that threads share them.
BOOST_AUTO_TEST_CASE(sums_have_the_same_bits_on_threads) {
  auto all = crossing<2>();
  all.streams[0].number = 6000;
  all.streams[1].number = 4000;
  all.reach.assign(4, 0.4);
  const auto sums = [&](int threads) {
    const int before = omp_get_max_threads();
    omp_set_num_threads(threads);
    simulated<2> is(all, domain::communicator::world());
    is.m.rebuild();
    const auto found = is.sums(0, 1);
    omp_set_num_threads(before);
    return found;
  };
  const auto one = sums(1);
  BOOST_TEST(*std::min_element(one.begin(), one.end()) > 0.0);
  BOOST_TEST(same_bits(one, sums(3)));
}

// With other cuts, and from the list positions, lists are what they were, and particles where they are.
BOOST_AUTO_TEST_CASE(lists_as_they_were) {
  const auto world = domain::communicator::world();
  const auto all = crossing<2>();
  simulated<2> is(all, world), expected(all, alone());
  for (auto* one : {&is, &expected}) {
    one->m.rebuild();
    one->move(0.1);
  }
  for (auto& level : is.m.d.cuts.at)
    for (double& cut : level)
      if (cut > 0.0 && cut < 6.0 && cut != all.box.length[1]) cut *= 0.7;
  is.m.rebuild(true);
  for (std::size_t b = 0; b < 2; ++b) expected.m.update_ghosts(b, {}, true);
  for (std::size_t a = 0; a < 2; ++a)
    for (std::size_t b = 0; b < 2; ++b) {
      BOOST_TEST(same_bits(is.sums(a, b), expected.sums(a, b)));
      std::map<std::int64_t, std::vector<std::int64_t>> by_id;
      const auto lists = expected.lists(a, b), here = is.lists(a, b);
      for (std::size_t i = 0; i < lists.size(); ++i) by_id[expected.m[a].s.id[i]] = lists[i];
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < here.size(); ++i) wrong += here[i] != by_id.at(is.m[a].s.id[i]);
      BOOST_TEST(wrong == 0U);
    }
}

// A field that only one species has, and contacts between the two, travel with the particles.
BOOST_AUTO_TEST_CASE(fields_and_partners_travel) {
  const auto world = domain::communicator::world();
  auto all = crossing<2>();
  constexpr double dt = 0.1;
  simulated<2> is(all, world);
  search<2> expected(all);
  auto& spin = particles::declare(is.m[1].s, "Spin", "1/s", particles::role::integrated);
  particles::allocate(is.m[1].s, is.m[1].s.fluid, 0, 0, 0);
  for (std::size_t i = 0; i < is.m[1].s.fluid; ++i) spin[i] = noise(is.m[1].s.id[i], 5);
  BOOST_TEST(is.m[0].s.extras.empty());
  particles::partners touched(1);  // steps in contact, of those of 1 with those of 0
  touched.reset({is.m[1].s.id.data(), is.m[1].s.fluid});
  is.m.attach(1, touched);
  std::map<std::pair<std::size_t, std::int64_t>, double> counts;
  std::size_t wrong = 0, ended = 0;
  for (int n = 0; n < 100; ++n) {
    is.m.rebuild();
    touched.begin();
    is.m.for_each_pair(1, 0, [&](std::size_t i, std::uint32_t j) { touched.insert(i, is.m[0].s.id[j])[0] += 1.0; });
    touched.commit();
    std::map<std::pair<std::size_t, std::int64_t>, double> now;
    for (std::size_t i = 0; i < expected.x[1].size(); ++i)
      for (const auto j : expected.neighbours(1, i, 0, [&](std::size_t) { return all.of(1, 0); }))
        now[{i, j}] = (counts.contains({i, j}) ? counts[{i, j}] : 0.0) + 1.0;
    for (const auto& [pair, count] : counts) ended += !now.contains(pair);
    counts = std::move(now);
    for (std::size_t i = 0; i < is.m[1].s.fluid; ++i) {
      const auto row = touched.row(i);
      for (std::size_t k = 0; k < row.size(); ++k) {
        const auto found = counts.find({static_cast<std::size_t>(is.m[1].s.id[i]), row[k]});
        wrong += found == counts.end() || found->second != touched.values(i, k)[0];
      }
      wrong += spin[i] != noise(is.m[1].s.id[i], 5);
    }
    wrong += world.sum(static_cast<std::int64_t>(touched.pairs())) != static_cast<std::int64_t>(counts.size());
    is.move(dt);
    expected.move(dt);
  }
  BOOST_TEST(wrong == 0U);
  BOOST_TEST(ended > 1000U);
  // Their ghosts have the field once it is asked for.
  is.m.rebuild();
  is.m.update_ghosts(1, std::array{spin.data()});
  std::size_t other = 0;
  for (std::size_t i = 0; i < is.m[1].s.total(); ++i) other += spin[i] != noise(is.m[1].s.id[i], 5);
  BOOST_TEST(other == 0U);
  BOOST_TEST(world.sum(static_cast<std::int64_t>(is.m[1].s.fluid_ghosts)) > 0);
}

BOOST_AUTO_TEST_CASE(misuse_is_told) {
  using mixture = species::mixture<2>;
  const auto box = crossing<2>().box;
  const auto told = [](const std::string& text) {
    return [=](const std::exception& e) {
      BOOST_TEST(e.what() == text);
      return true;
    };
  };
  BOOST_CHECK_EXCEPTION(mixture(alone(), box, {{"grains", 1.0}, {"grains", 2.0}}), std::logic_error,
                        told("species grains is there twice"));
  BOOST_CHECK_EXCEPTION(mixture(alone(), box, {{"grains", 0.0}}), std::logic_error,
                        told("species grains needs cells with an edge"));
  mixture m(alone(), box, {{"water", 1.0}, {"grains", 1.0}});
  BOOST_TEST(m.index("grains") == 1U);
  BOOST_CHECK_EXCEPTION(m.index("sand"), std::logic_error, told("no species sand"));
  BOOST_CHECK_EXCEPTION(m.set_reach(0, 1, -1.0), std::logic_error, told("a reach of -1.000000 m"));
  BOOST_CHECK_EXCEPTION(m.set_reach(0, 1, 6.1), foundation::error,
                        told("the periodic box, 6.000000 m wide, is narrower than the reach of water for grains, "
                             "6.100000 m"));
  particles::partners rows(1);
  rows.append(3);
  BOOST_CHECK_EXCEPTION(m.attach(0, rows), std::logic_error, told("there are 1 rows of partners for 0 particles"));
  m.list(0, 1).interleave = 2;
  BOOST_CHECK_THROW(m.for_each_pair(0, 1, [](std::size_t, std::uint32_t) {}), std::logic_error);
}
