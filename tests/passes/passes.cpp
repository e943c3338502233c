// Lists of passes on a box of particles without physics: the order of steps that follows from what they read and write,
// refusals by name, and sums of several generations, whose bits are to be the same on any number of ranks.
#include <cmath>
#include <passes/evaluation.hpp>
#include <run/start.hpp>

#include "../support/numbers.hpp"

using namespace tetsuame;
using namespace tetsuame::test;

namespace {

// Σ_j f_j W_ij, of a field that neighbours are asked for.
struct weighted_sum {
  const double* f;
  double* out;

  template <class R>
  struct me {
    R sum;
  };
  auto reads() const { return std::tuple{pairs::read(pairs::of_weight, f)}; }
  template <class R>
  me<R> begin(const pairs::cluster<R>&) const {
    return {R(0.0)};
  }
  void add(auto& a, const auto& ij) const { a.sum += ij(pairs::of_weight) * ij.W; }
  void end(const auto& i, const auto& a) const { i.set(out, a.sum, -2); }
};

// A periodic square, or one between two mirrors, with fields of its own.
struct scaffold {
  run::state<2> box;
  particles::particles<2>& s = box.w.s;
  particles::array& first = particles::declare(s, "First", "1", particles::role::derived);
  particles::array& second = particles::declare(s, "Second", "1", particles::role::derived);
  particles::array& third = particles::declare(s, "Third", "1", particles::role::derived);
  passes::evaluation<2> e{box};

  explicit scaffold(bool walls = false) {
    domain::options domain{.length = {24.0, 12.0, 1.0}, .particles = {24, 12, 1}, .periodic = {true, !walls, true}};
    domain.jitter = 0.2;
    run::set_up<2>(box, domain::communicator::world(), domain, walls::options{},
                   {.name = "wendland_c4", .h_over_dx = 1.3, .skin = 0.2}, 3.0);
    box.treatment = walls::mirror{};
    for (std::size_t i = 0; i < s.fluid; ++i) {
      s.m[i] = 1.0;
      s.T[i] = noise(s.id[i], 1);
      s.rho[i] = noise(s.id[i], 2);
    }
  }
  // Copies, sums and their sums; rate of T: the last of these.
  void declare() {
    e.integrate(s.T, {.name = "T", .scale = 1.0});
    e.integrate(s.rho, {.name = "rho", .scale = 1.0});
    e.each("double", {.reads = {s.T}, .writes = {first}}, [this](std::size_t i) { first[i] = 2.0 * s.T[i]; });
    add_sum("first sum", first, second);
    e.each("of the first sum", {.reads = {second, s.rho}, .writes = {third}},
           [this](std::size_t i) { third[i] = second[i] * s.rho[i]; });
    e.sum("second sum", {.at_neighbours = {third}, .accumulates = {s.T}}, [this](const auto& rows) {
      box.w.sum(rows, weighted_sum{third.data(), e.rate(0)});
    });
    e.each("rates", {.rates = {s.T, s.rho}}, [this](std::size_t i) {
      e.rate(0)[i] += 1.0;
      e.rate(1)[i] = 0.0;
    });
  }
  void add_sum(const char* name, particles::array& from, particles::array& to) {
    e.sum(name, {.at_neighbours = {from}, .writes = {to}}, [&](const auto& rows) {
      box.w.sum(rows, weighted_sum{from.data(), to.data()});
    });
  }
  void complete() { e.complete(passes::behind_walls::images); }
  void make_lists() {
    run::rebuild(box, false);
    particles::clear_derived(s);
  }
};

std::string refusal_of(scaffold& of) {
  try {
    of.complete();
  } catch (const std::logic_error& e) {
    return e.what();
  }
  return "";
}

// Rates of T of all ranks, by ID.
std::vector<double> rates_by_id(scaffold& of) {
  std::vector<double> T(of.s.fluid), rho(of.s.fluid);
  const std::array<double*, 2> rates{T.data(), rho.data()};
  of.e.run(std::span<double* const>(rates));
  std::vector<double> ids(of.s.id.begin(), of.s.id.begin() + static_cast<std::ptrdiff_t>(of.s.fluid));
  const auto& ranks = of.box.w.d.ranks;
  const auto all = of_all_ranks(ranks, T), places = of_all_ranks(ranks, ids);
  std::vector<double> sorted(all.size());
  for (std::size_t k = 0; k < all.size(); ++k) sorted[static_cast<std::size_t>(places[k])] = all[k];
  return sorted;
}

// The same by searches through all particles and their images, in long double.
std::vector<double> by_search(bool walls) {
  constexpr std::size_t n = 24 * 12;
  const auto x = [&](std::size_t id) {
    run::lattice_block<2> lattice{.number = {24, 12}, .spacing = {1.0, 1.0}};
    return run::detail::start_place<2>(lattice,
                                       {static_cast<std::int64_t>(id % 24), static_cast<std::int64_t>(id / 24)},
                                       static_cast<std::int64_t>(id), 0.2);
  };
  const auto kernel = kernels::make<2>("wendland_c4", 1.3);
  const auto sum = [&](const std::vector<double>& f) {
    std::vector<double> all(n);
    for (std::size_t i = 0; i < n; ++i) {
      long double total = 0.0L;
      for (std::size_t j = 0; j < n; ++j)
        for (int a = -1; a <= 1; ++a)
          for (int b = -1; b <= 1; ++b) {
            const auto x_i = x(i), x_j = x(j);
            const double y = !walls || b == 0 ? x_j[1] + 12.0 * b : b < 0 ? -x_j[1] : 24.0 - x_j[1];
            const double r = std::hypot(x_i[0] - x_j[0] - 24.0 * a, x_i[1] - y);
            if (r > 0.0 && r < std::visit([](const auto& k) { return k.support(); }, kernel))
              total += f[j] * std::visit([&](const auto& k) { return k.value(r); }, kernel);
          }
      all[i] = static_cast<double>(total);
    }
    return all;
  };
  std::vector<double> f(n);
  for (std::size_t i = 0; i < n; ++i) f[i] = 2.0 * noise(static_cast<std::int64_t>(i), 1);
  f = sum(f);
  for (std::size_t i = 0; i < n; ++i) f[i] *= noise(static_cast<std::int64_t>(i), 2);
  f = sum(f);
  for (double& value : f) value += 1.0;
  return f;
}

}  // namespace

