#define BOOST_TEST_MODULE riemann
#include <boost/test/unit_test.hpp>
