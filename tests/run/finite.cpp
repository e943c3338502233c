// Numbers that are none are found wherever they stand, and told by field, particle and place.
#include <boost/test/unit_test.hpp>
#include <limits>
#include <run/finite.hpp>

#include "../support/mpi.hpp"

using namespace tetsuame;

namespace {

using test::mpi_environment;
BOOST_TEST_GLOBAL_FIXTURE(mpi_environment);

constexpr double infinity = std::numeric_limits<double>::infinity(), none = std::numeric_limits<double>::quiet_NaN();

struct particles_of_two_fields {
  pairs::workspace<2> w;
  std::vector<double> T, body{0.0, 0.0};
  explicit particles_of_two_fields(std::size_t n) : T(n, 300.0) {
    particles::allocate(w.s, n, 0, 0, 0);
    w.d.ranks = domain::communicator::world();
    for (std::size_t i = 0; i < n; ++i) {
      w.s.id[i] = static_cast<std::int64_t>(n - i);  // the first in the arrays has the highest
      w.s.x[0][i] = static_cast<double>(i);
      w.s.x[1][i] = 0.5;
    }
  }
  std::vector<integrators::field> fields() {
    return {{"x", w.s.x[0].data(), 0.0, 1.0},
            {"T", T.data(), 0.0, 1.0},
            {"body_0", body.data(), 0.0, 1.0, 0.0, 0.0, nullptr, body.size()}};
  }
  std::string fault(const std::string& before = "") {
    w.first_fault = {};
    const auto all = fields();
    std::vector<const double*> values;
    for (const auto& f : all) values.push_back(f.data);
    run::report_not_finite<2>(w, all, values, before);
    return w.first_fault.message;
  }
};

}  // namespace

BOOST_AUTO_TEST_CASE(every_place_of_an_array_is_looked_at) {
  for (const std::size_t n : {1, 15, 16, 17, 2048, 2049, 20000}) {
    std::vector<double> first(n + 1, -1e300), second(n, 5e-324);
    first[n] = none;  // beyond
    const std::array<const double*, 2> both{first.data(), second.data()};
    BOOST_TEST(run::all_finite(both, n));
    for (const std::size_t i : {std::size_t{0}, n / 2, n - 1})
      for (auto* of : {&first, &second})
        for (const double bad : {none, infinity, -infinity}) {
          const double kept = std::exchange((*of)[i], bad);
          BOOST_TEST(!run::all_finite(both, n), n << " " << i << " " << bad);
          (*of)[i] = kept;
        }
  }
  BOOST_TEST(run::all_finite({}, 3));
}

BOOST_AUTO_TEST_CASE(the_particle_of_the_lowest_id_is_told_with_its_field) {
  particles_of_two_fields p(5);
  BOOST_TEST(p.fault() == "");
  p.T[1] = infinity;
  BOOST_TEST(p.fault() == "T is inf, not a finite number: particle 4 at (1, 0.5) m");
  p.w.s.x[0][3] = none;
  BOOST_TEST(p.fault("the rate of ") == "the rate of x is nan, not a finite number: particle 2 at (nan, 0.5) m");
  p.body[1] = none;
  BOOST_TEST(p.fault() == "body_0 is nan, not a finite number");
}

// Every field of a table, those that all particles have and those that a problem declares, by role and name.
BOOST_AUTO_TEST_CASE(every_field_of_the_table_is_told_by_its_name) {
  particles_of_two_fields p(5);
  auto& s = p.w.s;
  particles::declare(s, "Support", "m", particles::role::memory);
  particles::declare_vector<2>(s, "Force", "N", particles::role::derived);
  particles::declare_if(false, s, "Absent", "1", particles::role::derived);
  const auto told = [&](const auto& which) {
    p.w.first_fault = {};
    run::report_not_finite_in_table(p.w, which);
    return p.w.first_fault.message;
  };
  const auto all = [](particles::role) { return true; };
  BOOST_TEST(told(all) == "");
  std::size_t number = 0;
  particles::for_each_field<2>(s, [&](const particles::field_info& field, const auto& components) {
    for (std::size_t k = 0; k < components.size(); ++k) {
      auto& values = *components[k];
      BOOST_TEST_REQUIRE(values.size() == s.total() + 1);
      const double kept = std::exchange(values[2], none);
      const std::string name = field.name + (components.size() > 1 ? "_" + std::to_string(k) : "");
      BOOST_TEST(told(all).starts_with(name + " is nan, not a finite number: particle 3 at ("));
      BOOST_TEST(told(particles::travels).empty() == !particles::travels(field.kind));
      values[2] = kept;
      values[s.null()] = none;  // no particle
      BOOST_TEST(told(all) == "");
      ++number;
    }
  });
  BOOST_TEST(number > 20U);
  // Of a rate, with the derived fields that it may follow from.
  particles::extra(s, "Force_1")[2] = s.p[2] = none;
  p.T[2] = none;
  BOOST_TEST(p.fault("the rate of ") ==
             "the rate of T is nan, not a finite number: particle 3 at (2, 0.5) m; nor are its Pressure, Force_1");
}

BOOST_AUTO_TEST_CASE(what_was_agreed_on_is_forgotten) {
  particles_of_two_fields p(3);
  p.T[0] = none;
  p.fault();
  BOOST_CHECK_EXCEPTION(p.w.agree(), foundation::error, [](const foundation::error& e) {
    return e.status() == foundation::exit_status::calculation_failed;
  });
  BOOST_CHECK_NO_THROW(p.w.agree());
}