BOOST_AUTO_TEST_CASE(interior_rows_go_while_fields_travel) {
  scaffold of;
  of.declare();
  of.complete();
  BOOST_TEST(of.e.describe() ==
             "begin exchange Temperature\n"
             "each double\n"
             "sum first sum, interior\n"
             "end exchange \n"
             "each of ghosts double\n"
             "images First\n"
             "sum first sum, border\n"
             "each of the first sum\n"
             "begin exchange Third\n"
             "sum second sum, interior\n"
             "end exchange \n"
             "images Third\n"
             "sum second sum, border\n"
             "each rates\n");
}

// Its sources travel for something else; so it need not.
BOOST_AUTO_TEST_CASE(what_can_be_computed_of_ghosts_does_not_travel) {
  scaffold of;
  auto& e = of.e;
  auto& s = of.s;
  e.integrate(s.T, {.name = "T", .scale = 1.0});
  of.add_sum("sum of T", s.T, of.first);
  e.each("square", {.reads = {of.first, s.T}, .writes = {of.second}}, [](std::size_t) {});
  of.add_sum("sum of squares", of.second, of.third);
  e.sum("sum of the first", {.at_neighbours = {of.first}, .accumulates = {s.T}}, [](const auto&) {});
  e.each("rates", {.rates = {s.T}}, [](std::size_t) {});
  of.complete();
  BOOST_TEST(e.describe() ==
             "begin exchange Temperature\n"
             "sum sum of T, interior\n"
             "end exchange \n"
             "images Temperature\n"
             "sum sum of T, border\n"
             "each square\n"
             "begin exchange First\n"
             "sum sum of squares, interior\n"
             "sum sum of the first, interior\n"
             "end exchange \n"
             "each of ghosts square\n"
             "images First Second\n"
             "sum sum of squares, border\n"
             "sum sum of the first, border\n"
             "each rates\n");
}

