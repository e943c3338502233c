// A run whose numbers are not finite has not completed.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <run/summary.hpp>

#include "../support/mpi.hpp"

using namespace tetsuame;
using run::first_not_finite;
using json = nlohmann::ordered_json;

namespace {

using test::mpi_environment;
BOOST_TEST_GLOBAL_FIXTURE(mpi_environment);

constexpr double infinity = std::numeric_limits<double>::infinity();

auto fails(foundation::exit_status status, const std::string& says) {
  return [=](const foundation::error& e) {
    return e.status() == status && std::string(e.what()).find(says) != std::string::npos;
  };
}

}  // namespace

BOOST_AUTO_TEST_CASE(numbers_that_are_none_are_found_and_absent_ones_are_not) {
  const json good{{"a", 1.0}, {"b", {{"c", 2}, {"d", {1.0, nullptr, "nan"}}}}, {"e", nullptr}, {"f", true}};
  BOOST_TEST(first_not_finite(good) == "");
  BOOST_TEST(first_not_finite({{"a", 1.0}, {"b", {{"c", 2}, {"d", std::nan("")}}}}) == "b.d (nan)");
  BOOST_TEST(first_not_finite({{"a", {0.0, -infinity}}}) == "a.1 (-inf)");
  BOOST_TEST(first_not_finite(run::or_null(std::nullopt)) == "");
}

BOOST_AUTO_TEST_CASE(a_run_with_a_number_that_is_none_has_not_completed) {
  const auto ranks = domain::communicator::world();
  run::summary s;
  s.metrics["v_rms"] = nullptr;
  s.metrics["limit_thermal"] = run::bound_or_null(infinity);
  BOOST_CHECK_NO_THROW(s.check_finite(ranks));
  s.metrics["v_rms"] = std::nan("");
  BOOST_CHECK_EXCEPTION(s.check_finite(ranks), foundation::error,
                        fails(foundation::exit_status::calculation_failed, "metrics.v_rms (nan)"));
  s.metrics["v_rms"] = 1.0;
  s.conservation = {{"mass", 0.0}, {"energy", infinity}};
  BOOST_CHECK_EXCEPTION(s.check_finite(ranks), foundation::error,
                        fails(foundation::exit_status::calculation_failed, "conservation.energy (inf)"));
}

BOOST_AUTO_TEST_CASE(a_line_of_the_history_names_what_is_none) {
  const std::vector<output::history_column> columns{{"time", "s"}, {"thermal", "J"}};
  BOOST_CHECK_NO_THROW(run::check_line(columns, std::array{0.0, 1.0}));
  BOOST_CHECK_EXCEPTION(run::check_line(columns, std::array{0.0, std::nan("")}), foundation::error,
                        fails(foundation::exit_status::calculation_failed, "thermal is nan"));
}
