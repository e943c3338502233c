// The main function of every test.
#define BOOST_TEST_MODULE tetsuame
#include <boost/test/unit_test.hpp>
