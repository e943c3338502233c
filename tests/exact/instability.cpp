// Growth rates against formulas for flows that have one, and published numbers for one that has not.
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <exact/instability.hpp>
#include <foundation/error.hpp>

namespace exact = tetsuame::exact;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

bool close(double a, double b, double relative) { return std::abs(a - b) <= relative * std::abs(b); }

double growth(const exact::layered_flow& flow, double k) { return k * exact::fastest_mode(flow, k).imag(); }

exact::layered_flow unbounded(std::function<exact::layer_state(double)> at, double gamma, double height,
                              std::vector<double> jumps) {
  return {std::move(at), gamma, 0.0, -height, height, exact::edge::decaying, exact::edge::decaying, std::move(jumps)};
}

}  // namespace

BOOST_AUTO_TEST_CASE(sharp_incompressible_layers) {
  const auto at = [](double y) {
    return y < 0.0 ? exact::layer_state{1.0, -0.5, 1.0} : exact::layer_state{2.0, 0.5, 1.0};
  };
  const double k = 3.0, want = k * std::sqrt(2.0) / 3.0;  // k |dU| sqrt(rho1 rho2)/(rho1 + rho2)
  BOOST_TEST(close(growth(unbounded(at, infinity, 1.0, {0.0}), k), want, 1e-9));
}

// The broken-line profile: U = y within |y| < 1, +-1 beyond [Lord Rayleigh, Proc. London Math. Soc. 11, 57 (1880)]:
// 4 k^2 c^2 = (1 - 2k)^2 - exp(-4k).
BOOST_AUTO_TEST_CASE(rayleighs_shear_layer) {
  const auto at = [](double y) { return exact::layer_state{1.0, std::clamp(y, -1.0, 1.0), 1.0}; };
  for (const double k : {0.2, 0.4, 0.6}) {
    const double want = 0.5 * std::sqrt(std::exp(-4.0 * k) - (1.0 - 2.0 * k) * (1.0 - 2.0 * k));
    BOOST_TEST(close(growth(unbounded(at, infinity, 3.0, {-1.0, 1.0}), k), want, 1e-9));
  }
  // Beyond k = 0.6392 it is stable.
  BOOST_TEST(growth(unbounded(at, infinity, 3.0, {-1.0, 1.0}), 0.7) == 0.0);
}

// U = tanh y grows fastest at k = 0.4446 with 0.1897 [A. Michalke, J. Fluid Mech. 19, 543 (1964), whose
// (1 + tanh y)/2 has half of it], and not at all beyond k = 1.
BOOST_AUTO_TEST_CASE(michalkes_shear_layer) {
  const auto flow = unbounded([](double y) { return exact::layer_state{1.0, std::tanh(y), 1.0}; }, infinity, 12.0, {});
  const double most = growth(flow, 0.4446);
  BOOST_TEST(std::abs(most - 0.1897) < 5e-5, most);
  BOOST_TEST(growth(flow, 0.4446 - 0.01) < most);
  BOOST_TEST(growth(flow, 0.4446 + 0.01) < most);
  BOOST_TEST(growth(flow, 1.1) == 0.0);
}

// The vortex sheet between +-V in gas of sound speed a: c^2 = V^2 + a^2 - a sqrt(a^2 + 4 V^2), unstable
// for V < sqrt(2) a [L. D. Landau, Dokl. Akad. Nauk SSSR 44, 139 (1944)].
BOOST_AUTO_TEST_CASE(compressible_vortex_sheet) {
  const double gamma = 1.4, a = 1.0, p = a * a / gamma;
  const auto flow = [&](double V) {
    return unbounded([=](double y) { return exact::layer_state{1.0, y < 0.0 ? -V : V, p}; }, gamma, 1.0, {0.0});
  };
  for (const double V : {0.1, 0.5, 0.9, 1.3}) {
    const double want = std::sqrt(a * std::sqrt(a * a + 4.0 * V * V) - V * V - a * a);
    BOOST_TEST(close(growth(flow(V), 2.0), 2.0 * want, 1e-8), V);
  }
  BOOST_TEST(growth(flow(1.5), 2.0) == 0.0);
}

