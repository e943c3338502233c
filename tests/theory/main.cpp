#define BOOST_TEST_MODULE theory
#include <boost/test/unit_test.hpp>
