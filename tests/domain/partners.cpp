// Values of pairs that migrate with their particles and are read back on any number of ranks, against a search that
// knows no ranks: grains that fly through a periodic box and through each other.
#include <array>
#include <cmath>
#include <domain/partners.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <numeric>
#include <output/checkpoint.hpp>
#include <span>
#include <string>
#include <vector>

#include "../support/numbers.hpp"

using namespace tetsuame;
using namespace tetsuame::test;

namespace {

constexpr std::int64_t grains = 90;
constexpr double contact = 0.7, step_length = 0.05;  // m, s
constexpr domain::box<2> region{{8.0, 5.0}, {true, true}};

// Its first value is what squared distances add up to in the contact, the second one the number of steps.
using values_by_pair = std::map<std::pair<std::int64_t, std::int64_t>, std::array<double, 2>>;

void add(std::span<double> value, double r2) {
  value[0] += r2 / 3.0;
  value[1] += 1.0;
}

std::array<double, 2> start(std::int64_t id) {
  return {4.0 * (1.0 + noise(id, 1)), 2.5 * (1.0 + noise(id, 2))};  // m
}
std::array<double, 2> velocity(std::int64_t id) { return {3.0 * noise(id, 3), 2.0 * noise(id, 4)}; }  // m/s

// All grains, without ranks: each pair is looked at with all images.
struct search {
  std::array<std::vector<double>, 2> x;
  values_by_pair values;
  std::size_t begun = 0, ended = 0;  // contacts

  search() {
    for (std::int64_t id = 0; id < grains; ++id)
      for (std::size_t a = 0; a < 2; ++a) x[a].push_back(start(id)[a]);
  }
  void step() {
    for (std::int64_t id = 0; id < grains; ++id)
      for (std::size_t a = 0; a < 2; ++a) {
        double& at = x[a][static_cast<std::size_t>(id)];
        at += velocity(id)[a] * step_length;
        if (at < 0.0 || at >= region.length[a]) at += -std::floor(at / region.length[a]) * region.length[a];
      }
    values_by_pair now;
    for (std::size_t i = 0; i < grains; ++i)
      for (std::size_t j = 0; j < grains; ++j)
        for (const double shift_x : {-8.0, 0.0, 8.0}) {
          const double dx = x[0][i] - (x[0][j] + shift_x);
          if (i == j || std::abs(dx) > contact) continue;
          for (const double shift_y : {-5.0, 0.0, 5.0}) {
            const double dy = x[1][i] - (x[1][j] + shift_y), r2 = dx * dx + dy * dy;
            if (r2 >= contact * contact) continue;
            const std::pair key{static_cast<std::int64_t>(i), static_cast<std::int64_t>(j)};
            const auto before = values.find(key);
            begun += before == values.end();
            auto& value = now[key];
            if (before != values.end()) value = before->second;
            add(value, r2);
          }
        }
    ended += values.size() + begun;
    values = std::move(now);
    ended -= values.size() + begun;
  }
};

struct scene {
  domain::decomposition<2> d;
  particles::particles<2> s;
  particles::partners history{2};
  std::int64_t arrived = 0;  // on this rank

  explicit scene(const domain::communicator& ranks) : d(domain::decompose<2>(ranks, region, contact)) {
    particles::allocate(s, 0, 0, 0, 0);
  }
  void give(std::span<const std::int64_t> ids) {
    particles::allocate(s, ids.size(), 0, 0, 0);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      s.id[i] = ids[i];
      for (std::size_t a = 0; a < 2; ++a) {
        s.x[a][i] = start(ids[i])[a];
        s.v[a][i] = velocity(ids[i])[a];
      }
    }
  }
  std::span<const std::int64_t> owned() const { return {s.id.data(), s.fluid}; }

