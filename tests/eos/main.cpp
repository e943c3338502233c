#define BOOST_TEST_MODULE eos
#include <boost/test/unit_test.hpp>
