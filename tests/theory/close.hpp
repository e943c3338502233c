#pragma once

#include <boost/test/unit_test.hpp>
#include <cmath>

inline boost::test_tools::predicate_result close(double a, double b, double relative) {
  boost::test_tools::predicate_result result(std::abs(a - b) <= relative * std::abs(b));
  if (!result) result.message() << a << " is " << std::abs(a / b - 1.0) << " away from " << b;
  return result;
}