  // New owners, a new order that nobody could foresee, new ghosts.
  void rebuild(std::uint64_t salt) {
    std::vector<std::int64_t> before(owned().begin(), owned().end());
    std::sort(before.begin(), before.end());
    domain::wrap(d.region, s);
    domain::migrate(d, s, std::array{&history});
    for (const std::int64_t id : owned()) arrived += !std::binary_search(before.begin(), before.end(), id);
    std::vector<std::uint32_t> order(s.fluid);
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(),
              [&](auto i, auto j) { return noise(s.id[i], 10 + salt) < noise(s.id[j], 10 + salt); });
    particles::reorder(s, 0, std::span<const std::uint32_t>(order));
    history.reorder(order);
    domain::make_halo<2>(d, s, 0, s.fluid, s.fluid, d.fluid_halo,
                         [&](std::size_t ghosts) { particles::allocate(s, s.fluid, ghosts, 0, 0); });
  }
  void step(std::uint64_t number) {
    for (std::size_t a = 0; a < 2; ++a)
      for (std::size_t i = 0; i < s.fluid; ++i) s.x[a][i] += s.v[a][i] * step_length;
    rebuild(number);
    history.begin();
    for (std::size_t i = 0; i < s.fluid; ++i)
      for (std::size_t j = 0; j < s.total(); ++j) {
        const double dx = s.x[0][i] - s.x[0][j], dy = s.x[1][i] - s.x[1][j], r2 = dx * dx + dy * dy;
        if (i != j && r2 < contact * contact) add(history.insert(i, s.id[j]), r2);
      }
    history.commit();
  }

  // On this rank, rows in their order against those of the search; bits.
  std::size_t differences(const values_by_pair& expected) const {
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      auto e = expected.lower_bound({s.id[i], -1});
      for (std::size_t k = 0; k < history.row(i).size(); ++k, ++e) {
        if (e == expected.end() || e->first != std::pair{s.id[i], history.row(i)[k]}) return wrong + 1;
        for (std::size_t c = 0; c < 2; ++c) wrong += bits(history.values(i, k)[c]) != bits(e->second[c]);
      }
      wrong += e != expected.end() && e->first.first == s.id[i];
    }
    wrong += d.ranks.sum(static_cast<std::int64_t>(history.pairs())) != static_cast<std::int64_t>(expected.size());
    return wrong;
  }
};

scene all_grains(const domain::communicator& ranks) {
  scene all(ranks);
  std::vector<std::int64_t> ids;
  for (std::int64_t id = ranks.rank; id < grains; id += ranks.size) ids.push_back(id);
  all.give(ids);
  all.history.reset(all.owned());
  return all;
}

std::string fresh_directory() {
  const auto world = domain::communicator::world();
  const auto path =
      std::filesystem::path(TETSUAME_BINARY_DIR) / "tests" / ("partners_scratch." + std::to_string(world.size));
  if (world.rank == 0) {
    std::filesystem::remove_all(path);
    std::filesystem::create_directories(path);
  }
  MPI_Barrier(world.comm);
  return path.string();
}

// The first n ranks of all; nobody on the others.
domain::communicator first_ranks(int n) {
  const auto world = domain::communicator::world();
  domain::communicator part{MPI_COMM_NULL, world.rank, n};
  MPI_Comm_split(world.comm, world.rank < n ? 0 : MPI_UNDEFINED, world.rank, &part.comm);
  return part;
}

void write(const scene& from, const std::string& directory) {
  const auto t = domain::table_of(from.d.ranks, from.history);
  const auto& s = from.s;
  output::table_view grains_view{
      "grains",
      s.fluid,
      s.id.data(),
      {{"x_0", s.x[0].data()}, {"x_1", s.x[1].data()}, {"v_0", s.v[0].data()}, {"v_1", s.v[1].data()}},
      {}};
  output::table_view pairs_view{"contacts",
                                t.ids.size(),
                                t.ids.data(),
                                {{"history_0", t.values[0].data()}, {"history_1", t.values[1].data()}},
                                {{"owner", t.owner.data()}, {"partner", t.partner.data()}}};
  output::write_checkpoint(from.d.ranks.comm, directory, 1, {}, {grains_view, pairs_view});
}

scene read(const domain::communicator& ranks, const std::string& directory) {
  const auto state = output::read_checkpoint(ranks.comm, directory + "/" + output::checkpoint_name(1));
  scene to(ranks);
  const auto& rows = state.tables.at("grains");
  to.give(rows.ids);
  for (std::size_t a = 0; a < 2; ++a) {
    const auto& x = rows.reals.at("x_" + std::to_string(a));
    std::copy(x.begin(), x.end(), to.s.x[a].begin());
  }
  const auto& pairs = state.tables.at("contacts");
  const particles::pair_table t{pairs.ids,
                                pairs.integers.at("owner"),
                                pairs.integers.at("partner"),
                                {pairs.reals.at("history_0"), pairs.reals.at("history_1")}};
  domain::read_table(to.d, to.owned(), t, to.history);
  return to;
}

