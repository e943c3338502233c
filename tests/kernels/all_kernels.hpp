// What the tests of kernels go through: all kernels, and their knots.
#pragma once

#include <boost/mpl/list.hpp>
#include <kernels/kernel.hpp>

namespace tetsuame::kernels::test {

using all_kernels =
    boost::mpl::list<quintic_spline<1>, quintic_spline<2>, quintic_spline<3>, cubic_spline<1>, cubic_spline<2>,
                     cubic_spline<3>, wendland_c2<1>, wendland_c2<2>, wendland_c2<3>, wendland_c4<1>, wendland_c4<2>,
                     wendland_c4<3>, wendland_c6<1>, wendland_c6<2>, wendland_c6<3>>;

inline constexpr double support = 2.5e4;  // m: of the size of a planetary run, so that units matter

// A grid of thirds contains the knots of both splines (h = S/3, S/2 lie on sixths).
inline double knot(int k) { return support * k / 6.0; }

}  // namespace tetsuame::kernels::test