BOOST_AUTO_TEST_CASE(lists_that_do_not_fit_together_are_refused_by_name) {
  {
    scaffold of;
    of.e.integrate(of.s.T, {.name = "T"});
    of.add_sum("forces", of.first, of.second);
    of.e.each("rates", {.rates = {of.s.T}}, [](std::size_t) {});
    BOOST_TEST(refusal_of(of) == "list of passes: 'forces' reads First, which no pass before it writes");
  }
  {
    scaffold of;
    of.declare();
    of.e.each("once more", {.reads = {of.s.T}, .writes = {of.second}}, [](std::size_t) {});
    BOOST_TEST(refusal_of(of) == "list of passes: 'first sum' and 'once more' both write Second");
  }
  {
    scaffold of;
    of.declare();
    of.e.each("too late", {.rates = {of.s.T}}, [](std::size_t) {});
    BOOST_TEST(refusal_of(of) == "list of passes: 'rates' has written the rate of Temperature before 'too late'");
  }
  {
    scaffold of;
    of.e.integrate(of.s.T, {.name = "T"});
    BOOST_TEST(refusal_of(of) == "list of passes: no pass writes the rate of Temperature");
  }
  {
    scaffold of;
    of.e.integrate(of.s.T, {.name = "T"});
    of.e.each("set", {.writes = {of.s.T}}, [](std::size_t) {});
    BOOST_TEST(refusal_of(of) == "list of passes: 'set' writes Temperature, which is known already");
  }
  {
    scaffold of;
    of.e.integrate(of.s.T, {.name = "T"});
    of.e.each("more", {.updates = {of.third}}, [](std::size_t) {});
    BOOST_TEST(refusal_of(of) == "list of passes: 'more' updates Third, which no pass before it writes");
  }
  {
    scaffold of;
    of.e.integrate(of.s.T, {.name = "T"});
    of.e.walls("walls", {.at_neighbours = {of.s.T}, .gives = {of.s.T}}, [] {});
    of.e.walls("other walls", {.at_neighbours = {of.s.T}, .gives = {of.s.T}}, [] {});
    BOOST_TEST(refusal_of(of) == "list of passes: 'walls' and 'other walls' both give Temperature behind walls");
  }
  {
    scaffold of;
    of.declare();
    try {
      of.e.complete(passes::behind_walls::particles);
      BOOST_TEST(false);
    } catch (const std::logic_error& e) {
      BOOST_TEST(std::string(e.what()) ==
                 "list of passes: 'first sum' reads First behind walls, where no pass gives it");
    }
  }
}

BOOST_AUTO_TEST_CASE(sums_of_sums_are_those_of_a_search_on_any_ranks) {
  for (const bool walls : {false, true}) {
    scaffold of(walls);
    of.declare();
    of.complete();
    of.make_lists();
    const auto found = rates_by_id(of), expected = by_search(walls);
    double worst = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) worst = std::max(worst, std::abs(found[i] - expected[i]));
    BOOST_TEST(worst < 1e-13);
    BOOST_TEST(same_bits(found, rates_by_id(of)));
  }
}

// A fault of an earlier pass goes before one of a later pass, whichever particle it is of.
BOOST_AUTO_TEST_CASE(the_first_fault_is_that_of_the_earliest_pass) {
  scaffold of;
  auto& fault = of.box.w.first_fault;
  of.e.integrate(of.s.T, {.name = "T"});
  of.e.whole("late", {.reads = {of.s.T}, .writes = {of.first}}, [&] { fault.report(7, "cause"); });
  of.e.whole("later", {.reads = {of.first}, .writes = {of.second}}, [&] { fault.report(1, "consequence"); });
  of.e.each("rates", {.rates = {of.s.T}}, [](std::size_t) {});
  of.complete();
  of.make_lists();
  std::vector<double> T(of.s.fluid);
  const std::array<double*, 1> rates{T.data()};
  of.e.run(std::span<double* const>(rates));
  BOOST_TEST(fault.message == "cause");
}

// What is computed behind walls reads images; the field that these follow from is known of ghosts for their sake alone.
BOOST_AUTO_TEST_CASE(images_by_another_field) {
  scaffold s(true);
  s.e.integrate(s.s.rho, {.name = "rho", .scale = 1.0});
  s.e.mirrored(walls::hydrostatic(s.second, s.first, s.box.w.g));
  s.e.each("density", {.reads = {s.s.rho}, .writes = {s.first}}, [](std::size_t) {});
  s.e.whole("pressure", {.reads = {s.first}, .writes = {s.second}}, [] {});
  s.e.each(
      "stress", {.reads = {s.second}, .writes = {s.third}}, [](std::size_t) {}, true);
  s.e.sum("forces", {.at_neighbours = {s.third}, .rates = {s.s.rho}}, [](const auto&) {});
  BOOST_TEST(refusal_of(s) == "");
}