std::string contents(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

BOOST_AUTO_TEST_CASE(contacts_over_a_thousand_rebuilds) {
  const auto world = domain::communicator::world();
  auto flying = all_grains(world);
  search expected;
  std::size_t wrong = 0;
  for (std::uint64_t n = 0; n < 1000; ++n) {
    flying.step(n);
    expected.step();
    wrong += flying.differences(expected.values);
  }
  BOOST_TEST(wrong == 0U);
  // It was worth it: contacts last for some steps, begin and end, grains change ranks.
  BOOST_TEST(expected.begun > 10000U);
  BOOST_TEST(expected.ended > 10000U);
  BOOST_TEST(expected.values.size() > 100U);
  BOOST_TEST((world.sum(flying.arrived) > 1000) == (world.size > 1));
}

// The file is the same on every number of ranks, and every number of ranks goes on from it as if nothing had been.
BOOST_AUTO_TEST_CASE(saved_on_p_ranks_read_on_q) {
  const auto directory = fresh_directory();
  const auto file = directory + "/" + output::checkpoint_name(1);
  const auto world = domain::communicator::world();
  search at_save;
  for (int n = 0; n < 60; ++n) at_save.step();
  std::string first;
  for (int p = 1; p <= world.size; ++p) {
    if (const auto writers = first_ranks(p); writers.comm != MPI_COMM_NULL) {
      auto all = all_grains(writers);
      for (std::uint64_t n = 0; n < 60; ++n) all.step(n);
      BOOST_TEST(all.differences(at_save.values) == 0U);
      write(all, directory);
    }
    MPI_Barrier(world.comm);
    if (p == 1) first = contents(file);
    BOOST_TEST(!first.empty());
    BOOST_TEST((contents(file) == first), "the file depends on the number of ranks");
    for (int q = 1; q <= world.size; ++q)
      if (const auto readers = first_ranks(q); readers.comm != MPI_COMM_NULL) {
        auto all = read(readers, directory);
        BOOST_TEST(all.differences(at_save.values) == 0U);
        auto expected = at_save;
        for (std::uint64_t n = 0; n < 40; ++n) {
          all.step(n);
          expected.step();
        }
        BOOST_TEST(all.differences(expected.values) == 0U);
      }
    MPI_Barrier(world.comm);
  }
}

BOOST_AUTO_TEST_CASE(no_pairs_at_all_are_saved_too) {
  const auto world = domain::communicator::world();
  const auto directory = fresh_directory();
  write(all_grains(world), directory);
  const auto all = read(world, directory);
  BOOST_TEST(all.differences({}) == 0U);
  BOOST_TEST(all.history.rows() == all.s.fluid);
}

// What a file may have wrong is thrown on all ranks, whoever reads the row.
BOOST_AUTO_TEST_CASE(faults_of_tables_are_told_on_all_ranks) {
  const auto world = domain::communicator::world();
  auto all = all_grains(world);
  const auto last = static_cast<int>(world.rank + 1 == world.size);
  const auto told = [&](const std::string& text, const particles::pair_table& t, std::vector<std::int64_t> ids) {
    BOOST_CHECK_EXCEPTION(domain::read_table(all.d, ids, t, all.history), foundation::error,
                          [&](const foundation::error& e) {
                            BOOST_TEST(e.what() == text);
                            return e.status() == foundation::exit_status::file_failed;
                          });
  };
  const auto table = [&](std::vector<std::array<std::int64_t, 2>> pairs, std::size_t values = 2) {
    particles::pair_table t;
    t.values.assign(values, std::vector<double>(pairs.size(), 1.0));
    for (const auto& [owner, partner] : pairs) {
      t.ids.push_back(static_cast<std::int64_t>(t.ids.size()));
      t.owner.push_back(owner);
      t.partner.push_back(partner);
    }
    return t;
  };
  const std::vector<std::int64_t> mine(all.owned().begin(), all.owned().end());
  told("there are values of the pair of particles 95 and 3, but no particle 95",
       last ? table({{3, 4}, {95, 3}, {97, 3}}) : table({}), mine);
  told("there are values of the pair of particles -2 and 3, but no particle -2", last ? table({{-2, 3}}) : table({}),
       mine);
  // The same pair in rows of two ranks.
  told("there are values of the pair of particles 7 and 8 twice",
       world.size == 1           ? table({{7, 8}, {8, 7}, {7, 8}})
       : last || world.rank == 0 ? table({{7, 8}})
                                 : table({}),
       mine);
  auto twice = mine;
  if (last) twice.push_back(0);
  told("particle 0 is there twice", table({}), twice);
  told("pairs have 3 values in the table, and 2 in this run", table({}, 3), mine);
  // Partners may be of another set of particles.
  domain::read_table(all.d, mine, world.rank == 0 ? table({{5, 1000000}}) : table({}), all.history);
  BOOST_TEST(world.sum(static_cast<std::int64_t>(all.history.pairs())) == 1);
}

// Rows that were left behind when particles were sorted are found before they are handed to another's.
BOOST_AUTO_TEST_CASE(migration_wants_rows_in_the_order_of_the_particles) {
  auto all = all_grains(alone());
  std::vector<std::uint32_t> order(grains);
  std::iota(order.rbegin(), order.rend(), 0U);
  particles::reorder(all.s, 0, std::span<const std::uint32_t>(order));
  BOOST_CHECK_THROW(domain::migrate(all.d, all.s, std::array{&all.history}), std::logic_error);
  all.history.arrange(all.owned());
  BOOST_CHECK_NO_THROW(domain::migrate(all.d, all.s, std::array{&all.history}));
}
