#define BOOST_TEST_MODULE namelist
#include <boost/test/unit_test.hpp>