BOOST_AUTO_TEST_CASE(sharp_layers_under_gravity) {
  const double g = 10.0, k = 2.0;
  BOOST_TEST(close(exact::rayleigh_taylor_growth(k, g, 3.0, 1.0), std::sqrt(0.5 * g * k), 1e-15));
  BOOST_TEST(exact::rayleigh_taylor_growth(k, g, 1.0, 3.0) == 0.0);
  const auto at = [](double y) { return exact::layer_state{y < 0.0 ? 1.0 : 3.0, 0.0, 1.0}; };
  const exact::layered_flow box{at, infinity, g, -0.4, 0.7, exact::edge::wall, exact::edge::wall, {0.0}};
  BOOST_TEST(close(growth(box, k), exact::rayleigh_taylor_growth(k, g, 3.0, 1.0, 0.7, 0.4), 1e-9));
}

// Any gas, compressible and layered, that lies over a light one without weight: eta ~ exp(-k y), P = 0, growth
// sqrt(g k), exactly (the unstable twin of the surface wave). Here isothermal, to 8 wavelengths of k.
BOOST_AUTO_TEST_CASE(compressible_gas_over_nothing) {
  const double g = 1.0, k = 3.0, scale = 0.8;
  const auto at = [=](double y) {
    return exact::layer_state{std::exp(-y / scale), 0.0, g * scale * std::exp(-y / scale)};
  };
  const exact::layered_flow flow{at, 1.4, g, 0.0, 6.0, exact::edge::free, exact::edge::wall, {}};
  BOOST_TEST(close(growth(flow, k), std::sqrt(g * k), 1e-9));
}

// rho ~ exp(y/L), incompressible, between walls: sigma^2 = (g/L) k^2/(k^2 + pi^2/H^2 + 1/(4 L^2)) [Chandrasekhar
// (1961), section 92c].
BOOST_AUTO_TEST_CASE(exponential_layers) {
  const double g = 9.0, L = 0.5, H = 1.2, k = 4.0, pi = std::acos(-1.0);
  const exact::layered_flow flow{[=](double y) {
                                   return exact::layer_state{std::exp(y / L), 0.0, 1.0};
                                 },
                                 infinity,
                                 g,
                                 0.0,
                                 H,
                                 exact::edge::wall,
                                 exact::edge::wall,
                                 {}};
  const double want = std::sqrt(g / L * k * k / (k * k + pi * pi / (H * H) + 0.25 / (L * L)));
  BOOST_TEST(close(growth(flow, k), want, 1e-9));
}

// Two equal layers between walls, or between free edges: the factor coth(kh) or tanh(kh) is the same
// for both layers and drops out of k |dU|/2.
BOOST_AUTO_TEST_CASE(edges_of_a_periodic_strip) {
  const auto at = [](double y) { return exact::layer_state{1.0, y < 0.0 ? -0.5 : 0.5, 1.0}; };
  for (const exact::edge kind : {exact::edge::wall, exact::edge::free}) {
    const exact::layered_flow flow{at, infinity, 0.0, -0.25, 0.25, kind, kind, {0.0}};
    BOOST_TEST(close(growth(flow, 2.0), 1.0, 1e-9));
  }
}

BOOST_AUTO_TEST_CASE(mistakes_are_refused) {
  namespace foundation = tetsuame::foundation;
  auto flow = unbounded([](double) { return exact::layer_state{1.0, 0.0, 1.0}; }, infinity, 1.0, {});
  BOOST_TEST(growth(flow, 1.0) == 0.0);
  flow.g = 1.0;
  BOOST_CHECK_THROW(exact::fastest_mode(flow, 1.0), foundation::error);
}
